//! Combines runs into rows: one row for each method and setting, over all views of a viewport. The
//! band of a picture is the set of pixels at which rounding decides the right answer.

use skiagraph_compare::lists::entry;
use skiagraph_compare::records::figure::{Case, Figure, Value, Worst};
use skiagraph_compare::records::figures;
use skiagraph_compare::records::regimes::{Regime, When, quartiles_name, time_name};
use skiagraph_compare::records::results::{Measured, Run, step};
use skiagraph_compare::records::statistics::FrameTimes;
use skiagraph_compare::records::tuned::Tuned;
use skiagraph_compare::records::turns::{Ratio, Turns};

/// Figures of one method in one setting of its params and with one map size, combined over the
/// views of one viewport and light.
#[derive(Debug)]
pub struct Row<'a> {
    /// Name of the method with its setting and map size in texels: `crsm@n=1 1024`. Without a
    /// shadow map it is [`method`](Self::method).
    pub label: String,
    /// Name of the method with its setting, such as `crsm@n=1`.
    pub method: String,
    /// The method's runs with measurements, one for each view.
    runs: Vec<Measurement<'a>>,
    /// Reason why the method ran on none of the views; `None` if it ran on any.
    pub unavailable: Option<&'a str>,
    /// The same runs with what they were measured with.
    cases: Vec<Case<'a>>,
    /// True if its times are wall times, since not all rows have GPU times.
    pub by_wall: bool,
}

/// A run and its measurements.
type Measurement<'a> = (&'a Run, &'a Measured);

/// Number of wrong pixels of a method over all views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wrong {
    /// Wrong pixels outside the band (the pixels whose answer rounding decides). These count
    /// against the method.
    pub outside_band: u64,
    /// Wrong pixels in the band, the pixels whose answer rounding decides. These do not count
    /// against the method.
    pub in_band: u64,
    /// All pixels that face the light, wrong or not.
    pub facing_light: u64,
    /// All pixels in the band (those whose answer rounding decides), wrong or not.
    pub band: u64,
}

impl Wrong {
    /// Returns the wrong pixels outside the band (the pixels whose answer rounding decides) as a
    /// share of the pixels that face the light, from 0 to 1; 0 if no pixel faces the light.
    pub fn share(self) -> f64 {
        self.outside_band as f64 / self.facing_light.max(1) as f64
    }
}

impl<'a> Row<'a> {
    fn new(label: String, attempts: &[Case<'a>]) -> Option<Self> {
        let first = attempts.first()?;
        let measured = |case: &Case<'a>| Some((case.run, case.run.measured.as_ref()?));
        let runs: Vec<_> = attempts.iter().filter_map(measured).collect();
        let cases = attempts.iter().filter(|case| case.run.measured.is_some());
        let mut reasons = attempts.iter().map(|case| case.run.unavailable.as_deref());
        Some(Self {
            method: first.run.preset.clone(),
            label,
            unavailable: reasons.find_map(|why| why).filter(|_| runs.is_empty()),
            runs,
            cases: cases.copied().collect(),
            by_wall: first.by_wall,
        })
    }

    /// Returns the value of a figure over all views; `None` if a view has none.
    pub fn over(&self, figure: &Figure) -> Option<Value> {
        figure.over(&self.cases)
    }

    /// Returns the greatest value of a figure over views and frames of paths; `None` if one has
    /// none, or without runs.
    pub fn worst(&self, figure: &Figure) -> Option<Worst> {
        figure.worst(&self.cases)
    }

    /// Returns the runs with measurements, with the clock of their times.
    pub fn cases(&self) -> impl Iterator<Item = Case<'a>> {
        self.cases.iter().copied()
    }

    /// Returns the two numbers of the figure of this name over all views: a range, or a count and
    /// that of which it is a part. `None` if it has not two.
    pub fn range(&self, name: &str) -> Option<[f64; 2]> {
        match self.over(figures::named(name)?)? {
            Value::Numbers(ends) => ends.try_into().ok(),
            Value::Text(_) => None,
        }
    }

    /// Returns the number of the figure of this name over all views; `None` if a view has none.
    pub fn number(&self, name: &str) -> Option<f64> {
        let figure = figures::named(name)?;
        figure.number(self.over(figure)?)
    }

    /// Returns the runs with measurements, one for each view.
    pub fn runs(&self) -> impl Iterator<Item = (&'a Run, &'a Measured)> {
        self.runs.iter().copied()
    }

