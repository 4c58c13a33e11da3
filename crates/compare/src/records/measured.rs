//! Measurements of a run, as `results.json` holds them.

use crate::records::hint::Hint;
use crate::records::regimes::{Regime, RegimeTimes};
use crate::records::sequence::Sequence;
use crate::records::statistics::{FrameTimes, Spread};
use crate::records::steady::Steady;
use crate::records::turns::Turns;
use serde::{Deserialize, Serialize};
use skiagraph_reference::{
    BlockerCounts, CertainCounts, EdgeDistances, Graded, LayerJump, Split, TexelsPerPixel,
    WrongCounts,
};

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

/// Number of pixels of some kind, with the number of all pixels among which they are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Number of pixels of that kind.
    pub count: u64,
    /// Number of all pixels among which they are counted.
    pub of: u64,
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
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
