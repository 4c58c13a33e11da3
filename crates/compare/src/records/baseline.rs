//! `profile --baseline`: compares a profile with an older one.
//!
//! A ratio is new median by old median. Its spread goes from Q1(new) / Q3(old) to Q3(new) /
//! Q1(old), Q1 and Q3 being the quartiles of the samples: 1 lies outside it exactly if the middle
//! halves of both samples do not overlap. Only then is something called faster or slower.
//!
//! ```
//! use skiagraph_compare::records::{baseline::{Ratio, Verdict}, statistics::Series};
//!
//! let series = |samples: &[f64]| Series::new(samples.to_vec());
//! let old = series(&[2.0, 2.1, 2.2, 2.3, 2.4]).ok_or("no samples")?;
//! let new = series(&[1.0, 1.1, 1.1, 1.2, 1.9]).ok_or("no samples")?;
//! let ratio = Ratio::new(&old, &new);
//! assert_eq!((ratio.ratio, ratio.verdict), (0.5, Verdict::Faster));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::records::statistics::Series;
use serde::Serialize;

/// Comparison of a profile with an older one of `profile --baseline`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Path of the older profile's file.
    pub file: String,
    /// Date of the older profile, ISO 8601 in UTC.
    pub date: String,
    /// Conditions that differ between the two profiles; if there are any, a ratio says little about
    /// the code.
    pub differences: Vec<Difference>,
    /// Ratios of the times of the passes that both profiles have, in the order of the new profile.
    pub passes: Vec<PassRatio>,
    /// Ratios of the times of whole frames.
    pub frame: FrameRatio,
    /// Names of the passes that only the older profile has.
    pub only_old: Vec<String>,
    /// Names of the passes that only the new profile has.
    pub only_new: Vec<String>,
}

/// A condition that differs between two profiles.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// Name of the condition, such as `adapter`.
    pub what: String,
    /// Value in the older profile.
    pub old: String,
    /// Value in the new profile.
    pub new: String,
}

/// Ratios of the times of one pass.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PassRatio {
    /// Name of the pass.
    pub name: String,
    /// Ratio of GPU times; null unless both profiles have them.
    pub gpu: Option<Ratio>,
    /// Ratio of the CPU times of encoding.
    pub cpu: Ratio,
}

/// Ratios of the times of whole frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameRatio {
    /// Ratio of GPU times; null unless both profiles have them.
    pub gpu: Option<Ratio>,
    /// Ratio of the CPU times of encoding.
    pub cpu: Ratio,
    /// Ratio of the times from the start of encoding until the GPU was done.
    pub wall: Ratio,
}

/// Ratio of a new time to an old one, with its spread and a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// Median of the older profile's times, one per frame, in milliseconds.
    pub old_ms: f64,
    /// Median of the new profile's times, one per frame, in milliseconds.
    pub new_ms: f64,
    /// New median divided by old median.
    pub ratio: f64,
    /// Lower end of the ratio's spread: Q1(new) / Q3(old).
    pub low: f64,
    /// Upper end of the ratio's spread: Q3(new) / Q1(old).
    pub high: f64,
    /// Verdict on the new time: faster, slower, or no difference that can be told.
    pub verdict: Verdict,
}

/// Verdict on a ratio of times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The new time is shorter: the ratio's whole spread, `low` to `high`, lies below 1.
    Faster,
    /// The new time is longer: the ratio's whole spread, `low` to `high`, lies above 1.
    Slower,
    /// The times cannot be told apart: 1 lies in the ratio's spread, `low` to `high`.
    Same,
    /// One of the profiles has fewer than [`MIN_FRAMES`] frames: their quartiles say nothing.
    TooFewFrames,
}

/// Least number of samples for which quartiles are compared: with fewer, a quartile is hardly more
/// than one sample.
pub const MIN_FRAMES: usize = 5;

/// One nanosecond: what samples are stored in, so that nothing is divided by zero.
const RESOLUTION_MS: f64 = 1e-6;

impl Ratio {
    /// Compares a new series of times with an old one.
    pub fn new(old: &Series, new: &Series) -> Self {
        let ratio = |new: f64, old: f64| new.max(RESOLUTION_MS) / old.max(RESOLUTION_MS);
        let [old_q1, old_q3] = old.quartiles();
        let [new_q1, new_q3] = new.quartiles();
        let (low, high) = (ratio(new_q1, old_q3), ratio(new_q3, old_q1));
        let verdict = match () {
            () if old.samples.len().min(new.samples.len()) < MIN_FRAMES => Verdict::TooFewFrames,
            () if high < 1.0 => Verdict::Faster,
            () if low > 1.0 => Verdict::Slower,
            () => Verdict::Same,
        };
        Self {
            old_ms: old.median,
            new_ms: new.median,
            ratio: ratio(new.median, old.median),
            low,
            high,
            verdict,
        }
    }

    /// Compares a new series of times with an old one; `None` if one of them is `None`.
    pub fn from_both(old: Option<&Series>, new: Option<&Series>) -> Option<Self> {
        Some(Self::new(old?, new?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::statistics::tests::series;

    #[test]
    fn only_middle_halves_that_do_not_overlap_are_a_difference() {
        let old = series(&[1.0, 2.0, 3.0, 4.0, 5.0]); // quartiles 2 and 4
        let verdict = |samples: &[f64]| Ratio::new(&old, &series(samples)).verdict;
        assert_eq!(verdict(&[1.0, 2.0, 3.0, 4.0, 5.0]), Verdict::Same);
        assert_eq!(verdict(&[0.1, 0.5, 1.0, 1.5, 9.0]), Verdict::Faster); // up to 1.5
        assert_eq!(verdict(&[0.1, 0.5, 1.0, 2.0, 9.0]), Verdict::Same); // they touch
        assert_eq!(verdict(&[1.0, 5.0, 6.0, 7.0, 8.0]), Verdict::Slower); // from 5
        assert_eq!(verdict(&[9.0; 4]), Verdict::TooFewFrames);
    }

    #[test]
    fn a_ratio_is_that_of_the_medians_with_the_quartiles_extremes() {
        let ratio = Ratio::new(
            &series(&[1.0, 2.0, 4.0, 5.0, 8.0]),
            &series(&[2.0, 4.0, 8.0, 10.0, 16.0]),
        );
        assert_eq!((ratio.old_ms, ratio.new_ms, ratio.ratio), (4.0, 8.0, 2.0));
        assert_eq!((ratio.low, ratio.high), (4.0 / 5.0, 10.0 / 2.0));
    }

    #[test]
    fn times_of_zero_still_have_a_ratio() {
        let (zero, one) = (series(&[0.0; 5]), series(&[1.0; 5]));
        assert_eq!(Ratio::new(&zero, &zero).ratio, 1.0);
        assert_eq!(Ratio::new(&zero, &zero).verdict, Verdict::Same);
        for ratio in [Ratio::new(&zero, &one), Ratio::new(&one, &zero)] {
            assert!(ratio.ratio.is_finite() && ratio.low.is_finite() && ratio.high.is_finite());
        }
    }
}
