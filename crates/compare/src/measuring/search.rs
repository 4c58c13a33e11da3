//! Searches the values of several params for the combination with the least error.
//!
//! It changes one param at a time, then two at a time, as one alone often helps nothing: casters
//! that are not culled need a bias, and a bias without them only costs. Each change that helps is
//! kept at once. It ends where no change of two params helps, or where trials end.

use itertools::Itertools;
use std::collections::BTreeSet;

/// A combination of values: for each param, in the order of the [`Axis`] list, the index of its
/// value. 0 is the value that the param has by default.
pub type Point = Vec<usize>;

/// Outcome of a trial of a combination.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trial {
    /// The combination has this error, 0 or more; less is better.
    Error(f64),
    /// The combination has a greater error than the best one so far, or cannot run.
    Worse,
    /// A combination with fewer values other than the defaults has the same effect; this one was
    /// not tried.
    Same,
    /// No more trials are allowed; the combination was not tried.
    Ended,
}

/// A param of the search, with the number and kind of its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Number of the param's values, the default included.
    pub values: usize,
    /// True if the values are words or booleans. Their combinations with numbers are tried first.
    pub is_word: bool,
}

/// The best combination that a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The best combination: for each param the index of its value.
    pub point: Point,
    /// Error of the combination `point`; infinite if no combination could run.
    pub error: f64,
    /// Number of combinations that were tried, the defaults included.
    pub tried: u32,
    /// True if the search ended because no change helps; false if a trial was [`Trial::Ended`].
    pub is_whole: bool,
}

/// Searches for the combination with the least error, beginning with the defaults. `trial` gets a
/// combination, never the same twice, and the least error so far: it may answer [`Trial::Worse`] as
/// soon as the error must be greater. Of combinations with equal errors the one with fewer values
/// other than the defaults is kept.
///
/// # Errors
/// The errors of `trial`.
pub async fn search<E>(
    axes: &[Axis],
    trial: impl AsyncFnMut(&[usize], f64) -> Result<Trial, E>,
) -> Result<Found, E> {
    let mut search = Search {
        axes,
        trial,
        known: BTreeSet::new(),
        found: Found {
            point: vec![0; axes.len()],
            error: f64::INFINITY,
            tried: 0,
            is_whole: true,
        },
    };
    search.visit(vec![0; axes.len()]).await?;
    while search.found.is_whole && search.found.error > 0.0 {
        if !search.singles().await? && !search.pairs().await? {
            break;
        }
    }
    Ok(search.found)
}

/// A search under way.
struct Search<'a, T> {
    axes: &'a [Axis],
    trial: T,
    /// The combinations that were tried.
    known: BTreeSet<Point>,
    found: Found,
}

