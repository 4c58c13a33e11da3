//! `profile --baseline`: an older profile beside the new one.
//!
//! A ratio is new median by old median. Its spread goes from Q1(new) / Q3(old) to Q3(new) / Q1(old), Q1 and Q3 being the
//! quartiles of the samples: 1 lies outside it exactly if the middle halves of both samples do not overlap. Only then is
//! something called faster or slower.

use crate::profile::record::{Conditions, Profile, Series};
use serde::Serialize;
use std::{collections::BTreeSet, path::Path};

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
    /// Of GPU times; null unless both profiles have them.
    pub gpu: Option<Ratio>,
    /// Of encoding on the CPU.
    pub cpu: Ratio,
}

/// Whole frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameRatio {
    /// Of GPU times; null unless both profiles have them.
    pub gpu: Option<Ratio>,
    /// Of encoding on the CPU.
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
    /// Whether that is a difference.
    pub verdict: Verdict,
}

/// Whether times differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The whole spread lies below 1.
    Faster,
    /// The whole spread lies above 1.
    Slower,
    /// 1 lies in the spread.
    Same,
    /// One of the profiles has fewer than [`FEWEST`] frames: their quartiles say nothing.
    TooFewFrames,
}

/// With fewer samples a quartile is hardly more than one of them.
pub const FEWEST: usize = 5;

/// One nanosecond: what samples are stored in, so that nothing is divided by zero.
const GRAIN_MS: f64 = 1e-6;

