//! Requests of a host for a frame, and the report of a frame.

use super::{statistics::PassStatistics, times::FrameTiming};
use crate::readback::Readback;

/// Settings of one frame, for [`Executor::encode`](crate::Executor::encode).
#[derive(Clone, Copy, Debug, Default)]
pub struct Frame<'a> {
    /// Take GPU timestamps of every pass.
    pub timing: bool,
    /// Count how often the shaders of each pass run, if the device has `PIPELINE_STATISTICS_QUERY`.
    pub statistics: bool,
    /// Run every pass, even if nothing that it reads has changed. Passes whose `run: When(…)`
    /// condition is false are still skipped.
    pub all: bool,
    /// Names of the outputs and captures to read back.
    pub read: &'a [&'a str],
    /// Time of the shown moment in seconds: `frame.seconds` in the shaders.
    pub seconds: f32,
}

/// Times, statistics, skipped passes and readbacks of one frame.
#[derive(Clone, Debug, Default)]
pub struct FrameReport {
    /// Number of the frame: `frame.index` in the shaders, and the result of
    /// [`encode`](crate::Executor::encode).
    pub index: u32,
    /// Times of the passes; `None` if [`Frame::timing`] was not set.
    pub timing: Option<FrameTiming>,
    /// Shader runs of the passes that ran, in schedule order. `None` if [`Frame::statistics`] was
    /// not set, the device cannot count, or the plan has no draws and dispatches.
    pub statistics: Option<Vec<PassStatistics>>,
    /// Names of the passes that did not run because their run condition was not met, in schedule
    /// order.
    pub skipped: Vec<String>,
    /// Contents of the outputs and captures, in the order of [`Frame::read`].
    pub readbacks: Vec<Readback>,
}
