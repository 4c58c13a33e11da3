//! The schema of `results.json` and `results.csv`, version 2. Scripts rely on it: extend it, rename
//! nothing.
//!
//! ```
//! use skiagraph_compare::records::{read_back, results::step};
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let results = read_back::kept(out.path())?;
//! let measured = results.runs[0].measured.as_ref().ok_or("it ran")?;
//! assert_eq!(measured.wrong_outside_band(), 497);
//! for pass in &measured.passes {
//!     println!("{}, of the step {}", pass.name, step(&pass.name));
//! }
//! assert_eq!(measured.step_ms("gbuffer+create_shadow_map"), Some(0.75));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::records::assignments::assignments;
use crate::records::budgets::Budgets;
use crate::records::hint::Hint;
use crate::records::regimes::{Regime, RegimeTimes};
use crate::records::sequence::Sequence;
use crate::records::statistics::{FrameTimes, Spread};
use crate::records::steady::Steady;
use crate::records::tuned::Tuned;
use crate::records::turns::Turns;
use crate::wording::{or_nothing, size, thousands};
use itertools::Itertools;
use serde::{Deserialize, Serialize};
use skiagraph_reference::{
    AreaVisibility, BlockerCounts, CertainCounts, EdgeDistances, Graded, GroundTruthPixels,
    LayerJump, PixelCounts, Split, TexelsPerPixel, WrongCounts,
};
use std::{collections::BTreeMap, fmt};

/// Version of the schema of `results.json`.
pub const SCHEMA: u32 = 2;

/// Name and version of this program, as files show them.
pub const PROGRAM: &str = concat!("skiagraph ", env!("CARGO_PKG_VERSION"));

/// Content of `results.json`: the results of one or several `compare` commands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Version of this schema, [`SCHEMA`].
    pub schema: u32,
    /// The program that measured, `skiagraph 0.1.0`.
    pub program: String,
    /// GPU on which the runs were measured.
    pub adapter: Adapter,
    /// Machine on which the runs were measured.
    pub machine: Machine,
    /// The scene that was drawn.
    pub scene: Scene,
    /// Mode of the [reference](crate#terms)'s shadow rays: `exact` (from the visible surface, whose
    /// own triangle is excluded) or `offset:LENGTH` (the origin is moved towards the light by
    /// LENGTH scene units).
    pub oracle: String,
    /// Number of timed frames of a still view. Of a camera path each frame is timed.
    pub frames: u32,
    /// Number of untimed warm-up frames before the timed ones.
    pub warmup: u32,
    /// Number of timed frames of each [`Regime`]; 0 if there are none.
    pub regime_frames: u32,
    /// Start of the comparison that measured the newest runs, in UTC: `2026-11-21T04:30:12Z`.
    pub began: String,
    /// Limits on frame time, wrong pixels and memory that the user set; left out of the file if
    /// there are none.
    #[serde(default, skip_serializing_if = "Budgets::is_empty")]
    pub budgets: Budgets,
    /// Commands that measured the runs, the first one first.
    pub commands: Vec<String>,
    /// Notes on the scene, one line each: what its import repaired or left out, and the camera,
    /// light and ground that were chosen for it. Left out of the file if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Hash of the plan of which the runs are cells, 16 hexadecimal digits: they may be of several
    /// machines of one kind. Absent without a plan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<String>,
    /// One entry per view, viewport, preset and map size, in this order.
    pub runs: Vec<Run>,
    /// Results of other machines, adapters, scenes or protocols that `merge` put into the same
    /// file; absent where all runs were measured alike. The `others` of each entry are empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<Results>,
}

impl Results {
    /// Splits joined results: returns these without `others`, and behind them each of `others`.
    pub fn each(mut self) -> Vec<Self> {
        let parts = std::mem::take(&mut self.others);
        let parts = parts.into_iter().flat_map(Self::each);
        [self].into_iter().chain(parts).collect()
    }

    /// Splits results, those that are joined too: returns each run alone, with its machine.
    pub fn each_run(self) -> impl Iterator<Item = Self> {
        self.each().into_iter().flat_map(|mut part| {
            let runs = std::mem::take(&mut part.runs).into_iter();
            runs.map(move |run| Self {
                machine: part.machine_of(&run).clone(),
                runs: vec![run],
                ..part.clone()
            })
        })
    }

