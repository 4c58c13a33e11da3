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

use crate::error::{CompareError, Result};
use crate::lists::unique;
use crate::records::regimes::{AT_REST_MS, Regime};
use crate::records::results::{Measured, Results, Run};
use crate::records::statistics::{FrameTimes, Spread};
use crate::records::turns::{LEAST_TURNS, Ratio};
use crate::records::{read_back, unpaired};
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

/// Direction of a change since the baseline, the one that counts most last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// A difference within the [`Tolerance`], or times that cannot be told apart.
    Same,
    /// Fewer errors or less time.
    Better,
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
    pub fn read(place: &Path) -> Result<Self> {
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
    pub fn check(&self, now: &Results, planned: &[Run]) -> Result<()> {
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
    pub fn against(&self, now: &Results) -> Result<Changes> {
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
        let notes = notes.map(|(note, count)| format!("{note} ({})", plural(count, "cell")));
        Ok(Changes {
            baseline: self.name.clone(),
            began: began.max().unwrap_or_default(),
            cells,
            only_then: gone.unique_by(|(_, then)| &then.cell).count(),
            only_now,
            notes: notes.collect(),
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
    ) -> Result<CellChange> {
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
    ) -> Result<()> {
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
        times.fold(self.errors, Change::max)
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
#[path = "results_baseline_tests.rs"]
mod tests;
