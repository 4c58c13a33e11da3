//! Requests of a host for a frame, and the report of a frame.

use super::{statistics::PassStatistics, times::FrameTiming};
use crate::readback::Readback;

/// Settings of one frame, for [`Executor::encode`](crate::Executor::encode) and
/// [`Executor::submit`](crate::Executor::submit). The [`Default`] requests no report and runs only
/// the passes that have to run.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct Frame<'a> {
    /// Measures the GPU and CPU time of every pass that runs; the times come in
    /// [`FrameReport::timing`]. GPU times need a device with `TIMESTAMP_QUERY`, those of copies,
    /// buffer clears and work of the CPU also `TIMESTAMP_QUERY_INSIDE_ENCODERS`; without them they
    /// are `None`.
    pub timing: bool,
    /// Counts how often the shaders of each pass run, if the device has the feature
    /// `PIPELINE_STATISTICS_QUERY`; the counts come in [`FrameReport::statistics`].
    pub statistics: bool,
    /// Runs every pass whose results are needed, even if nothing that it reads has changed. Passes
    /// whose `run: When(…)` condition in the document is false in every frame are still skipped.
    pub all: bool,
    /// Names of the outputs of the graph document and of the captures
    /// ([`PlanRequest::captures`](skiagraph_graph::PlanRequest)) to copy to the host; their
    /// contents come in [`FrameReport::readbacks`].
    /// [`Capture::name`](skiagraph_graph::Capture::name) returns the name of a capture.
    pub read: &'a [&'a str],
    /// Time in seconds that shaders read as `frame.seconds`, for animation; the host chooses which
    /// moment is 0.
    pub seconds: f32,
}

impl<'a> Frame<'a> {
    /// Creates the settings of a frame without a report, equal to the [`Default`].
    pub const fn new() -> Self {
        Self {
            timing: false,
            statistics: false,
            all: false,
            read: &[],
            seconds: 0.0,
        }
    }

    /// Sets [`timing`](Self::timing).
    #[must_use]
    pub const fn with_timing(mut self, timing: bool) -> Self {
        self.timing = timing;
        self
    }

    /// Sets [`statistics`](Self::statistics).
    #[must_use]
    pub const fn with_statistics(mut self, statistics: bool) -> Self {
        self.statistics = statistics;
        self
    }

    /// Sets [`all`](Self::all).
    #[must_use]
    pub const fn with_all(mut self, forced: bool) -> Self {
        self.all = forced;
        self
    }

    /// Sets [`read`](Self::read).
    #[must_use]
    pub const fn with_read(mut self, read: &'a [&'a str]) -> Self {
        self.read = read;
        self
    }

    /// Sets [`seconds`](Self::seconds).
    #[must_use]
    pub const fn with_seconds(mut self, seconds: f32) -> Self {
        self.seconds = seconds;
        self
    }
}

/// Times, statistics, skipped passes and readbacks of one frame, from
/// [`Executor::poll`](crate::Executor::poll) or [`finish`](crate::Executor::finish).
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct FrameReport {
    /// Number of the frame, counted from 0: `frame.index` in the shaders, and the result of
    /// [`encode`](crate::Executor::encode). `u32::MAX` if no frame was encoded.
    pub index: u32,
    /// Times of the passes; `None` if [`Frame::timing`] was not set.
    pub timing: Option<FrameTiming>,
    /// Counts of shader runs, one entry for each pass that ran, in the order in which they ran.
    /// `None` if [`Frame::statistics`] was not set, the device cannot count, or the plan has no
    /// draws and dispatches.
    pub statistics: Option<Vec<PassStatistics>>,
    /// Names of the passes that did not run although their results are needed, because their inputs
    /// were unchanged (`run: OnChange`), they had run before (`run: Once`), their condition was
    /// false (`run: When(…)`), or the frame would have computed the same as one before (see
    /// [`Executor::encode`](crate::Executor::encode)). They stand in the order in which the passes
    /// would have run.
    pub skipped: Vec<String>,
    /// Contents of the requested outputs and captures: one entry for each name in [`Frame::read`],
    /// in that order.
    pub readbacks: Vec<Readback>,
    /// Reason why the contents may be stale; `None` if they are right.
    pub fault: Option<FaultKind>,
}

/// A frame that did not show what it should: an entry of
/// [`Executor::take_faults`](crate::Executor::take_faults). Its text names the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FrameFault {
    /// Number of the frame, as [`encode`](crate::Executor::encode) returned it.
    pub index: u32,
    /// Reason.
    pub kind: FaultKind,
}

impl std::fmt::Display for FrameFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "frame {} {}", self.index, self.kind)
    }
}

/// Reasons why a frame did not show what it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FaultKind {
    /// Its commands never ran.
    #[error("never ran: its encoder was dropped, or wgpu refused its commands")]
    NeverRan,
    /// It was encoded before an earlier frame was known to be lost, whose results it needs.
    #[error("ran without an earlier frame that it was encoded to follow: it may be stale")]
    WithoutPredecessor,
    /// It was submitted in another order than it was encoded in, or behind frames that were.
    #[error("was not submitted in the order of encoding, or behind such frames: it may be stale")]
    OutOfOrder,
}