    /// True if runs on both machines belong together in these results: it is the same one, or of
    /// cells of a plan one of the same kind, whatever its name.
    pub fn joins(&self, one: &Machine, other: &Machine) -> bool {
        let kind = |machine: &Machine| (machine.processor.clone(), machine.cores);
        one.is_same(other) || (self.plan.is_some() && kind(one) == kind(other))
    }

    /// Returns the machine on which a run of these results was measured.
    pub fn machine_of<'a>(&'a self, run: &'a Run) -> &'a Machine {
        run.machine.as_ref().unwrap_or(&self.machine)
    }
}

/// GPU on which something was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adapter {
    /// Name of the GPU by its driver.
    pub name: String,
    /// Graphics API: vulkan, metal, dx12 or gl.
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
    /// DiscreteGpu, IntegratedGpu, VirtualGpu, Cpu or Other.
    pub device_type: String,
    /// Reason why all `gpu_ms` are null; absent if they are measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gpu_unavailable: Option<String>,
}

/// Machine on which something was measured, as it was when the comparison began.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Host name of the machine; null where the system does not say.
    pub host: Option<String>,
    /// Name of the processor; empty where the system does not say.
    pub processor: String,
    /// Number of logical processors.
    pub cores: u32,
    /// Mean number of processes that ran or waited to run over the minute before; null where the
    /// system does not say.
    pub load: Option<f64>,
}

impl Machine {
    /// True if the load is half of the logical processors or more: other processes then slow down
    /// what is timed.
    pub fn is_loaded(&self) -> bool {
        let half = 0.5 * f64::from(self.cores);
        self.load.is_some_and(|load| load >= half)
    }

    /// True if `self` and `other` have the same host name, processor and number of cores; their
    /// loads may differ.
    pub fn is_same(&self, other: &Self) -> bool {
        let key = |machine: &Self| {
            (
                machine.host.clone(),
                machine.processor.clone(),
                machine.cores,
            )
        };
        key(self) == key(other)
    }
}

/// Scene on which something was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Name of the scene.
    pub name: String,
    /// Number of triangles in the mesh.
    pub triangles: u64,
    /// Numbers of open and of all parts (connected sets of triangles) of the mesh.
    pub parts: OpenParts,
}

/// Numbers of a mesh's parts: sets of triangles that are connected by shared edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OpenParts {
    /// Number of all parts.
    pub all: u64,
    /// Number of open parts, which have an edge with a triangle on one side only.
    pub open: u64,
    /// Number of triangles in open parts, those that have an edge with a triangle on one side only.
    pub open_triangles: u64,
}

impl OpenParts {
    /// Counts the parts of a mesh.
    pub fn new(mesh: &skiagraph_scene::Mesh) -> Self {
        let parts = skiagraph_scene::Parts::new(mesh);
        let open = |part: &&u32| parts.open[**part as usize];
        Self {
            all: parts.open.len() as u64,
            open: parts.open.iter().filter(|open| **open).count() as u64,
            open_triangles: parts.of.iter().filter(open).count() as u64,
        }
    }
}

impl From<&skiagraph_scene::Scene> for Scene {
    fn from(scene: &skiagraph_scene::Scene) -> Self {
        Self {
            name: scene.name.clone(),
            triangles: scene.mesh.triangles.len() as u64,
            parts: OpenParts::new(&scene.mesh),
        }
    }
}

impl fmt::Display for Adapter {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} · {} · {}", self.name, self.backend, self.driver)
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let s = if self.cores == 1 { "" } else { "s" };
        let host = self.host.as_deref().unwrap_or("a host without a name");
        write!(f, "{host}, {}, {} core{s}", self.processor, self.cores)
    }
}

impl fmt::Display for Scene {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let s = if self.triangles == 1 { "" } else { "s" };
        let triangles = thousands(self.triangles);
        write!(f, "{}, {triangles} triangle{s}", self.name)
    }
}

