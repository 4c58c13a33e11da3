//! A command in a process of its own, with a time limit; what it says goes into files.

use crate::error::CompareError;
use crate::records::adapter::Outcome;
use crate::sink::Sink;
use std::{
    fs::File,
    path::Path,
    process::{Command, ExitStatus, Stdio},
    sync::atomic::Ordering,
    thread,
    time::{Duration, Instant},
};

/// How often an end, the limit and Ctrl-C are looked for.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// The end of a process.
pub(super) struct Ended {
    pub outcome: Outcome,
    pub exit: Option<i32>,
    pub signal: Option<i32>,
    pub took: Duration,
}

/// Runs a command until it ends or `limit` is over, with its output in `stdout.txt` and
/// `stderr.txt` of `folder`.
///
/// # Errors
/// A program that cannot be started; an early end, of which the process hears first.
pub(super) fn run(
    mut command: Command,
    folder: &Path,
    limit: Duration,
    sink: &dyn Sink,
) -> Result<Ended, CompareError> {
    let file = |name: &str| {
        let path = folder.join(name);
        File::create(&path).map_err(|error| CompareError::write(&path, error))
    };
    command
        .stdin(Stdio::null())
        .stdout(file("stdout.txt")?)
        .stderr(file("stderr.txt")?)
        .env("SKIAGRAPH_PROGRESS", "lines")
        .env("NO_COLOR", "1");
    let began = Instant::now();
    let program = command.get_program().to_string_lossy().into_owned();
    let mut child = command
        .spawn()
        .map_err(|error| CompareError::Input(format!("cannot start {program}: {error}")))?;
    let lost = |error| CompareError::Input(format!("cannot wait for {program}: {error}"));
    loop {
        if let Some(status) = child.try_wait().map_err(lost)? {
            return Ok(ended(status, began.elapsed()));
        }
        let is_stopped = sink.stop().load(Ordering::Relaxed);
        if is_stopped || began.elapsed() >= limit {
            // An end of its own in between is as good.
            let _ = child.kill();
            let status = child.wait().map_err(lost)?;
            if is_stopped {
                return Err(CompareError::interrupted());
            }
            return Ok(Ended {
                outcome: Outcome::TimedOut,
                ..ended(status, began.elapsed())
            });
        }
        thread::sleep(POLL_INTERVAL);
    }
}

/// True if the user, or what started this program, ended the process by SIGHUP, SIGINT or SIGTERM:
/// that says nothing about the adapter. 130 is this program's exit code after SIGINT. SIGKILL is
/// left out, as the kernel sends it for want of memory.
pub(super) fn is_from_outside(exit: Option<i32>, signal: Option<i32>) -> bool {
    exit == Some(130) || matches!(signal, Some(1 | 2 | 15))
}

fn ended(status: ExitStatus, took: Duration) -> Ended {
    let outcome = match status.code() {
        Some(0) => Outcome::Done,
        Some(3) => Outcome::Lost,
        // A panic of Rust, and an abort where there are no signals.
        Some(101) => Outcome::Crashed,
        Some(code) if !(0..128).contains(&code) => Outcome::Crashed,
        Some(_) => Outcome::Failed,
        None => Outcome::Crashed,
    };
    Ended {
        outcome,
        exit: status.code(),
        signal: signal(status),
        took,
    }
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> Option<i32> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::sink::Silent;

    #[test]
    fn every_end_is_told_from_the_others() {
        let folder = tempfile::tempdir().unwrap();
        let limit = Duration::from_millis(400);
        for (script, outcome, exit, signal) in [
            ("echo said; exit 0", Outcome::Done, Some(0), None),
            ("exit 1", Outcome::Failed, Some(1), None),
            ("exit 3", Outcome::Lost, Some(3), None),
            ("exit 101", Outcome::Crashed, Some(101), None),
            ("kill -SEGV $$", Outcome::Crashed, None, Some(11)),
            ("kill -TERM $$", Outcome::Crashed, None, Some(15)),
            ("exec sleep 60", Outcome::TimedOut, None, Some(9)),
        ] {
            let mut command = Command::new("sh");
            command.args(["-c", script]);
            let ended = run(command, folder.path(), limit, &Silent).unwrap();
            assert_eq!(
                (ended.outcome, ended.exit, ended.signal),
                (outcome, exit, signal),
                "{script}"
            );
            let said = std::fs::read_to_string(folder.path().join("stdout.txt")).unwrap();
            let is_stopped = is_from_outside(ended.exit, ended.signal);
            assert_eq!(is_stopped, script == "kill -TERM $$", "{script}");
            assert_eq!(said == "said\n", script.starts_with("echo"), "{script}");
        }
        let nothing = run(Command::new("/no/such"), folder.path(), limit, &Silent);
        assert!(nothing.err().unwrap().to_string().contains("/no/such"));
    }
}
