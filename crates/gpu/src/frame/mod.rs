//! Frames: decides which passes run, encodes them into the host's encoder, and changes the plan.

mod clears;
mod contents;
mod cpu;
mod encode;
pub(crate) mod executor;
mod fetch;
mod growth;
mod growth_readback;
mod host_changes;
mod idle;
mod imports;
mod in_flight;
mod pass;
mod poison;
mod prepare;
mod read_buffer;
mod recordings;
mod replan;
mod report;
mod runner;
mod stamp;
mod state;
mod statistics;
mod timer;
mod times;
mod uniform;

pub use executor::Executor;
pub use prepare::{Prepared, Preparer};
pub use recordings::Recordings;
pub use replan::ReplanReport;
pub use report::{FaultKind, Frame, FrameFault, FrameReport};
pub use statistics::PassStatistics;
pub use times::{FrameTiming, PassTiming};
