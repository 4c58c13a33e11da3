//! Talk with the user: standard output and error, progress, Ctrl-C.

pub mod console;
pub mod interrupt;
pub mod progress;

use skiagraph_compare::sink::Sink;
use skiagraph_graph::{Diagnostic, diagnostics};
use std::sync::atomic::AtomicBool;

/// Standard error, which hears of the work, and Ctrl-C, which ends it.
pub struct Terminal;

impl Sink for Terminal {
    fn note(&self, text: &str) {
        console::note(text);
    }

    fn warnings(&self, warnings: &[Diagnostic]) {
        console::note(diagnostics::render(warnings, console::colour()).trim_end());
    }

    fn begin_runs(&self, total: u64) {
        progress::begin_runs(total);
    }

    fn count_run(&self) {
        progress::count_run();
    }

    fn end_runs(&self) {
        progress::end_runs();
    }

    fn begin_step(&self, name: &str, total: u64, unit: &'static str) {
        progress::begin_step(name, total, unit);
    }

    fn set_done(&self, done: u64) {
        progress::set_done(done);
    }

    fn end_step(&self, is_whole: bool) {
        progress::end_step(is_whole);
    }

    fn stop(&self) -> &AtomicBool {
        interrupt::flag()
    }
}
