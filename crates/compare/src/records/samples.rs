//! Holds the times of single frames as they were sampled.
//!
//! ```
//! use skiagraph_compare::records::samples::{Samples, TimedFrame};
//! use skiagraph_gpu::FrameTiming;
//! use std::time::Duration;
//!
//! let frame = |index: u64| TimedFrame {
//!     began: Duration::from_millis(20 * index),
//!     timing: FrameTiming::new(Vec::new()),
//!     wall: Duration::from_millis(16),
//!     skipped: Vec::new(),
//! };
//! let samples = Samples::new(&[frame(0), frame(1)]);
//! assert_eq!(samples.wall, [Duration::from_millis(16); 2]);
//! ```

use crate::lists::find_or_push;
use skiagraph_gpu::FrameTiming;
use std::time::Duration;

/// Times of one frame, as measured.
pub struct TimedFrame {
    /// Time from the start of the first timed frame until the start of this frame's encoding.
    pub began: Duration,
    /// GPU and CPU times of the frame's passes.
    pub timing: FrameTiming,
    /// Time from the start of encoding until the GPU was done.
    pub wall: Duration,
    /// Names of the passes that were skipped in the frame, as their inputs had not changed.
    pub skipped: Vec<String>,
}

/// Times of several frames, as one list per kind of time with one item per frame.
#[derive(Default)]
pub struct Samples {
    /// Times of each pass, in the order in which the passes ran.
    pub passes: Vec<PassSamples>,
    /// GPU time of each frame from the start of the first pass to the end of the last; `None` if it
    /// is not known.
    pub gpu: Vec<Option<Duration>>,
    /// CPU time of encoding all passes of each frame.
    pub cpu: Vec<Duration>,
    /// Time of each frame from the start of encoding until the GPU was done.
    pub wall: Vec<Duration>,
}

/// Times of one pass: each list has one item for each frame in which the pass ran.
pub struct PassSamples {
    /// Name of the pass.
    pub name: String,
    /// GPU time between the pass's timestamps, for each frame in which it ran; `None` if it is not
    /// known.
    pub gpu: Vec<Option<Duration>>,
    /// CPU time of encoding the pass, for each frame in which it ran.
    pub cpu: Vec<Duration>,
}

impl Samples {
    /// Gathers the times of `frames` into lists, in their order.
    pub fn new(frames: &[TimedFrame]) -> Self {
        let mut samples = Self::default();
        for TimedFrame { timing, wall, .. } in frames {
            samples.wall.push(*wall);
            samples.gpu.push(timing.gpu());
            samples.cpu.push(timing.cpu());
            for pass in &timing.passes {
                let is_own = |samples: &PassSamples| samples.name == pass.name;
                let own = find_or_push(&mut samples.passes, is_own, || PassSamples {
                    name: pass.name.clone(),
                    gpu: Vec::new(),
                    cpu: Vec::new(),
                });
                own.gpu.push(pass.gpu);
                own.cpu.push(pass.cpu);
            }
        }
        samples
    }
}
