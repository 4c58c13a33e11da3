//! Computes the ground truth of a view in a viewport: the GPU finds the visible primitive of each
//! pixel, and the oracle judges its light.
//!
//! ```
//! use skiagraph_compare::{measuring::ground_truth::GroundTruthView, sink::Silent};
//! use skiagraph_reference::{Oracle, OracleMode};
//!
//! let scene = skiagraph_cases::case("box_on_floor").ok_or("it is in the catalogue")?.scene();
//! let (view, light) = (&scene.views[0], scene.light_of(&scene.views[0]));
//! // Every pixel shows the first triangle: a GPU says which ones they show.
//! let ids = vec![0; 8 * 8];
//! let oracle = Oracle::new(&scene.mesh).into();
//! let (camera, how) = (view.camera([8, 8]), (OracleMode::Exact, 1));
//! let answer = GroundTruthView::new(oracle, camera, light, ids, how, ("main", &Silent))?;
//! assert_eq!(answer.ground_truth.pixels.classes.len(), 64);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::fingerprint::{Fingerprint, RecordedSources};
use crate::files::truth_file::Truth;
use crate::graphs::faults::GraphFaults;
use crate::graphs::planning::Capabilities;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::frame;
use crate::measuring::frame_sequence::FrameSequence;
use crate::sink::{Session, Sink, Step};
use skiagraph_gpu::{Content, Provider};
use skiagraph_graph::{Graph, Plan, Sources};
use skiagraph_passes::registry;
use skiagraph_reference::{
    BlockerCounts, EdgeDistances, Error, Footprint, GroundTruth, GroundTruthPixels, LayerJump,
    Oracle, OracleMode, Progress, Receiver, Statistics, area, nearest_blockers,
    shimmer::{Seen, same_receivers},
    texels, wrong_surfaces,
};
use skiagraph_scene::{Camera, LightKind, Mesh};
use std::rc::Rc;

/// The graph that every comparison draws first, as far as its output `primitive` needs: which one
/// does each pixel show?
const GBUFFER: &str = "pipelines/shared/gbuffer.ron";

/// Graph that renders the id of each pixel's visible primitive (triangle) in the same way as every
/// method's G-buffer, so that methods are judged on the surfaces that they show.
#[derive(Clone)]
pub struct PrimaryVisibility {
    graph: Graph,
    /// Hash of the files from which the graph was read.
    pub fingerprint: Fingerprint,
}

impl PrimaryVisibility {
    /// Loads the G-buffer's graph, `pipelines/shared/gbuffer.ron`, with its shaders from `sources`.
    /// [`EmbeddedSources`](skiagraph_passes::EmbeddedSources) has these files; others may replace
    /// them.
    ///
    /// # Errors
    /// A file is missing or has a fault.
    pub fn load(sources: &dyn Sources) -> Result<Self> {
        let recorded = RecordedSources::new(sources);
        let graph = Graph::load(GBUFFER, &registry(), &recorded);
        Ok(Self {
            graph: graph.map_err(|diagnostics| GraphFaults::one(GBUFFER, &diagnostics))?,
            fingerprint: recorded.fingerprint(),
        })
    }

    /// Plans the graph for a viewport in pixels on the session's GPU.
    ///
    /// # Errors
    /// The viewport is too large for this adapter.
    pub fn plan(
        &self,
        session: Session,
        viewport: [u32; 2],
        provider: &dyn Provider,
    ) -> Result<Plan> {
        let mut request = Capabilities::new(session.gpu).request(viewport, provider);
        request.outputs = Some(vec!["primitive".to_owned()]);
        let plan = self.graph.plan(&request);
        plan.map_err(|diagnostics| GraphFaults::one(GBUFFER, &diagnostics))
    }

    /// Renders and returns the id of the primitive that each pixel shows, row by row from the top
    /// left; [`BACKGROUND`](skiagraph_reference::BACKGROUND) for pixels without one.
    ///
    /// # Errors
    /// The graph cannot run, or has no output `primitive`.
    pub async fn ids(
        &self,
        session: Session<'_>,
        viewport: [u32; 2],
        provider: &mut dyn Provider,
    ) -> Result<Vec<u32>> {
        let plan = self.plan(session, viewport, provider)?;
        let rendered = frame::render(session, plan, provider, &["primitive"]).await;
        let (contents, _) = rendered.map_err(|error| frame::failed(session, GBUFFER, error))?;
        let ids = contents.get("primitive").and_then(Content::as_u32);
        let none = || format!("{GBUFFER} has no output `primitive` of integers");
        ids.ok_or_else(|| CompareError::Input(none()))
    }
}

