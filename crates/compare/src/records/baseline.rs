//! `profile --baseline`: an older profile beside the new one.
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

/// How a profile stands to an older one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The older profile's file.
    pub file: String,
    /// When it was measured.
    pub date: String,
    /// Conditions in which both differ; where there are any, a ratio says little about the code.
    pub differences: Vec<Difference>,
    /// Passes that both have, in the new order.
    pub passes: Vec<PassRatio>,
    /// Whole frames.
    pub frame: FrameRatio,
    /// Passes that only the older profile has.
    pub only_old: Vec<String>,
    /// Passes that only the new profile has.
    pub only_new: Vec<String>,
}

/// A condition under which two profiles were not alike.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// The condition.
    pub what: String,
    /// In the older profile.
    pub old: String,
    /// In the new one.
    pub new: String,
}

/// One pass.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PassRatio {
    /// Its name.
    pub name: String,
    /// Ratio of GPU times; null unless both profiles have them.
    pub gpu: Option<Ratio>,
    /// Ratio of encoding times on the CPU.
    pub cpu: Ratio,
}

/// Whole frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameRatio {
    /// Ratio of GPU times; null unless both profiles have them.
    pub gpu: Option<Ratio>,
    /// Ratio of encoding times on the CPU.
    pub cpu: Ratio,
    /// From the start of encoding until the GPU was done.
    pub wall: Ratio,
}

/// New by old.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// Old median, milliseconds.
    pub old_ms: f64,
    /// New median, milliseconds.
    pub new_ms: f64,
    /// New by old median.
    pub ratio: f64,
    /// Q1(new) / Q3(old).
    pub low: f64,
    /// Q3(new) / Q1(old).
    pub high: f64,
    /// The ratio in a word: a difference, or none.
    pub verdict: Verdict,
}

/// Judgement whether times differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The whole spread lies below 1.
    Faster,
    /// The whole spread lies above 1.
    Slower,
    /// 1 lies in the spread.
    Same,
    /// One of the profiles has fewer than [`MIN_FRAMES`] frames: their quartiles say nothing.
    TooFewFrames,
}

/// With fewer samples a quartile is hardly more than one of them.
pub const MIN_FRAMES: usize = 5;

/// One nanosecond: what samples are stored in, so that nothing is divided by zero.
const RESOLUTION_MS: f64 = 1e-6;

impl Ratio {
    /// Compares an old and a new series.
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

    /// The same, where both are there.
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
