//! A scene under a view, the oracle's word on it, and what runs presets on it.

use super::graphs::{allow_ray_queries, open, plan, plan_with, provider, run_on, values};
use skiagraph_gpu::device::Gpu;
use skiagraph_graph::{Capture, ParamValue, Sources};
use skiagraph_passes::{EmbeddedSources, SceneProvider};
use skiagraph_reference::{
    GroundTruthPixels, Oracle, OracleMode, PixelCounts, Progress, Statistics, statistics::status,
};
use skiagraph_scene::{Scene, View};
use std::sync::Arc;

/// Answers of a preset, pixel by pixel, and the oracle.
pub struct Answers {
    pub visibility: Vec<u32>,
    pub status: Vec<u32>,
    pub primitives: Vec<u32>,
    pub truth: GroundTruthPixels,
    pub counts: Statistics,
}

impl Answers {
    /// Number of pixels that face the light and asked no ray.
    pub fn certain(&self) -> usize {
        let is_certain =
            |word: &&u32| [status::CERTAIN_LIGHT, status::CERTAIN_SHADOW].contains(word);
        self.status.iter().filter(is_certain).count()
    }
}

/// A scene under a view, its oracle, and what runs graphs on it.
pub struct Bench<'a> {
    pub scene: &'a Scene,
    view: &'a View,
    viewport: [u32; 2],
    pub gpu: Gpu,
    provider: SceneProvider,
    oracle: Oracle<'a>,
}

impl<'a> Bench<'a> {
    pub fn new(scene: &'a Arc<Scene>, viewport: [u32; 2]) -> Self {
        let view = &scene.views[0];
        let provider = provider(scene, view, viewport);
        Self {
            scene,
            view,
            viewport,
            gpu: open(),
            provider,
            oracle: Oracle::new(&scene.mesh),
        }
    }

    pub fn look(&mut self, view: &'a View) {
        self.view = view;
        self.provider.set_view(view, self.viewport);
    }

    /// Judges a preset's outputs by the oracle, for the primitives that the preset saw itself.
    pub fn judge(&mut self, preset: &str, params: &[(&str, ParamValue)]) -> Statistics {
        self.answers(preset, params).counts
    }

    /// A preset's answers, and what the oracle says of them.
    pub fn answers(&mut self, preset: &str, params: &[(&str, ParamValue)]) -> Answers {
        self.answers_with(&EmbeddedSources, preset, params)
    }

    /// The same by a preset, and shaders, from other files.
    pub fn answers_with(
        &mut self,
        sources: &dyn Sources,
        preset: &str,
        params: &[(&str, ParamValue)],
    ) -> Answers {
        let plan = plan_with(
            sources,
            &format!("pipelines/{preset}.ron"),
            &self.provider,
            self.viewport,
            |request| {
                request.captures.push(Capture::new("primitive"));
                allow_ray_queries(request);
                request.params.extend(
                    params
                        .iter()
                        .map(|(name, value)| ((*name).to_owned(), value.clone())),
                );
            },
        );
        let report = run_on(
            &self.gpu,
            plan,
            &mut self.provider,
            &["visibility", "status", "primitive"],
        );
        let primitives = values(&report, "primitive");
        let camera = self.view.camera(self.viewport);
        let light = self.scene.light();
        let truth = self
            .oracle
            .shade(
                &camera,
                light,
                &primitives,
                OracleMode::Exact,
                Progress::default(),
            )
            .unwrap();
        let (visibility, status) = (values(&report, "visibility"), values(&report, "status"));
        let counts = Statistics::judged(&visibility, &status, &truth).unwrap();
        println!(
            "{preset} {} {} {:?} {params:?}: {counts:?}",
            self.scene.name, self.view.name, self.viewport
        );
        Answers {
            visibility,
            status,
            primitives,
            truth,
            counts,
        }
    }

    /// The oracle's pixels, for the primitives of the G-buffer.
    pub fn reference_pixels(&mut self, mode: OracleMode) -> PixelCounts {
        let gbuffer = "pipelines/shared/gbuffer.ron";
        let plan = plan(gbuffer, &self.provider, self.viewport, |_| {});
        let report = run_on(&self.gpu, plan, &mut self.provider, &["primitive"]);
        let (primitives, progress) = (values(&report, "primitive"), Progress::default());
        let (camera, light) = (self.view.camera(self.viewport), self.scene.light());
        let shaded = self
            .oracle
            .shade(&camera, light, &primitives, mode, progress);
        let truth = shaded.unwrap();
        Statistics::judged(&truth.visibility(), &truth.status(), &truth)
            .unwrap()
            .pixels
    }

    /// Traced, no pixel is wrong but indeterminate ones, which are few.
    pub fn rt_is_exact(&mut self) {
        let counts = self.judge("rt", &[]);
        assert!(
            counts.pixels.lit > 0 && counts.pixels.shadow > 0,
            "{counts:?}"
        );
        assert_eq!(
            counts.wrong.total - counts.wrong.in_band,
            0,
            "{}: {counts:?}",
            self.view.name
        );
        // A case all of which is indeterminate proves nothing.
        assert!(
            counts.indeterminate_share() < 3e-3,
            "{}: {counts:?}",
            self.view.name
        );
    }
}