/// One method (a preset in one setting of its params) on one view or camera path in one viewport,
/// with its measurements, or the reason why there are none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Name of the preset, or path of the graph, with what tells one setting of it from its others:
    /// `crsm@n=1,depth=plane`.
    pub preset: String,
    /// Name of the view or camera path.
    pub view: String,
    /// Name of the light, where the view is compared under several; absent elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub light: Option<String>,
    /// Width and height of the viewport in pixels.
    pub viewport: [u32; 2],
    /// Width and height of the shadow map in texels (the param `map_size`); null where the graph
    /// has no such param.
    pub map_size: Option<u32>,
    /// All params of the graph, defaults included, with the values that it ran with.
    pub params: BTreeMap<String, serde_json::Value>,
    /// Hash of everything but the params that the run depends on: the files of the graph, its
    /// includes and shaders; the files of the graph that finds the visible triangles; the mesh,
    /// light and view.
    pub fingerprint: String,
    /// Day on which the run was measured, `2026-11-21` (UTC).
    pub date: String,
    /// Start of the comparison that measured the run, in UTC: `2026-11-21T04:30:12Z`. Runs of one
    /// comparison have the same.
    pub session: String,
    /// Id of the cell (the method with its params on the view, in the viewport, under the
    /// protocol), 16 hexadecimal digits, the same on every machine
    /// ([`cell::id`](crate::measuring::cell::id)). Empty in results of older versions.
    #[serde(default)]
    pub cell: String,
    /// Commit that the measuring program was built from; absent where the program does not know.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// Machine on which the run was measured, with its load at the start of the comparison; absent
    /// in results of older versions, for which [`Results::machine`] holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub machine: Option<Machine>,
    /// Record of the search that chose these params; absent for a method that was not tuned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tuned: Option<Tuned>,
    /// Promise of the method's document about its answers with these params; absent if it makes
    /// none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub promise: Option<Promise>,
    /// Numbers of pixels by the [reference](crate#terms)'s answer, over all frames of a camera
    /// path.
    pub pixels: PixelCounts,
    /// Number of pixels in the [band](crate#terms): those facing the light whose right answer flips
    /// when the receiver (the point that the pixel shows) or the casters move within their f32
    /// rounding error. Summed over all frames of a camera path.
    pub band: u64,
    /// Number of pixels for which the GPU rasterised a triangle that is hidden behind another one,
    /// by more than rounding explains. All methods are judged on the rasterised triangle.
    pub wrong_surface: u64,
    /// Number of samples and estimated error of the [reference](crate#terms) under a light [with an
    /// extent](crate#terms); absent for other lights.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area: Option<AreaReference>,
    /// The measurements; absent where the method could not run.
    #[serde(flatten)]
    pub measured: Option<Measured>,
    /// Reason why the method could not run on this adapter, or its outputs do not have the size,
    /// format or values of a shadow method's; absent where it was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unavailable: Option<String>,
    /// Figures that others have published about the run, from the files of `--beside`; absent if
    /// there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub published: Vec<Published>,
}

impl Run {
    /// True if the method answers only 0 or 1 and the light has no extent: each pixel is then lit
    /// or in shadow, and right or wrong. Without measurements only the light counts.
    pub fn is_hard(&self) -> bool {
        let measured = self.measured.as_ref();
        self.area.is_none() && measured.is_none_or(|measured| measured.answer == Answer::Hard)
    }

    /// False if the work ended before this run took turns with others; otherwise true.
    pub fn is_whole(&self) -> bool {
        let measured = self.measured.as_ref();
        measured.is_none_or(|measured| measured.turns.is_some())
    }

    /// Returns method, view, viewport and map size as text: `nsm on main 512x256, map 1024`.
    pub fn label(&self) -> String {
        let map = or_nothing(self.map_size, |n| format!(", map {n}"));
        let size = size(self.viewport);
        format!("{} on {} {size}{map}", self.preset, self.view)
    }

    /// True if `self` and `other` have the same preset, view, viewport and map size. Results keep
    /// only one of two such runs.
    pub fn is_in_place_of(&self, other: &Self) -> bool {
        (&self.preset, &self.view, self.viewport, self.map_size)
            == (&other.preset, &other.view, other.viewport, other.map_size)
    }

    /// True if both ran with the same params, and nothing else has changed that a run depends on.
    pub fn is_unchanged(&self, other: &Self) -> bool {
        (&self.params, &self.fingerprint) == (&other.params, &other.fingerprint)
    }

    /// True if both runs have the same preset, view, viewport, map size and cell (in results of
    /// older versions, the same params), so that reports use only the newer one.
    pub fn is_same_cell(&self, other: &Self) -> bool {
        let is_same = match (&*self.cell, &*other.cell) {
            ("", _) | (_, "") => self.params == other.params,
            (cell, other_cell) => cell == other_cell,
        };
        is_same && self.is_in_place_of(other)
    }

