//! Describes a comparison: methods, a scene, views or camera paths, viewports and the protocol.
//!
//! ```
//! use skiagraph_compare::{comparison::Comparison, graphs::shadow_method::load_methods};
//! use skiagraph_passes::EmbeddedSources;
//! use skiagraph_scene::SceneLibrary;
//! use std::{collections::BTreeMap, sync::Arc};
//!
//! let (scene, _) = SceneLibrary::default().load("park")?;
//! let methods = load_methods(&["rt", "nsm@bias=0"], &[], &[512, 1024], &EmbeddedSources)?;
//! let mut comparison = Comparison::new(Arc::new(scene), methods)?;
//! comparison.viewports = vec![[640, 360], [1280, 720]];
//! comparison.views.truncate(1);
//! comparison.protocol.frames = 100;
//! assert_eq!(comparison.methods.len(), 3); // `rt` has no map
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::fingerprint::Fingerprint;
use crate::graphs::faults::GraphFaults;
use crate::graphs::idle_params::IdleParams;
use crate::graphs::light_kinds::kind_and_number;
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::graphs::shadow_method::PlanCheck;
use crate::measuring::frame_sequence::MovingParts;
use crate::measuring::ground_truth::{PrimaryVisibility, REFERENCE_SAMPLES};
use crate::measuring::view_or_path::ViewOrPath;
use crate::pictures::data::DataFormat;
use crate::pictures::run_pictures::{check_stems, reference_stem, stem};
use crate::records::budgets::Budgets;
use crate::records::published_row::Row;
use crate::records::tuned::Tuned;
use crate::sink::Session;
use itertools::Itertools;
use skiagraph_passes::{EmbeddedSources, SceneProvider};
use skiagraph_reference::OracleMode;
use skiagraph_scene::{LightKind, Scene};
use std::{collections::BTreeMap, sync::Arc};

/// Settings of how methods are run, timed and judged. Defaults: 10 timed frames after 2 warm-up
/// frames, 10 frames of each regime, no jitter, [`OracleMode::Exact`], 512
/// reference samples, no files.
#[derive(Clone, Copy, Debug)]
pub struct Protocol {
    /// Number of timed frames of a still view, at least 1; each frame of a camera path is timed
    /// once. The frame that is judged and pictured is an extra one, so that its readback is not
    /// timed.
    pub frames: u32,
    /// Number of untimed warm-up frames before the timed ones; on a camera path its first frame is
    /// repeated so often.
    pub warmup: u32,
    /// Number of timed frames of each [regime](crate::records::regimes::Regime): before each the
    /// same has moved (nothing, the camera, the light, meshes), and passes with unchanged inputs
    /// are skipped; 0 to time none.
    pub regime_frames: u32,
    /// Number of sample positions within a pixel (0 counts as 1) that the camera takes in turns
    /// along a camera path, frame by frame; the [reference](crate#terms) samples the same ones. All
    /// frames of a still view sample the first. `None` to sample the pixel's centre.
    pub jitter: Option<u32>,
    /// Mode of the reference, an `f64` ray tracer (the oracle): its shadow rays start exactly on
    /// the visible surfaces, or at an offset from them.
    pub oracle: OracleMode,
    /// Least number of shadow rays that the [reference](crate#terms) traces from a pixel to a light
    /// [with an extent](crate#terms), rounded up to an even number of at least four; other lights
    /// take one ray.
    pub reference_samples: u32,
    /// True if pictures of every run are written into the folder of the results; on a camera path,
    /// of its worst frame ([`Images::frame`](crate::records::results::Images::frame)).
    pub pictures: bool,
    /// Format of the files with the visibility and status of each pixel, by every run and by the
    /// [reference](crate#terms), that are written into the folder of the results
    /// ([`judged`](crate::pictures::data::judged)), on a camera path of its worst frame; `None` to
    /// write none.
    pub data: Option<DataFormat>,
}

impl Default for Protocol {
    fn default() -> Self {
        Self {
            frames: 10,
            warmup: 2,
            regime_frames: 10,
            jitter: None,
            oracle: OracleMode::Exact,
            reference_samples: REFERENCE_SAMPLES,
            pictures: false,
            data: None,
        }
    }
}

/// Methods, a scene, views or camera paths, viewports and the protocol. Every method runs on every
/// view or path in every viewport.
pub struct Comparison {
    /// The scene that the methods draw.
    pub scene: Arc<Scene>,
    /// Still views and camera paths from which the scene is seen, each under its default light
    /// ([`Scene::light_of`]); [`under_lights`](crate::measuring::view_or_path::under_lights) makes
    /// one view for each light.
    pub views: Vec<ViewOrPath>,
    /// Width and height of each viewport in pixels; these replace [`Method::viewport`].
    pub viewports: Vec<[u32; 2]>,
    /// The methods, each with one setting of its params. Every method runs in every viewport.
    pub methods: Vec<Method>,
    /// Settings of how the methods are run, timed and judged.
    pub protocol: Protocol,
    /// Records of the searches that chose params of methods, by the index of the method in
    /// `methods`: see [`tune`](crate::measuring::tune::tune). Empty if no search was made.
    pub tuned: BTreeMap<usize, Tuned>,
    /// Graph that finds on the GPU which triangle each pixel shows; the [reference](crate#terms)
    /// then finds the exact shadow on that triangle.
    pub primary: PrimaryVisibility,
    /// Limits on frame time, wrong pixels and memory. They change no measurement: the results
    /// record them, and a report recommends no method that exceeds one.
    pub budgets: Budgets,
    /// Published figures, such as those of a paper. Figures for the scene, view, viewport, map size
    /// and preset of a run are shown beside the run's own.
    /// [`read`](crate::records::published::read) reads them from files.
    pub published: Vec<Row>,
    /// Command line that the results record, so that the measurement can be repeated; `None` to
    /// record none.
    pub command: Option<String>,
    /// Commit that the measuring program was built from, for the results to record; `None` to
    /// record none.
    pub commit: Option<String>,
    /// Notes on the scene for the results to record, such as its import's repairs and the
    /// [parts chosen for it](crate::own_scene_notes::notes), one line each; empty to record none.
    pub notes: Vec<String>,
    /// Parts of the mesh that move on a path of the scene: on still views, too, frames are timed
    /// before which they have moved. `None` for a scene that stands still, or to time none.
    pub moving: Option<Arc<MovingParts>>,
}