impl<E, T: AsyncFnMut(&[usize], f64) -> Result<Trial, E>> Search<'_, T> {
    /// Tries a combination; true if it is the best so far.
    async fn visit(&mut self, point: Point) -> Result<bool, E> {
        if !self.found.is_whole || !self.known.insert(point.clone()) {
            return Ok(false);
        }
        match (self.trial)(&point, self.found.error).await? {
            Trial::Ended => {
                self.found.is_whole = false;
                return Ok(false);
            }
            Trial::Error(error) if self.is_better(&point, error) => {
                (self.found.point, self.found.error) = (point, error);
                self.found.tried += 1;
                return Ok(true);
            }
            Trial::Error(_) | Trial::Worse => self.found.tried += 1,
            Trial::Same => {}
        }
        Ok(false)
    }

    fn is_better(&self, point: &[usize], error: f64) -> bool {
        let changes = |point: &[usize]| point.iter().filter(|value| **value > 0).count();
        let has_fewer = changes(point) < changes(&self.found.point);
        error < self.found.error || (error == self.found.error && has_fewer)
    }

    /// Tries all values of each param by itself, until none helps; true if any did.
    async fn singles(&mut self) -> Result<bool, E> {
        let mut any = false;
        loop {
            let mut helps = false;
            for axis in 0..self.axes.len() {
                helps |= self.change([(axis, None)]).await?;
            }
            if !helps {
                return Ok(any);
            }
            any = true;
        }
    }

    /// Tries all values of two params together; true as soon as the values of two help.
    async fn pairs(&mut self) -> Result<bool, E> {
        let axes = self.axes;
        let pairs = (0..axes.len()).array_combinations();
        // Words with numbers, then words with words, then numbers with numbers.
        let pairs =
            pairs.sorted_by_key(|&[one, two]| match (axes[one].is_word, axes[two].is_word) {
                (true, true) => 1,
                (false, false) => 2,
                _ => 0,
            });
        for [one, two] in pairs {
            let mut helps = false;
            for value in 0..axes[one].values {
                helps |= self.change([(one, Some(value)), (two, None)]).await?;
            }
            if helps {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Changes the best combination: params with a value get it, the last one all of its values in
    /// turn. True if that helps.
    async fn change<const N: usize>(
        &mut self,
        changes: [(usize, Option<usize>); N],
    ) -> Result<bool, E> {
        let mut helps = false;
        let Some(&(last, _)) = changes.last() else {
            return Ok(false);
        };
        for value in 0..self.axes[last].values {
            let mut point = self.found.point.clone();
            for &(axis, given) in &changes {
                point[axis] = given.unwrap_or(value);
            }
            helps |= self.visit(point).await?;
        }
        Ok(helps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use itertools::Itertools;
    use skiagraph_gpu::block_on;

    const AXES: [Axis; 4] = [
        Axis {
            values: 3,
            is_word: true,
        },
        Axis {
            values: 5,
            is_word: false,
        },
        Axis {
            values: 3,
            is_word: false,
        },
        Axis {
            values: 3,
            is_word: true,
        },
    ];

    fn grid() -> impl Iterator<Item = Point> {
        AXES.iter()
            .map(|axis| 0..axis.values)
            .multi_cartesian_product()
    }

    /// Searches with at most `most` trials; checks that none is repeated.
    fn searched(most: usize, error: impl Fn(&[usize]) -> f64) -> Found {
        let mut seen: Vec<Point> = Vec::new();
        let outcome = search(&AXES, async |point, best| {
            if seen.len() == most {
                return Ok::<_, ()>(Trial::Ended);
            }
            assert!(!seen.iter().any(|seen| seen == point), "{point:?} again");
            seen.push(point.to_vec());
            let error = error(point);
            Ok(if error <= best {
                Trial::Error(error)
            } else {
                Trial::Worse
            })
        });
        let outcome = block_on(outcome).unwrap();
        assert_eq!(outcome.tried as usize, seen.len());
        outcome
    }

    /// Like a map whose casters may be culled: without culling, only a bias makes it right.
    fn culled(point: &[usize]) -> f64 {
        let [cull, slope, bias, fit] = point else {
            panic!("four params")
        };
        let acne = [0.0, 0.6, 0.6][*cull] * 0.2f64.powi(*slope as i32);
        let leak = [0.2, 0.0, 0.1][*cull] + 0.01 * *slope as f64 + 0.02 * *bias as f64;
        (acne + leak) * [1.0, 0.7, 0.5][*fit]
    }

    #[test]
    fn two_params_that_help_only_together_are_found() {
        let outcome = searched(usize::MAX, culled);
        let best = grid()
            .map(|point| culled(&point))
            .fold(f64::INFINITY, f64::min);
        assert_eq!(outcome.error, best);
        assert_eq!(outcome.point, [1, 3, 0, 2]);
        assert!(outcome.is_whole);
        assert!(
            outcome.tried < 90,
            "{} of {}",
            outcome.tried,
            grid().count()
        );
    }

    #[test]
    fn rough_errors_come_within_a_fifth_of_the_grids_best() {
        // Noise of up to a tenth on a bowl whose middle lies anywhere.
        for seed in 0..50u64 {
            let noise = |point: &[usize]| {
                let key = point.iter().fold(seed, |key, &at| key * 31 + at as u64);
                (key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / f64::from(1 << 24)
            };
            let middle = [
                seed as usize % 3,
                seed as usize % 5,
                seed as usize / 5 % 3,
                1,
            ];
            let error = |point: &[usize]| {
                let far = point
                    .iter()
                    .zip(middle)
                    .map(|(&at, middle)| at.abs_diff(middle));
                (1.0 + far.sum::<usize>() as f64) * (1.0 + 0.1 * noise(point))
            };
            let best = grid()
                .map(|point| error(&point))
                .fold(f64::INFINITY, f64::min);
            let outcome = searched(usize::MAX, error);
            assert!(
                outcome.error <= 1.2 * best,
                "{seed}: {} {best}",
                outcome.error
            );
        }
    }

    #[test]
    fn it_ends_with_the_trials_and_keeps_what_it_has() {
        for most in 0..40 {
            let outcome = searched(most, culled);
            assert_eq!((outcome.tried as usize, outcome.is_whole), (most, false));
            assert!(most == 0 || outcome.error <= culled(&[0; 4]));
        }
        assert_eq!(searched(0, culled).point, [0; 4]);
    }

    #[test]
    fn of_equal_errors_the_defaults_stay() {
        let outcome = searched(usize::MAX, |_| 0.5);
        assert_eq!(outcome.point, [0; 4]);
        // Nothing is better than no error.
        assert_eq!(searched(usize::MAX, |_| 0.0).tried, 1);
        // One that cannot run has no error at all.
        assert_eq!(searched(usize::MAX, |_| f64::INFINITY).error, f64::INFINITY);
    }

    #[test]
    fn a_change_that_helped_on_the_way_only_is_taken_back() {
        // The third param helps at once, and no more when the first two are right.
        let outcome = searched(usize::MAX, |point| match point {
            [1, 2, ..] => 0.1,
            [_, _, 1, _] => 0.4,
            _ => 0.5,
        });
        assert_eq!((outcome.point, outcome.error), (vec![1, 2, 0, 0], 0.1));
    }
}