/// Counts the [reference](crate#terms)'s pixels as [`Statistics::judged`] would count the pixels of
/// a method that gave exactly the reference's answers.
pub fn own_counts(truth: &GroundTruthPixels) -> Statistics {
    let (visibility, status) = (truth.visibility(), truth.status());
    // Its own buffers are as large as it is and hold values that are allowed.
    Statistics::judged(&visibility, &status, truth).unwrap_or_default()
}

/// Default number of shadow rays that the [reference](crate#terms) traces from a pixel to a light
/// [with an extent](crate#terms).
pub const REFERENCE_SAMPLES: u32 = 512;

/// Ground truth of one view in one viewport, with the scene data from which it was traced.
pub struct GroundTruthView<'a> {
    oracle: Rc<Oracle<'a>>,
    camera: Camera,
    light: LightKind,
    primitives: Vec<u32>,
    mode: OracleMode,
    /// The [reference](crate#terms)'s answer for each pixel: lit, in shadow, or a [share of
    /// light](crate#terms).
    pub ground_truth: GroundTruth,
    /// Number of pixels that the GPU rasterised with a surface that is hidden behind another one by
    /// more than rounding. Methods are judged on the rasterised surface nevertheless.
    pub wrong_surfaces: u64,
}

impl<'a> GroundTruthView<'a> {
    /// Runs the oracle (the `f64` ray tracer) for a camera and a light. `primitives` is the visible
    /// primitive of each pixel, as [`PrimaryVisibility::ids`] returns it. `how` is the oracle's
    /// mode, and the number of rays from a pixel to a light [with an extent](crate#terms).
    /// `listener` is a name, and the sink that receives the progress under it.
    ///
    /// # Errors
    /// An [early end](crate#terms), primitive ids of another mesh or in another number than the
    /// pixels, an invalid light, or an offset of the mode that the mesh does not allow.
    pub fn new(
        oracle: Rc<Oracle<'a>>,
        camera: Camera,
        light: LightKind,
        primitives: Vec<u32>,
        how: (OracleMode, u32),
        listener: (&str, &dyn Sink),
    ) -> Result<Self> {
        let truth = trace(&oracle, &camera, light, &primitives, how, listener)?;
        let (camera, seen) = ((camera, light), (primitives, how.0));
        Ok(Self::traced(oracle, camera, seen, truth))
    }

    /// Creates the ground truth from answers that were traced before, of the same inputs.
    pub(crate) fn traced(
        oracle: Rc<Oracle<'a>>,
        (camera, light): (Camera, LightKind),
        (primitives, mode): (Vec<u32>, OracleMode),
        truth: Truth,
    ) -> Self {
        Self {
            oracle,
            camera,
            light,
            primitives,
            mode,
            ground_truth: truth.ground_truth,
            wrong_surfaces: truth.wrong_surfaces,
        }
    }

