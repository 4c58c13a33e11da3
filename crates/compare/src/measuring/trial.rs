//! Trials of a method's settings on some views: each is run and judged once, without being timed.

use crate::error::CompareError;
use crate::graphs::method::{Method, ParamValues};
use crate::graphs::planning::Capabilities;
use crate::graphs::shadow_method::Outputs;
use crate::graphs::{ground_truth, light_kinds};
use crate::measuring::frame;
use crate::measuring::ground_truth::GroundTruthView;
use crate::measuring::run::scene_bytes;
use crate::measuring::search::Trial;
use crate::measuring::stop::{Stop, attempt};
use crate::sink::Session;
use itertools::Itertools;
use skiagraph_gpu::{Executor, Frame};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{LightKind, View};

/// A view on which settings are tried, with its ground truth.
pub struct TrialView<'a> {
    /// The view.
    pub view: View,
    /// Its light.
    pub light: LightKind,
    /// The ground truth of the view in the viewport of the trials.
    pub truth: GroundTruthView<'a>,
}

impl TrialView<'_> {
    /// Number of pixels that are judged: those that face the light.
    fn facing_light(&self) -> f64 {
        let classes = &self.truth.ground_truth.pixels.classes;
        classes.iter().filter(|class| class.faces_light()).count() as f64
    }
}

/// Runs settings of one method on the views that take part.
pub struct Trials<'a> {
    session: Session<'a>,
    method: &'a Method,
    /// The views, those first on which the last whole trial was most wrong: a setting that is
    /// worse is then found out soon.
    views: Vec<&'a TrialView<'a>>,
    viewport: [u32; 2],
    provider: &'a mut SceneProvider,
    /// Most bytes that the method and the scene data that it reads may take; `None` for any.
    most_bytes: Option<u64>,
    /// Executor of the last setting, and the kind of light that it is planned for.
    executor: Option<(Executor, &'static str)>,
    /// Pixels facing the light, over all views.
    facing_light: f64,
    /// Work that may still be done: a plan or a frame is one.
    left: u64,
}

impl<'a> Trials<'a> {
    /// Prepares trials of a method on the views whose kind of light it takes. `most` is the work
    /// that may be done; making a plan counts one, and so does running a frame.
    pub fn new(
        session: Session<'a>,
        method: &'a Method,
        views: &'a [TrialView<'a>],
        provider: &'a mut SceneProvider,
        (most, most_bytes): (u64, Option<u64>),
    ) -> Self {
        let takes = |view: &&TrialView| light_kinds::takes(&method.preset.graph, view.light.word());
        let views: Vec<&TrialView> = views.iter().filter(takes).collect();
        Self {
            session,
            viewport: method.viewport,
            method,
            facing_light: views.iter().map(|view| view.facing_light()).sum(),
            views,
            provider,
            most_bytes,
            executor: None,
            left: most,
        }
    }

    /// Work that may still be done.
    pub fn left(&self) -> u64 {
        self.left
    }

    /// Tries the method with `params`. Ends as soon as its error must be greater than `best`.
    ///
    /// # Errors
    /// An early end, a lost device, outputs that are not a shadow method's.
    pub fn run(&mut self, params: &ParamValues, best: f64) -> Result<Trial, CompareError> {
        self.session.check_stopped()?;
        if self.left < 1 + self.views.len() as u64 {
            return Ok(Trial::Ended);
        }
        let method = self.method;
        let preset = method.preset.clone();
        let set = Method::on(preset, params.clone(), self.viewport, method.features);
        let set = set.named(&method.name);
        if self.has_idle_param(&set) {
            return Ok(Trial::Same);
        }
        let came = self.judged(&set, best);
        match attempt(self.session, method, came)? {
            Ok(trial) => Ok(trial),
            Err(_refused) => Ok(Trial::Worse),
        }
    }

    /// True if a param of a setting has no effect under any light: without it the setting is the
    /// same.
    fn has_idle_param(&mut self, set: &Method) -> bool {
        let new = set.params.keys();
        let mut idle: Vec<&String> = new
            .filter(|name| !self.method.params.contains_key(*name))
            .collect();
        for view in self.views.iter().unique_by(|view| view.light.word()) {
            if idle.is_empty() {
                return false;
            }
            self.provider.set_view(&view.view, self.viewport);
            let capabilities = Capabilities::new(self.session.gpu);
            let Ok(plan) = set.plan(self.viewport, capabilities, self.provider) else {
                return false;
            };
            let names = plan.idle_params();
            idle.retain(|name| names.contains(&name.as_str()));
        }
        !idle.is_empty()
    }

    fn judged(&mut self, set: &Method, best: f64) -> Result<Trial, Stop> {
        let (mut error, mut planned) = (0.0, None);
        let mut errors: Vec<(f64, &TrialView)> = Vec::new();
        for view in self.views.clone() {
            self.provider.set_view(&view.view, self.viewport);
            let kind = view.light.word();
            if planned != Some(kind) {
                if !self.plan(set, kind)? {
                    return Ok(Trial::Worse);
                }
                planned = Some(kind);
            }
            let wrong = self.error_on(set, view)?;
            errors.push((wrong, view));
            error += wrong / self.facing_light.max(1.0);
            if error > best {
                return Ok(Trial::Worse);
            }
        }
        errors.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        self.views = errors.into_iter().map(|(_, view)| view).collect();
        Ok(Trial::Error(error))
    }

    /// Plans a setting under the light of the provider; false if it cannot run, or needs too much
    /// memory.
    fn plan(&mut self, set: &Method, kind: &'static str) -> Result<bool, Stop> {
        self.left = self.left.saturating_sub(1);
        let capabilities = Capabilities::new(self.session.gpu);
        let Ok(plan) = set.plan(self.viewport, capabilities, self.provider) else {
            return Ok(false);
        };
        if let Some(most) = self.most_bytes {
            let scene = scene_bytes(self.session, &plan, self.provider)?;
            if plan.memory_bytes() + scene > most {
                return Ok(false);
            }
        }
        self.executor = Some(match self.executor.take() {
            Some((mut executor, before)) if before == kind => {
                executor.replace_graph(plan, self.provider)?;
                (executor, kind)
            }
            _ => (frame::executor(self.session, plan, self.provider)?, kind),
        });
        Ok(true)
    }

    /// Error on one view, in pixels: wrong ones outside the band, or the sum of squared errors of
    /// the shares of light.
    fn error_on(&mut self, set: &Method, view: &TrialView) -> Result<f64, Stop> {
        let Some((executor, _)) = &mut self.executor else {
            return Ok(f64::INFINITY);
        };
        executor.refresh(self.provider)?;
        let growth = frame::grow(self.session, executor, self.provider)?;
        let names = set.preset.judged();
        let request = Frame {
            all: true,
            read: &names,
            ..Frame::default()
        };
        let (report, _) = frame::run(self.session, executor, &request)?;
        self.left = self.left.saturating_sub(1 + u64::from(growth.frames));
        let contents = frame::contents(report.readbacks);
        let truth = &view.truth.ground_truth;
        let light = self.provider.light_number();
        let outputs = Outputs::from_contents(contents, light, &truth.pixels);
        Ok(ground_truth::error(&set.preset, outputs, truth)?)
    }
}
