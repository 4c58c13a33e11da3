//! Maps values to a logarithmic axis, with or without a strip for zero.

use crate::text::{clean, number};
use plotters::coord::ranged1d::{
    KeyPointHint, NoDefaultFormatting, Ranged, ReversibleRanged, ValueFormatter,
};
use std::ops::Range;

/// Height of a lane of the strip, pixels: the largest mark and a little air.
const LANE: f64 = 16.0;
/// Free of marks above and below the lanes.
const RIM: f64 = 5.0;
/// Least span of an axis, decades: there is always a 1, 2 or 5 in it.
const LEAST: f64 = 0.6;
/// First digits of ticks.
const LEADS: [f64; 9] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
/// Beyond the outermost values, as a share of the span between them.
const MARGIN: f64 = 0.06;

/// A logarithmic axis with an optional strip for zero. Values above 0 lie at their logarithm. A
/// value −k stands for the k-th lane of the strip, counted from above and from 1; 0 is the middle
/// of the strip.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    /// Logarithms to base 10 of both ends.
    low: f64,
    high: f64,
    lanes: usize,
    /// Labels of the axis: values with their text. If empty, decades are labelled.
    pub named: Vec<(f64, String)>,
}

impl Scale {
    /// Returns an axis with room for the positive values among `values`, and with this many lanes
    /// for zero.
    pub fn around(values: impl Iterator<Item = f64>, lanes: usize) -> Self {
        let logarithms = values.filter(|value| *value > 0.0).map(f64::log10);
        let ends = logarithms.map(|value| (value, value));
        let ends = ends.reduce(|(low, high), (value, _)| (low.min(value), high.max(value)));
        // Nothing but zeros: a decade of nothing above them.
        let (low, high) = ends.unwrap_or((-1.0, 0.0));
        let room = (high - low) * MARGIN;
        let more = (LEAST - (high - low + 2.0 * room)).max(0.0) / 2.0;
        Self {
            low: low - room - more,
            high: high + room + more,
            lanes,
            named: Vec::new(),
        }
    }

    /// Returns the height of the strip for zero in pixels; 0 without lanes.
    pub fn strip(&self) -> f64 {
        if self.lanes == 0 {
            return 0.0;
        }
        self.lanes as f64 * LANE + 2.0 * RIM
    }

    /// Returns the least and the greatest value of the logarithmic part.
    pub fn ends(&self) -> (f64, f64) {
        (10f64.powf(self.low), 10f64.powf(self.high))
    }

    /// Values m · 10ⁿ within the axis for each of some m, growing.
    fn ticks(&self, leads: &[f64]) -> Vec<f64> {
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        let values =
            decades.flat_map(|decade| leads.iter().map(move |lead| lead * 10f64.powi(decade)));
        let is_shown = |value: &f64| (self.low..=self.high).contains(&value.log10());
        values.filter(is_shown).collect()
    }

    /// Where labels stand: decades, or 1, 2, 5 where there are few of them, or 1 to 9.
    fn labelled(&self) -> Vec<f64> {
        let leads: [&[f64]; 3] = [&[1.0], &[1.0, 2.0, 5.0], &LEADS];
        let candidates = leads.map(|leads| self.ticks(leads));
        let enough = candidates.iter().find(|ticks| ticks.len() >= 3);
        let ticks = enough.unwrap_or(&candidates[2]);
        // No more than ten of them.
        let step = ticks.len().div_ceil(10).max(1);
        let zero = (self.lanes > 0).then_some(0.0).into_iter();
        zero.chain(ticks.iter().copied().step_by(step)).collect()
    }
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let (from, to) = (f64::from(from), f64::from(to));
        let sign = (to - from).signum();
        let strip = self.strip();
        let place = if *value > 0.0 {
            let room = (to - from).abs() - strip;
            strip + room * (value.log10() - self.low) / (self.high - self.low)
        } else if *value == 0.0 {
            strip / 2.0
        } else {
            strip - RIM - (-value - 0.5) * LANE
        };
        (from + sign * place).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if !self.named.is_empty() {
            return self.named.iter().map(|(value, _)| *value).collect();
        }
        if hint.weight().allow_light_points() && self.high - self.low < 6.0 {
            self.ticks(&LEADS)
        } else {
            self.labelled()
        }
    }

    fn range(&self) -> Range<f64> {
        let (low, high) = self.ends();
        low..high
    }
}

impl ReversibleRanged for Scale {
    fn unmap(&self, pixel: i32, (from, to): (i32, i32)) -> Option<f64> {
        let (from, to) = (f64::from(from), f64::from(to));
        let place = (f64::from(pixel) - from) * (to - from).signum() - self.strip();
        let share = place / ((to - from).abs() - self.strip());
        (0.0..=1.0)
            .contains(&share)
            .then(|| 10f64.powf(self.low + share * (self.high - self.low)))
    }
}

impl ValueFormatter<f64> for Scale {
    fn format_ext(&self, value: &f64) -> String {
        let mut named = self.named.iter();
        match named.find(|(tick, _)| tick == value) {
            Some((_, name)) => clean(name),
            None => number(*value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::coord::ranged1d::BoldPoints;

    #[test]
    fn zero_lies_below_everything_in_lanes_of_its_own() {
        let scale = Scale::around([0.01, 5.0, 0.0].into_iter(), 3);
        let at = |value: f64| scale.map(&value, (400, 0));
        assert!(at(5.0) < at(0.01) && at(0.01) < at(-1.0), "upwards is less");
        assert_eq!((at(-2.0) - at(-1.0), at(-3.0) - at(-2.0)), (16, 16));
        assert_eq!(at(0.0), at(-2.0), "the label stands in the middle");
        assert!(at(-3.0) < 400 && at(5.0) > 0);
        let back = scale.unmap(at(0.5), (400, 0)).unwrap();
        assert!((back / 0.5 - 1.0).abs() < 0.02, "{back}");
        assert_eq!(scale.unmap(at(0.0), (400, 0)), None);
    }

    #[test]
    fn there_are_three_to_ten_labels_whatever_the_span() {
        let short = (0..100).map(|at| 10f64.powf(f64::from(at) / 100.0));
        let short = short.flat_map(|low| [1.0, 1.5, 4.0, 9.0].map(|by| (low, low * by)));
        for (low, high) in short.chain([(0.02, 700.0), (1e-12, 1e12)]) {
            let scale = Scale::around([low, high].into_iter(), 0);
            let labels = scale.key_points(BoldPoints(10));
            assert!((3..=10).contains(&labels.len()), "{low} {high}: {labels:?}");
            let (first, last) = scale.ends();
            assert!(first < low && high < last);
            assert!(labels.iter().all(|label| (first..=last).contains(label)));
        }
        let nothing = Scale::around([0.0].into_iter(), 1).key_points(BoldPoints(10));
        assert_eq!(nothing.first(), Some(&0.0));
    }
}
