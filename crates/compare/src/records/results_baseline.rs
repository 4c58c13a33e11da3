//! `compare --baseline`: compares results with older ones, cell by cell, aware of noise.
//!
//! Errors repeat to the pixel on one adapter and driver, so there any growth is worse; on another
//! one a [`Tolerance`] is granted. Times are compared on one machine, adapter and driver that was
//! not loaded, by [`unpaired::ratio`], and never scaled.
//!
//! ```
//! use skiagraph_compare::records::results_baseline::{Baseline, Change};
//! use skiagraph_compare::records::read_back;
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let mut now = read_back::kept(out.path())?;
//! let baseline = Baseline::read(out.path())?;
//! baseline.check(&now, &now.runs)?;
//! now.runs[0].measured.as_mut().ok_or("it ran")?.wrong.total += 1;
//! let changes = baseline.against(&now)?;
//! assert_eq!(changes.cells[0].verdict(), Change::Worse);
//! assert_eq!(changes.cells[1].verdict(), Change::Same);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::CompareError;
use crate::lists::unique;
use crate::records::read_back;
use crate::records::regimes::{AT_REST_MS, Regime};
use crate::records::results::{Measured, Results, Run};
use crate::records::statistics::{FrameTimes, Spread};
use crate::records::turns::{LEAST_TURNS, Ratio};
use crate::records::unpaired;
use crate::wording::{plural, size, thousands};
use itertools::Itertools;
use std::path::Path;

/// Older results of `compare`, to compare newer ones with.
#[derive(Debug)]
pub struct Baseline {
    /// Path of the file or folder, for messages.
    name: String,
    /// The results, of several machines and scenes if they were joined.
    all: Vec<Results>,
}

/// Comparison of results with a baseline, older results.
#[derive(Debug)]
pub struct Changes {
    /// Path of the baseline's file or folder.
    pub baseline: String,
    /// Start of the comparison that measured the newest runs of the baseline, in UTC.
    pub began: String,
    /// Cells that are in both, in the order of the new results. A cell is one method with its
    /// params on one view, in one viewport, under one protocol.
    pub cells: Vec<CellChange>,
    /// Number of cells (method, view, viewport and protocol) of the scene that only the baseline
    /// has.
    pub only_then: usize,
    /// Names of the new runs that the baseline lacks, or that could not run when it was measured.
    pub only_now: Vec<String>,
    /// Lines of remarks: tolerances, and why times were not compared.
    pub notes: Vec<String>,
}

/// Figures of one cell (a method with its params on one view, in one viewport, under one protocol)
/// in the baseline and in the new results.
#[derive(Clone, Debug, PartialEq)]
pub struct CellChange {
    /// Name of the method with its map size in texels: `nsm 1024`.
    pub method: String,
    /// Name of the view or path.
    pub view: String,
    /// Width and height of the viewport in pixels.
    pub viewport: [u32; 2],
    /// Figures of the cell in the baseline.
    pub then: Figures,
    /// New figures; `None` for a method that could not run this time.
    pub now: Option<Figures>,
    /// Change of the errors; a method that could not run this time is worse.
    pub errors: Change,
    /// Changes of the times: of the frames in which every pass runs (of a path, of its frames),
    /// then of each regime. Empty if times are not compared, for example on another machine.
    pub times: Vec<TimeChange>,
}

/// Times of one kind of frame in the baseline and in the new results.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeChange {
    /// The regime of the frames; `None` for those in which every pass runs, or those of a path.
    pub regime: Option<Regime>,
    /// Median milliseconds of a frame in the baseline: GPU and upkeep of the CPU, or by the wall
    /// clock where one side lacks GPU times.
    pub then: f64,
    /// Median milliseconds of a frame in the new results.
    pub now: f64,
    /// Ratio of the new times to the old ones.
    pub ratio: Ratio,
}