    /// Returns the record of the search that chose this row's params; `None` if the method was not
    /// tuned, or could not run.
    pub fn tuned(&self) -> Option<&'a Tuned> {
        self.runs.first().and_then(|(run, _)| run.tuned.as_ref())
    }

    /// True if the row's params were searched for, and are others than the defaults.
    pub fn is_tuned(&self) -> bool {
        self.tuned().is_some_and(|tuned| !tuned.set.is_empty())
    }

    /// Returns the number of views on which the method was measured; 0 if it could not run.
    pub fn views(&self) -> usize {
        self.runs.len()
    }

    /// Returns the numbers of wrong pixels, summed over the views; a [share of
    /// light](skiagraph_compare#terms) of one half or more counts as lit. For a method that reuses
    /// results of earlier frames they are means over its steady state (the pictures that it
    /// repeats), rounded up.
    pub fn wrong(&self) -> Wrong {
        let number = |name| self.number(name).unwrap_or_default() as u64;
        let sum = |count: fn(&Run) -> u64| self.runs.iter().map(|(run, _)| count(run)).sum();
        Wrong {
            outside_band: number("wrong_outside_band"),
            in_band: number("wrong_in_band"),
            facing_light: sum(|run| run.pixels.facing_light),
            band: sum(|run| run.band),
        }
    }

    /// Returns the start of the newest comparison among those that measured the runs, in UTC:
    /// `2026-11-21T04:30:12Z`. It is empty without runs.
    pub fn session(&self) -> &'a str {
        let sessions = self.runs.iter().map(|(run, _)| run.session.as_str());
        sessions.max().unwrap_or_default()
    }

    /// True unless a run was cut short after a single frame.
    pub fn is_whole(&self) -> bool {
        self.runs.iter().all(|(run, _)| run.is_whole())
    }

    /// True if the visibility of every pixel outside the band (the pixels whose answer rounding
    /// decides) equals the [reference](skiagraph_compare#terms)'s, also as a [share of
    /// light](skiagraph_compare#terms). True without runs.
    pub fn is_exact(&self) -> bool {
        let is_exact = |(_, measured): &(&Run, &Measured)| {
            measured.wrong_outside_band() == 0 && measured.graded.rmse_outside_band == 0.0
        };
        self.runs.iter().all(is_exact)
    }

    /// Returns the width and height of the shadow map in texels; `None` if the method has none, or
    /// could not run.
    pub fn map_size(&self) -> Option<u32> {
        self.runs.first().and_then(|(run, _)| run.map_size)
    }

    /// Returns the method's steps (passes with the same name up to the first dot) in order, each
    /// with its GPU milliseconds: the sum of the medians of its passes, as the mean of the views.
    /// Passes without GPU times are left out.
    pub fn steps(&self) -> Vec<(&'a str, f64)> {
        let mut steps: Vec<(&str, f64)> = Vec::new();
        let passes = self.runs.iter().flat_map(|(_, measured)| &measured.passes);
        for (name, gpu) in passes.filter_map(|pass| Some((step(&pass.name), pass.gpu_ms?))) {
            let ms = gpu.median / self.views() as f64;
            *entry(&mut steps, name) += ms;
        }
        steps
    }

    /// Returns the root mean square error of the [shares of light](skiagraph_compare#terms), 0 to
    /// 1, over all views; `None` without runs. For a method that reuses results of earlier frames
    /// the error of a view is the mean over its steady state, the pictures that it repeats.
    pub fn rmse(&self) -> Option<f64> {
        self.number("rmse")
    }

    /// True if the light has an extent. Then methods are judged by their [shares of
    /// light](skiagraph_compare#terms).
    pub fn is_soft(&self) -> bool {
        self.runs.iter().any(|(run, _)| run.area.is_some())
    }

    /// Returns the milliseconds of a frame: GPU time and the upkeep of the CPU added, or wall time,
    /// the mean of the views' medians. `None` if a view has no such time.
    pub fn frame_ms(&self, when: When) -> Option<f64> {
        self.number(&time_name(when))
    }

    /// Returns the first and third quartile of the times of [`frame_ms`](Self::frame_ms), in
    /// milliseconds: the means of the views. `None` if a view has no such times.
    pub fn quartiles(&self, when: When) -> Option<[f64; 2]> {
        self.range(&quartiles_name(when))
    }

    /// Returns the regimes in which every run of the row was timed; none without runs.
    pub fn regimes(&self) -> Vec<Regime> {
        let is_timed = |regime: &Regime| {
            let mut runs = self.runs();
            runs.all(|(_, measured)| measured.times(Some(*regime)).is_some())
        };
        let regimes = Regime::ALL.into_iter().filter(|_| self.views() > 0);
        regimes.filter(is_timed).collect()
    }

    /// True if a run is of a camera path.
    pub fn is_path(&self) -> bool {
        self.runs().any(|(_, measured)| measured.sequence.is_some())
    }

    /// Returns the number of timed frames of the view that has the fewest; 0 without runs.
    pub fn frames(&self, when: When) -> usize {
        let times = self.runs.iter().map(|(_, measured)| measured.times(when));
        let frames = times.map(|times| times.map_or(0, |times| times.wall_frames.len()));
        frames.min().unwrap_or_default()
    }

    /// Returns the ratio of the times of this row's frames to those of another row that was timed
    /// in the same turns, summed over the views, with its interval ([`Ratio::paired`]). `None` if
    /// the rows have other views, or frames that were not timed in the same turns of one session;
    /// if times are missing, or of fewer than eight turns.
    pub fn ratio(&self, other: &Self, when: When) -> Option<Ratio> {
        let mut sums: [Vec<f64>; 2] = Default::default();
        for ((run, one), (other_run, other)) in self.runs.iter().zip(&other.runs) {
            let is_pair = (&run.session, &run.view) == (&other_run.session, &other_run.view);
            let turns = [one, other].map(|measured| measured.turns.as_ref());
            let [Some(turns), Some(other_turns)] = turns.map(|turns| turns.filter(|_| is_pair))
            else {
                return None;
            };
            let [ms, other_ms] =
                [one, other].map(|measured| measured.times(when)?.costs(self.by_wall));
            let (ms, mut other_ms) = (ms?, other_ms?);
            if turns.group != other_turns.group {
                // The anchor drew in both groups.
                let anchors =
                    [turns, other_turns].map(|turns| anchor(turns, when)?.costs(self.by_wall));
                let [anchor, other_anchor] = anchors;
                let scales = anchor?.into_iter().zip(other_anchor?);
                for (ms, (anchor, other)) in other_ms.iter_mut().zip(scales) {
                    *ms *= anchor / other.max(1e-6);
                }
            }
            for (sum, frames) in sums.iter_mut().zip([ms, other_ms]) {
                sum.resize(sum.len().max(frames.len()), 0.0);
                sum.iter_mut().zip(frames).for_each(|(sum, ms)| *sum += ms);
            }
        }
        Ratio::paired(&sums[0], &sums[1]).filter(|_| self.views() == other.views())
    }

    /// True if the frame times of two rows differ by more than chance: their [`ratio`](Self::ratio)
    /// is [told apart](Ratio::is_told_apart). False if there is no ratio.
    pub fn is_told_apart(&self, other: &Self, when: When) -> bool {
        let ratio = self.ratio(other, when);
        ratio.is_some_and(|ratio| ratio.is_told_apart())
    }

    /// Returns the bytes of the textures and buffers that the graph makes, and of the scene buffers
    /// that it reads: the most on any view.
    pub fn bytes(&self) -> u64 {
        self.number("memory").unwrap_or_default() as u64
    }

    /// Returns the estimated standard error of the [reference](skiagraph_compare#terms)'s [shares
    /// of light](skiagraph_compare#terms) under a light [with an extent](skiagraph_compare#terms),
    /// as the root mean square over the pixels: the greatest of the views. `None` under other
    /// lights.
    pub fn reference_error(&self) -> Option<f64> {
        let errors = self.runs.iter().filter_map(|(run, _)| run.area);
        errors.map(|area| area.standard_error_rms).reduce(f64::max)
    }
}

