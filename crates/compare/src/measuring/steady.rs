//! Finds the steady state of a method that reuses results of earlier frames: the pictures of a
//! still view that it repeats.

use crate::error::CompareError;
use crate::graphs::ground_truth::{Judgement, judged};
use crate::graphs::preset::{Preset, VISIBILITY};
use crate::graphs::shadow_method::Outputs;
use crate::measuring::frame;
use crate::measuring::stop::Stop;
use crate::records::steady::{Cycle, EarlyPicture, Steady};
use crate::sink::Session;
use skiagraph_gpu::{Content, Executor};
use skiagraph_reference::GroundTruth;
use std::collections::VecDeque;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::rc::Rc;

/// The longest period that is looked for, unless the plan tells a longer one.
const LONGEST: usize = 16;
/// As many frames in a row must each be equal to the one a period before, or as many as the plan's
/// period has.
const REPEATED: usize = 32;
/// After so many frames nothing is waited for any more.
const MOST: usize = 256;

/// Shares of light that differ by no more are the same: less than 8 bits can show.
const SAME: f32 = 1.0 / 1024.0;

/// Runs frames of a new executor until its output `visibility` repeats with a period of at most 16
/// frames, for 32 frames in a row, or with one of at most the plan's own period
/// ([`Plan::period`](skiagraph_graph::Plan::period)), if that is longer, for at least as many
/// frames; after 256 frames it gives up. Answers 0 and 1 must repeat to the
/// bit, shares of light within 1/1024. The pictures after 1, 4, 16 … frames are judged. Runs no
/// frame and returns `None` if the method reuses no results of earlier frames.
///
/// # Errors
/// The errors of [`judge`].
pub async fn settle(
    session: Session<'_>,
    (preset, executor): (&Preset, &mut Executor),
    (ground_truth, layer): (&GroundTruth, usize),
) -> Result<Option<Steady>, Stop> {
    if !executor.plan().remembers() {
        return Ok(None);
    }
    let (mut pictures, mut begin) = (Pictures::new(executor.plan().period()), Vec::new());
    while pictures.period.is_none() && pictures.frames < MOST {
        session.check_stopped()?;
        let contents = frame::read(session, executor, &preset.judged()).await?;
        let shown = contents.get(VISIBILITY);
        pictures.add(shown.map_or(Shown::Bits(0), Shown::new));
        let frames = pictures.frames as u32;
        if frames.is_power_of_two() && frames.trailing_zeros().is_multiple_of(2) {
            let (_, judgement) = judged(preset, (contents, layer), ground_truth)?;
            begin.push(EarlyPicture {
                frames,
                wrong_outside_band: judgement.counts.wrong.total - judgement.counts.wrong.in_band,
                rmse: judgement.graded.rmse,
                flip: judgement.graded.flip,
            });
        }
    }
    Ok(Some(Steady {
        frames: pictures.frames as u32,
        period: pictures.period.map(|period| period as u32),
        begin,
        judged: None,
    }))
}

/// A picture, as far as it is compared with others.
enum Shown {
    /// The hash of a hard one.
    Bits(u64),
    Shares(Vec<f32>),
}

impl Shown {
    fn new(content: &Content) -> Self {
        match content.as_f32() {
            Some(shares) => Self::Shares(shares),
            None => {
                let mut hasher = DefaultHasher::new();
                content.bytes().hash(&mut hasher);
                Self::Bits(hasher.finish())
            }
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Bits(one), Self::Bits(other)) => one == other,
            (Self::Shares(one), Self::Shares(other)) => {
                let is_same = |(one, other): (&f32, &f32)| {
                    one.to_bits() == other.to_bits() || (one - other).abs() <= SAME
                };
                one.len() == other.len() && one.iter().zip(other).all(is_same)
            }
            _ => false,
        }
    }
}

/// The pictures so far.
struct Pictures {
    /// As many of the last ones as the longest period has.
    last: VecDeque<Rc<Shown>>,
    frames: usize,
    periods: Vec<Period>,
    /// Number of frames in a row for which a period must be repeated.
    enough: usize,
    /// The shortest period that has repeated long enough.
    period: Option<usize>,
}

/// A period that is looked for: all pictures are held against those of its first turn, so that one
/// that creeps is not steady.
#[derive(Default)]
struct Period {
    first_turn: Vec<Rc<Shown>>,
    /// How many pictures in a row were like theirs in the first turn.
    repeated: usize,
}

impl Pictures {
    /// Begins with no picture of a plan whose passes run in turns of `turns` frames.
    fn new(turns: usize) -> Self {
        Self {
            last: VecDeque::new(),
            frames: 0,
            periods: (0..LONGEST.max(turns)).map(|_| Period::default()).collect(),
            enough: REPEATED.max(turns),
            period: None,
        }
    }