/// Figures of a method on one view that are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Number of wrong pixels outside the band (the pixels whose right answer rounding may flip);
    /// for a method that reuses results of earlier frames the mean over its steady state, rounded
    /// up.
    pub wrong: u64,
    /// Root mean square error of the [shares of light](crate#terms), 0 to 1, without pixels whose
    /// answer rounding decides; for a method that reuses results of earlier frames the mean over
    /// its steady state, of all pixels.
    pub rmse: f64,
}

/// Direction of a change since the baseline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Fewer errors or less time.
    Better,
    /// A difference within the [`Tolerance`], or times that cannot be told apart.
    Same,
    /// More errors or more time.
    Worse,
}

/// Greatest difference of errors that does not count as a change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Difference of the numbers of wrong pixels: 0 on one adapter and driver, otherwise the larger
    /// of both bands, but at least 0.05 % of the pixels facing the light.
    pub pixels: u64,
    /// Difference of the root mean square errors of the [shares of light](crate#terms), 0 to 1:
    /// 10⁻⁹ on one adapter and driver, otherwise 0.001.
    pub rmse: f64,
}

/// Share of the pixels facing the light by which errors may differ from adapter to adapter.
const OTHER_ADAPTER: f64 = 0.0005;

/// Root mean square error by which shares may differ from adapter to adapter.
const OTHER_ADAPTER_RMSE: f64 = 0.001;

/// Rounding of a mean over all pixels.
const ROUNDING: f64 = 1e-9;

/// A run with measurements, and the results that it is of.
#[derive(Clone, Copy)]
struct Measurement<'a> {
    results: &'a Results,
    run: &'a Run,
    measured: &'a Measured,
}

impl Baseline {
    /// Reads the results of a folder or file, or of the folders in it
    /// ([`with_scenes`](read_back::with_scenes)).
    ///
    /// # Errors
    /// The errors of [`read_back::kept`]; results of an older version, whose runs have no ids of
    /// cells.
    pub fn read(place: &Path) -> Result<Self, CompareError> {
        let mut parts = Vec::new();
        for place in read_back::with_scenes(&[place.to_path_buf()]) {
            parts.extend(read_back::kept(&place)?.each());
        }
        let baseline = Self {
            name: place.display().to_string(),
            all: parts,
        };
        if baseline.runs().all(|(_, run)| run.cell.is_empty()) {
            return Err(CompareError::Input(format!(
                "{} has no ids of cells: it is empty, or of an older version; measure it anew",
                baseline.name
            )));
        }
        Ok(baseline)
    }

    fn runs(&self) -> impl Iterator<Item = (&Results, &Run)> {
        let parts = self.all.iter();
        parts.flat_map(|results| results.runs.iter().map(move |run| (results, run)))
    }

    /// Checks that the baseline has a cell (method, view, viewport and protocol) of a comparison.
    /// `planned` are the comparison's runs, and `now` holds its scene and protocol.
    ///
    /// # Errors
    /// No cell is in both; the message lists how scene, protocol, views and methods differ.
    pub fn check(&self, now: &Results, planned: &[Run]) -> Result<(), CompareError> {
        let is_known = |run: &Run| self.runs().any(|(_, then)| then.cell == run.cell);
        if planned.iter().any(is_known) {
            return Ok(());
        }
        let pairs = planned.iter().map(|run| (now, run));
        let lines = differences(self.runs().map(facts), pairs.map(facts));
        Err(CompareError::Input(format!(
            "the baseline {} has no cell of this comparison\n  {}\n  measure it anew, or name \
             another one",
            self.name,
            lines.join("\n  ")
        )))
    }

