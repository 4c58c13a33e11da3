//! Times of methods that took turns frame by frame, and the ratio of two of them.
//!
//! Whatever slows the machine down for a while slows the frames of one turn down alike, so the
//! ratio of two methods in each turn tells more than the ratio of their medians.
//!
//! ```
//! use skiagraph_compare::records::turns::Ratio;
//!
//! let fast = [1.0, 1.1, 1.0, 5.0, 1.0, 1.2, 1.0, 1.1];
//! let slow = fast.map(|ms| 2.0 * ms);
//! let ratio = Ratio::paired(&slow, &fast).ok_or("too few frames")?;
//! assert_eq!((ratio.low, ratio.median, ratio.high), (2.0, 2.0, 2.0));
//! assert!(ratio.is_told_apart());
//! assert!(!Ratio::paired(&fast, &fast).ok_or("too few")?.is_told_apart());
//! # Ok::<(), &str>(())
//! ```

use crate::records::regimes::RegimeTimes;
use crate::records::statistics::FrameTimes;
use serde::{Deserialize, Serialize};

/// Group of runs that took turns: in each turn the method of each run drew one frame. Frame `i` of
/// one run and frame `i` of another were therefore drawn under the same conditions.
///
/// Two runs are in one group if they have the same [`session`](super::results::Run::session), view,
/// viewport and [`group`](Self::group). Two runs of different groups with the same session, view
/// and viewport are compared by the anchor, a method that drew in both groups: multiply the time of
/// frame `i` of a run in group A by `anchor[i]` of group B divided by `anchor[i]` of group A, and
/// compare it with frame `i` of the run in group B.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Turns {
    /// Index of the group among the groups of the same session, view and viewport, from 0. A group
    /// holds as many methods as fit into the memory at once.
    pub group: u32,
    /// Times of the frames that the anchor drew in this group, one per turn. The anchor is the
    /// first of the methods that were timed; it takes part in every group of the session, view and
    /// viewport.
    pub anchor: FrameTimes,
    /// Times of the anchor in this group by what has moved since the frame before.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regimes: Vec<RegimeTimes>,
}

/// Ratio of the frame times of two methods, with an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// Lower end of the interval that contains the true ratio with the confidence of
    /// [`paired`](Self::paired) or [`unpaired::ratio`](super::unpaired::ratio).
    pub low: f64,
    /// Median of the ratios: one per turn, or of every frame of one run to every frame of the
    /// other.
    pub median: f64,
    /// Upper end of the interval whose lower end is `low`.
    pub high: f64,
}

/// The confidence of an interval of turns.
const CONFIDENCE: f64 = 0.99;

/// Least number of turns for which there is an interval: of fewer, even if all agree, the
/// confidence is lower.
pub const LEAST_TURNS: usize = 8;

/// Times that differ by less than this share are level whatever the interval says: it knows nothing
/// of how memory happens to lie.
const LEVEL: f64 = 0.03;

/// One nanosecond in milliseconds, so that nothing is divided by zero.
const RESOLUTION_MS: f64 = 1e-6;

impl Ratio {
    /// Divides the time of each frame of `one` by that of the same turn of `other`; entry `i` of
    /// both lists is of turn `i`, in the same unit. Entries of the longer list without a partner
    /// are left out. The interval has a confidence of at least 99 %, for any distribution of the
    /// times (order statistics). Returns `None` for fewer than [`LEAST_TURNS`] turns.
    pub fn paired(one: &[f64], other: &[f64]) -> Option<Self> {
        let pairs = one.iter().zip(other);
        Self::within(pairs, rank(one.len().min(other.len()))?)
    }

    /// The ratios of some pairs, the interval without so many at each end.
    pub(super) fn within<'t>(
        pairs: impl Iterator<Item = (&'t f64, &'t f64)>,
        outside: usize,
    ) -> Option<Self> {
        let ratio = |(one, other): (&f64, &f64)| one.max(RESOLUTION_MS) / other.max(RESOLUTION_MS);
        let mut ratios: Vec<f64> = pairs.map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let last = ratios.len().checked_sub(1)?;
        Some(Self {
            low: ratios[outside],
            median: (ratios[last / 2] + ratios[ratios.len() / 2]) * 0.5,
            high: ratios[last - outside],
        })
    }

    /// True if the two methods differ: 1 lies outside the interval, and the median ratio is off 1
    /// by 3 % or more.
    pub fn is_told_apart(&self) -> bool {
        let differs = self.median >= 1.0 + LEVEL || self.median <= 1.0 / (1.0 + LEVEL);
        differs && (self.low > 1.0 || self.high < 1.0)
    }
}

/// The greatest rank from both ends between which the median lies with the confidence: each sample
/// lies above it or below it like a tossed coin.
fn rank(count: usize) -> Option<usize> {
    let mut probability = 0.5f64.powi(count as i32);
    let (mut below, mut rank) = (0.0, None);
    for ends in 0..count.div_ceil(2) {
        below += probability;
        if 1.0 - 2.0 * below < CONFIDENCE {
            break;
        }
        rank = Some(ends);
        probability *= (count - ends) as f64 / (ends + 1) as f64;
    }
    rank
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_has_the_ranks_of_the_sign_tests_tables() {
        // Both ends from 8 samples on: 1 - 2/256 = 0.992. One sample is left out at each end from
        // 12 on: 1 - 2 * 13/4096 = 0.9937.
        let ranks = [7, 8, 11, 12, 20, 100].map(rank);
        assert_eq!(ranks, [None, Some(0), Some(0), Some(1), Some(3), Some(36)]);
        assert!(rank(LEAST_TURNS - 1).is_none() && rank(LEAST_TURNS).is_some());
    }

    #[test]
    fn only_what_all_turns_agree_on_is_told_apart() {
        let even: Vec<f64> = (0..10).map(|turn| 10.0 + f64::from(turn)).collect();
        let scaled = |by: f64| even.iter().map(|ms| ms * by).collect::<Vec<f64>>();
        let apart = |other: &[f64]| Ratio::paired(&even, other).unwrap().is_told_apart();
        assert!(apart(&scaled(1.1)) && apart(&scaled(0.9)));
        assert!(!apart(&scaled(1.02)), "level");
        let mut one_faster = scaled(1.1);
        one_faster[3] = 0.5 * even[3];
        assert!(!apart(&one_faster));
        assert_eq!(Ratio::paired(&even[..7], &even[..7]), None);
        assert!(Ratio::paired(&[0.0; 8], &[0.0; 8]).unwrap().median == 1.0);
    }
}
