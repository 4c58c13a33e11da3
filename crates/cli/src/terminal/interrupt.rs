//! Ctrl-C: the first one requests a clean stop, and ends the process where nothing takes notice of
//! it; the second one ends the process at once.

use crate::error::CliError;
use crate::terminal::{console, progress::Terminal, stop};
use skiagraph_compare::{files::write::remove_unfinished, sink::Sink};
use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use std::{process, thread};

/// Work that looks for a stop does so ten times a second. Other work (a hierarchy that is built, a
/// shader that a driver compiles, a file that is read) may take minutes.
const PATIENCE: Duration = Duration::from_millis(700);

type LastWords = Box<dyn FnOnce() -> Result<(), CliError> + Send>;

static LAST_WORDS: Mutex<Option<LastWords>> = Mutex::new(None);

fn last_words() -> MutexGuard<'static, Option<LastWords>> {
    LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Installs the handler of Ctrl-C, which raises [`stop::flag`].
///
/// # Errors
/// If the operating system refuses the handler.
pub fn install() -> Result<(), CliError> {
    ctrlc::set_handler(|| {
        if stop::flag().swap(true, Ordering::Relaxed) {
            end();
        }
        console::note("\nstopping (once more to stop at once)");
        // Without a thread a second Ctrl-C is left.
        let _ = thread::Builder::new().spawn(end_unnoticed);
    })
    .map_err(|error| CliError::Input(format!("cannot listen for Ctrl-C: {error}")))
}

/// Sets the function that shows and writes what is finished if the process has to end in the middle
/// of work. It returns the error that says so.
pub fn on_end_in_the_middle(words: impl FnOnce() -> Result<(), CliError> + Send + 'static) {
    *last_words() = Some(Box::new(words));
}

fn end_unnoticed() {
    thread::sleep(PATIENCE);
    if !stop::is_unnoticed() {
        return;
    }
    Terminal.end_step(false);
    let words = last_words().take();
    let outcome = words.map_or(Ok(()), |words| words());
    console::report(&outcome.err().unwrap_or_else(|| CliError::Interrupted {
        kept: "what was under way is lost".into(),
    }));
    end();
}

/// Ends the process with what shells show for an interrupt. On Unix another program takes its
/// place: an exit would run the destructors of drivers, and LLVM dies of them in a thread that
/// compiles a shader.
fn end() -> ! {
    remove_unfinished();
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt;
        let _ = process::Command::new("/bin/sh")
            .args(["-c", "exit 130"])
            .exec();
    }
    process::exit(130)
}
