//! `profile --baseline`: compares a profile with an older one.
//!
//! The two were not measured side by side, so their times are compared as `compare --baseline` does
//! ([`unpaired`]): a time is called faster or slower only if the whole interval of the ratio lies
//! on one side of 1, and the ratio is off 1 by 3 % or more.
//!
//! ```
//! use skiagraph_compare::records::{baseline::{Ratio, Verdict}, statistics::Series};
//!
//! let old = Series::new(vec![2.0; 8]).ok_or("no samples")?;
//! let new = Series::new(vec![1.0; 8]).ok_or("no samples")?;
//! let ratio = Ratio::new(&old, &new);
//! assert_eq!((ratio.ratio, ratio.verdict), (Some(0.5), Verdict::Faster));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::records::statistics::Series;
use crate::records::unpaired;
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
    /// Median of the ratios of every frame of the new profile to every frame of the older one; null
    /// if one of them has too few frames.
    pub ratio: Option<f64>,
    /// Lower end of the interval of the ratio; null where `ratio` is.
    pub low: Option<f64>,
    /// Upper end of the interval of the ratio; null where `ratio` is.
    pub high: Option<f64>,
    /// Verdict on the new time: faster, slower, or no difference that can be told.
    pub verdict: Verdict,
}

/// Verdict on a ratio of times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The new time is shorter: the ratio's whole interval lies below 1, the ratio by 3 % or more.
    Faster,
    /// The new time is longer: the ratio's whole interval lies above 1, the ratio by 3 % or more.
    Slower,
    /// The times cannot be told apart.
    Same,
    /// One of the profiles has fewer than [`LEAST_TURNS`](super::turns::LEAST_TURNS) frames.
    TooFewFrames,
}

impl Ratio {
    /// Compares a new series of times with an old one.
    pub fn new(old: &Series, new: &Series) -> Self {
        let ratio = unpaired::ratio(&new.samples, &old.samples);
        Self {
            old_ms: old.median,
            new_ms: new.median,
            ratio: ratio.map(|ratio| ratio.median),
            low: ratio.map(|ratio| ratio.low),
            high: ratio.map(|ratio| ratio.high),
            verdict: match ratio {
                None => Verdict::TooFewFrames,
                Some(ratio) if !ratio.is_told_apart() => Verdict::Same,
                Some(ratio) if ratio.median < 1.0 => Verdict::Faster,
                Some(_) => Verdict::Slower,
            },
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
    fn the_verdict_is_that_of_runs_that_were_not_measured_side_by_side() {
        let old = series(&[10.0, 10.1, 10.2, 10.3, 10.4, 10.5, 10.6, 10.7]);
        let against = |by: f64| {
            let new: Vec<f64> = old.samples.iter().map(|ms| ms * by).collect();
            Ratio::new(&old, &series(&new))
        };
        let verdicts = [0.8, 1.0, 1.02, 1.2].map(|by| against(by).verdict);
        let expected = [
            Verdict::Faster,
            Verdict::Same,
            Verdict::Same, // less than 3 % off
            Verdict::Slower,
        ];
        assert_eq!(verdicts, expected);
        let paired = unpaired::ratio(&old.samples, &old.samples).unwrap();
        let same = against(1.0);
        let ratio = [same.low, same.ratio, same.high].map(Option::unwrap);
        assert_eq!(ratio, [paired.low, paired.median, paired.high]);
    }

    #[test]
    fn with_too_few_frames_there_is_no_ratio() {
        let ratio = Ratio::new(&series(&[1.0; 8]), &series(&[9.0; 7]));
        assert_eq!((ratio.old_ms, ratio.new_ms), (1.0, 9.0));
        assert_eq!((ratio.ratio, ratio.verdict), (None, Verdict::TooFewFrames));
    }
}
