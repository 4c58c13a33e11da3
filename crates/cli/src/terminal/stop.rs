//! State of a stop that Ctrl-C requests: whether one is requested, and which part of the program
//! ends it.

use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::thread;

static RAISED: AtomicBool = AtomicBool::new(false);

/// Part of the program that ends it: [`NOT_YET`], [`THE_WORK`] or [`THE_WATCH`].
static ENDING: AtomicU8 = AtomicU8::new(NOT_YET);
const NOT_YET: u8 = 0;
/// The work has taken notice: it shows and writes what it has.
const THE_WORK: u8 = 1;
/// The work took no notice: the process ends in the middle of it.
const THE_WATCH: u8 = 2;

/// Returns the flag that Ctrl-C raises.
pub fn flag() -> &'static AtomicBool {
    &RAISED
}

/// True if Ctrl-C has requested a stop. The caller then ends the command, and has all the time that
/// it needs for that. Does not return where the process ends already.
pub fn raised() -> bool {
    if !RAISED.load(Ordering::Relaxed) {
        return false;
    }
    take_end();
    true
}

/// Leaves the end of the command to the caller, whether a stop is requested or not: the work is
/// done, and is shown and written whole. Does not return where the process ends already.
pub fn take_end() {
    while !claim(THE_WORK) {
        thread::park();
    }
}

/// True if the work has taken no notice of the stop. From then on [`raised`] does not return.
pub fn is_unnoticed() -> bool {
    claim(THE_WATCH)
}

/// True if nothing else ends the process.
fn claim(by: u8) -> bool {
    let before = ENDING.compare_exchange(NOT_YET, by, Ordering::Relaxed, Ordering::Relaxed);
    before.is_ok() || before == Err(by)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_watch_does_not_end_what_the_work_ends() {
        take_end();
        assert!(!is_unnoticed());
        take_end();
    }
}