    /// Returns all params as assignments, separated by semicolons: `cull=front;slope_bias=1.5`.
    pub fn assignments(&self) -> String {
        assignments(&self.params).join(";")
    }

    /// Returns preset and map size as the name of a row: `nsm 1024`.
    pub fn method_label(&self) -> String {
        let with_size = |size| format!("{} {size}", self.preset);
        self.map_size.map_or(self.preset.clone(), with_size)
    }
}

/// Promise that a method's document makes about which of its pixels are right.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Promise {
    /// Pixels that are promised to be right, but where rounding decides the answer: `exact` for
    /// all, `certain` for those that the method's output `status` calls certain.
    pub of: String,
    /// True if the promise holds for closed casters alone, since the method culls faces from its
    /// shadow map.
    pub closed_only: bool,
}

impl Promise {
    /// True if all pixels are promised to be right (but where rounding decides), for closed and
    /// open casters.
    pub fn is_exact_for_all(&self) -> bool {
        self.of == "exact" && !self.closed_only
    }
}

/// Kind of a method's answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// Answers 0 and 1: the output `visibility` is a texture of integers.
    #[default]
    Hard,
    /// Answers that are [shares of light](crate#terms), 0 to 1: the output `visibility` is a
    /// texture of floats or normalised integers.
    Graded,
}

impl Answer {
    /// Returns the word for tables and files: `hard` or `graded`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Hard => "hard",
            Self::Graded => "graded",
        }
    }
}

/// Number of samples and estimated error of the [reference](crate#terms) under a light [with an
/// extent](crate#terms). The run's `pixels` count a pixel as lit if it sees half of the light or
/// more.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AreaReference {
    /// Number of shadow rays per pixel that faces the light.
    pub samples: u32,
    /// Estimated standard error of the [reference](crate#terms)'s [shares of light](crate#terms),
    /// root mean square over the pixels that face the light.
    pub standard_error_rms: f64,
    /// Greatest estimated standard error of a pixel's [share of light](crate#terms).
    pub standard_error_worst: f64,
    /// Number of pixels facing the light that see only a part of it.
    pub penumbra: u64,
}

impl AreaReference {
    /// Takes the figures from the [oracle](crate#terms)'s answer for a light [with an
    /// extent](crate#terms).
    pub fn new(area: &AreaVisibility, truth: &GroundTruthPixels) -> Self {
        let [standard_error_rms, standard_error_worst] = area.standard_error(truth);
        let is_partial = |share: &&f32| **share > 0.0 && **share < 1.0;
        let partial = area.shares.iter().filter(is_partial);
        Self {
            samples: area.samples,
            standard_error_rms,
            standard_error_worst,
            penumbra: partial.count() as u64,
        }
    }
}

/// Number of pixels of some kind, with the number of all pixels among which they are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Number of pixels of that kind.
    pub count: u64,
    /// Number of all pixels among which they are counted.
    pub of: u64,
}

