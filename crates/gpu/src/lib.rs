//! Plans of [`skiagraph_graph`] on a wgpu device: what the live passes touch is made, frames are
//! encoded into the host's encoder, timed and read back.
//!
//! [`Executor`] is a plan on a device; [`Provider`] makes what the graph does not make itself.

pub mod device;
mod error;
mod experimental;
mod frame;
pub mod import;
mod memory;
mod pipelines;
mod presence;
mod provider;
mod readback;
mod signal;
pub mod timing;

pub use error::ExecuteError;
pub use frame::{Executor, Frame, FrameReport, Prepared, Preparer, ReplanReport};
pub use provider::{Provider, ProviderError};
pub use readback::{Content, Readback};
pub use timing::{FrameTiming, PassStatistics, PassTiming};