    fn add(&mut self, shown: Shown) {
        let shown = Rc::new(shown);
        self.frames += 1;
        if self.last.len() == self.periods.len() {
            self.last.pop_front();
        }
        self.last.push_back(Rc::clone(&shown));
        for (index, period) in self.periods.iter_mut().enumerate() {
            let length = index + 1;
            let like = period.first_turn.get(period.repeated % length);
            if like.is_some_and(|like| period.first_turn.len() == length && like.is_like(&shown)) {
                period.repeated += 1;
                continue;
            }
            let skipped = self.last.len().saturating_sub(length);
            period.first_turn = self.last.iter().skip(skipped).cloned().collect();
            period.repeated = 0;
        }
        let is_steady = |period: &Period| period.repeated >= self.enough;
        let shortest = self.periods.iter().position(is_steady);
        self.period = shortest.map(|index| index + 1);
    }
}

/// Judges the next frame of a method on a still view. Of one in its steady state, those of one
/// period are judged (if it has none, 16 or as many as the plan's has): their means are written
/// into `steady`, and the worst by [`Judgement::is_worse_than`] is returned. `layer` is the layer
/// of the outputs that is judged.
///
/// # Errors
/// An early end; the errors of the executor; outputs that are not those of a shadow method.
pub async fn judge(
    session: Session<'_>,
    (preset, executor): (&Preset, &mut Executor),
    steady: Option<&mut Steady>,
    (ground_truth, layer): (&GroundTruth, usize),
) -> Result<(Outputs, Judgement), Stop> {
    let longest = LONGEST.max(executor.plan().period()) as u32;
    let period = |steady: &Steady| steady.period.unwrap_or(longest);
    let pictures = steady.as_deref().map_or(1, period);
    let mut judgements: Vec<Judgement> = Vec::new();
    let mut worst: Option<(usize, Outputs)> = None;
    for _ in 0..pictures {
        session.check_stopped()?;
        let contents = frame::read(session, executor, &preset.judged()).await?;
        let (outputs, judgement) = judged(preset, (contents, layer), ground_truth)?;
        let is_worse = |(worst, _): &(usize, _)| judgement.is_worse_than(&judgements[*worst]);
        if worst.as_ref().is_none_or(is_worse) {
            worst = Some((judgements.len(), outputs));
        }
        judgements.push(judgement);
    }
    if let Some(steady) = steady {
        let mean = |figure: fn(&Judgement) -> f64| {
            judgements.iter().map(figure).sum::<f64>() / f64::from(pictures)
        };
        steady.judged = Some(Cycle {
            pictures,
            wrong_mean: mean(|judged| judged.counts.wrong.total as f64),
            wrong_outside_band_mean: mean(|judged| {
                (judged.counts.wrong.total - judged.counts.wrong.in_band) as f64
            }),
            rmse_mean: mean(|judged| judged.graded.rmse),
            flip_mean: mean(|judged| judged.graded.flip),
        });
    }
    let none = || CompareError::Input("no picture of the steady state".into());
    let (index, outputs) = worst.ok_or_else(none)?;
    Ok((outputs, judgements.swap_remove(index)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn period(shown: impl IntoIterator<Item = Shown>) -> Option<usize> {
        in_turns(1, shown)
    }

    fn in_turns(turns: usize, shown: impl IntoIterator<Item = Shown>) -> Option<usize> {
        let mut pictures = Pictures::new(turns);
        shown.into_iter().for_each(|shown| pictures.add(shown));
        pictures.period
    }

    #[test]
    fn a_picture_is_steady_once_a_period_has_been_repeated_long_enough() {
        let cycle = |begin: u64, length: usize, frames: usize| {
            let begin = (0..begin).map(|frame| 1000 + frame);
            let rest = (0..frames).map(move |frame| (frame % length) as u64);
            begin.chain(rest).map(Shown::Bits)
        };
        for length in [1, 2, 5, LONGEST] {
            let enough = REPEATED + length;
            assert_eq!(period(cycle(3, length, enough)), Some(length));
            assert_eq!(period(cycle(3, length, enough - 1)), None);
        }
        let too_long = LONGEST + 1;
        assert_eq!(period(cycle(0, too_long, 8 * too_long)), None);
        // Unless the plan says that its passes take turns of as many frames.
        let enough = REPEATED + too_long;
        assert_eq!(
            in_turns(too_long, cycle(0, too_long, enough)),
            Some(too_long)
        );
        // What changes once in 64 frames is not steady after 32 that are alike.
        assert_eq!(period(cycle(1, 1, 40)), Some(1));
        assert_eq!(in_turns(64, cycle(1, 1, 64)), None);
        assert_eq!(in_turns(64, cycle(1, 1, 65)), Some(1));
        assert_eq!(period([]), None);
    }

    #[test]
    fn shares_are_steady_within_a_thousandth_but_not_while_they_creep() {
        let mean = |weight: f32, frames: usize| {
            let shares = (0..frames).map(move |frame| 1.0 - (1.0 - weight).powi(frame as i32));
            shares.map(|share| Shown::Shares(vec![share, 0.0]))
        };
        // An exponential mean whose weight is 1/20: frames 130 to 162 differ by 1/1024.
        assert_eq!(period(mean(0.05, 110)), None);
        assert_eq!(period(mean(0.05, MOST)), Some(1));
        // One that moves by less than 1/4096 a frame, for thousands of frames.
        assert_eq!(period(mean(0.0002, MOST)), None);
        let nan = || Shown::Shares(vec![f32::NAN]);
        assert_eq!(period((0..REPEATED + 1).map(|_| nan())), Some(1));
    }
}
