//! Reports progress and remarks of work under way, and lets the caller end it early.
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

use crate::error::{CompareError, Result};
use skiagraph_gpu::device::Gpu;
use skiagraph_graph::{Diagnostic, diagnostics};
use std::sync::atomic::{AtomicBool, Ordering};

/// Receives progress and remarks of work under way, from any thread, and can ask the work to end
/// early. Only [`note`](Self::note) has to be implemented; the other functions have defaults.
pub trait Sink: Sync {
    /// Receives a remark that is not an error: text of one or several lines.
    fn note(&self, text: &str);

    /// Receives the warnings of a graph and its plan, or the mistakes of documents whose methods
    /// are left out; at least one. By default, their text is passed to [`note`](Self::note).
    fn warnings(&self, warnings: &[Diagnostic]) {
        self.note(diagnostics::render(warnings, false).trim_end());
    }

    /// Receives the start of `total` runs. A run is one method on one view in one viewport, and
    /// consists of several steps.
    fn begin_runs(&self, _total: u64) {}

    /// Receives the end of one of these runs; one that cannot run here ends at once.
    fn count_run(&self) {}

    /// Receives the end of all runs.
    fn end_runs(&self) {}

    /// Receives the start of a step named `name`, of `total` parts that are counted in `unit`. Only
    /// one step is under way at a time.
    fn begin_step(&self, _name: &str, _total: u64, _unit: &'static str) {}

    /// Receives the number of parts of the current step that are done.
    fn set_done(&self, _done: u64) {}

    /// Receives the end of the current step. `is_whole` is false if it ended early.
    fn end_step(&self, _is_whole: bool) {}

    /// Receives that all work is done, and that its files are written now: an end in the middle of
    /// that would leave some of them out of date.
    fn begin_writing(&self) {}

    /// Returns the flag that asks the work to end early once it is true. A
    /// [`Series`](crate::measuring::series::Series) keeps the results that it has by then. By
    /// default the flag is never set.
    fn stop(&self) -> &AtomicBool {
        static NEVER: AtomicBool = AtomicBool::new(false);
        &NEVER
    }
}

/// A sink that ignores all progress and remarks, and never asks for an early end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Sink for Silent {
    fn note(&self, _text: &str) {}
}

/// An opened GPU, and the [`Sink`] that receives the progress of work on it.
#[derive(Clone, Copy)]
pub struct Session<'a> {
    /// The GPU that work runs on.
    pub gpu: &'a Gpu,
    /// The sink that receives progress and remarks.
    pub sink: &'a dyn Sink,
}

impl<'a> Session<'a> {
    /// Creates a session from a GPU and a sink.
    pub fn new(gpu: &'a Gpu, sink: &'a dyn Sink) -> Self {
        Self { gpu, sink }
    }

    /// True once the sink has asked for an early end.
    pub fn is_stopped(&self) -> bool {
        self.sink.stop().load(Ordering::Relaxed)
    }

    /// Returns an error once the sink has asked for an early end.
    ///
    /// # Errors
    /// [`CompareError::Interrupted`].
    pub fn check_stopped(&self) -> Result<()> {
        if self.is_stopped() {
            return Err(CompareError::interrupted());
        }
        Ok(())
    }
}

/// A step of work under way, such as the timed frames of a method, reported to a sink. If it is
/// dropped without [`end`](Self::end), it counts as ended early.
pub struct Step<'a> {
    sink: &'a dyn Sink,
    is_whole: bool,
}

impl<'a> Step<'a> {
    /// Tells the sink that the step `name` begins. It has `total` parts, which are counted in
    /// `unit`, such as `frames`.
    pub fn begin(sink: &'a dyn Sink, name: &str, total: u64, unit: &'static str) -> Self {
        sink.begin_step(name, total, unit);
        let is_whole = false;
        Self { sink, is_whole }
    }

    /// Tells the sink how many of the step's parts are done. Can be called from any thread.
    pub fn set_done(&self, done: u64) {
        self.sink.set_done(done);
    }

    /// Tells the sink that the whole step is done.
    pub fn end(mut self) {
        self.is_whole = true;
    }
}

impl Drop for Step<'_> {
    fn drop(&mut self) {
        self.sink.end_step(self.is_whole);
    }
}

/// Several runs under way, reported to a sink; a run is one method on one view in one viewport.
/// Dropping this value tells the sink that all runs have ended.
pub struct Runs<'a>(&'a dyn Sink);

impl<'a> Runs<'a> {
    /// Tells the sink that `total` runs begin.
    pub fn begin(sink: &'a dyn Sink, total: u64) -> Self {
        sink.begin_runs(total);
        Self(sink)
    }

    /// Tells the sink that one run is done.
    pub fn count(&self) {
        self.0.count_run();
    }
}

impl Drop for Runs<'_> {
    fn drop(&mut self) {
        self.0.end_runs();
    }
}