/// A figure that others have published about a run, or about its view and viewport.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Published {
    /// Label of the publication, from `--beside LABEL:FILE.csv`.
    pub by: String,
    /// Name of the quantity: `wrong_percent`, `ms.trace_rays` …
    pub quantity: String,
    /// Value of the figure, in the unit of its quantity.
    pub value: f64,
    /// Place in the publication, `table 12`.
    pub source: String,
    /// Remark on a mistake in the figure as it is printed; absent if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// Measurements of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Numbers of pixels facing the light that the method calls certain by its output `status`: its
    /// shadow map decides them.
    pub certain: CertainCounts,
    /// Number of pixels facing the light that the method calls uncertain: its shadow map does not
    /// decide them, so that it traces rays or guesses.
    pub uncertain: u64,
    /// Counts of the certain and the uncertain pixels, and of the wrong ones among them, separately
    /// for pixels that the [reference](crate#terms) lights and pixels in its shadow.
    pub split: Split,
    /// Number of rays traced in a frame of a still view, or in all frames of a camera path
    /// together; null where the graph does not count them.
    pub rays: Option<u64>,
    /// Numbers of pixels on which method and reference disagree. Pixels facing the light are
    /// judged, and those that only the method takes for facing it.
    pub wrong: WrongCounts,
    /// Counts of the pixels of `wrong.certain`, by the caster that blocks their light; absent if
    /// there are none, or if answers are graded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certain_wrong_blockers: Option<BlockerCounts>,
    /// A setting that makes most wrong pixels right; absent if none was found, if methods were
    /// tuned, if answers are [shares of light](crate#terms), and for a camera path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hint: Option<Hint>,
    /// Number of pixels that face the light by the [reference](crate#terms) but not by the method's
    /// output `status`, or the other way round.
    pub facing_mismatch: u64,
    /// Number of lights whose shadows a frame computes at once, all of them in its times; absent if
    /// it is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lights: Option<u32>,
    /// Kind of the answers: 0 and 1, or [shares of light](crate#terms). Of shares, `certain`,
    /// `split` and `wrong` count one half or more as lit.
    pub answer: Answer,
    /// Errors of the [shares of light](crate#terms) that the method shows, against the
    /// [reference](crate#terms); a hard answer shows 0 or 1.
    pub graded: Graded,
    /// Distances in pixels of wrong pixels from the edges of the [reference](crate#terms)'s
    /// shadows.
    pub edges: EdgeDistances,
    /// Times of each pass over the timed frames, in the order in which they ran.
    pub passes: Vec<Pass>,
    /// Times of whole frames: of a still view with every pass run, of a camera path with passes
    /// skipped whose inputs had not changed, and with the upkeep of the CPU.
    pub frame: FrameTimes,
    /// Times of frames by what has moved since the frame before, from the least that moves to the
    /// most; empty if they were not measured.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regimes: Vec<RegimeTimes>,
    /// Bytes of the textures and buffers that the graph makes; memory that several share counts
    /// once.
    pub memory_bytes: u64,
    /// Bytes by which `memory_bytes` is less because textures and buffers share memory.
    pub saved_bytes: u64,
    /// Bytes of the scene's resources that the graph reads, such as positions, indices and
    /// hierarchy.
    pub scene_bytes: u64,
    /// Group of methods that took turns with this one, frame by frame; absent if the work ended
    /// before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turns: Option<Turns>,
    /// Steady state of a method that reuses results of earlier frames: the pictures of a still view
    /// that it repeats, with means over them. The other fields count the worst of these pictures.
    /// Absent for other methods.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steady: Option<Steady>,
    /// Texels of the shadow map per pixel, for a path in its worst frame; absent where the graph
    /// has no output `texel_density`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texels: Option<TexelsPerPixel>,
    /// Differences of the errors of neighbouring pixels that read different layers of the shadow
    /// map, for a path in its worst frame; absent where the graph has no output `map_layer`, or no
    /// two layers meet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layer_jump: Option<LayerJump>,
    /// Measurements of each frame of a camera path; all other fields are sums and spreads over the
    /// frames. Absent for a still view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sequence: Option<Sequence>,
    /// File names of the run's pictures in the results' folder, for a path of its worst frame;
    /// absent with `--images none`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub images: Option<Images>,
}

/// Returns the step that a pass belongs to: its name up to the first dot. `create_shadow_map.outer`
/// and `create_shadow_map.inner` belong to the step `create_shadow_map`. The name of a repeat is
/// skipped: `turn[0].trace_rays` belongs to the step `trace_rays`.
pub fn step(pass: &str) -> &str {
    let mut steps = pass.split('.');
    steps.find(|step| !step.ends_with(']')).unwrap_or(pass)
}

/// Name of the step that draws the camera's G-buffer. Every built-in preset begins with it, so that
/// it is not counted as a shadow method's own work.
pub const GBUFFER: &str = "gbuffer";

impl Measured {
    /// Returns the median GPU times of the passes of the [`step`] with this name, added up, in
    /// milliseconds; `one+another` adds up several steps. Returns `None` if a step has no pass, or
    /// a pass no GPU time.
    pub fn step_ms(&self, name: &str) -> Option<f64> {
        let steps = name.split('+');
        let each = steps.map(|name| self.sum_ms(|pass| step(pass) == name));
        each.sum()
    }

    /// Returns the median GPU times of all passes, added up, in milliseconds, to compare with
    /// published sums. Where passes overlap, this is more than the frame's time. Returns `None`
    /// without GPU times.
    pub fn steps_ms(&self) -> Option<f64> {
        self.sum_ms(|_| true)
    }

