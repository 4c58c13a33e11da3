//! GPU timestamps that are true, or none; and what the device counts.

mod check;

pub use crate::frame::{FrameTiming, PassStatistics, PassTiming};
pub use check::{Trust, check};
