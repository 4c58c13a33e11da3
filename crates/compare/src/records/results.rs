//! The schema of `results.json` and `results.csv`, version 1. Scripts rely on it: extend it, rename
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
use crate::records::sequence::Sequence;
use crate::records::statistics::{FrameTimes, Spread};
use crate::records::steady::Steady;
use crate::records::turns::Turns;
use crate::wording::{size, thousands};
use serde::{Deserialize, Serialize};
use skiagraph_reference::{
    AreaVisibility, BlockerCounts, CertainCounts, EdgeDistances, Graded, GroundTruthPixels,
    LayerJump, PixelCounts, Split, TexelsPerPixel, WrongCounts,
};
use std::{collections::BTreeMap, fmt};

/// The program that measures, as files name it.
pub const PROGRAM: &str = concat!("skiagraph ", env!("CARGO_PKG_VERSION"));

/// Everything that one `compare` measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Version of this schema: 1.
    pub schema: u32,
    /// The program that measured, `skiagraph 0.1.0`.
    pub program: String,
    /// The GPU that it ran on.
    pub adapter: Adapter,
    /// The machine that it ran on.
    pub machine: Machine,
    /// The scene that was drawn.
    pub scene: Scene,
    /// The oracle's mode, `exact` or `offset:LENGTH`.
    pub oracle: String,
    /// Timed frames per run.
    pub frames: u32,
    /// Frames before the timed ones.
    pub warmup: u32,
    /// Timed frames in which only the camera moves, per run.
    pub cached_frames: u32,
    /// When the comparison began that measured the newest runs, `2026-11-21T04:30:12Z`.
    pub began: String,
    /// Limits on methods that are to be taken; absent without any.
    #[serde(default, skip_serializing_if = "Budgets::is_empty")]
    pub budgets: Budgets,
    /// The commands that measured it, the first one first.
    pub commands: Vec<String>,
    /// One entry per view, viewport, preset and map size, in this order.
    pub runs: Vec<Run>,
}

/// The GPU.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adapter {
    /// Name by its driver.
    pub name: String,
    /// vulkan, metal or dx12.
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
    /// DiscreteGpu, IntegratedGpu, VirtualGpu, Cpu or Other.
    pub device_type: String,
    /// Why all `gpu_ms` are null; absent where they are not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gpu_unavailable: Option<String>,
}

/// The machine, as it was when a comparison began.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Its name in its network; null where the system does not say.
    pub host: Option<String>,
    /// Name of its processor; empty where the system does not say.
    pub processor: String,
    /// Logical processors.
    pub cores: u32,
    /// Mean number of processes that ran or waited to run over the minute before; null where the
    /// system does not say.
    pub load: Option<f64>,
}

impl Machine {
    /// True if other processes took half of the processors and more: they slow down what is timed.
    pub fn is_loaded(&self) -> bool {
        self.load
            .is_some_and(|load| load >= 0.5 * f64::from(self.cores))
    }
}

/// The scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Its name.
    pub name: String,
    /// Triangles in its mesh.
    pub triangles: u64,
    /// How much of its mesh is open.
    pub parts: OpenParts,
}

/// The parts of a mesh, triangles that share edges, and which are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OpenParts {
    /// All of them.
    pub all: u64,
    /// Those that have an edge of one side.
    pub open: u64,
    /// Triangles of the open ones.
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

impl fmt::Display for Scene {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let s = if self.triangles == 1 { "" } else { "s" };
        let triangles = thousands(self.triangles);
        write!(f, "{}, {triangles} triangle{s}", self.name)
    }
}

/// One preset in one setting on one view and viewport, with its measurements or why there are none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Name of the preset, or path of the graph, with what tells one setting of it from its others:
    /// `crsm@n=1,depth=plane`.
    pub preset: String,
    /// Name of the view.
    pub view: String,
    /// Name of the light, where the view is compared under several; absent elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub light: Option<String>,
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// Value of the param `map_size`; null where the graph has none.
    pub map_size: Option<u32>,
    /// All params of the graph with the values it ran with.
    pub params: BTreeMap<String, serde_json::Value>,
    /// Hash of everything else that the run depends on: the texts of the graph, of what it includes
    /// and of their shaders, the same of the graph that finds the visible triangles, mesh, light
    /// and view.
    pub fingerprint: String,
    /// The day on which it was measured, `2026-11-21` (UTC).
    pub date: String,
    /// When the comparison began that measured it, `2026-11-21T04:30:12Z`.
    pub session: String,
    /// The document's promise of its answers with these params; absent where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub promise: Option<Promise>,
    /// The reference's pixels.
    pub pixels: PixelCounts,
    /// Pixels facing the light whose answer flips within the rounding error of receiver and
    /// casters.
    pub band: u64,
    /// Pixels whose primitive, as rasterised, is hidden behind another one by more than rounding.
    /// All methods are judged on the rasterised one.
    pub wrong_surface: u64,
    /// Sampling of the reference, of a light that has an extent; absent where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area: Option<AreaReference>,
    /// The measurements; absent where the preset is unavailable.
    #[serde(flatten)]
    pub measured: Option<Measured>,
    /// Why the preset could not run on this adapter; absent where it did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unavailable: Option<String>,
    /// Figures that others have published, with `--beside`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub published: Vec<Published>,
}