    /// Returns the mesh, camera and visible primitives (triangles) of the view, as functions of the
    /// [reference](crate#terms) take them.
    pub fn seen(&self) -> Seen<'_> {
        Seen {
            mesh: self.oracle.mesh(),
            camera: &self.camera,
            primitives: &self.primitives,
        }
    }

    /// Counts the pixels that a method calls certain (by its output `status`) but gets wrong, by
    /// the kind of caster that blocks the light there. `truth` holds the right answers for these
    /// pixels, of a light without an extent.
    ///
    /// # Errors
    /// Outputs of another size than the [reference](crate#terms).
    pub fn blockers(&self, outputs: &Outputs, truth: &GroundTruthPixels) -> Result<BlockerCounts> {
        let (visibility, status) = (&outputs.visibility, &outputs.status);
        let pixels = Statistics::certain_wrong_pixels(visibility, status, truth);
        let (camera, light, primitives) = (&self.camera, &self.light, &self.primitives);
        let blockers = pixels.and_then(|pixels| {
            let oracle = &self.oracle;
            skiagraph_reference::blockers(oracle, camera, light, primitives, self.mode, &pixels)
        });
        blockers.map_err(|error| CompareError::Input(format!("no blockers: {error}")))
    }

    /// Counts the pixels that face a spot or point light and show a surface no farther from its
    /// centre than its radius. A lamp's points lie on a disk, so that a surface within its ball is
    /// answered as if the rest of the ball were not there. 0 for a directional light and for one
    /// without extent.
    pub fn inside_light(&self) -> u64 {
        let Some(radius) = self.light.radius() else {
            return 0;
        };
        let classes = self.ground_truth.pixels.classes.iter().enumerate();
        let facing = classes.filter(|(_, class)| radius > 0.0 && class.faces_light());
        let width = self.camera.viewport[0];
        let is_inside = |index: usize| {
            let pixel = [index as u32 % width, index as u32 / width];
            let (mesh, camera) = (self.oracle.mesh(), &self.camera);
            let receiver = Receiver::from_pixel(mesh, &self.primitives, camera, pixel, &self.light);
            // The oracle has found all of them before.
            matches!(receiver, Ok(Some(receiver)) if receiver.towards.distance <= radius)
        };
        facing.filter(|(index, _)| is_inside(*index)).count() as u64
    }

    /// Finds the caster nearest to each pixel's receiver on its ray to the light's centre, as
    /// [`nearest_blockers`] does.
    ///
    /// # Errors
    /// An [early end](crate#terms).
    pub fn nearest_blockers(&self, progress: Progress) -> Result<Vec<u32>> {
        let (oracle, camera, light) = (&self.oracle, &self.camera, self.light);
        let (primitives, mode) = (&self.primitives, self.mode);
        let blockers = nearest_blockers(oracle, camera, light, primitives, mode, progress);
        blockers.map_err(|_| CompareError::interrupted())
    }

    /// Measures how far a method's wrong pixels lie from the edges of the
    /// [reference](crate#terms)'s shadows. `truth` holds the right answers for these pixels.
    ///
    /// # Errors
    /// Outputs of another size than the reference.
    pub fn edges(&self, outputs: &Outputs, truth: &GroundTruthPixels) -> Result<EdgeDistances> {
        let (visibility, status) = (&outputs.visibility, &outputs.status);
        let edges = EdgeDistances::measured(self.seen(), visibility, status, truth);
        edges.map_err(|error| CompareError::Input(format!("no distances from edges: {error}")))
    }

    /// Returns each pixel's footprint (the area of the shadow map that it covers, in texels), row
    /// by row from the top left; `None` for a pixel that the map does not cover. `density` is the
    /// output `texel_density`, the map's texels per square unit of the scene at each pixel.
    ///
    /// # Errors
    /// A density of another length than the [reference](crate#terms)'s pixels.
    pub fn footprints(&self, density: &[f32]) -> Result<Vec<Option<Footprint>>> {
        let truth = &self.ground_truth.pixels;
        let footprints = texels::footprints(self.seen(), &self.light, density, truth);
        footprints.map_err(|error| CompareError::Input(format!("no texels per pixel: {error}")))
    }

    /// Measures how a method's errors differ between neighbouring pixels that read different layers
    /// of its shadow map. `layers` is the index of the layer that each pixel reads, the method's
    /// output [`MAP_LAYER`](crate::graphs::preset::MAP_LAYER), row by row from the top left; the
    /// values of pixels that do not face the light, or are indeterminate, do not count. Returns
    /// `None` if no [pair](LayerJump) of pixels reads different layers.
    ///
    /// # Errors
    /// Outputs or layers of another size than the [reference](crate#terms).
    pub fn layer_jump(&self, outputs: &Outputs, layers: &[u32]) -> Result<Option<LayerJump>> {
        let (truth, shares) = (&self.ground_truth.pixels, self.ground_truth.shares());
        let shown = outputs.shown();
        let jump = LayerJump::measured(self.seen(), [&shown, &shares], layers, truth);
        jump.map_err(|error| CompareError::Input(format!("no jump between layers: {error}")))
    }
}

