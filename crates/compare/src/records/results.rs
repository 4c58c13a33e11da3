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

use crate::records::budgets::Budgets;
pub use crate::records::measured::{Answer, GBUFFER, Images, Measured, Part, Pass, step};
use crate::records::tuned::{Tuned, assignments};
use crate::wording::{or_nothing, plural, size, thousands};
use itertools::Itertools;
use serde::{Deserialize, Serialize};
use skiagraph_reference::{AreaVisibility, GroundTruthPixels, PixelCounts};
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
    /// Number of timed frames of each [regime](crate::records::regimes::Regime); 0 for none.
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
        (&self.host, &self.processor, self.cores) == (&other.host, &other.processor, other.cores)
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

/// Numbers of a mesh's parts that cast shadows: sets of triangles that are connected by shared
/// edges.
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
        // Each is an open part of its own.
        let cast_nothing = (mesh.triangles.len() - mesh.casters().len()) as u64;
        Self {
            all: parts.open.len() as u64 - cast_nothing,
            open: parts.open.iter().filter(|open| **open).count() as u64 - cast_nothing,
            open_triangles: parts.of.iter().filter(open).count() as u64 - cast_nothing,
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
        let host = self.host.as_deref().unwrap_or("a host without a name");
        let cores = plural(self.cores as usize, "core");
        write!(f, "{host}, {}, {cores}", self.processor)
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

#[cfg(test)]
#[path = "results_tests.rs"]
pub(crate) mod tests;