impl Run {
    /// True if answer and light are hard, so that pixels are right or wrong.
    pub fn is_hard(&self) -> bool {
        let measured = self.measured.as_ref();
        self.area.is_none() && measured.is_none_or(|of| of.answer == Answer::Hard)
    }

    /// True unless it was kept at an early end, with a single frame that was timed by itself.
    pub fn is_whole(&self) -> bool {
        let measured = self.measured.as_ref();
        measured.is_none_or(|of| of.sequence.is_some() || of.turns.is_some())
    }

    /// Method, view, viewport and map in words.
    pub fn label(&self) -> String {
        let map = self
            .map_size
            .map_or(String::new(), |n| format!(", map {n}"));
        let size = size(self.viewport);
        format!("{} on {} {size}{map}", self.preset, self.view)
    }

    /// The pixels that the method lights wrongly, of all that it lights.
    pub fn wrong_lit(&self) -> Option<Part> {
        let WrongCounts { lit, shadow, .. } = self.measured.as_ref()?.wrong;
        let of = (self.pixels.lit + lit).saturating_sub(shadow);
        Some(Part { count: lit, of })
    }

    /// The pixels that the method has wrongly in shadow, of all that it has there.
    pub fn wrong_shadow(&self) -> Option<Part> {
        let WrongCounts { lit, shadow, .. } = self.measured.as_ref()?.wrong;
        let of = (self.pixels.shadow + shadow).saturating_sub(lit);
        Some(Part { count: shadow, of })
    }

    /// True if it stands at the same place of a comparison as another one: of the same method,
    /// view, viewport and map.
    pub fn is_in_place_of(&self, other: &Self) -> bool {
        (&self.preset, &self.view, self.viewport, self.map_size)
            == (&other.preset, &other.view, other.viewport, other.map_size)
    }

    /// Preset and map size, as a row's name.
    pub fn method_label(&self) -> String {
        let with_size = |size| format!("{} {size}", self.preset);
        self.map_size.map_or(self.preset.clone(), with_size)
    }
}

/// The promise of a document.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Promise {
    /// `exact` of all its pixels, `certain` of those that it calls certain.
    pub of: String,
    /// True if it holds of closed casters alone, as the method leaves out faces.
    pub closed_only: bool,
}

/// In what a method answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// In 0 and 1: its visibility is a texture of integers.
    Hard,
    /// In shares of light.
    Graded,
}

impl Answer {
    /// As tables and files have it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Hard => "hard",
            Self::Graded => "graded",
        }
    }
}

/// The reference of a light that has an extent; the run's `pixels` count as lit what sees half of
/// it or more.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AreaReference {
    /// Shadow rays per pixel that faces the light.
    pub samples: u32,
    /// The estimated standard error of its shares, root mean square over the pixels that face the
    /// light.
    pub standard_error_rms: f64,
    /// The greatest one.
    pub standard_error_worst: f64,
    /// Pixels facing the light that see a part of it.
    pub penumbra: u64,
}

impl AreaReference {
    /// Takes the figures of the oracle's answer.
    pub fn new(area: &AreaVisibility, truth: &GroundTruthPixels) -> Self {
        let [standard_error_rms, standard_error_worst] = area.standard_error(truth);
        let partial = area
            .shares
            .iter()
            .filter(|share| **share > 0.0 && **share < 1.0);
        Self {
            samples: area.samples,
            standard_error_rms,
            standard_error_worst,
            penumbra: partial.count() as u64,
        }
    }
}

/// Some of those pixels that the method gives the same answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// How many.
    pub count: u64,
    /// Number of all of them.
    pub of: u64,
}