    fn sum_ms(&self, counts: impl Fn(&str) -> bool) -> Option<f64> {
        let passes = self.passes.iter().filter(|pass| counts(&pass.name));
        let medians = passes.map(|pass| Some(pass.gpu_ms?.median));
        let medians = medians.collect::<Option<Vec<f64>>>()?;
        (!medians.is_empty()).then(|| medians.iter().sum())
    }

    /// Returns the median GPU times of the passes of the step `gbuffer`, added up, in milliseconds;
    /// `None` if there are none.
    pub fn gbuffer_ms(&self) -> Option<f64> {
        self.step_ms(GBUFFER)
    }

    /// Returns the median GPU time of a frame without the step `gbuffer`, in milliseconds; `None`
    /// without GPU times. A G-buffer under another name is included.
    pub fn ms_without_gbuffer(&self) -> Option<f64> {
        Some(self.frame.gpu_ms?.median - self.gbuffer_ms().unwrap_or(0.0))
    }

    /// Returns the times of frames before which that moved, with `None` those of
    /// [`frame`](Self::frame). Returns `None` if they were not measured.
    pub fn times(&self, regime: Option<Regime>) -> Option<&FrameTimes> {
        let Some(regime) = regime else {
            return Some(&self.frame);
        };
        let mut regimes = self.regimes.iter();
        let times = regimes.find(|times| times.regime == regime)?;
        Some(&times.frame)
    }

    /// Returns the number of wrong pixels outside the band (the pixels whose right answer rounding
    /// may flip). For a method that reuses results of earlier frames it counts the worst picture of
    /// its steady state; the mean over all these pictures, by which reports rank, is in
    /// [`steady`](Self::steady).
    pub fn wrong_outside_band(&self) -> u64 {
        self.wrong.total.saturating_sub(self.wrong.in_band)
    }
}

/// Times of one pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pass {
    /// Name of the pass in the graph.
    pub name: String,
    /// Milliseconds between the pass's GPU timestamps; null if the device has none or they cannot
    /// be trusted.
    pub gpu_ms: Option<Spread>,
    /// Milliseconds that the CPU took to encode the pass's commands.
    pub cpu_ms: Spread,
}

