//! Requests of a host for a frame, and the report of a frame.

use super::{statistics::PassStatistics, times::FrameTiming};
use crate::readback::Readback;

/// Settings of one frame, for [`Executor::encode`](crate::Executor::encode). The [`Default`]
/// requests no report and runs only the passes that have to run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Frame<'a> {
    /// Measures the GPU and CPU time of every pass; the times come in [`FrameReport::timing`].
    pub timing: bool,
    /// Counts how often the shaders of each pass run, if the device has the feature
    /// `PIPELINE_STATISTICS_QUERY`; the counts come in [`FrameReport::statistics`].
    pub statistics: bool,
    /// Runs every live pass, even if nothing that it reads has changed. Passes whose `run: When(…)`
    /// condition is false are still skipped.
    pub all: bool,
    /// Names of the outputs and captures to copy to the host; their contents come in
    /// [`FrameReport::readbacks`]. [`Capture::name`](skiagraph_graph::Capture::name) returns the
    /// name of a capture.
    pub read: &'a [&'a str],
    /// Time in seconds that shaders read as `frame.seconds`, for animation; the host chooses its
    /// zero.
    pub seconds: f32,
}

/// Times, statistics, skipped passes and readbacks of one frame, from
/// [`Executor::poll`](crate::Executor::poll) or [`finish`](crate::Executor::finish).
#[derive(Clone, Debug, Default)]
pub struct FrameReport {
    /// Number of the frame, counted from 0: `frame.index` in the shaders, and the result of
    /// [`encode`](crate::Executor::encode).
    pub index: u32,
    /// Times of the passes; `None` if [`Frame::timing`] was not set.
    pub timing: Option<FrameTiming>,
    /// Counts of shader runs, one entry for each pass that ran, in the order in which they ran.
    /// `None` if [`Frame::statistics`] was not set, the device cannot count, or the plan has no
    /// draws and dispatches.
    pub statistics: Option<Vec<PassStatistics>>,
    /// Names of the live passes that did not run, because their inputs were unchanged (`run:
    /// OnChange`) or their condition was false (`run: When(…)`), in schedule order.
    pub skipped: Vec<String>,
    /// Contents of the requested outputs and captures: one entry for each name in [`Frame::read`],
    /// in that order.
    pub readbacks: Vec<Readback>,
}
