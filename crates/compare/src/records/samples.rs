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
//! let samples = Samples::new(&[frame(0), frame(1)], true);
//! assert_eq!(samples.wall, [16.0; 2]);
//! ```

use crate::lists::find_or_push;
use crate::records::statistics::ms;
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

/// Times of several frames in milliseconds, as one list per kind of time with one item per frame.
#[derive(Default)]
pub struct Samples {
    /// Times of each pass, in the order in which the passes ran.
    pub passes: Vec<PassSamples>,
    /// GPU time of each frame from the start of the first pass to the end of the last, 0 without
    /// passes; `None` if that of any frame is not known.
    pub gpu: Option<Vec<f64>>,
    /// CPU time of encoding all passes of each frame.
    pub cpu: Vec<f64>,
    /// CPU time of each frame's upkeep and encoding; `None` if a frame has no upkeep.
    pub upkeep: Option<Vec<f64>>,
    /// Time of each frame from the start of its upkeep, or of encoding, until the GPU was done.
    pub wall: Vec<f64>,
}

/// Times of one pass in milliseconds: each list has one item for each frame in which the pass ran.
pub struct PassSamples {
    /// Name of the pass.
    pub name: String,
    /// GPU time between the pass's timestamps, for each frame in which it ran; `None` if any is not
    /// known.
    pub gpu: Option<Vec<f64>>,
    /// CPU time of encoding the pass, for each frame in which it ran.
    pub cpu: Vec<f64>,
}

impl Samples {
    /// Gathers the times of `frames` into lists, in their order; without GPU times unless they can
    /// be trusted.
    pub fn new(frames: &[TimedFrame], is_trusted: bool) -> Self {
        let mut passes: Vec<PassSamples> = Vec::new();
        for pass in frames.iter().flat_map(|frame| &frame.timing.passes) {
            let is_own = |samples: &PassSamples| samples.name == pass.name;
            let own = find_or_push(&mut passes, is_own, || PassSamples {
                name: pass.name.clone(),
                gpu: is_trusted.then(Vec::new),
                cpu: Vec::new(),
            });
            own.cpu.push(ms(pass.cpu));
            own.gpu = own.gpu.take().zip(pass.gpu).map(|(mut gpu, time)| {
                gpu.push(ms(time));
                gpu
            });
        }
        let gpu = |TimedFrame { timing, .. }: &TimedFrame| {
            let nothing = timing.passes.is_empty().then_some(Duration::ZERO);
            timing.gpu().or(nothing).filter(|_| is_trusted).map(ms)
        };
        let upkeep = |frame: &TimedFrame| Some(ms(frame.upkeep?.time + frame.timing.cpu()));
        let wall = |frame: &TimedFrame| ms(frame.upkeep.unwrap_or_default().time + frame.wall);
        Self {
            passes,
            gpu: frames.iter().map(gpu).collect(),
            cpu: frames.iter().map(|frame| ms(frame.timing.cpu())).collect(),
            upkeep: frames.iter().map(upkeep).collect(),
            wall: frames.iter().map(wall).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_gpu::PassTiming;

    #[test]
    fn gpu_times_are_left_out_if_one_is_missing_or_none_is_trusted() {
        let ms = Duration::from_millis;
        let frame = |gpu: Option<u64>| {
            let pass = PassTiming::new("draw", ms(1));
            let pass = match gpu {
                Some(gpu) => pass.with_gpu(ms(0), ms(gpu)),
                None => pass,
            };
            TimedFrame {
                began: Duration::ZERO,
                timing: FrameTiming::new(vec![pass]),
                wall: ms(9),
                upkeep: None,
                skipped: Vec::new(),
            }
        };
        let gpu = |frames: &[TimedFrame], is_trusted| {
            let samples = Samples::new(frames, is_trusted);
            assert_eq!(samples.passes[0].cpu, vec![1.0; frames.len()]);
            [samples.gpu, samples.passes.into_iter().next().unwrap().gpu]
        };
        let both = [frame(Some(2)), frame(Some(3))];
        assert_eq!(gpu(&both, true), [(); 2].map(|()| Some(vec![2.0, 3.0])));
        assert_eq!(gpu(&both, false), [None, None]);
        assert_eq!(gpu(&[frame(Some(2)), frame(None)], true), [None, None]);
    }
}
