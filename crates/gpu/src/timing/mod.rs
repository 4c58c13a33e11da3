//! GPU timestamps that are true, or none; and what the device counts.

mod check;
pub(crate) mod statistics;
pub(crate) mod timer;
pub(crate) mod times;

pub use check::{Trust, check};
pub use statistics::PassStatistics;
pub use times::{FrameTiming, PassTiming};
