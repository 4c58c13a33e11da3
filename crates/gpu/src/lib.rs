//! Runs the plans of [`skiagraph_graph`] on a wgpu device, inside the host's own command encoders.
//!
//! ```no_run
//! use skiagraph_gpu::{Executor, Frame, device};
//! use skiagraph_graph::{FolderSources, Graph, NoProvider, PlanRequest, Registry};
//!
//! let sources = FolderSources { root: "graphs".into() };
//! let graph = Graph::load("ramp.ron", &Registry::standard(), &sources)?;
//! let gpu = device::open(None)?; // or the host's own device and queue
//! let mut request = PlanRequest::new([64, 32], &NoProvider);
//! request.limits = gpu.device.limits();
//! let plan = graph.plan(&request)?;
//! let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut NoProvider)?;
//!
//! let mut encoder = gpu.device.create_command_encoder(&Default::default());
//! executor.encode(&mut encoder, &Frame::new().with_read(&["image"]))?;
//! gpu.queue.submit([encoder.finish()]);
//! let image = &executor.finish()?.readbacks[0].content;
//! println!("{:?}", image.as_f32());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
    Executor, FaultKind, Frame, FrameFault, FrameReport, Prepared, Preparer, ReplanReport,
};
pub use identity::DeviceIdentity;
pub use pipelines::pipelines::Pipelines;
pub use provider::{CpuWork, Provider, ProviderError};
pub use readback::{Content, Readback};
pub use timing::{FrameTiming, PassStatistics, PassTiming};
pub use waiting::{block_on, submitted_work};