    /// Compares the runs of new results with the baseline, but not those of
    /// [`others`](Results::others) in joined results: call it for each of [`Results::each`]. If no
    /// cell is in both, the changes have no cells; [`check`](Self::check) refuses that before
    /// anything is measured.
    ///
    /// # Errors
    /// The scene has changed: the [reference](crate#terms) counts other numbers of lit and shadowed
    /// pixels, by more than the [`Tolerance`].
    pub fn against(&self, now: &Results) -> Result<Changes, CompareError> {
        let (mut cells, mut only_now, mut notes) = (Vec::new(), Vec::new(), Vec::new());
        for run in &now.runs {
            match self.of(now, run) {
                Some(then) => cells.push(self.cell(then, now, run, &mut notes)?),
                None => only_now.extend(run.measured.as_ref().map(|_| run.label())),
            }
        }
        let is_now = |then: &Run| now.runs.iter().any(|run| run.cell == then.cell);
        let same_scene = self.runs().filter(|(old, _)| old.scene == now.scene);
        let gone = same_scene.filter(|(_, then)| !then.cell.is_empty() && !is_now(then));
        let began = self.all.iter().map(|results| results.began.clone());
        let notes = notes.iter().counts().into_iter().sorted();
        Ok(Changes {
            baseline: self.name.clone(),
            began: began.max().unwrap_or_default(),
            cells,
            only_then: gone.unique_by(|(_, then)| &then.cell).count(),
            only_now,
            notes: notes
                .map(|(note, count)| format!("{note} ({})", plural(count, "cell")))
                .collect(),
        })
    }

    /// The baseline's run of a cell: of several the one that was measured the most alike.
    fn of<'a>(&'a self, now: &Results, run: &Run) -> Option<Measurement<'a>> {
        let same = self.runs().filter(|(_, then)| then.cell == run.cell);
        let measured = same.filter_map(|(results, run)| Measurement::new(results, run));
        measured.max_by_key(|then| {
            let machine = then.results.machine_of(then.run);
            let is_same_adapter = then.is_on_adapter_of(now);
            let is_same_machine = machine.is_same(now.machine_of(run));
            let is_same_label = then.run.preset == run.preset;
            let when = (&then.run.session, &then.run.date);
            (is_same_adapter, is_same_machine, is_same_label, when)
        })
    }

    fn cell(
        &self,
        then: Measurement,
        now: &Results,
        run: &Run,
        notes: &mut Vec<String>,
    ) -> Result<CellChange, CompareError> {
        let mut cell = CellChange {
            method: run.method_label(),
            view: run.view.clone(),
            viewport: run.viewport,
            then: then.figures(),
            now: None,
            errors: Change::Worse,
            times: Vec::new(),
        };
        let Some(now) = Measurement::new(now, run) else {
            return Ok(cell);
        };
        let tolerance = Tolerance::new(then, now);
        if !then.is_on_adapter_of(now.results) {
            notes.push(format!(
                "measured on another adapter then ({}): errors within 0.05 % of the pixels that \
                 face the light, or the band, and RMSE within {OTHER_ADAPTER_RMSE} are the same",
                then.results.adapter
            ));
        }
        self.check_reference(then, now, tolerance)?;
        let figures = now.figures();
        (cell.now, cell.errors) = (Some(figures), tolerance.change(cell.then, figures));
        match times(then, now) {
            Ok(times) => cell.times = times,
            Err(why) => notes.push(format!("times are not compared: {why}")),
        }
        Ok(cell)
    }

    /// Refuses a baseline whose reference has other pixels.
    fn check_reference(
        &self,
        then: Measurement,
        now: Measurement,
        tolerance: Tolerance,
    ) -> Result<(), CompareError> {
        let counts = |measurement: Measurement| {
            let pixels = &measurement.run.pixels;
            [pixels.facing_light, pixels.lit, pixels.shadow]
        };
        let mut pairs = counts(then).into_iter().zip(counts(now));
        if pairs.all(|(then, now)| then.abs_diff(now) <= tolerance.pixels) {
            return Ok(());
        }
        let text = |measurement| {
            let [facing, lit, shadow] = counts(measurement).map(thousands);
            format!("{facing} pixels face the light, {lit} lit and {shadow} in shadow")
        };
        let (baseline, view, size) = (&self.name, &now.run.view, size(now.run.viewport));
        let [theirs, ours] = [then, now].map(text);
        Err(CompareError::Input(format!(
            "the baseline {baseline} is of another scene: on {view} at {size} {theirs} there, and \
             {ours} here\n  measure it anew"
        )))
    }
}

