//! Finds the steady state of a method that reuses results of earlier frames: the pictures of a
//! still view that it repeats.

use crate::error::CompareError;
use crate::graphs::ground_truth::Judgement;
use crate::graphs::preset::VISIBILITY;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::frame::{self, Contents};
use crate::measuring::stop::Stop;
use crate::records::steady::{Cycle, EarlyPicture, Steady};
use crate::sink::Session;
use skiagraph_gpu::{Content, Executor};
use std::{
    collections::VecDeque,
    hash::{DefaultHasher, Hash, Hasher},
    rc::Rc,
};

/// The longest period that is looked for.
const LONGEST: usize = 16;
/// As many frames in a row must each be equal to the one a period before.
const REPEATED: usize = 32;
/// After so many frames nothing is waited for any more.
const MOST: usize = 256;

/// Shares of light that differ by no more are the same: less than 8 bits can show.
const SAME: f32 = 1.0 / 1024.0;

/// Runs frames of a new executor until its output `visibility` repeats with a period of at most 16
/// frames, for 32 frames in a row; after 256 frames it gives up. Answers 0 and 1 must repeat to the
/// bit, shares of light within 1/1024. `judge` gets the contents of the outputs `names` after 1, 4,
/// 16 … frames.
///
/// # Errors
/// An early end; the errors of the executor and of `judge`.
pub fn settle(
    session: Session,
    executor: &mut Executor,
    names: &[&str],
    judge: impl Fn(Contents) -> Result<(Outputs, Judgement), CompareError>,
) -> Result<Steady, Stop> {
    let (mut pictures, mut begin) = (Pictures::default(), Vec::new());
    while pictures.period.is_none() && pictures.frames < MOST {
        session.check_stopped()?;
        let mut contents = frame::read(session, executor, names)?;
        let shown = contents.get(VISIBILITY);
        pictures.add(shown.map_or(Shown::Bits(0), Shown::new));
        let frames = pictures.frames as u32;
        if frames.is_power_of_two() && frames.trailing_zeros() % 2 == 0 {
            let (_, judgement) = judge(std::mem::take(&mut contents))?;
            begin.push(EarlyPicture {
                frames,
                wrong_outside_band: judgement.counts.wrong.total - judgement.counts.wrong.in_band,
                rmse: judgement.graded.rmse,
                flip: judgement.graded.flip,
            });
        }
    }
    Ok(Steady {
        frames: pictures.frames as u32,
        period: pictures.period.map(|period| period as u32),
        begin,
        judged: None,
    })
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
    periods: [Period; LONGEST],
    /// The shortest period that has repeated long enough.
    period: Option<usize>,
}

/// A period that is looked for: all pictures are held against those of its first turn, so that one
/// that creeps is not steady.
#[derive(Clone, Default)]
struct Period {
    first_turn: Vec<Rc<Shown>>,
    /// How many pictures in a row were like theirs in the first turn.
    repeated: usize,
}

impl Default for Pictures {
    fn default() -> Self {
        Self {
            last: VecDeque::new(),
            frames: 0,
            periods: std::array::from_fn(|_| Period::default()),
            period: None,
        }
    }
}

impl Pictures {
    fn add(&mut self, shown: Shown) {
        let shown = Rc::new(shown);
        self.frames += 1;
        if self.last.len() == LONGEST {
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
        let is_steady = |period: &Period| period.repeated >= REPEATED;
        self.period = self
            .periods
            .iter()
            .position(is_steady)
            .map(|index| index + 1);
    }
}

/// Draws the pictures of one period of a steady state (16 if it has none), and judges each by
/// `judge`, which gets the contents of the outputs `names`. The state must be reached already.
/// Returns the worst by [`Judgement::is_worse_than`], and writes the means of all into `steady`.
///
/// # Errors
/// An early end; the errors of the executor and of `judge`.
pub fn judge(
    session: Session,
    executor: &mut Executor,
    names: &[&str],
    steady: &mut Steady,
    judge: impl Fn(Contents) -> Result<(Outputs, Judgement), CompareError>,
) -> Result<(Outputs, Judgement), Stop> {
    let pictures = steady.period.unwrap_or(LONGEST as u32);
    let mut sums = Cycle::default();
    let mut worst: Option<(Outputs, Judgement)> = None;
    for _ in 0..pictures {
        session.check_stopped()?;
        let (outputs, judgement) = judge(frame::read(session, executor, names)?)?;
        let wrong = &judgement.counts.wrong;
        sums.wrong_mean += wrong.total as f64;
        sums.wrong_outside_band_mean += (wrong.total - wrong.in_band) as f64;
        sums.rmse_mean += judgement.graded.rmse;
        sums.flip_mean += judgement.graded.flip;
        if worst
            .as_ref()
            .is_none_or(|(_, worst)| judgement.is_worse_than(worst))
        {
            worst = Some((outputs, judgement));
        }
    }
    let mean = |sum: f64| sum / f64::from(pictures);
    steady.judged = Some(Cycle {
        pictures,
        wrong_mean: mean(sums.wrong_mean),
        wrong_outside_band_mean: mean(sums.wrong_outside_band_mean),
        rmse_mean: mean(sums.rmse_mean),
        flip_mean: mean(sums.flip_mean),
    });
    let none = || CompareError::Input("no picture of the steady state".into()).into();
    worst.ok_or_else(none)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn period(shown: impl IntoIterator<Item = Shown>) -> Option<usize> {
        let mut pictures = Pictures::default();
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
