//! Times of a frame and of its passes.

use std::time::Duration;

/// Times of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameTiming {
    /// Times of the passes, in the order in which they ran.
    pub passes: Vec<PassTiming>,
}

/// Times of one pass.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTiming {
    /// The pass.
    pub name: String,
    /// When its first step began on the GPU, from the frame's first begin on; `None` where `gpu`
    /// is.
    pub begin: Option<Duration>,
    /// From the begin of its first step to the end of its last on the GPU; `None` where the adapter
    /// has no timestamps.
    pub gpu: Option<Duration>,
    /// Time that encoding it took on the CPU.
    pub cpu: Duration,
}

impl FrameTiming {
    /// From the first begin to the last end on the GPU. Not the sum of the passes: they may
    /// overlap, and there are gaps.
    pub fn gpu(&self) -> Option<Duration> {
        let timed = || {
            let passes = self.passes.iter();
            passes.filter_map(|pass| Some((pass.begin?, pass.gpu?)))
        };
        let begin = timed().map(|(begin, _)| begin).min()?;
        let end = timed().map(|(begin, length)| begin + length).max()?;
        Some(end - begin)
    }

    /// Time that encoding all passes took on the CPU.
    pub fn cpu(&self) -> Duration {
        self.passes.iter().map(|pass| pass.cpu).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_no_sum_of_its_passes() {
        let ms = |ms| Some(Duration::from_millis(ms));
        let pass = |begin, gpu| PassTiming {
            name: String::new(),
            begin,
            gpu,
            cpu: Duration::ZERO,
        };
        let of = |passes: &[_]| FrameTiming {
            passes: passes.to_vec(),
        };
        let overlapping = of(&[pass(ms(0), ms(9)), pass(ms(4), ms(3)), pass(None, None)]);
        assert_eq!(overlapping.gpu(), ms(9));
        let apart = of(&[pass(ms(0), ms(2)), pass(ms(6), ms(2))]);
        assert_eq!(apart.gpu(), ms(8));
        assert_eq!(of(&[pass(None, None)]).gpu(), None);
    }
}