impl Ratio {
    /// Of an old and a new series.
    pub fn of(old: &Series, new: &Series) -> Self {
        let ratio = |new: f64, old: f64| new.max(GRAIN_MS) / old.max(GRAIN_MS);
        let [old_q1, old_q3] = quartiles(&old.samples);
        let [new_q1, new_q3] = quartiles(&new.samples);
        let (low, high) = (ratio(new_q1, old_q3), ratio(new_q3, old_q1));
        let verdict = match () {
            () if old.samples.len().min(new.samples.len()) < FEWEST => Verdict::TooFewFrames,
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

    fn of_both(old: Option<&Series>, new: Option<&Series>) -> Option<Self> {
        Some(Self::of(old?, new?))
    }
}

/// First and third quartile, linear between the samples beside them.
fn quartiles(samples: &[f64]) -> [f64; 2] {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    [0.25, 0.75].map(|share| {
        let place = share * sorted.len().saturating_sub(1) as f64;
        let at = |index: f64| sorted.get(index as usize).copied().unwrap_or(f64::NAN);
        let (below, above) = (at(place.floor()), at(place.ceil()));
        below + (above - below) * place.fract()
    })
}

impl Comparison {
    /// Of an older profile, read from `file`, and a new one.
    pub fn of(file: &Path, old: &Profile, new: &Profile) -> Self {
        let missing = |from: &Profile, other: &Profile| {
            let names = from.passes.iter().map(|pass| pass.name.clone());
            names
                .filter(|name| other.passes.iter().all(|pass| pass.name != *name))
                .collect()
        };
        let passes = new.passes.iter().filter_map(|pass| {
            let before = old.passes.iter().find(|old| old.name == pass.name)?;
            Some(PassRatio {
                name: pass.name.clone(),
                gpu: Ratio::of_both(before.gpu_ms.as_ref(), pass.gpu_ms.as_ref()),
                cpu: Ratio::of(&before.cpu_ms, &pass.cpu_ms),
            })
        });
        Self {
            file: file.display().to_string(),
            date: old.conditions.date.clone(),
            differences: differences(&old.conditions, &new.conditions),
            passes: passes.collect(),
            frame: FrameRatio {
                gpu: Ratio::of_both(old.frame.gpu_ms.as_ref(), new.frame.gpu_ms.as_ref()),
                cpu: Ratio::of(&old.frame.cpu_ms, &new.frame.cpu_ms),
                wall: Ratio::of(&old.frame.wall_ms, &new.frame.wall_ms),
            },
            only_old: missing(old, new),
            only_new: missing(new, old),
        }
    }
}

fn differences(old: &Conditions, new: &Conditions) -> Vec<Difference> {
    let facts = |conditions: &Conditions| {
        let [width, height] = conditions.viewport;
        [
            ("program", conditions.program.clone()),
            ("build", conditions.build.clone()),
            ("adapter", conditions.adapter.to_string()),
            ("scene", conditions.scene.to_string()),
            ("method", conditions.preset.clone()),
            ("view", conditions.view.clone()),
            ("viewport", format!("{width}x{height}")),
        ]
    };
    let names: BTreeSet<&str> = old
        .params()
        .chain(new.params())
        .map(|(name, _)| name)
        .collect();
    let param = |conditions: &Conditions, name: &str| {
        let value = conditions.params().find(|(known, _)| *known == name);
        value.map_or_else(|| "–".to_owned(), |(_, value)| value)
    };
    let params = names
        .into_iter()
        .map(|name| (format!("param {name}"), param(old, name), param(new, name)));
    let facts = facts(old).into_iter().zip(facts(new));
    facts
        .map(|((what, old), (_, new))| (what.to_owned(), old, new))
        .chain(params)
        .filter(|(_, old, new)| old != new)
        .map(|(what, old, new)| Difference { what, old, new })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::record::tests::{sample, series};

    #[test]
    fn quartiles_lie_between_the_samples_beside_them() {
        assert_eq!(quartiles(&[5.0, 1.0, 2.0, 4.0, 3.0]), [2.0, 4.0]);
        assert_eq!(quartiles(&[1.0, 2.0]), [1.25, 1.75]);
        assert_eq!(quartiles(&[7.0]), [7.0, 7.0]);
    }

    #[test]
    fn only_middle_halves_that_do_not_overlap_are_a_difference() {
        let old = series(&[1.0, 2.0, 3.0, 4.0, 5.0]); // quartiles 2 and 4
        let verdict = |samples: &[f64]| Ratio::of(&old, &series(samples)).verdict;
        assert_eq!(verdict(&[1.0, 2.0, 3.0, 4.0, 5.0]), Verdict::Same);
        assert_eq!(verdict(&[0.1, 0.5, 1.0, 1.5, 9.0]), Verdict::Faster); // up to 1.5
        assert_eq!(verdict(&[0.1, 0.5, 1.0, 2.0, 9.0]), Verdict::Same); // they touch
        assert_eq!(verdict(&[1.0, 5.0, 6.0, 7.0, 8.0]), Verdict::Slower); // from 5
        assert_eq!(verdict(&[9.0; 4]), Verdict::TooFewFrames);
    }

    #[test]
    fn a_ratio_is_that_of_the_medians_with_the_quartiles_extremes() {
        let ratio = Ratio::of(
            &series(&[1.0, 2.0, 4.0, 5.0, 8.0]),
            &series(&[2.0, 4.0, 8.0, 10.0, 16.0]),
        );
        assert_eq!((ratio.old_ms, ratio.new_ms, ratio.ratio), (4.0, 8.0, 2.0));
        assert_eq!((ratio.low, ratio.high), (4.0 / 5.0, 10.0 / 2.0));
    }

    #[test]
    fn times_of_zero_still_have_a_ratio() {
        let (zero, one) = (series(&[0.0; 5]), series(&[1.0; 5]));
        assert_eq!(Ratio::of(&zero, &zero).ratio, 1.0);
        assert_eq!(Ratio::of(&zero, &zero).verdict, Verdict::Same);
        for ratio in [Ratio::of(&zero, &one), Ratio::of(&one, &zero)] {
            assert!(ratio.ratio.is_finite() && ratio.low.is_finite() && ratio.high.is_finite());
        }
    }

    #[test]
    fn what_differs_and_what_stands_on_one_side_is_listed() {
        let (old, mut new) = (sample(), sample());
        new.conditions.viewport = [64, 64];
        new.conditions.params.insert("bias".into(), 0.5.into());
        new.conditions.date = "2027-01-01T00:00:00Z".into();
        new.passes[1].name = "fill".into();
        let comparison = Comparison::of(Path::new("old.json"), &old, &new);
        let whats: Vec<_> = comparison
            .differences
            .iter()
            .map(|d| d.what.as_str())
            .collect();
        assert_eq!(whats, ["viewport", "param bias"]);
        assert_eq!(comparison.differences[1].old, "–");
        assert_eq!(
            (&comparison.only_old[..], &comparison.only_new[..]),
            (&["clear".to_owned()][..], &["fill".to_owned()][..])
        );
        assert_eq!(comparison.passes.len(), 1);
        assert_eq!(
            Comparison::of(Path::new("old.json"), &old, &old).differences,
            []
        );
    }
}