/// Builds the oracle of a mesh, as a step with this name.
pub(crate) fn built_oracle<'m>(mesh: &'m Mesh, name: &str, sink: &dyn Sink) -> Rc<Oracle<'m>> {
    let step = Step::begin(sink, name, 1, "steps");
    let oracle = Rc::new(Oracle::new(mesh));
    step.end();
    oracle
}

/// Runs the oracle as [`GroundTruthView::new`] does, and returns its answers alone.
pub(crate) fn trace(
    oracle: &Oracle,
    camera: &Camera,
    light: LightKind,
    primitives: &[u32],
    how: (OracleMode, u32),
    (what, sink): (&str, &dyn Sink),
) -> Result<Truth> {
    let rows = camera.viewport[1];
    let failed = |error: Error| match error {
        Error::Interrupted => CompareError::interrupted(),
        error => CompareError::Input(format!("no reference for {what}: {error}")),
    };
    let ground_truth = by_rows(sink, &format!("reference, {what}"), rows, |progress| {
        let truth = area::ground_truth(oracle, camera, light, primitives, how, progress);
        truth.map_err(failed)
    })?;
    let name = format!("what is visible, {what}");
    let wrong_surfaces = by_rows(sink, &name, rows, |progress| {
        wrong_surfaces(oracle, camera, primitives, progress).map_err(failed)
    })?;
    Ok(Truth {
        ground_truth,
        wrong_surfaces,
    })
}

/// Frames of a still view or camera path with their ground truth.
pub struct GroundTruthFrames<'a> {
    /// Camera pose and mesh of each frame.
    pub frames: &'a FrameSequence,
    /// Ground truth of each frame, in order.
    pub truth_views: Vec<GroundTruthView<'a>>,
    /// `same[i]` matches frame `i + 1` with frame `i`. It has one entry per pixel of frame `i + 1`:
    /// the index of the pixel of frame `i` that shows the same surface point, or
    /// [`BACKGROUND`](skiagraph_reference::BACKGROUND) if there is none.
    pub same: Vec<Vec<u32>>,
}

impl<'a> GroundTruthFrames<'a> {
    /// Matches the visible surface points of each frame with those of the frame before.
    /// `truth_views` has one entry per frame, in order.
    ///
    /// # Errors
    /// [`CompareError::Interrupted`].
    pub fn new(
        frames: &'a FrameSequence,
        truth_views: Vec<GroundTruthView<'a>>,
        sink: &dyn Sink,
    ) -> Result<Self> {
        let progress = heard(sink, &|_| ());
        let pairs = truth_views.windows(2);
        let same = pairs.map(|pair| same_receivers(pair[0].seen(), pair[1].seen(), progress));
        let same = same.collect::<Result<_, _>>();
        let same = same.map_err(|_| CompareError::interrupted())?;
        Ok(Self {
            frames,
            truth_views,
            same,
        })
    }

    /// Returns the number of pixels, over all frames, that the GPU rasterised with a surface that
    /// is hidden behind another one by more than rounding.
    pub fn wrong_surfaces(&self) -> u64 {
        let truth_views = self.truth_views.iter();
        truth_views.map(|view| view.wrong_surfaces).sum()
    }

    /// Counts the pixels of the [reference](crate#terms) itself over all frames, as [`own_counts`]
    /// does for one.
    pub fn own_counts(&self) -> Statistics {
        let mut total = Statistics::default();
        for truth_view in &self.truth_views {
            total += own_counts(&truth_view.ground_truth.pixels);
        }
        total
    }
}

/// Does `work` of the oracle on `rows` rows of pixels as a step of the sink.
pub(crate) fn by_rows<T>(
    sink: &dyn Sink,
    name: &str,
    rows: u32,
    work: impl FnOnce(Progress) -> Result<T>,
) -> Result<T> {
    let step = Step::begin(sink, name, rows.into(), "rows");
    let outcome = work(heard(sink, &|rows| step.set_done(rows)))?;
    step.end();
    Ok(outcome)
}

/// Creates the progress callback of an oracle. It calls `rows_done` with the number of finished
/// rows of pixels, and stops the [oracle](crate#terms) when the sink asks for an early end.
pub fn heard<'a>(sink: &'a dyn Sink, rows_done: &'a (dyn Fn(u64) + Sync)) -> Progress<'a> {
    Progress {
        rows_done,
        interrupted: sink.stop(),
    }
}