/// A figure published by others about such a run or about its view and viewport.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Published {
    /// Label of who did.
    pub by: String,
    /// Quantity that it is of: `wrong_percent`, `ms.trace_rays` …
    pub quantity: String,
    /// The figure.
    pub value: f64,
    /// Where it stands, `table 12`.
    pub source: String,
    /// A remark on what is wrong with it as it is printed there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// Measurements of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Pixels that the method decided by its map alone.
    pub certain: CertainCounts,
    /// Pixels that it left to rays, or all that it traced.
    pub uncertain: u64,
    /// Certain and uncertain pixels, apart for those that the reference lights and those in its
    /// shadow, each with how many are wrong.
    pub split: Split,
    /// Rays traced per frame; null where the graph does not count them.
    pub rays: Option<u64>,
    /// Pixels facing the light on which method and reference disagree.
    pub wrong: WrongCounts,
    /// The pixels of `wrong.certain` by what blocks them; absent where there are none, or where
    /// answers are graded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certain_wrong_blockers: Option<BlockerCounts>,
    /// Pixels that face the light by the reference but not by the method, or the other way round.
    pub facing_mismatch: u64,
    /// Kind of the answers: 0 and 1, or shares of light. Of shares, `certain`, `split` and
    /// `wrong` count as lit what is one half or more.
    pub answer: Answer,
    /// How far the shares of light that it shows are from the reference's; a hard answer shows 0 or
    /// 1.
    pub graded: Graded,
    /// How far wrong pixels lie from the edges of the reference's shadows.
    pub edges: EdgeDistances,
    /// Times of each pass, in the order in which they ran.
    pub passes: Vec<Pass>,
    /// Times of whole frames.
    pub frame: FrameTimes,
    /// Times of frames in which only the camera moved and unchanged passes were skipped; null where
    /// nothing was.
    pub cached: Option<Cached>,
    /// Bytes of the graph's own materials.
    pub memory_bytes: u64,
    /// Bytes saved by letting materials share memory.
    pub saved_bytes: u64,
    /// Bytes of the scene's resources: positions, indices, hierarchy …
    pub scene_bytes: u64,
    /// The methods that it took turns with, frame by frame; absent of a camera path, which each
    /// method follows by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turns: Option<Turns>,
    /// How a method that remembers came to its steady state; absent of one that does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steady: Option<Steady>,
    /// Texels of its shadow map per pixel, of a path's worst frame; absent where the graph has no
    /// output `texel_density`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texels: Option<TexelsPerPixel>,
    /// How errors jump where two layers of its shadow map meet, in a path's worst frame; absent
    /// where the graph has no output `map_layer`, or no two layers meet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layer_jump: Option<LayerJump>,
    /// The frames of a camera path; all other fields are their sums and spreads. Absent of a still
    /// view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sequence: Option<Sequence>,
    /// The run's pictures, those of a path's worst frame, file names in the results' folder; absent
    /// with `--images none`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub images: Option<Images>,
}

/// The step that a pass belongs to: its name up to the first dot, so that `create_shadow_map.outer`
/// and `create_shadow_map.inner` are one. What is repeated is no step, but what is in it:
/// `turn[0].trace_rays` is of the step `trace_rays`.
pub fn step(pass: &str) -> &str {
    let mut steps = pass.split('.');
    steps.find(|step| !step.ends_with(']')).unwrap_or(pass)
}

/// The step that every preset begins with, and that is not the method's own work.
pub const GBUFFER: &str = "gbuffer";

impl Measured {
    /// The sum of the medians of a step's passes, or of several steps' in `one+another`; `None` if
    /// a step has none, or one without a GPU time.
    pub fn step_ms(&self, name: &str) -> Option<f64> {
        let steps = name.split('+');
        let each = steps.map(|name| self.sum_ms(|pass| step(pass) == name));
        each.sum()
    }

    /// The sum of the medians of all passes, to stand beside figures that are sums. Where passes
    /// overlap it is more than the frame; `None` without GPU times.
    pub fn steps_ms(&self) -> Option<f64> {
        self.sum_ms(|_| true)
    }

    fn sum_ms(&self, counts: impl Fn(&str) -> bool) -> Option<f64> {
        let passes = self.passes.iter();
        let medians: Vec<f64> = passes
            .filter(|pass| counts(&pass.name))
            .map(|pass| Some(pass.gpu_ms?.median))
            .collect::<Option<_>>()?;
        (!medians.is_empty()).then(|| medians.iter().sum())
    }

