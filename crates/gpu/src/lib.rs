#![doc = include_str!("../README.md")]
//!
//! [`Executor`] puts a plan on a device: it creates the textures, buffers and pipelines that
//! [live](skiagraph_graph#terms) passes use, and it encodes, times and reads back frames.
//! [`Provider`] builds the resources that a graph expects from its host, such as scene buffers.

mod buffer;
pub mod device;
mod error;
mod experimental;
mod frame;
mod identity;
pub mod import;
#[cfg(target_arch = "wasm32")]
mod late;
mod memory;
mod pipelines;
mod presence;
mod provider;
mod readback;
mod signal;
pub mod timing;
mod waiting;

pub use error::ExecuteError;
pub use frame::{
    Executor, FaultKind, Frame, FrameFault, FrameReport, Prepared, Preparer, Recordings,
    ReplanReport,
};
pub use identity::DeviceIdentity;
pub use pipelines::pipelines::Pipelines;
pub use provider::{CpuWork, Provider, ProviderError};
pub use readback::{Content, Readback};
pub use timing::{FrameTiming, PassStatistics, PassTiming};
pub use waiting::{block_on, submitted_work};