impl CellChange {
    /// Returns the verdict on the method on this view: worse if errors or the times of any frames
    /// are worse than in the baseline, otherwise better if any are better.
    pub fn verdict(&self) -> Change {
        let times = self.times.iter().map(TimeChange::change);
        let changes: Vec<Change> = times.chain([self.errors]).collect();
        let is = |change: &Change| changes.contains(change);
        let order = [Change::Worse, Change::Better];
        order.into_iter().find(is).unwrap_or(Change::Same)
    }
}

impl TimeChange {
    /// Compares two lists of frames; `None` where nothing moves and both cost next to nothing, or
    /// one list is too short.
    fn new(regime: Option<Regime>, then: &[f64], now: &[f64]) -> Option<Self> {
        let median = |ms: &[f64]| Some(Spread::new(ms.to_vec())?.median);
        let change = Self {
            regime,
            then: median(then)?,
            now: median(now)?,
            ratio: unpaired::ratio(now, then)?,
        };
        let is_at_rest =
            regime == Some(Regime::Nothing) && change.then.max(change.now) < AT_REST_MS;
        (!is_at_rest).then_some(change)
    }

    /// Returns the change of the times; [`Change::Same`] if they cannot be told apart.
    pub fn change(&self) -> Change {
        match self.ratio {
            ratio if !ratio.is_told_apart() => Change::Same,
            ratio if ratio.median < 1.0 => Change::Better,
            _ => Change::Worse,
        }
    }
}

impl Changes {
    /// Returns the cells whose [`verdict`](CellChange::verdict) is `verdict`.
    pub fn with(&self, verdict: Change) -> Vec<&CellChange> {
        let cells = self.cells.iter();
        cells.filter(|cell| cell.verdict() == verdict).collect()
    }
}

impl Tolerance {
    /// Returns the tolerance between two runs of a cell: none on one adapter and driver.
    fn new(then: Measurement, now: Measurement) -> Self {
        if then.is_on_adapter_of(now.results) {
            return Self {
                pixels: 0,
                rmse: ROUNDING,
            };
        }
        let share = OTHER_ADAPTER * then.run.pixels.facing_light as f64;
        Self {
            pixels: then.run.band.max(now.run.band).max(share.ceil() as u64),
            rmse: OTHER_ADAPTER_RMSE,
        }
    }

    fn change(self, then: Figures, now: Figures) -> Change {
        let grows = |then: Figures, now: Figures| {
            now.wrong > then.wrong + self.pixels || now.rmse > then.rmse + self.rmse
        };
        if grows(then, now) {
            Change::Worse
        } else if grows(now, then) {
            Change::Better
        } else {
            Change::Same
        }
    }
}

impl<'a> Measurement<'a> {
    fn new(results: &'a Results, run: &'a Run) -> Option<Self> {
        run.measured.as_ref().map(|measured| Self {
            results,
            run,
            measured,
        })
    }

    fn is_on_adapter_of(&self, other: &Results) -> bool {
        self.results.adapter.to_string() == other.adapter.to_string()
    }

    fn figures(&self) -> Figures {
        let measured = self.measured;
        let cycle = measured.steady.as_ref().and_then(|steady| steady.judged);
        let wrong = cycle.map(|cycle| cycle.wrong_outside_band_mean.ceil() as u64);
        let rmse = measured.graded.rmse_outside_band;
        Figures {
            wrong: wrong.unwrap_or_else(|| measured.wrong_outside_band()),
            rmse: cycle.map_or(rmse, |cycle| cycle.rmse_mean),
        }
    }
}