    /// Frames per second: what the median frame allows. `None` without GPU times.
    pub fn fps(&self) -> Option<f64> {
        Some(1000.0 / self.frame.gpu_ms?.median)
    }

    /// The sum of the medians of the G-buffer's passes, those of the step `gbuffer`.
    pub fn gbuffer_ms(&self) -> Option<f64> {
        self.step_ms(GBUFFER)
    }

    /// The median frame less its G-buffer; `None` without GPU times. A method that calls its
    /// G-buffer something else keeps it in.
    pub fn ms_without_gbuffer(&self) -> Option<f64> {
        Some(self.frame.gpu_ms?.median - self.gbuffer_ms().unwrap_or(0.0))
    }

    /// Wrong pixels that are determinate: outside the band.
    pub fn wrong_outside_band(&self) -> u64 {
        self.wrong.total.saturating_sub(self.wrong.in_band)
    }
}

/// Times of one pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pass {
    /// Its name in the graph.
    pub name: String,
    /// Between its GPU timestamps; null where they cannot be had or trusted.
    pub gpu_ms: Option<Spread>,
    /// Encoding on the CPU.
    pub cpu_ms: Spread,
}

/// A frame in which unchanged passes did not run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cached {
    /// Its times.
    pub frame: FrameTimes,
    /// Names of the passes that did not run.
    pub skipped: Vec<String>,
}

/// File names of a run's pictures.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Images {
    /// Frame of a camera path that they show, counted from 0: the worst. Its number is in
    /// their names. Absent of a still view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<usize>,
    /// The reference's shadows, the same of all methods.
    pub reference: String,
    /// The scene in the method's shadow.
    pub shaded: String,
    /// The output `visibility`.
    pub visibility: String,
    /// Blue where wrongly lit, red where wrongly in shadow, paler in the band, in as many pixels as
    /// are wrong. Of grades the stronger the farther off, in full from a quarter on.
    pub error: String,
    /// `shaded` with purple where uncertain; absent where the method calls no pixel certain or
    /// uncertain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertain: Option<String>,
    /// Shadow-map texels per pixel, from red (few) over pale yellow (1) to blue (many); absent
    /// where the graph has no output `texel_density`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texels: Option<String>,
    /// Their part of distance and map alone; absent as `texels` is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub perspective: Option<String>,
    /// Their part of angles alone; absent as `texels` is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub projection: Option<String>,
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
            gpu_frames: gpu.map(|ms| vec![ms * 2.0, ms, ms * 1.5]),
            wall_frames: vec![wall * 2.0, wall, wall * 1.5],
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
            session: "2026-11-20T04:30:12Z".into(),
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
            certain_wrong_blockers: gpu.then_some(BlockerCounts {
                open_part: 90,
                closed_part: 9,
                none: 396,
            }),
            facing_mismatch: 3,
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
            cached: gpu.then(|| Cached {
                frame: times(Some(0.5), 1.0),
                skipped: vec!["create_shadow_map".into()],
            }),
            memory_bytes: 12_582_912,
            saved_bytes: 1_048_576,
            scene_bytes: 2_000_000,
            turns: Some(Turns {
                group: 0,
                anchor: times(Some(1.0), 2.0),
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
            }),
        };
        Results {
            schema: 1,
            program: "skiagraph 0.1.0".into(),
            adapter: adapter(),
            machine: Machine {
                host: Some("bench".into()),
                processor: "Some CPU".into(),
                cores: 8,
                load: Some(0.25),
            },
            scene: scene(),
            oracle: "exact".into(),
            frames: 10,
            warmup: 2,
            cached_frames: 10,
            began: "2026-11-20T04:30:12Z".into(),
            budgets: Budgets::default(),
            commands: vec!["skiagraph compare nsm rt rt_hw --size 512x256".into()],
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
        }
    }

    #[test]
    fn a_step_is_what_stands_before_the_first_dot_but_no_repeat() {
        for (pass, of) in [
            ("trace_rays", "trace_rays"),
            ("fill_rays.compact", "fill_rays"),
            ("turn[0].fill_rays.compact", "fill_rays"),
            ("fill[3]", "fill[3]"),
        ] {
            assert_eq!(step(pass), of);
        }
    }

    #[test]
    fn the_schema_is_pinned_and_reads_back() {
        let json = json::to_text(&sample());
        insta::assert_snapshot!(json);
        assert_eq!(serde_json::from_str::<Results>(&json).unwrap(), sample());
    }
}
