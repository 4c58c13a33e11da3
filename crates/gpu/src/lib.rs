//! Plans of [`skiagraph_graph`] on a wgpu device, encoded into the host's own frames.
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
//! executor.encode(&mut encoder, &Frame { read: &["image"], ..Frame::default() })?;
//! gpu.queue.submit([encoder.finish()]);
//! let image = &executor.finish()?.readbacks[0].content;
//! println!("{:?}", image.as_f32());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Executor`] is a plan on a device: what the live passes touch is made, frames are encoded,
//! timed and read back. [`Provider`] makes what the graph does not make itself.

mod buffer;
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
