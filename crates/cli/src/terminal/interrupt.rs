//! Ctrl-C: the first one requests a clean stop, the second one ends the process at once.

use crate::error::CliError;
use crate::terminal::console::note;
use std::{
    process,
    sync::atomic::{AtomicBool, Ordering},
};

static RAISED: AtomicBool = AtomicBool::new(false);

/// Installs the handler of Ctrl-C, which raises [`flag`].
///
/// # Errors
/// If the operating system refuses the handler.
pub fn install() -> Result<(), CliError> {
    ctrlc::set_handler(|| {
        if RAISED.swap(true, Ordering::Relaxed) {
            process::exit(130);
        }
        note("\nstopping (once more to stop at once)");
    })
    .map_err(|error| CliError::Input(format!("cannot listen for Ctrl-C: {error}")))
}

/// Returns the flag that Ctrl-C raises.
pub fn flag() -> &'static AtomicBool {
    &RAISED
}

/// True if Ctrl-C has requested a stop.
pub fn raised() -> bool {
    RAISED.load(Ordering::Relaxed)
}