/// How the times have changed, or why they are not compared.
fn times(then: Measurement, now: Measurement) -> Result<Vec<TimeChange>, String> {
    let machines = [then, now].map(|measurement| measurement.results.machine_of(measurement.run));
    if !machines[0].is_same(machines[1]) {
        let [old, new] = machines;
        return Err(format!("another machine ({old} then, {new} now)"));
    }
    if !then.is_on_adapter_of(now.results) {
        return Err("another adapter or driver".into());
    }
    for (machine, when) in machines.into_iter().zip(["then", "now"]) {
        if machine.is_loaded() {
            let (cores, load) = (plural(machine.cores as usize, "core"), machine.load);
            let load = load.unwrap_or_default();
            return Err(format!(
                "the machine was busy {when} (load {load:.1} on {cores})"
            ));
        }
    }
    let frames = [then, now].map(|measurement| &measurement.measured.frame);
    let by_wall = frames.iter().any(|times| times.gpu_frames.is_none());
    let costs = |times: &FrameTimes| times.costs(by_wall).unwrap_or_default();
    let [old, new] = frames.map(costs);
    let whole = TimeChange::new(None, &old, &new).ok_or_else(|| {
        let (then, now) = (plural(old.len(), "frame"), new.len());
        format!("{then} then and {now} now, and both must be {LEAST_TURNS} or more")
    })?;
    let regimes = Regime::ALL.into_iter().filter_map(|regime| {
        let [old, new] = [then, now].map(|measurement| {
            let times = measurement.measured.times(Some(regime));
            times.map(costs).unwrap_or_default()
        });
        TimeChange::new(Some(regime), &old, &new)
    });
    Ok([whole].into_iter().chain(regimes).collect())
}

/// A fact that tells cells apart, behind its name.
type Fact = (String, String);

fn facts((results, run): (&Results, &Run)) -> Vec<Fact> {
    let params = format!("params of {}", run.method_label());
    let facts = [
        ("scene", results.scene.to_string()),
        ("oracle", results.oracle.clone()),
        ("frames", results.frames.to_string()),
        ("warmup", results.warmup.to_string()),
        ("frames of each regime", results.regime_frames.to_string()),
        ("views", run.view.clone()),
        ("viewports", size(run.viewport)),
        ("methods", run.method_label()),
        (&params, run.assignments()),
    ];
    facts.map(|(what, value)| (what.to_owned(), value)).into()
}

