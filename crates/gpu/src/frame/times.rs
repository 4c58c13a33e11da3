//! Times of a frame and of its passes.

use std::time::Duration;

/// GPU and CPU times of one frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FrameTiming {
    /// Times of the passes that ran, in the order in which they ran.
    pub passes: Vec<PassTiming>,
}

/// GPU and CPU times of one pass in one frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PassTiming {
    /// Name of the pass, as in [`PassSummary::name`](skiagraph_graph::PassSummary::name).
    pub name: String,
    /// Time on the GPU at which the pass began, counted from the earliest begin of a pass in the
    /// frame. `None` if `gpu` is `None`.
    pub begin: Option<Duration>,
    /// GPU time from the begin of the pass's first draw, dispatch, copy or clear to the end of its
    /// last. `None` if there are no valid timestamps, for example because the adapter has none.
    /// For a pass that works on the CPU, it is the time that the GPU waits for it.
    pub gpu: Option<Duration>,
    /// CPU time that the encoding of the pass's commands took; for a pass that works on the CPU the
    /// time of that work.
    pub cpu: Duration,
}

impl PassTiming {
    /// Creates the times of a pass that took so long on the CPU, and has no times on the GPU.
    pub fn new(name: impl Into<String>, cpu: Duration) -> Self {
        Self {
            name: name.into(),
            begin: None,
            gpu: None,
            cpu,
        }
    }

    /// Sets [`begin`](Self::begin) and [`gpu`](Self::gpu).
    #[must_use]
    pub fn with_gpu(mut self, begin: Duration, gpu: Duration) -> Self {
        (self.begin, self.gpu) = (Some(begin), Some(gpu));
        self
    }
}

impl FrameTiming {
    /// Creates the times of a frame from those of its passes, in the order in which they ran.
    pub fn new(passes: Vec<PassTiming>) -> Self {
        Self { passes }
    }

    /// Returns the GPU time from the earliest begin of a pass to the latest end; `None` if no pass
    /// has GPU times. It differs from the sum of the passes: passes may overlap, and there are
    /// gaps.
    pub fn gpu(&self) -> Option<Duration> {
        let timed = || {
            let passes = self.passes.iter();
            passes.filter_map(|pass| Some((pass.begin?, pass.gpu?)))
        };
        let begin = timed().map(|(begin, _)| begin).min()?;
        let end = timed().map(|(begin, length)| begin + length).max()?;
        Some(end - begin)
    }

    /// Returns the sum of [`PassTiming::cpu`] over all passes that ran.
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
        let timing = |passes: &[_]| FrameTiming {
            passes: passes.to_vec(),
        };
        let overlapping = timing(&[pass(ms(0), ms(9)), pass(ms(4), ms(3)), pass(None, None)]);
        assert_eq!(overlapping.gpu(), ms(9));
        let apart = timing(&[pass(ms(0), ms(2)), pass(ms(6), ms(2))]);
        assert_eq!(apart.gpu(), ms(8));
        assert_eq!(timing(&[pass(None, None)]).gpu(), None);
    }
}
