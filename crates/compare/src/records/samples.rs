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
//!     upkeep: None,
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
    /// Work of the CPU before encoding; `None` if nothing moves and every pass runs all the same.
    pub upkeep: Option<Upkeep>,
    /// Names of the passes that were skipped in the frame, as their inputs had not changed.
    pub skipped: Vec<String>,
}

/// Work of the CPU for one method between two frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Upkeep {
    /// Time in which the scene's resources that the method reads were brought up to date.
    pub time: Duration,
    /// Number of bytes that were uploaded to the GPU.
    pub uploaded: u64,
}

/// Times of several frames, as one list per kind of time with one item per frame.
#[derive(Default)]
pub struct Samples {
    /// Times of each pass, in the order in which the passes ran.
    pub passes: Vec<PassSamples>,
    /// GPU time of each frame from the start of the first pass to the end of the last: 0 without
    /// passes, `None` if it is not known.
    pub gpu: Vec<Option<Duration>>,
    /// CPU time of encoding all passes of each frame.
    pub cpu: Vec<Duration>,
    /// CPU time of each frame's upkeep and encoding; `None` if a frame has no upkeep.
    pub upkeep: Option<Vec<Duration>>,
    /// Time of each frame from the start of its upkeep, or of encoding, until the GPU was done.
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
        let upkeep = |frame: &TimedFrame| Some(frame.upkeep?.time + frame.timing.cpu());
        samples.upkeep = frames.iter().map(upkeep).collect();
        for frame in frames {
            let (timing, upkeep) = (&frame.timing, frame.upkeep.unwrap_or_default());
            samples.wall.push(upkeep.time + frame.wall);
            let is_empty = timing.passes.is_empty();
            samples
                .gpu
                .push(timing.gpu().or(is_empty.then_some(Duration::ZERO)));
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
