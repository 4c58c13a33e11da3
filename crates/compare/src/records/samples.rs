//! Times of frames as they were sampled, one by one.
//!
//! ```
//! use skiagraph_compare::records::samples::{Samples, TimedFrame};
//! use skiagraph_gpu::FrameTiming;
//! use std::time::Duration;
//!
//! let frame = |index: u64| TimedFrame {
//!     began: Duration::from_millis(20 * index),
//!     timing: FrameTiming { passes: Vec::new() },
//!     wall: Duration::from_millis(16),
//!     skipped: Vec::new(),
//! };
//! let samples = Samples::new(&[frame(0), frame(1)]);
//! assert_eq!(samples.wall, [Duration::from_millis(16); 2]);
//! ```

use skiagraph_gpu::FrameTiming;
use std::time::Duration;

/// A frame that was timed.
pub struct TimedFrame {
    /// When its encoding began, from that of the first timed frame on.
    pub began: Duration,
    /// Times of its passes.
    pub timing: FrameTiming,
    /// From the start of encoding until the GPU was done.
    pub wall: Duration,
    /// The passes that did not run.
    pub skipped: Vec<String>,
}

/// The times of several frames, sorted by what they are times of.
#[derive(Default)]
pub struct Samples {
    /// Each pass, in the order in which they ran.
    pub passes: Vec<PassSamples>,
    /// From the first begin to the last end on the GPU.
    pub gpu: Vec<Option<Duration>>,
    /// Encoding of all passes.
    pub cpu: Vec<Duration>,
    /// From the start of encoding until the GPU was done.
    pub wall: Vec<Duration>,
}

/// The times of one pass in several frames.
pub struct PassSamples {
    /// Its name.
    pub name: String,
    /// Between its timestamps.
    pub gpu: Vec<Option<Duration>>,
    /// Encoding.
    pub cpu: Vec<Duration>,
}

impl Samples {
    /// Gathers the samples of some frames.
    pub fn new(frames: &[TimedFrame]) -> Self {
        let mut samples = Self::default();
        for TimedFrame { timing, wall, .. } in frames {
            samples.wall.push(*wall);
            samples.gpu.push(timing.gpu());
            samples.cpu.push(timing.cpu());
            for pass in &timing.passes {
                let known = |samples: &PassSamples| samples.name == pass.name;
                let index = samples.passes.iter().position(known).unwrap_or_else(|| {
                    samples.passes.push(PassSamples {
                        name: pass.name.clone(),
                        gpu: Vec::new(),
                        cpu: Vec::new(),
                    });
                    samples.passes.len() - 1
                });
                samples.passes[index].gpu.push(pass.gpu);
                samples.passes[index].cpu.push(pass.cpu);
            }
        }
        samples
    }
}