/// File names of a run's pictures, in the folder of the results.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Images {
    /// Index of the frame of a camera path that the pictures show, from 0: the worst frame. The
    /// file names contain it. Absent for a still view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<usize>,
    /// File name of the picture of the [reference](crate#terms)'s shadows; methods share one
    /// picture for each view, viewport and frame.
    pub reference: String,
    /// File name of the picture of the scene, shaded with the method's shadows.
    pub shaded: String,
    /// File name of the picture of the output `visibility`.
    pub visibility: String,
    /// File name of the picture of the errors: blue where wrongly lit, red where wrongly in shadow,
    /// paler where rounding may flip the right answer. For [shares of light](crate#terms) the
    /// colour grows with the error, and is full from an error of a quarter on.
    pub error: String,
    /// File name of the picture `shaded` with uncertain pixels in purple; absent where the method
    /// calls no pixel certain or uncertain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertain: Option<String>,
    /// File name of the picture of the shadow map's texels per pixel, from red (few) over pale
    /// yellow (1) to blue (many); absent where the graph has no output `texel_density`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texels: Option<String>,
    /// File name of the picture of the factor of the texels per pixel that distances and the map's
    /// resolution cause (perspective aliasing); absent where the graph has no output
    /// `texel_density`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub perspective: Option<String>,
    /// File name of the picture of the factor of the texels per pixel that the surface's angles to
    /// eye and light cause (projection aliasing); absent where the graph has no output
    /// `texel_density`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub projection: Option<String>,
    /// File names of the pictures of the kind `shaded` of each frame of the second of a path in
    /// which the most pixels shimmer, in order; of a shorter path all its frames. Absent for a
    /// still view.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub worst_second: Vec<String>,
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::files::json;
    use skiagraph_reference::{ClassSplit, Quantiles};

    /// An adapter that no machine has.
    pub(crate) fn adapter() -> Adapter {
        Adapter {
            name: "Some GPU".into(),
            backend: "vulkan".into(),
            driver: "driver 1.2".into(),
            device_type: "Cpu".into(),
            gpu_unavailable: None,
        }
    }

    /// A machine that is hardly loaded.
    fn machine() -> Machine {
        Machine {
            host: Some("bench".into()),
            processor: "Some CPU".into(),
            cores: 8,
            load: Some(0.25),
        }
    }

    /// A scene of open and closed parts.
    pub(crate) fn scene() -> Scene {
        Scene {
            name: "park".into(),
            triangles: 55_000,
            parts: OpenParts {
                all: 40,
                open: 12,
                open_triangles: 5_000,
            },
        }
    }

    /// Results with every field in use: one full run, one without a map or GPU times, one
    /// unavailable.
    #[allow(clippy::too_many_lines, reason = "every field has a value")]
    pub(crate) fn sample() -> Results {
        let spread = |ms: f64| Spread {
            min: ms,
            q1: ms * 1.25,
            median: ms * 1.5,
            q3: ms * 1.75,
            p95: ms * 2.0,
        };
        let times = |gpu: Option<f64>, wall: f64| FrameTimes {
            gpu_ms: gpu.map(spread),
            wall_ms: spread(wall),
            cpu_ms: None,
            gpu_frames: gpu.map(|ms| vec![ms * 2.0, ms, ms * 1.5]),
            cpu_frames: None,
            wall_frames: vec![wall * 2.0, wall, wall * 1.5],
        };
        let regime = |regime, gpu: Option<f64>| RegimeTimes {
            regime,
            frame: FrameTimes {
                cpu_ms: Some(spread(0.125)),
                cpu_frames: Some(vec![0.25, 0.125, 0.1875]),
                ..times(gpu, 1.0)
            },
            uploaded_bytes: 96,
            skipped: vec!["create_shadow_map".into()],
        };
        let run = |preset: &str, map_size| Run {
            preset: preset.into(),
            view: "main".into(),
            light: None,
            viewport: [512, 256],
            map_size,
            params: BTreeMap::from([
                ("slope_bias".into(), 1.5.into()),
                ("cull".into(), "front".into()),
            ]),
            fingerprint: "85944171f73967e8".into(),
            date: "2026-11-20".into(),
            tuned: None,
            session: "2026-11-20T04:30:12Z".into(),
            cell: format!("c0ffee{:010x}", preset.len()),
            commit: Some("0123456789abcdef0123456789abcdef01234567".into()),
            machine: Some(machine()),
            promise: None,
            pixels: PixelCounts {
                background: 72,
                facing_away: 31_000,
                facing_light: 100_000,
                lit: 60_000,
                shadow: 40_000,
            },
            band: 12,
            wrong_surface: 0,
            area: None,
            measured: None,
            unavailable: None,
            published: Vec::new(),
        };
        let published = |quantity: &str, value, note: Option<&str>| Published {
            by: "D".into(),
            quantity: quantity.into(),
            value,
            source: "table 12".into(),
            note: note.map(Into::into),
        };
        let measured = |name: &str, gpu: bool, rays| Measured {
            certain: CertainCounts {
                lit: 57_100,
                shadow: 37_900,
            },
            uncertain: 5_000,
            split: Split {
                lit: ClassSplit {
                    certain_right: 57_000,
                    certain_wrong: 400,
                    certain_wrong_outside_band: 396,
                    uncertain: 2_600,
                    uncertain_wrong: 1,
                },
                shadow: ClassSplit {
                    certain_right: 37_500,
                    certain_wrong: 100,
                    certain_wrong_outside_band: 99,
                    uncertain: 2_400,
                    uncertain_wrong: 2,
                },
            },
            rays,
            wrong: WrongCounts {
                lit: 102,
                shadow: 401,
                total: 503,
                certain: 495,
                in_band: 6,
            },
            hint: None,
            certain_wrong_blockers: gpu.then_some(BlockerCounts {
                open_part: 90,
                closed_part: 9,
                none: 396,
            }),
            facing_mismatch: 3,
            lights: None,
            answer: Answer::Hard,
            graded: Graded {
                rmse: 0.071,
                flip: 0.012,
                ..Graded::default()
            },
            edges: EdgeDistances::default(),
            passes: ["gbuffer", name]
                .map(|name| Pass {
                    name: name.into(),
                    gpu_ms: gpu.then(|| spread(0.25)),
                    cpu_ms: spread(0.01),
                })
                .into(),
            frame: times(gpu.then_some(1.0), 2.0),
            regimes: vec![
                regime(Regime::Camera, gpu.then_some(0.5)),
                regime(Regime::Light, gpu.then_some(1.0)),
            ],
            memory_bytes: 12_582_912,
            saved_bytes: 1_048_576,
            scene_bytes: 2_000_000,
            turns: Some(Turns {
                group: 0,
                anchor: times(Some(1.0), 2.0),
                regimes: vec![regime(Regime::Camera, Some(0.5))],
            }),
            steady: None,
            texels: gpu.then(|| TexelsPerPixel {
                pixels: 99_990,
                under_one: 25_000,
                outside_map: 10,
                texels: Quantiles {
                    p5: 0.25,
                    median: 2.5,
                    p95: 40.0,
                },
                ..TexelsPerPixel::default()
            }),
            layer_jump: gpu.then_some(LayerJump {
                pairs: 500,
                across: 0.0625,
                pairs_elsewhere: 198_000,
                elsewhere: 0.015625,
            }),
            sequence: None,
            images: gpu.then(|| Images {
                frame: None,
                reference: "reference.png".into(),
                shaded: format!("{name}-shaded.png"),
                visibility: format!("{name}-visibility.png"),
                error: format!("{name}-error.png"),
                uncertain: Some(format!("{name}-uncertain.png")),
                texels: Some(format!("{name}-texels.png")),
                perspective: Some(format!("{name}-perspective.png")),
                projection: Some(format!("{name}-projection.png")),
                worst_second: Vec::new(),
            }),
        };
        Results {
            schema: SCHEMA,
            program: "skiagraph 0.1.0".into(),
            adapter: adapter(),
            machine: machine(),
            scene: scene(),
            oracle: "exact".into(),
            frames: 10,
            warmup: 2,
            regime_frames: 10,
            began: "2026-11-20T04:30:12Z".into(),
            budgets: Budgets::default(),
            commands: vec!["skiagraph compare nsm rt rt_hw --size 512x256".into()],
            notes: vec!["1 point and 2 lines left out".into()],
            runs: vec![
                Run {
                    measured: Some(measured("create_shadow_map", true, None)),
                    published: vec![
                        published("lit", 60_001.0, None),
                        published("wrong_percent", 0.5, Some("misprint: 5.0")),
                        published("ms.trace_rays", 1.25, None),
                    ],
                    ..run("nsm", Some(1024))
                },
                Run {
                    measured: Some(measured("trace_rays", false, Some(100_000))),
                    ..run("rt", None)
                },
                Run {
                    unavailable: Some("needs ray queries, \"not\" here".into()),
                    ..run("rt_hw", None)
                },
            ],
            plan: None,
            others: Vec::new(),
        }
    }

    #[test]
    fn a_step_is_what_stands_before_the_first_dot_but_no_repeat() {
        for (pass, name) in [
            ("trace_rays", "trace_rays"),
            ("fill_rays.compact", "fill_rays"),
            ("turn[0].fill_rays.compact", "fill_rays"),
            ("fill[3]", "fill[3]"),
        ] {
            assert_eq!(step(pass), name);
        }
    }

    #[test]
    fn joined_results_are_split_and_older_files_lack_cell_commit_and_machine() {
        let mut joined = sample();
        joined.others = vec![sample(), sample()];
        joined.others[0].others = vec![sample()];
        let text = json::to_text(&joined);
        let read: Results = serde_json::from_str(&text).unwrap();
        assert_eq!(read.each(), [sample(), sample(), sample(), sample()]);
        let mut older = serde_json::to_value(sample()).unwrap();
        for run in older["runs"].as_array_mut().unwrap() {
            let run = run.as_object_mut().unwrap();
            for field in ["cell", "commit", "machine"] {
                assert!(run.remove(field).is_some(), "{field}");
            }
        }
        let older: Results = serde_json::from_value(older).unwrap();
        assert_eq!(older.machine_of(&older.runs[0]), &machine());
        assert!(
            older.runs[0].is_same_cell(&sample().runs[0]),
            "by its params"
        );
        assert_eq!(older.runs[0].assignments(), "cull=front;slope_bias=1.5");
    }

    #[test]
    fn the_schema_is_pinned_and_reads_back() {
        let json = json::to_text(&sample());
        insta::assert_snapshot!(json);
        assert_eq!(serde_json::from_str::<Results>(&json).unwrap(), sample());
    }
}
