//! Requests to a frame, and its report.

use super::{statistics::PassStatistics, times::FrameTiming};
use crate::readback::Readback;

/// Requests to a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct Frame<'a> {
    /// Take GPU timestamps.
    pub timing: bool,
    /// Count how often the shaders of each pass run, where the device has
    /// `PIPELINE_STATISTICS_QUERY`.
    pub statistics: bool,
    /// Run every pass, also those of which nothing that they read has changed.
    pub all: bool,
    /// Outputs and captures to read back.
    pub read: &'a [&'a str],
    /// The time of what is shown, seconds: `frame.seconds` of the shaders.
    pub seconds: f32,
}

/// Report of a frame.
#[derive(Clone, Debug, Default)]
pub struct FrameReport {
    /// Which frame: its `frame.index` in the shaders, and what
    /// [`encode`](crate::Executor::encode) returned.
    pub index: u32,
    /// Times, if they were asked for.
    pub timing: Option<FrameTiming>,
    /// Counts of the passes that ran, in schedule order, if asked for and supported by the device.
    pub statistics: Option<Vec<PassStatistics>>,
    /// The passes that did not run because their run condition said so, in schedule order.
    pub skipped: Vec<String>,
    /// Contents, in the order in which they were asked for.
    pub readbacks: Vec<Readback>,
}
