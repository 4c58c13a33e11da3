//! Hearing of work under way, and ending it early.
//!
//! ```
//! use skiagraph_compare::sink::{Silent, Sink, Step};
//!
//! /// Prints remarks, and the steps of the work.
//! struct Lines;
//!
//! impl Sink for Lines {
//!     fn note(&self, text: &str) {
//!         println!("{text}");
//!     }
//!     fn begin_step(&self, name: &str, total: u64, unit: &'static str) {
//!         println!("{name}: {total} {unit}");
//!     }
//! }
//!
//! for sink in [&Lines as &dyn Sink, &Silent] {
//!     let step = Step::begin(sink, "nsm", 32, "frames");
//!     step.set_done(32);
//!     step.end();
//! }
//! ```

use crate::error::CompareError;
use skiagraph_gpu::device::Gpu;
use skiagraph_graph::{Diagnostic, diagnostics};
use std::sync::atomic::{AtomicBool, Ordering};

/// Hears of work under way, from any thread. Only [`note`](Self::note) has to be implemented.
pub trait Sink: Sync {
    /// A remark that is not an error, a line or several.
    fn note(&self, text: &str);

    /// Warnings of a graph and its plan, at least one; [`note`](Self::note) of their text unless
    /// said otherwise.
    fn warnings(&self, warnings: &[Diagnostic]) {
        self.note(diagnostics::render(warnings, false).trim_end());
    }

    /// So many runs begin, each of several steps.
    fn begin_runs(&self, _total: u64) {}

    /// One of the runs is done.
    fn count_run(&self) {}

    /// No runs are under way any more.
    fn end_runs(&self) {}

    /// A step of `total` parts begins, counted in `unit`. One step is under way at a time.
    fn begin_step(&self, _name: &str, _total: u64, _unit: &'static str) {}

    /// So many parts of the step are done.
    fn set_done(&self, _done: u64) {}

    /// The step has ended, early if not `is_whole`.
    fn end_step(&self, _is_whole: bool) {}

    /// The flag that asks for an early end: what is done until then is kept.
    fn stop(&self) -> &AtomicBool {
        static NEVER: AtomicBool = AtomicBool::new(false);
        &NEVER
    }
}

/// Hears nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Sink for Silent {
    fn note(&self, _text: &str) {}
}

/// An opened GPU, and who hears of the work on it.
#[derive(Clone, Copy)]
pub struct Session<'a> {
    /// The GPU.
    pub gpu: &'a Gpu,
    /// Hears of the work.
    pub sink: &'a dyn Sink,
}

impl<'a> Session<'a> {
    /// Creates one of a GPU and a sink.
    pub fn new(gpu: &'a Gpu, sink: &'a dyn Sink) -> Self {
        Self { gpu, sink }
    }

    /// True once the work is asked to end early.
    pub fn is_stopped(&self) -> bool {
        self.sink.stop().load(Ordering::Relaxed)
    }

    /// Ends work that is asked to end early.
    ///
    /// # Errors
    /// It is asked to.
    pub fn check_stopped(&self) -> Result<(), CompareError> {
        if self.is_stopped() {
            return Err(CompareError::interrupted());
        }
        Ok(())
    }
}

/// A step under way; it ends early if it is dropped.
pub struct Step<'a> {
    sink: &'a dyn Sink,
    is_whole: bool,
}

impl<'a> Step<'a> {
    /// Begins a step of `total` parts, counted in `unit`.
    pub fn begin(sink: &'a dyn Sink, name: &str, total: u64, unit: &'static str) -> Self {
        sink.begin_step(name, total, unit);
        let is_whole = false;
        Self { sink, is_whole }
    }

    /// Says how many parts are done; from any thread.
    pub fn set_done(&self, done: u64) {
        self.sink.set_done(done);
    }

    /// Ends the step.
    pub fn end(mut self) {
        self.is_whole = true;
    }
}

impl Drop for Step<'_> {
    fn drop(&mut self) {
        self.sink.end_step(self.is_whole);
    }
}

/// Runs under way; they end when it is dropped.
pub struct Runs<'a>(&'a dyn Sink);

impl<'a> Runs<'a> {
    /// Begins so many runs.
    pub fn begin(sink: &'a dyn Sink, total: u64) -> Self {
        sink.begin_runs(total);
        Self(sink)
    }

    /// Counts a run that is done.
    pub fn count(&self) {
        self.0.count_run();
    }
}

impl Drop for Runs<'_> {
    fn drop(&mut self) {
        self.0.end_runs();
    }
}
