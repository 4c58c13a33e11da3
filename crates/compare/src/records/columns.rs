//! Columns of a comparison's tables, for the terminal, for documents and for results.csv. Each
//! figure is defined once; a table says in which order it shows which figures, and under which
//! heads.
//!
//! ```
//! use skiagraph_compare::{records::{columns, read_back}, wording};
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let results = read_back::kept(out.path())?;
//! let runs: Vec<_> = results.runs.iter().collect();
//! for column in columns::terminal(&runs) {
//!     println!("{}: {}", column.head, column.cell(&results, runs[0], wording::percent));
//! }
//! assert_eq!(columns::figure("wrong_percent", &results, runs[0]), Some(0.503));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::records::regimes::Regime::{self, *};
use crate::records::results::{AreaReference, GBUFFER, Measured, Part, Results, Run};
use crate::records::sequence::Sequence;
use crate::records::statistics::Spread;
use crate::records::steady::Steady;
use crate::wording::{ms, thousands};
use Source::{Always, Measure};
use Value::{Count, OfPicture, Rate, Real, Share, Text, Time, Unknown};
use skiagraph_reference::{BlockerCounts, Distances, LayerJump, SoftErrors, TexelsPerPixel};

/// A name, and where the figure of that name comes from.
type Figure = (&'static str, Source);

enum Source {
    /// Known whatever came of the run.
    Always(fn(&Results, &Run) -> Value),
    /// Measured, if the method could run.
    Measure(fn(&Measured) -> Value),
}

/// Content of a cell.
enum Value {
    Unknown,
    Text(String),
    Count(u64),
    /// A count of pixels; tables show it as a share of those that face the light.
    Share(u64),
    /// A count of pixels; tables show it as a share of those that the method gives that answer.
    OfPicture(Part),
    /// Milliseconds.
    Time(f64),
    /// A number that is small.
    Real(f64),
    /// Frames per second.
    Rate(f64),
}

/// The figures of results.csv in its order. Scripts rely on it: new ones stand at the end.
#[rustfmt::skip] // A line each.
const CSV: &[Figure] = &[
    ("adapter", Always(|results, _| text(&results.adapter.name))),
    ("scene", Always(|results, _| text(&results.scene.name))),
    ("triangles", Always(|results, _| Count(results.scene.triangles))),
    ("oracle", Always(|results, _| text(&results.oracle))),
    ("preset", Always(|_, run| text(&run.preset))),
    ("view", Always(|_, run| text(&run.view))),
    ("width", Always(|_, run| Count(run.viewport[0].into()))),
    ("height", Always(|_, run| Count(run.viewport[1].into()))),
    (MAP_SIZE, Always(|_, run| run.map_size.map_or(Unknown, |size| text(&size.to_string())))),
    ("background", Always(|_, run| Count(run.pixels.background))),
    ("facing_away", Always(|_, run| Count(run.pixels.facing_away))),
    ("facing_light", Always(|_, run| Count(run.pixels.facing_light))),
    ("lit", Always(|_, run| Count(run.pixels.lit))),
    ("shadow", Always(|_, run| Count(run.pixels.shadow))),
    ("band", Always(|_, run| Count(run.band))),
    ("certain_lit", Measure(|measured| Count(measured.certain.lit))),
    ("certain_shadow", Measure(|measured| Count(measured.certain.shadow))),
    ("uncertain", Measure(|measured| Share(measured.uncertain))),
    ("rays", Measure(|measured| measured.rays.map_or(Unknown, Count))),
    ("wrong_lit", Measure(|measured| Count(measured.wrong.lit))),
    ("wrong_shadow", Measure(|measured| Count(measured.wrong.shadow))),
    ("wrong_total", Measure(|measured| Share(measured.wrong.total))),
    ("wrong_certain", Measure(|measured| Count(measured.wrong.certain))),
    ("wrong_in_band", Measure(|measured| Count(measured.wrong.in_band))),
    ("facing_mismatch", Measure(|measured| Count(measured.facing_mismatch))),
    ("gpu_ms", Measure(|measured| median(measured.frame.gpu_ms))),
    ("wall_ms", Measure(|measured| median(Some(measured.frame.wall_ms)))),
    ("memory_bytes", Measure(|measured| Count(measured.memory_bytes))),
    ("saved_bytes", Measure(|measured| Count(measured.saved_bytes))),
    ("unavailable", Always(|_, run| run.unavailable.as_deref().map_or(Unknown, text))),
    ("lit_certain_right", Measure(|measured| Count(measured.split.lit.certain_right))),
    ("lit_certain_wrong", Measure(|measured| Count(measured.split.lit.certain_wrong))),
    ("lit_certain_wrong_outside_band",
        Measure(|measured| Count(measured.split.lit.certain_wrong_outside_band))),
    ("lit_uncertain", Measure(|measured| Count(measured.split.lit.uncertain))),
    ("lit_uncertain_wrong", Measure(|measured| Count(measured.split.lit.uncertain_wrong))),
    ("shadow_certain_right", Measure(|measured| Count(measured.split.shadow.certain_right))),
    ("shadow_certain_wrong", Measure(|measured| Count(measured.split.shadow.certain_wrong))),
    ("shadow_certain_wrong_outside_band",
        Measure(|measured| Count(measured.split.shadow.certain_wrong_outside_band))),
    ("shadow_uncertain", Measure(|measured| Count(measured.split.shadow.uncertain))),
    ("shadow_uncertain_wrong", Measure(|measured| Count(measured.split.shadow.uncertain_wrong))),
    ("gbuffer_gpu_ms", Measure(|measured| measured.gbuffer_ms().map_or(Unknown, Time))),
    ("scene_bytes", Measure(|measured| Count(measured.scene_bytes))),
    ("wrong_certain_open_part", Measure(|measured| blocked(measured, |by| by.open_part))),
    ("wrong_certain_closed_part", Measure(|measured| blocked(measured, |by| by.closed_part))),
    ("wrong_certain_no_blocker", Measure(|measured| blocked(measured, |by| by.none))),
    ("shimmer", Measure(|measured| shimmer(measured).map_or(Unknown, OfPicture))),
    ("shimmer_compared",
        Measure(|measured| shimmer(measured).map_or(Unknown, |part| Count(part.of)))),
    ("worst_frame", Measure(|measured| worst(measured).map_or(Unknown, |(index, _)| Count(index)))),
    ("worst_frame_wrong",
        Measure(|measured| worst(measured).map_or(Unknown, |(_, part)| OfPicture(part)))),
    ("answer", Measure(|measured| text(measured.answer.word()))),
    ("reference", Always(|_, run| text(run.area.map_or("hard", |_| "area")))),
    ("reference_samples", Always(|_, run| area(run, |area| Count(area.samples.into())))),
    ("reference_error_rms", Always(|_, run| area(run, |area| Real(area.standard_error_rms)))),
    ("reference_error_worst", Always(|_, run| area(run, |area| Real(area.standard_error_worst)))),
    ("penumbra", Always(|_, run| area(run, |area| Count(area.penumbra)))),
    ("rmse", Measure(|measured| Real(measured.graded.rmse))),
    ("rmse_outside_band", Measure(|measured| Real(measured.graded.rmse_outside_band))),
    ("mean_absolute_error", Measure(|measured| Real(measured.graded.mean_absolute_error))),
    ("off_over_1_255", Measure(|measured| Share(measured.graded.off.over_1_255))),
    ("off_over_1_16", Measure(|measured| Share(measured.graded.off.over_1_16))),
    ("off_over_1_4", Measure(|measured| Share(measured.graded.off.over_1_4))),
    ("flip", Measure(|measured| Real(measured.graded.flip))),
    ("nan", Measure(|measured| Count(measured.graded.invalid.nan))),
    ("infinite", Measure(|measured| Count(measured.graded.invalid.infinite))),
    ("outside", Measure(|measured| Count(measured.graded.invalid.outside))),
    ("steady_frames", Measure(|measured| steady(measured, |by| Some(by.frames)))),
    ("steady_period", Measure(|measured| steady(measured, |by| by.period))),
    ("slowest_frame", Measure(|measured| path(measured, |by| Some(Count(by.slowest()?.0 as u64))))),
    ("slowest_frame_ms", Measure(|measured| path(measured, |by| Some(Time(by.slowest()?.1.ms()))))),
    ("worst_frame_rmse",
        Measure(|measured| path(measured, |by| Some(Real(by.worst()?.1.graded.rmse))))),
    ("wrong_surface", Always(|_, run| Count(run.wrong_surface))),
    ("light_in_umbra", Measure(|measured| Real(measured.graded.soft.light_in_umbra))),
    ("dark_in_light", Measure(|measured| Real(measured.graded.soft.dark_in_light))),
    ("penumbra_rmse", Measure(|measured| penumbra(measured, |soft| soft.penumbra_rmse))),
    ("penumbra_bias", Measure(|measured| penumbra(measured, |soft| soft.penumbra_bias))),
    ("edge_near", Measure(|measured| Count(measured.edges.all().near))),
    ("edge_mean_pixels", Measure(|measured| edge(measured, |distances| distances.mean_pixels))),
    ("edge_max_pixels", Measure(|measured| edge(measured, |distances| distances.max_pixels))),
    ("edge_mean_world", Measure(|measured| edge(measured, |distances| distances.mean_world))),
    ("edge_max_world", Measure(|measured| edge(measured, |distances| distances.max_world))),
    ("texel_pixels", Measure(|measured| texels(measured, |by| Count(by.pixels)))),
    ("texels_under_one", Measure(|measured| texels(measured, |by| Count(by.under_one)))),
    ("texels_outside_map", Measure(|measured| texels(measured, |by| Count(by.outside_map)))),
    ("texels_p5", Measure(|measured| texels(measured, |by| Real(by.texels.p5)))),
    ("texels_median", Measure(|measured| texels(measured, |by| Real(by.texels.median)))),
    ("texels_p95", Measure(|measured| texels(measured, |by| Real(by.texels.p95)))),
    ("perspective_p5", Measure(|measured| texels(measured, |by| Real(by.perspective.p5)))),
    ("perspective_median", Measure(|measured| texels(measured, |by| Real(by.perspective.median)))),
    ("perspective_p95", Measure(|measured| texels(measured, |by| Real(by.perspective.p95)))),
    ("projection_p5", Measure(|measured| texels(measured, |by| Real(by.projection.p5)))),
    ("projection_median", Measure(|measured| texels(measured, |by| Real(by.projection.median)))),
    ("projection_p95", Measure(|measured| texels(measured, |by| Real(by.projection.p95)))),
    ("layer_pairs", Measure(|measured| layers(measured, |by| Count(by.pairs)))),
    ("layer_differ", Measure(|measured| layers(measured, |by| Real(by.across)))),
    ("layer_differ_elsewhere", Measure(|measured| layers(measured, |by| Real(by.elsewhere)))),
    ("layer_jump", Measure(|measured| layers(measured, |by| Real(by.jump())))),
    ("light", Always(|_, run| run.light.as_deref().map_or(Unknown, text))),
    ("params", Always(|_, run| Text(run.assignments()))),
    ("frames", Always(|results, _| Count(results.frames.into()))),
    ("warmup", Always(|results, _| Count(results.warmup.into()))),
    ("regime_frames", Always(|results, _| Count(results.regime_frames.into()))),
    ("gpu_min_ms", Measure(|measured| spread(measured.frame.gpu_ms, |times| times.min))),
    ("gpu_q1_ms", Measure(|measured| spread(measured.frame.gpu_ms, |times| times.q1))),
    ("gpu_q3_ms", Measure(|measured| spread(measured.frame.gpu_ms, |times| times.q3))),
    ("gpu_p95_ms", Measure(|measured| spread(measured.frame.gpu_ms, |times| times.p95))),
    ("cpu_ms", Measure(|measured| median(measured.frame.cpu_ms))),
    ("wall_min_ms", Measure(|measured| spread(Some(measured.frame.wall_ms), |times| times.min))),
    ("wall_q1_ms", Measure(|measured| spread(Some(measured.frame.wall_ms), |times| times.q1))),
    ("wall_q3_ms", Measure(|measured| spread(Some(measured.frame.wall_ms), |times| times.q3))),
    ("wall_p95_ms", Measure(|measured| spread(Some(measured.frame.wall_ms), |times| times.p95))),
    ("nothing_gpu_ms", Measure(|measured| gpu(measured, Nothing))),
    ("nothing_cpu_ms", Measure(|measured| cpu(measured, Nothing))),
    ("nothing_wall_ms", Measure(|measured| wall(measured, Nothing))),
    ("nothing_uploaded_bytes", Measure(|measured| uploaded(measured, Nothing))),
    ("camera_gpu_ms", Measure(|measured| gpu(measured, Camera))),
    ("camera_cpu_ms", Measure(|measured| cpu(measured, Camera))),
    ("camera_wall_ms", Measure(|measured| wall(measured, Camera))),
    ("camera_uploaded_bytes", Measure(|measured| uploaded(measured, Camera))),
    ("light_gpu_ms", Measure(|measured| gpu(measured, Light))),
    ("light_cpu_ms", Measure(|measured| cpu(measured, Light))),
    ("light_wall_ms", Measure(|measured| wall(measured, Light))),
    ("light_uploaded_bytes", Measure(|measured| uploaded(measured, Light))),
    ("some_meshes_gpu_ms", Measure(|measured| gpu(measured, SomeMeshes))),
    ("some_meshes_cpu_ms", Measure(|measured| cpu(measured, SomeMeshes))),
    ("some_meshes_wall_ms", Measure(|measured| wall(measured, SomeMeshes))),
    ("some_meshes_uploaded_bytes", Measure(|measured| uploaded(measured, SomeMeshes))),
    ("all_meshes_gpu_ms", Measure(|measured| gpu(measured, AllMeshes))),
    ("all_meshes_cpu_ms", Measure(|measured| cpu(measured, AllMeshes))),
    ("all_meshes_wall_ms", Measure(|measured| wall(measured, AllMeshes))),
    ("all_meshes_uploaded_bytes", Measure(|measured| uploaded(measured, AllMeshes))),
    ("backend", Always(|results, _| text(&results.adapter.backend))),
    ("driver", Always(|results, _| text(&results.adapter.driver))),
    ("device_type", Always(|results, _| text(&results.adapter.device_type))),
    ("host", Always(|results, run| {
        results.machine_of(run).host.as_deref().map_or(Unknown, text)
    })),
    ("processor", Always(|results, run| text(&results.machine_of(run).processor))),
    ("cores", Always(|results, run| Count(results.machine_of(run).cores.into()))),
    ("load", Always(|results, run| results.machine_of(run).load.map_or(Unknown, Rate))),
    ("date", Always(|_, run| text(&run.date))),
    ("hour", Always(|_, run| text(&run.session))),
    ("program", Always(|results, _| text(&results.program))),
    ("commit", Always(|_, run| run.commit.as_deref().map_or(Unknown, text))),
    ("cell", Always(|_, run| text(&run.cell))),
    ("fingerprint", Always(|_, run| text(&run.fingerprint))),
];

/// Figures that only tables show.
#[rustfmt::skip]
const IN_TABLES: &[Figure] = &[
    ("certain_right", Measure(|measured| Share(measured.split.certain_right()))),
    ("certain_wrong", Measure(|measured| Share(measured.split.certain_wrong()))),
    ("wrong_lit_percent", Always(|_, run| run.wrong_lit().map_or(Unknown, OfPicture))),
    ("wrong_shadow_percent", Always(|_, run| run.wrong_shadow().map_or(Unknown, OfPicture))),
    ("steps_ms", Measure(|measured| measured.steps_ms().map_or(Unknown, Time))),
    ("fps", Measure(|measured| measured.fps().map_or(Unknown, Rate))),
    ("no_share", Measure(|measured| Count(measured.graded.invalid.total()))),
];

/// A column: its figure, its head, and what published figures of it are called, if there are any.
type Entry = (&'static str, &'static str, &'static str);

/// The terminal's table.
const TERMINAL: [Entry; 22] = [
    ("preset", "method", ""),
    (MAP_SIZE, "map", ""),
    ("answer", "answer", ""),
    ("gpu_ms", "GPU ms", ""),
    ("wall_ms", "wall ms", ""),
    ("wrong_total", "wrong", ""),
    ("wrong_lit", "wrong lit", ""),
    ("wrong_shadow", "wrong shadow", ""),
    ("wrong_in_band", "in band", ""),
    ("rmse", "RMSE", ""),
    ("flip", "FLIP", ""),
    ("light_in_umbra", "light in umbra", ""),
    ("dark_in_light", "dark in light", ""),
    ("penumbra_rmse", "penumbra RMSE", ""),
    ("penumbra_bias", "penumbra bias", ""),
    ("edge_mean_pixels", "px from edge", ""),
    ("no_share", "no share", ""),
    ("uncertain", "uncertain", ""),
    ("certain_wrong", "certain wrong", ""),
    ("rays", "rays", ""),
    ("worst_frame_wrong", "worst frame", ""),
    ("shimmer", "shimmer", ""),
];

/// The column that only stands in the terminal's table if there are maps.
const MAP_SIZE: &str = "map_size";

/// Columns that only stand in a table of camera paths.
const OF_PATHS: [&str; 3] = ["worst_frame_wrong", "worst_frame_rmse", "shimmer"];

/// Columns that only stand in a table with a graded answer, or under a light with extent.
const OF_GRADES: [&str; 7] = [
    "answer",
    "light_in_umbra",
    "dark_in_light",
    "penumbra_rmse",
    "penumbra_bias",
    "no_share",
    "worst_frame_rmse",
];

/// A document's table, but for the times of steps, which stand behind the rays.
const DOCUMENT: [Entry; 30] = [
    ("preset", "method", ""),
    (MAP_SIZE, "map", ""),
    ("answer", "answer", ""),
    ("certain_right", "certain right %", "certain_right_percent"),
    ("uncertain", "uncertain %", "uncertain_percent"),
    ("certain_wrong", "certain wrong %", "certain_wrong_percent"),
    ("wrong_total", "wrong %", "wrong_percent"),
    ("wrong_lit", "wrong lit", "wrong_lit"),
    ("wrong_shadow", "wrong shadow", "wrong_shadow"),
    ("wrong_lit_percent", "wrong lit %", "wrong_lit_percent"),
    (
        "wrong_shadow_percent",
        "wrong shadow %",
        "wrong_shadow_percent",
    ),
    ("certain_lit", "certain lit", "certain_lit"),
    ("certain_shadow", "certain shadow", "certain_shadow"),
    ("lit_uncertain", "uncertain lit", "lit_uncertain"),
    ("shadow_uncertain", "uncertain shadow", "shadow_uncertain"),
    ("rmse", "RMSE", ""),
    ("flip", "FLIP", ""),
    ("light_in_umbra", "light in umbra", ""),
    ("dark_in_light", "dark in light", ""),
    ("penumbra_rmse", "penumbra RMSE", ""),
    ("penumbra_bias", "penumbra bias", ""),
    ("edge_mean_pixels", "px from edge", ""),
    ("no_share", "no share", ""),
    ("worst_frame_wrong", "worst frame wrong %", ""),
    ("worst_frame_rmse", "worst frame RMSE", ""),
    ("shimmer", "shimmer %", ""),
    ("rays", "rays", "rays"),
    ("steps_ms", "sum of steps ms", "ms.steps"),
    ("fps", "fps", "fps"),
    ("gpu_ms", "frame ms", "ms.frame"),
];

/// Columns of a document that only stand where figures of them were published.
const IF_PUBLISHED: [&str; 8] = [
    "wrong_lit_percent",
    "wrong_shadow_percent",
    "certain_lit",
    "certain_shadow",
    "lit_uncertain",
    "shadow_uncertain",
    "steps_ms",
    "fps",
];

/// Names of the steps of the built-in presets, each with the word for it in heads of table columns.
/// A step is the passes of a graph with the same name up to the first dot. The word for any other
/// step is its name.
pub const STEPS: [(&str, &str); 5] = [
    ("create_shadow_map", "map"),
    ("detect_uncertain", "detect"),
    ("fill_rays", "fill"),
    ("trace_rays", "trace"),
    ("fix_pixels", "fix"),
];

/// Returns the head of the column with the GPU time of a step, or of a sum of steps: `gbuffer +
/// detect ms` for `gbuffer+detect_uncertain`.
pub fn step_head(step: &str) -> String {
    let heads = step.split('+').map(|step| {
        let short = STEPS.iter().find(|(name, _)| *name == step);
        short.map_or(step, |(_, head)| head)
    });
    format!("{} ms", heads.collect::<Vec<_>>().join(" + "))
}

fn text(text: &str) -> Value {
    Text(text.to_owned())
}

fn median(times: Option<Spread>) -> Value {
    spread(times, |times| times.median)
}

fn spread(times: Option<Spread>, figure: fn(&Spread) -> f64) -> Value {
    times.map_or(Unknown, |times| Time(figure(&times)))
}

fn gpu(measured: &Measured, regime: Regime) -> Value {
    median(measured.times(Some(regime)).and_then(|times| times.gpu_ms))
}

fn cpu(measured: &Measured, regime: Regime) -> Value {
    median(measured.times(Some(regime)).and_then(|times| times.cpu_ms))
}

fn wall(measured: &Measured, regime: Regime) -> Value {
    median(measured.times(Some(regime)).map(|times| times.wall_ms))
}

fn uploaded(measured: &Measured, regime: Regime) -> Value {
    let mut regimes = measured.regimes.iter();
    let times = regimes.find(|times| times.regime == regime);
    times.map_or(Unknown, |times| Count(times.uploaded_bytes))
}

/// Certain wrong pixels of one kind of blocker; unknown of graded answers.
fn blocked(measured: &Measured, count: fn(BlockerCounts) -> u64) -> Value {
    match measured.certain_wrong_blockers {
        Some(blockers) => Count(count(blockers)),
        None if measured.wrong.certain == 0 => Count(0),
        None => Unknown,
    }
}

/// Counts, of a camera path, answers that changed though the right ones did not, of those compared.
fn shimmer(measured: &Measured) -> Option<Part> {
    let shimmer = measured.sequence.as_ref()?.shimmer;
    Some(Part {
        count: shimmer.changed,
        of: shimmer.compared,
    })
}

/// Worst frame of a camera path, and its share of wrong pixels.
fn worst(measured: &Measured) -> Option<(u64, Part)> {
    let (index, frame) = measured.sequence.as_ref()?.worst()?;
    let part = Part {
        count: frame.wrong,
        of: frame.facing_light,
    };
    Some((index as u64, part))
}

/// How a method that remembers came to its steady state.
fn steady(measured: &Measured, figure: fn(&Steady) -> Option<u32>) -> Value {
    let figure = measured.steady.as_ref().and_then(figure);
    figure.map_or(Unknown, |count| Count(count.into()))
}

/// A figure of a camera path.
fn path(measured: &Measured, figure: fn(&Sequence) -> Option<Value>) -> Value {
    measured
        .sequence
        .as_ref()
        .and_then(figure)
        .unwrap_or(Unknown)
}

/// An error of the penumbra, where there is one.
fn penumbra(measured: &Measured, figure: fn(&SoftErrors) -> f64) -> Value {
    match measured.graded.soft.penumbra {
        0 => Unknown,
        _ => Real(figure(&measured.graded.soft)),
    }
}

/// A distance of wrong pixels from the edges of shadows, where there are any.
fn edge(measured: &Measured, figure: fn(&Distances) -> f64) -> Value {
    match measured.edges.all() {
        distances if distances.count == 0 => Unknown,
        distances => Real(figure(&distances)),
    }
}

/// A figure of the map's texels, where the graph tells it.
fn texels(measured: &Measured, figure: fn(&TexelsPerPixel) -> Value) -> Value {
    measured.texels.as_ref().map_or(Unknown, figure)
}

/// A figure of the borders between layers, where there are any.
fn layers(measured: &Measured, figure: fn(&LayerJump) -> Value) -> Value {
    measured.layer_jump.as_ref().map_or(Unknown, figure)
}

/// A figure of the reference of a light with extent.
fn area(run: &Run, figure: fn(&AreaReference) -> Value) -> Value {
    run.area.as_ref().map_or(Unknown, figure)
}

/// A column in a table with a row per run: one figure or one condition of each run.
pub struct Column {
    /// Head of the column.
    pub head: &'static str,
    /// Name of the column's quantity in files of published figures, such as `wrong_percent`; empty
    /// if such files cannot have the column's quantity.
    pub quantity: &'static str,
    source: &'static Source,
}

impl Column {
    fn new((name, head, quantity): Entry) -> Option<Self> {
        let mut figures = CSV.iter().chain(IN_TABLES);
        let (_, source) = figures.find(|(figure, _)| *figure == name)?;
        Some(Self {
            head,
            quantity,
            source,
        })
    }

    /// True if the column shows a measurement: its cell is empty for a method that could not run.
    pub fn is_measured(&self) -> bool {
        matches!(self.source, Measure(_))
    }

    fn value(&self, results: &Results, run: &Run) -> Value {
        match self.source {
            Always(value) => value(results, run),
            Measure(value) => run.measured.as_ref().map_or(Unknown, value),
        }
    }

    /// Returns the text of a run's cell in a table; `–` if the figure is unknown. `share` formats
    /// its first argument, a count, as a share of its second one, for example as percent.
    pub fn cell(&self, results: &Results, run: &Run, share: fn(u64, u64) -> String) -> String {
        match self.value(results, run) {
            Unknown => "–".to_owned(),
            Text(text) => text,
            Count(count) => thousands(count),
            Share(count) => share(count, run.pixels.facing_light),
            OfPicture(Part { count, of: whole }) => share(count, whole),
            Time(time) => ms(time),
            Real(number) => format!("{number:.5}"),
            Rate(rate) => format!("{rate:.2}"),
        }
    }

    /// Returns the text of a run's cell in results.csv, not yet quoted for CSV; empty if the figure
    /// is unknown.
    pub fn csv_cell(&self, results: &Results, run: &Run) -> String {
        match self.value(results, run) {
            Unknown => String::new(),
            Text(text) => text,
            Count(count) | Share(count) | OfPicture(Part { count, .. }) => count.to_string(),
            Time(time) => format!("{time:.6}"),
            Real(number) | Rate(number) => format!("{number:.9}"),
        }
    }
}

/// Returns the columns of results.csv, in order.
pub fn csv() -> Vec<Column> {
    let entries = CSV.iter().map(|(name, _)| (*name, *name, ""));
    entries.filter_map(Column::new).collect()
}

/// Returns the columns of the terminal's table of `runs`, in order. Those for map sizes, camera
/// paths or [shares of light](crate#terms) are left out if no run has them.
pub fn terminal(runs: &[&Run]) -> Vec<Column> {
    let has_maps = runs.iter().any(|run| run.map_size.is_some());
    let entries = TERMINAL.iter().filter(|(name, ..)| {
        (has_maps || *name != MAP_SIZE) && is_shown(name, runs.iter().copied())
    });
    entries.copied().filter_map(Column::new).collect()
}

/// True unless the column says something of other runs alone.
fn is_shown<'a>(name: &str, runs: impl Iterator<Item = &'a Run> + Clone) -> bool {
    (!OF_PATHS.contains(&name) || are_paths(runs.clone()))
        && (!OF_GRADES.contains(&name) || runs.clone().any(|run| !run.is_hard()))
}

/// True if any run has measurements along a camera path.
pub fn are_paths<'a>(runs: impl IntoIterator<Item = &'a Run>) -> bool {
    let mut measured = runs.into_iter().filter_map(|run| run.measured.as_ref());
    measured.any(|measured| measured.sequence.is_some())
}

