//! The steady state: what a method that remembers shows of a still view.

use crate::error::CompareError;
use crate::graphs::ground_truth::Judgement;
use crate::graphs::preset::VISIBILITY;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::frame::{self, Contents};
use crate::measuring::stop::Stop;
use crate::records::steady::{Cycle, Steady};
use crate::sink::Session;
use skiagraph_gpu::{Content, Executor};
use std::hash::{DefaultHasher, Hash, Hasher};

/// The longest period that is looked for.
const LONGEST: usize = 16;
/// As many frames in a row must each be equal to the one a period before.
const REPEATED: usize = 32;
/// After so many frames nothing is waited for any more.
const MOST: usize = 256;

/// Runs frames of a new executor until its picture repeats, whatever else is asked for: so the same
/// is judged under all flags.
///
/// # Errors
/// Ctrl-C, and those of the executor.
pub fn settle(session: Session, executor: &mut Executor) -> Result<Steady, Stop> {
    let mut shown = Vec::new();
    let mut found = None;
    while found.is_none() && shown.len() < MOST {
        session.check_stopped()?;
        let contents = frame::read(session, executor, &[VISIBILITY])?;
        let mut hasher = DefaultHasher::new();
        contents
            .get(VISIBILITY)
            .map(Content::bytes)
            .hash(&mut hasher);
        shown.push(hasher.finish());
        found = period(&shown);
    }
    Ok(Steady {
        frames: shown.len() as u32,
        period: found.map(|period| period as u32),
        judged: None,
    })
}

/// After how many pictures the last ones repeat.
fn period(shown: &[u64]) -> Option<usize> {
    (1..=LONGEST).find(|period| {
        let begin = shown.len().checked_sub(REPEATED + period);
        begin.is_some_and(|begin| {
            let last = &shown[begin..];
            last[*period..] == last[..REPEATED]
        })
    })
}

/// Judges the pictures of one period; returns the worst one.
///
/// # Errors
/// Ctrl-C, those of the executor and of `judge`.
pub fn judge(
    session: Session,
    executor: &mut Executor,
    names: &[&str],
    steady: &mut Steady,
    judge: impl Fn(Contents) -> Result<(Outputs, Judgement), CompareError>,
) -> Result<(Outputs, Judgement), Stop> {
    let pictures = steady.period.unwrap_or(LONGEST as u32);
    let (mut wrong, mut rmse) = (0, None);
    let mut worst: Option<(Outputs, Judgement)> = None;
    for _ in 0..pictures {
        session.check_stopped()?;
        let (outputs, judgement) = judge(frame::read(session, executor, names)?)?;
        wrong += judgement.counts.wrong.total;
        if let Some(graded) = &judgement.graded {
            *rmse.get_or_insert(0.0) += graded.rmse;
        }
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
        wrong_mean: mean(wrong as f64),
        rmse_mean: rmse.map(mean),
    });
    let none = || CompareError::Input("no picture of the steady state".into()).into();
    worst.ok_or_else(none)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_steady_once_a_period_has_been_repeated_long_enough() {
        let cycle = |begin: u64, length: usize, frames: usize| -> Vec<u64> {
            let begin = (0..begin).map(|frame| 1000 + frame);
            let rest = (0..frames).map(|frame| (frame % length) as u64);
            begin.chain(rest).collect()
        };
        for length in [1, 2, 5, LONGEST] {
            let enough = REPEATED + length;
            assert_eq!(period(&cycle(3, length, enough)), Some(length));
            assert_eq!(period(&cycle(3, length, enough - 1)), None);
        }
        let too_long = LONGEST + 1;
        assert_eq!(period(&cycle(0, too_long, 8 * too_long)), None);
        assert_eq!(period(&[]), None);
    }
}
