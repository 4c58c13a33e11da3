//! GPU timestamps, checked against wall time, and pipeline statistics.
//!
//! ```no_run
//! use skiagraph_gpu::{Executor, Frame, block_on, device::Gpu, timing::{self, Trust}};
//!
//! # fn time(gpu: &Gpu, executor: &mut Executor) -> Result<(), skiagraph_gpu::ExecuteError> {
//! if let Trust::Untrusted { reason } = block_on(timing::check(&gpu.device, &gpu.queue))? {
//!     println!("no GPU times: {reason}");
//! }
//! let mut encoder = gpu.device.create_command_encoder(&Default::default());
//! executor.encode(&mut encoder, &Frame::new().with_timing(true))?;
//! gpu.queue.submit([encoder.finish()]);
//! for pass in executor.finish()?.timing.into_iter().flat_map(|frame| frame.passes) {
//!     println!("{}: {:?} on the GPU, {:?} on the CPU", pass.name, pass.gpu, pass.cpu);
//! }
//! # Ok(())
//! # }
//! ```

mod check;

pub use crate::frame::{FrameTiming, PassStatistics, PassTiming};
pub use check::{Trust, check};