/// Returns the columns of a document's table of `runs` in two lists: those to the left and those to
/// the right of the columns with times of steps, which the caller adds. `published` returns true if
/// there are published figures of the quantity with this name.
pub fn document(runs: &[&Run], published: impl Fn(&str) -> bool) -> [Vec<Column>; 2] {
    let shown = |(name, _, quantity): &Entry| {
        (!IF_PUBLISHED.contains(name) || published(quantity))
            && is_shown(name, runs.iter().copied())
    };
    let rays = DOCUMENT.iter().position(|(name, ..)| *name == "rays");
    let (front, back) = DOCUMENT.split_at(rays.map_or(DOCUMENT.len(), |rays| rays + 1));
    [front, back].map(|part| {
        let entries = part.iter().copied().filter(shown);
        entries.filter_map(Column::new).collect()
    })
}

/// Lists the names of the quantities that published figures can have, such as `wrong_percent` and
/// `ms.trace_rays`, without sums of steps such as `ms.gbuffer+detect_uncertain`.
pub fn quantities() -> Vec<String> {
    let of_columns = DOCUMENT.iter().map(|(.., quantity)| quantity.to_string());
    let of_steps = STEPS.iter().map(|(step, _)| format!("ms.{step}"));
    let names = of_columns.chain(of_steps);
    names.filter(|quantity| !quantity.is_empty()).collect()
}

