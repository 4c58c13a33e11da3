//! Adds up the frames of a view or camera path as they are judged.

use crate::error::{CompareError, Result};
use crate::graphs::ground_truth::Judgement;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::ground_truth::GroundTruthFrames;
use crate::pictures::run_pictures::PictureFile;
use crate::records::results::Answer;
use crate::records::samples::TimedFrame;
use crate::records::sequence::{FrameCost, Sequence, SequenceFrame};
use crate::records::statistics::ms;
use skiagraph_reference::shimmer::shimmer;
use skiagraph_reference::{
    BlockerCounts, EdgeDistances, Graded, JudgedPixels, Shimmer, Statistics,
};
use std::collections::VecDeque;

/// The times of a frame; `has_gpu` is false if GPU times cannot be trusted.
pub fn cost(frame: &TimedFrame, has_gpu: bool) -> FrameCost {
    let upkeep = frame.upkeep.unwrap_or_default().time;
    let gpu = frame.timing.gpu().filter(|_| has_gpu);
    FrameCost {
        gpu_ms: gpu.map(ms),
        cpu_ms: ms(upkeep + frame.timing.cpu()),
        wall_ms: ms(upkeep + frame.wall),
    }
}

/// A second of a path in pictures: the one with the most shimmer.
#[derive(Default)]
pub struct WorstSecond {
    /// Number of frames in a second.
    length: usize,
    /// The last frames: changed pixels, and the picture.
    recent: VecDeque<(u64, PictureFile)>,
    /// Changed pixels of the worst second.
    changed: Option<u64>,
    /// The pictures of the worst second, in order.
    pub pictures: Vec<PictureFile>,
}

impl WorstSecond {
    /// Creates a list for seconds of so many frames.
    pub fn new(length: usize) -> Self {
        Self {
            length,
            ..Self::default()
        }
    }

    /// Adds the picture of the next frame; `changed` is the number of its pixels that shimmer.
    pub fn add(&mut self, changed: u64, picture: PictureFile) {
        if self.recent.len() == self.length {
            self.recent.pop_front();
        }
        self.recent.push_back((changed, picture));
        let changed = self.recent.iter().map(|(changed, _)| changed).sum();
        let is_whole = self.recent.len() == self.length;
        if is_whole && self.changed.is_none_or(|worst| changed > worst) {
            self.changed = Some(changed);
            let pictures = self.recent.iter();
            self.pictures = pictures.map(|(_, picture)| picture.clone()).collect();
        }
    }
}

/// Figures of the frames that were judged so far: of a still view one, of a path all.
#[derive(Default)]
pub struct Account {
    /// Counts of all frames.
    pub counts: Statistics,
    /// Rays of all frames; `None` if the method does not count them.
    pub rays: Option<u64>,
    /// Casters that block the light of pixels of which the method was certain and wrong.
    pub blockers: Option<BlockerCounts>,
    /// Distances of wrong pixels from edges.
    pub edges: EdgeDistances,
    /// Kind of the answers.
    pub answer: Answer,
    /// The worst frame that was seen yet, for its pictures; of equal ones the first.
    pub worst: Option<(usize, Outputs, Judgement)>,
    /// The frames in their order.
    pub frames: Vec<SequenceFrame>,
    /// Shares of light that the last frame showed.
    pub shown: Option<Vec<f32>>,
    /// Pictures of the path's worst second, in order.
    pub second: Vec<PictureFile>,
    /// Errors of each frame's shares.
    graded: Vec<(Graded, JudgedPixels)>,
}

impl Account {
    /// Adds the frame with the index `index` of `path`.
    ///
    /// # Errors
    /// Outputs of another size than the reference.
    pub fn add(
        &mut self,
        path: &GroundTruthFrames,
        index: usize,
        outputs: Outputs,
        judgement: Judgement,
    ) -> Result<()> {
        let (truth_view, counts) = (&path.truth_views[index], judgement.counts);
        let truth = &truth_view.ground_truth.pixels;
        let edges = truth_view.edges(&outputs, truth)?;
        self.edges = match self.frames.len() {
            0 => edges,
            _ => self.edges.with(edges),
        };
        if counts.wrong.certain > 0 && judgement.is_hard {
            *self.blockers.get_or_insert_default() += truth_view.blockers(&outputs, truth)?;
        }
        let shown = outputs.shown().into_owned();
        let changed = match &self.shown {
            None => None,
            Some(before) => {
                let earlier = &path.truth_views[index - 1].ground_truth;
                let ground_truth = [earlier, &truth_view.ground_truth];
                let counts = shimmer(&path.same[index - 1], [before, &shown], ground_truth);
                Some(counts.map_err(|error| CompareError::Input(format!("no shimmer: {error}")))?)
            }
        };
        self.frames.push(SequenceFrame {
            facing_light: counts.pixels.facing_light,
            wrong: counts.wrong.total,
            wrong_outside_band: counts.wrong.total - counts.wrong.in_band,
            graded: judgement.graded,
            rays: outputs.rays,
            shimmer: changed,
            ..SequenceFrame::default()
        });
        self.counts += counts;
        if let Some(rays) = outputs.rays {
            self.rays = Some(self.rays.unwrap_or(0) + rays);
        }
        self.shown = Some(shown);
        if outputs.shares.is_some() {
            self.answer = Answer::Graded;
        }
        let pixels = JudgedPixels {
            facing_light: counts.pixels.facing_light,
            in_band: counts.band,
        };
        self.graded.push((judgement.graded, pixels));
        let error = self.frames[index].error();
        let worst = self.worst.as_ref();
        if worst.is_none_or(|(worst, ..)| error > self.frames[*worst].error()) {
            self.worst = Some((index, outputs, judgement));
        }
        Ok(())
    }

    /// Returns the errors of all frames together.
    pub fn graded(&self) -> Graded {
        match &self.graded[..] {
            [(graded, _)] => *graded,
            frames => Graded::together(frames.iter().copied()),
        }
    }

    /// Returns the measurements of the frames of a path.
    pub fn sequence(self) -> Sequence {
        let mut total = Shimmer::default();
        for frame in &self.frames {
            total += frame.shimmer.unwrap_or_default();
        }
        Sequence {
            frames: self.frames,
            shimmer: total,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_with_the_most_shimmer_is_kept() {
        let worst = |changed: &[u64]| {
            let mut second = WorstSecond::new(2);
            for (frame, changed) in changed.iter().enumerate() {
                let name = frame.to_string();
                second.add(
                    *changed,
                    PictureFile {
                        name,
                        bytes: Vec::new(),
                    },
                );
            }
            let names = second.pictures.iter().map(|picture| picture.name.clone());
            names.collect::<String>()
        };
        assert_eq!(worst(&[0, 1, 9, 3, 4]), "23");
        assert_eq!(worst(&[0, 0, 0]), "01", "of equal ones the first");
        assert_eq!(worst(&[5]), "", "shorter than a second");
    }
}