impl Comparison {
    /// Creates a comparison of methods on all views of a scene, in 512×512 pixels with the default
    /// protocol.
    ///
    /// # Errors
    /// The built-in G-buffer cannot be loaded.
    pub fn new(scene: Arc<Scene>, methods: Vec<Method>) -> Result<Self> {
        let views = scene.views.iter().cloned().map(ViewOrPath::Still);
        Ok(Self {
            views: views.collect(),
            viewports: vec![[512, 512]],
            methods,
            protocol: Protocol::default(),
            tuned: BTreeMap::new(),
            primary: PrimaryVisibility::load(&EmbeddedSources)?,
            budgets: Budgets::default(),
            published: Vec::new(),
            command: None,
            commit: None,
            notes: Vec::new(),
            moving: None,
            scene,
        })
    }

    /// Checks a comparison before it runs: plans every method in every viewport and under every
    /// kind of light, so that a mistake in the last one is found at once. Tells the session's sink
    /// the mistakes of documents, and which params were set but have no effect.
    ///
    /// # Errors
    /// A protocol without timed frames; no method that can be planned, with the reasons of all; a
    /// GPU that cannot run the graph of the visible triangles in a viewport; runs whose pictures
    /// would have the same file name.
    pub fn check(&self, session: Session) -> Result<()> {
        self.refusals(session)?.none_or_error()
    }

    /// Checks a comparison as [`check`](Self::check) does. If no method can be planned, the reasons
    /// of all are returned, so that comparisons of other scenes may go on.
    ///
    /// # Errors
    /// The other errors of [`check`](Self::check).
    pub fn refusals(&self, session: Session) -> Result<GraphFaults> {
        if self.protocol.frames == 0 {
            let text = "a comparison needs at least one timed frame (`Protocol::frames`)";
            return Err(CompareError::Input(text.to_owned()));
        }
        let device = Capabilities::new(session.gpu);
        let mut provider = SceneProvider::new(self.scene.clone());
        if self.protocol.pictures || self.protocol.data.is_some() {
            self.check_pictures(session)?;
        }
        for &viewport in &self.viewports {
            self.primary.plan(session, viewport, &provider)?;
        }
        // A provider describes the same for all views under lights of one kind and number.
        let (methods, mut idle) = (&self.methods, IdleParams::default());
        let mut plans = PlanCheck::default();
        let lights = |view: &&ViewOrPath| {
            provider.set_view(view.view(), [1; 2]);
            kind_and_number(&provider)
        };
        let views: Vec<&ViewOrPath> = self.views.iter().unique_by(lights).collect();
        for view in views {
            provider.set_view(view.view(), [1; 2]);
            plans.add(methods, &self.viewports, &provider, &device);
            idle.note(session.sink, methods, &device, &provider);
        }
        Ok(plans.end(session.sink))
    }

    /// Returns the methods with the params that they have on the session's GPU
    /// ([`Method::settled`]): default values may depend on its features.
    pub fn settled(&self, session: Session) -> Vec<Method> {
        let features = session.gpu.device.features();
        let methods = self.methods.iter().cloned();
        methods.map(|method| method.settled(features)).collect()
    }

    /// Returns the first light of each kind (directional, spot, point) that the views are under, in
    /// the order of the views.
    pub fn kinds_of_light(&self) -> Vec<LightKind> {
        let lights = self.views.iter().map(|view| view.light(&self.scene));
        lights.unique_by(|light| light.word()).collect()
    }

    /// Hashes the inputs that all runs share: mesh, lights, the graph of the visible triangles, and
    /// the protocol's rays and jitter.
    pub(crate) fn fingerprint(&self) -> Fingerprint {
        let (scene, primary) = (&self.scene, self.primary.fingerprint);
        let mut fingerprint = primary.with_scene(&scene.mesh, &scene.lights);
        if self.views.iter().any(|view| view.light(scene).has_extent()) {
            fingerprint = fingerprint.with_text(&self.protocol.reference_samples.to_string());
        }
        match self.protocol.jitter {
            Some(count) => fingerprint.with_text(&format!("jitter {count}")),
            None => fingerprint,
        }
    }

    /// Refuses runs that would overwrite each other's pictures.
    fn check_pictures(&self, session: Session) -> Result<()> {
        let methods = self.settled(session);
        let mut stems = Vec::new();
        for view in &self.views {
            let view = view.name();
            for &viewport in &self.viewports {
                stems.extend(methods.iter().map(|method| {
                    let owner = format!("`{}` on view `{view}`", method.name);
                    (stem(method, view, viewport), owner)
                }));
                let owner = format!("the reference on view `{view}`");
                stems.push((reference_stem(view, viewport), owner));
            }
        }
        check_stems(stems)
    }
}