/// Returns the steps of a quantity that is a time of steps, each of them [`GBUFFER`] or one of
/// [`STEPS`]: `gbuffer+detect_uncertain` for `ms.gbuffer+detect_uncertain`. Returns `None` for any
/// other quantity.
pub fn steps_of(quantity: &str) -> Option<&str> {
    let steps = quantity.strip_prefix("ms.")?;
    let is_known = |step| step == GBUFFER || STEPS.iter().any(|(name, _)| *name == step);
    steps.split('+').all(is_known).then_some(steps)
}

/// Returns the head of the table column of a quantity such as `wrong_percent`; the quantity itself
/// if it has no column.
pub fn head_of(quantity: &str) -> String {
    let mut entries = DOCUMENT.iter();
    let entry = entries.find(|(.., name)| *name == quantity);
    match (steps_of(quantity), entry) {
        (Some(steps), _) => step_head(steps),
        (None, Some((_, head, _))) => (*head).to_owned(),
        (None, None) => quantity.to_owned(),
    }
}

/// Returns the measured figure of a run for a quantity such as `wrong_percent`, in the quantity's
/// unit: percent, milliseconds, a count, frames per second. Returns `None` if the figure is unknown
/// or not a number.
pub fn figure(quantity: &str, results: &Results, run: &Run) -> Option<f64> {
    if let Some(steps) = steps_of(quantity) {
        return run.measured.as_ref()?.step_ms(steps);
    }
    let entry = DOCUMENT.iter().find(|(.., name)| *name == quantity)?;
    let percent = |count: u64, whole: u64| 100.0 * count as f64 / whole as f64;
    match Column::new(*entry)?.value(results, run) {
        Unknown | Text(_) => None,
        Count(count) => Some(count as f64),
        Share(count) => Some(percent(count, run.pixels.facing_light)),
        OfPicture(Part { count, of: whole }) => Some(percent(count, whole)),
        Time(number) | Real(number) | Rate(number) => Some(number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::results::{Answer, tests::sample};

    #[test]
    fn every_column_of_a_table_has_its_figure() {
        assert_eq!(csv().len(), CSV.len());
        let runs = sample().runs;
        let mixed: Vec<&Run> = runs.iter().collect();
        let count = |entries: &[Entry], names: &[&str]| {
            let named = entries.iter().filter(|(name, ..)| names.contains(name));
            named.count()
        };
        let hidden = |entries: &[Entry]| count(entries, &[&OF_PATHS[..], &OF_GRADES].concat());
        let with_maps = TERMINAL.len() - hidden(&TERMINAL);
        assert_eq!(terminal(&mixed).len(), with_maps);
        let without: Vec<&Run> = runs.iter().filter(|run| run.map_size.is_none()).collect();
        assert_eq!(terminal(&without).len(), with_maps - 1);
        let mut graded = runs.clone();
        graded[0].measured.as_mut().unwrap().answer = Answer::Graded;
        let graded: Vec<&Run> = graded.iter().collect();
        assert_eq!(
            terminal(&graded).len(),
            TERMINAL.len() - count(&TERMINAL, &OF_PATHS)
        );
        let parts = |runs, published| document(runs, |_| published).map(|part| part.len());
        let whole = DOCUMENT.len() - count(&DOCUMENT, &OF_PATHS);
        assert_eq!(parts(&graded, true).iter().sum::<usize>(), whole);
        let fewer = DOCUMENT.len() - IF_PUBLISHED.len() - hidden(&DOCUMENT);
        // Only the frame is behind the steps.
        assert_eq!(parts(&mixed, false), [fewer - 1, 1]);
        let mut names: Vec<_> = CSV.iter().chain(IN_TABLES).map(|(name, _)| name).collect();
        names.sort();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