/// Lists the facts of which both sides have no value in common.
fn differences(
    there: impl Iterator<Item = Vec<Fact>>,
    own: impl Iterator<Item = Vec<Fact>>,
) -> Vec<String> {
    let (there, own) = (unique(there.flatten()), unique(own.flatten()));
    let values = |facts: &[Fact], what: &str| -> Vec<String> {
        let facts = facts.iter().filter(|(name, _)| name == what);
        facts.map(|(_, value)| value.clone()).collect()
    };
    let mut lines = Vec::new();
    for what in unique(own.iter().map(|(what, _)| what.clone())) {
        let [there, own] = [&there, &own].map(|facts| values(facts, &what));
        if !there.is_empty() && !own.iter().any(|value| there.contains(value)) {
            let [theirs, ours] = [there, own].map(|values| values.join(", "));
            lines.push(format!("{what}: there {theirs}, here {ours}"));
        }
    }
    if lines.is_empty() {
        let unseen = "camera, light, jitter or number of reference samples: not the same";
        lines.push(unseen.to_owned());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::regimes::RegimeTimes;
    use crate::records::results::{Answer, tests::sample};
    use crate::records::statistics::FrameTimes;

    /// `sample()` with ten frames of around so many milliseconds.
    fn timed(ms: f64) -> Results {
        let mut results = sample();
        for measured in results
            .runs
            .iter_mut()
            .filter_map(|run| run.measured.as_mut())
        {
            let frame = |turn: u32| ms + f64::from(turn % 3) * 0.01;
            let frames: Vec<f64> = (0..10).map(frame).collect();
            measured.frame = FrameTimes::new(Some(frames.clone()), None, frames).unwrap();
        }
        results
    }

    fn baseline(results: Results) -> Baseline {
        Baseline {
            name: "old.json".into(),
            all: results.each(),
        }
    }

    fn changes(then: Results, now: &Results) -> Changes {
        baseline(then).against(now).unwrap()
    }

    /// Errors and times of the first cell.
    fn first(then: Results, change: impl Fn(&mut Results)) -> (Change, Change) {
        let mut now = timed(10.0);
        change(&mut now);
        let changes = changes(then, &now);
        let times = changes.cells[0].times.first();
        (
            changes.cells[0].errors,
            times.map_or(Change::Same, TimeChange::change),
        )
    }

    fn measured(results: &mut Results) -> &mut Measured {
        results.runs[0].measured.as_mut().unwrap()
    }

    #[test]
    fn any_growth_of_errors_is_worse_on_one_adapter() {
        use Change::{Better, Same, Worse};
        let errors = |change: fn(&mut Measured)| first(timed(10.0), |now| change(measured(now))).0;
        assert_eq!(errors(|_| ()), Same);
        assert_eq!(errors(|measured| measured.wrong.total += 1), Worse);
        assert_eq!(errors(|measured| measured.wrong.total -= 1), Better);
        assert_eq!(
            errors(|measured| (measured.wrong.total, measured.wrong.in_band) = (504, 7)),
            Same,
            "in the band"
        );
        assert_eq!(
            errors(|measured| measured.graded.rmse_outside_band += 1e-6),
            Worse
        );
        // Fewer wrong pixels, but worse shades: no trade.
        let both = |measured: &mut Measured| {
            (measured.answer, measured.wrong.total) = (Answer::Graded, 400);
            measured.graded.rmse_outside_band += 0.1;
        };
        assert_eq!(errors(both), Worse);
    }

    #[test]
    fn another_adapter_has_a_tolerance_and_no_times() {
        let far = |results: &mut Results| results.adapter.driver = "driver 2".into();
        let wrong = |by: u64| {
            let change = |now: &mut Results| {
                far(now);
                measured(now).wrong.total += by;
            };
            first(timed(5.0), change)
        };
        // 0.05 % of 100,000 pixels.
        assert_eq!(wrong(50), (Change::Same, Change::Same));
        assert_eq!(wrong(51), (Change::Worse, Change::Same));
        let mut now = timed(10.0);
        far(&mut now);
        let notes = changes(timed(5.0), &now).notes;
        assert_eq!(
            notes,
            [
                "measured on another adapter then (Some GPU · vulkan · driver 1.2): errors within \
                 0.05 % of the pixels that face the light, or the band, and RMSE within 0.001 are \
                 the same (2 cells)",
                "times are not compared: another adapter or driver (2 cells)"
            ]
        );
    }

    #[test]
    fn times_are_told_apart_or_it_is_said_why_not() {
        let times = |then: f64| first(timed(then), |_| ()).1;
        assert_eq!(times(8.0), Change::Worse);
        assert_eq!(times(12.0), Change::Better);
        assert_eq!([9.8, 10.0, 10.2].map(times), [Change::Same; 3], "level");
        type Spoil = fn(&mut Results);
        let spoils: [(Spoil, &str); 3] = [
            (
                |now| now.runs[0].machine.as_mut().unwrap().host = Some("far".into()),
                "another machine (bench, Some CPU, 8 cores then, far, Some CPU, 8 cores now)",
            ),
            (
                |now| now.runs[0].machine.as_mut().unwrap().load = Some(6.0),
                "the machine was busy now (load 6.0 on 8 cores)",
            ),
            (
                |now| measured(now).frame.gpu_frames = Some(vec![1.0; 3]),
                "10 frames then and 3 now, and both must be 8 or more",
            ),
        ];
        for (spoil, why) in spoils {
            let mut now = timed(20.0);
            spoil(&mut now);
            let changes = changes(timed(10.0), &now);
            assert_eq!(changes.cells[0].times, []);
            assert_eq!(
                changes.notes,
                [format!("times are not compared: {why} (1 cell)")]
            );
            assert_eq!(changes.with(Change::Worse).len(), 1, "the other cell");
        }
    }

    #[test]
    fn times_are_compared_by_what_moves() {
        let with = |light: f64, nothing: f64| {
            let mut results = timed(10.0);
            let regime = |regime, ms| RegimeTimes {
                regime,
                frame: measured(&mut timed(ms)).frame.clone(),
                uploaded_bytes: 0,
                skipped: Vec::new(),
            };
            measured(&mut results).regimes = vec![
                regime(Regime::Nothing, nothing),
                regime(Regime::Light, light),
            ];
            results
        };
        let changes = |now: &Results| changes(with(4.0, 0.01), now).cells[0].clone();
        let slower = changes(&with(8.0, 0.03));
        assert_eq!(slower.verdict(), Change::Worse);
        let times = |cell: &CellChange| -> Vec<(Option<Regime>, Change)> {
            let times = cell.times.iter();
            times.map(|times| (times.regime, times.change())).collect()
        };
        let light = Some(Regime::Light);
        let expected = [(None, Change::Same), (light, Change::Worse)];
        assert_eq!(times(&slower), expected, "next to nothing at rest");
        let moved = changes(&with(4.0, 2.0));
        assert_eq!(times(&moved)[1], (Some(Regime::Nothing), Change::Worse));
        assert_eq!(times(&changes(&timed(10.0))).len(), 1, "no regimes now");
    }

    #[test]
    fn a_method_that_cannot_run_any_more_is_worse_and_new_ones_are_named() {
        let mut now = timed(10.0);
        (now.runs[0].measured, now.runs[0].unavailable) = (None, Some("no ray queries".into()));
        now.runs[1].cell = "1".into();
        let changes = changes(timed(10.0), &now);
        assert_eq!(
            (changes.cells.len(), changes.cells[0].verdict()),
            (1, Change::Worse)
        );
        assert_eq!(changes.only_now, ["rt on main 512x256"]);
        assert_eq!(changes.only_then, 1);
    }

    #[test]
    fn of_a_joined_baseline_the_run_of_this_machine_counts() {
        let mut joined = timed(5.0);
        joined.adapter.name = "Far GPU".into();
        joined.others = vec![timed(10.0)];
        assert_eq!(first(joined, |_| ()), (Change::Same, Change::Same));
    }

    #[test]
    fn a_baseline_of_something_else_says_what_differs() {
        let refused = |change: fn(&mut Results)| {
            let mut now = sample();
            for (index, run) in now.runs.iter_mut().enumerate() {
                run.cell = format!("{index}");
            }
            change(&mut now);
            baseline(sample())
                .check(&now, &now.runs)
                .unwrap_err()
                .to_string()
        };
        type Change = fn(&mut Results);
        let changes: [(Change, &str); 6] = [
            (
                |now| now.scene.name = "sponza".into(),
                "scene: there park, 55,000 triangles, here sponza, 55,000 triangles",
            ),
            (|now| now.frames = 3, "frames: there 10, here 3"),
            (
                |now| now.oracle = "offset:1".into(),
                "oracle: there exact, here offset:1",
            ),
            (
                |now| now.runs.iter_mut().for_each(|run| run.view = "down".into()),
                "views: there main, here down",
            ),
            (
                |now| {
                    now.runs
                        .iter_mut()
                        .for_each(|run| drop(run.params.remove("cull")))
                },
                "params of nsm 1024: there cull=front;slope_bias=1.5, here slope_bias=1.5",
            ),
            (
                |_| (),
                "camera, light, jitter or number of reference samples: not the same",
            ),
        ];
        for (change, part) in changes {
            let message = refused(change);
            assert!(
                message.contains(part) && message.contains("measure it anew"),
                "{message}"
            );
        }
        assert!(baseline(sample()).check(&sample(), &sample().runs).is_ok());
        let mut moved = sample();
        moved.runs[0].pixels.lit += 1;
        let message = baseline(sample()).against(&moved).unwrap_err().to_string();
        assert!(
            message.contains("is of another scene: on main at 512x256"),
            "{message}"
        );
    }
}