/// Times of a group's anchor.
fn anchor(turns: &Turns, when: When) -> Option<&FrameTimes> {
    let Some(regime) = when else {
        return Some(&turns.anchor);
    };
    let mut regimes = turns.regimes.iter();
    Some(&regimes.find(|times| times.regime == regime)?.frame)
}

/// Combines the runs of one light that are in the viewport `viewport` (pixels) into rows by method,
/// setting and map size, the fastest first. Rows that could not run come last. A tuned method
/// stands behind the one that it is a setting of.
pub fn rows<'a>(cases: impl IntoIterator<Item = Case<'a>>, viewport: [u32; 2]) -> Vec<Row<'a>> {
    let mut cells: Vec<(String, Vec<Case>)> = Vec::new();
    let is_there = |case: &Case| case.run.viewport == viewport;
    for case in cases.into_iter().filter(is_there) {
        entry(&mut cells, case.run.method_label()).push(case);
    }
    let cells = cells.into_iter();
    let rows = cells.filter_map(|(label, cases)| Row::new(label, &cases));
    let mut rows: Vec<Row> = rows.collect();
    let time = |row: &Row| row.frame_ms(None).unwrap_or(f64::INFINITY);
    rows.sort_by(|one, other| time(one).total_cmp(&time(other)));
    let (tuned, mut rows): (Vec<Row>, Vec<Row>) = rows.into_iter().partition(Row::is_tuned);
    for row in tuned {
        let base = row.tuned().map(|tuned| &tuned.of);
        let before = rows.iter().rposition(|other| Some(&other.method) == base);
        rows.insert(before.map_or(rows.len(), |before| before + 1), row);
    }
    rows
}
