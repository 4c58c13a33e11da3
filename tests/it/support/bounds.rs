//! Bounds on the cost of a hostile input: used by the tests of several crates.

use std::{
    io::Write as _,
    sync::mpsc::{RecvTimeoutError, channel},
    thread,
    time::{Duration, Instant},
};

/// Ten times the slowest input in a debug build, and half of what 4000 misspelt names took that
/// were each compared with as many.
const LONGEST: Duration = Duration::from_secs(10);

/// A longer run is taken for endless: the process ends with the input's name.
const ENDLESS: Duration = Duration::from_secs(120);

/// Peak of the whole process, whatever else its tests hold meanwhile: less than 0.2 GiB.
const MOST_MIB: u64 = 2048;

/// Runs `work` on an input.
///
/// # Panics
/// Names the input by its beginning, if that took too long (the whole process ends if it does not
/// end at all), or if the process needed more memory than ever before and than it may.
#[track_caller]
pub fn bounded<T>(input: &str, work: impl FnOnce() -> T) -> T {
    let name: String = input.chars().take(240).collect();
    let (before, begin) = (peak_mib(), Instant::now());
    let answer = watched(&name, work);
    let (took, after) = (begin.elapsed(), peak_mib());
    assert!(
        took <= LONGEST,
        "it took {took:.1?}, {LONGEST:?} at most, for {} bytes: {name}",
        input.len()
    );
    assert!(
        after <= MOST_MIB || after == before,
        "the peak of memory rose from {before} to {after} MiB, {MOST_MIB} at most, over {} bytes: \
         {name}",
        input.len()
    );
    answer
}

/// Runs `work`, and ends the process if it does not end: a loop on this thread cannot be left in
/// any other way.
fn watched<T>(name: &str, work: impl FnOnce() -> T) -> T {
    let (done, waiting) = channel::<()>();
    let name = name.to_owned();
    thread::spawn(move || {
        // Done, or panicked: either drops the sender.
        if waiting.recv_timeout(ENDLESS) == Err(RecvTimeoutError::Timeout) {
            // Not `eprintln!`, whose lines a test keeps until it ends.
            let _ = writeln!(std::io::stderr(), "still running after {ENDLESS:?}: {name}");
            std::process::abort();
        }
    });
    let answer = work();
    drop(done);
    answer
}

/// The most memory that this process ever held. 0 where no system says so: nothing is judged there.
fn peak_mib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kib = status.lines().find_map(|line| {
        let number = line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?;
        number.parse::<u64>().ok()
    });
    assert!(kib.is_some() || !cfg!(target_os = "linux"), "{status}");
    kib.unwrap_or(0) >> 10
}
