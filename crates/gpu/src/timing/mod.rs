//! GPU timestamps that are true, or none.

mod check;
pub(crate) mod timer;
pub(crate) mod times;

pub use check::{Trust, check};
pub use times::{FrameTiming, PassTiming};
