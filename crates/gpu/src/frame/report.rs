//! What is asked of a frame, and what it brought.

use crate::{
    readback::Readback,
    timing::{statistics::PassStatistics, times::FrameTiming},
};

/// What a frame is asked for.
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

/// What a frame brought.
#[derive(Clone, Debug, Default)]
pub struct FrameReport {
    /// Which frame: its `frame.index` in the shaders, and what
    /// [`encode`](crate::Executor::encode) returned.
    pub index: u32,
    /// Times, if they were asked for.
    pub timing: Option<FrameTiming>,
    /// What was counted of the passes that ran, in schedule order, if it was asked for and the
    /// device counts.
    pub statistics: Option<Vec<PassStatistics>>,
    /// The passes that did not run because their run condition said so, in schedule order.
    pub skipped: Vec<String>,
    /// Contents, in the order in which they were asked for.
    pub readbacks: Vec<Readback>,
}
