//! Tries settings of a method on some views: runs and judges each once.

use crate::error::{CompareError, Result};
use crate::graphs::contract::layer_of;
use crate::graphs::ground_truth;
use crate::graphs::light_kinds::{self, kind_and_number};
use crate::graphs::method::{Method, ParamValues};
use crate::graphs::planning::Capabilities;
use crate::measuring::frame_sequence::FrameSequence;
use crate::measuring::ground_truth::GroundTruthView;
use crate::measuring::run::scene_bytes;
use crate::measuring::search::Trial;
use crate::measuring::stop::{Stop, attempt};
use crate::measuring::view_or_path::ViewOrPath;
use crate::measuring::{frame, timing};
use crate::records::budgets::Budgets;
use crate::sink::Session;
use itertools::Itertools;
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::Plan;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{LightKind, View};

/// A view on which settings are tried, with its ground truth.
pub struct TrialView<'a> {
    /// The view on which settings are tried.
    pub view: View,
    /// Light under which the view is drawn.
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

/// Limits of work, frame time and memory for trials.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Number of plans and frames that may be run, added up.
    pub work: u64,
    /// Limits of frame time and memory that a setting must keep to.
    pub budgets: Budgets,
    /// True if GPU times can be trusted; otherwise the limit of frame time is one of wall times.
    pub has_timestamps: bool,
}

/// Frames before the timed ones, and timed ones, by which a budget of time is checked; and the
/// share of the budget that they may take, as other views may take longer.
const TIMED: [u32; 2] = [1, 5];
const MARGIN: f64 = 0.9;

/// Tries settings of one method on the views whose kind of light it takes.
pub struct Trials<'a> {
    session: Session<'a>,
    method: &'a Method,
    /// The views, those first on which the last whole trial was most wrong: a setting that is
    /// worse is then found out soon.
    views: Vec<&'a TrialView<'a>>,
    viewport: [u32; 2],
    provider: &'a mut SceneProvider,
    pub limits: Limits,
    /// True to answer [`Trial::Worse`] for settings beyond the limit of memory.
    pub holds_memory: bool,
    /// Executor of the last setting.
    executor: Option<Executor>,
    /// Pixels facing the light, over all views; of 0 no setting can be judged.
    pub facing_light: f64,
    /// Work that may still be done: a plan or a frame is one.
    pub left: u64,
}

impl<'a> Trials<'a> {
    /// Prepares trials of a method on those of `views` whose kind of light it takes, in the
    /// method's viewport.
    pub fn new(
        session: Session<'a>,
        method: &'a Method,
        views: &'a [TrialView<'a>],
        provider: &'a mut SceneProvider,
        limits: Limits,
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
            limits,
            holds_memory: false,
            executor: None,
            left: limits.work,
        }
    }

    /// Tries the method with `params` on all views, and returns its error: the share of wrong
    /// pixels, or under lights with an extent the mean square error. Returns [`Trial::Worse`] as
    /// soon as it must be greater than `best`.
    ///
    /// # Errors
    /// An early end; a lost device.
    pub async fn run(&mut self, params: &ParamValues, best: f64) -> Result<Trial> {
        self.session.check_stopped()?;
        if self.left < 1 + self.views.len() as u64 {
            return Ok(Trial::Ended);
        }
        let set = self.method.with(params.clone());
        if self.has_idle_param(&set) {
            return Ok(Trial::Same);
        }
        if self.holds_memory && !self.is_small(params)? {
            return Ok(Trial::Worse);
        }
        let trial = self.judged(&set, best).await;
        match attempt(self.session, self.method, trial) {
            Err(CompareError::InvalidOutputs(_)) => Ok(Trial::Worse),
            trial => trial.map(|trial| trial.unwrap_or(Trial::Worse)),
        }
    }

    /// True if the method with `params` keeps to the limit of memory under each kind of light, or
    /// if there is none.
    ///
    /// # Errors
    /// A lost device.
    pub fn is_small(&mut self, params: &ParamValues) -> Result<bool> {
        let Some(most) = self.limits.budgets.memory_bytes else {
            return Ok(true);
        };
        let set = self.method.with(params.clone());
        for view in self.one_of_each_light() {
            self.provider.set_view(&view.view, self.viewport);
            let Some(plan) = self.planned(&set) else {
                return Ok(false);
            };
            let scene = scene_bytes(self.session, &plan, self.provider);
            match attempt(self.session, &set, scene)? {
                Ok(scene) if plan.memory_bytes() + scene <= most => {}
                _ => return Ok(false),
            }
        }
        Ok(true)
    }

    /// True if a frame of the method with `params` takes at most nine tenths of the limit of frame
    /// time, on the view with most errors, or if there is no limit. False if the method cannot run.
    ///
    /// # Errors
    /// An early end, a lost device.
    pub async fn is_quick(&mut self, params: &ParamValues) -> Result<bool> {
        let (Some(most), Some(view)) = (self.limits.budgets.frame_ms, self.views.first()) else {
            return Ok(true);
        };
        let set = self.method.with(params.clone());
        self.provider.set_view(&view.view, self.viewport);
        let timed = self.timed(&set, &view.view).await;
        Ok(match attempt(self.session, &set, timed)? {
            Ok(Some(ms)) => ms <= MARGIN * most,
            Ok(None) | Err(_) => false,
        })
    }

    /// One view for each kind of light and number of lights: others may need other plans.
    fn one_of_each_light(&mut self) -> Vec<&'a TrialView<'a>> {
        let lights = |view: &&TrialView| {
            self.provider.set_view(&view.view, self.viewport);
            kind_and_number(self.provider)
        };
        self.views.iter().copied().unique_by(lights).collect()
    }

    /// Median milliseconds of a frame with every pass; `None` if it cannot be planned.
    async fn timed(&mut self, set: &Method, view: &View) -> Result<Option<f64>, Stop> {
        let (true, Some(executor)) = (self.plan(set)?, &mut self.executor) else {
            return Ok(None);
        };
        executor.refresh(self.provider)?;
        frame::grow(self.session, executor, self.provider).await?;
        let still = ViewOrPath::Still(view.clone());
        let frames = FrameSequence::new(&still, self.provider.scene(), None, None)?;
        let drawn = (executor, &*self.provider);
        let timed = timing::sample(self.session, &frames, drawn, TIMED, |_| ()).await?;
        let (frame, _) = timing::times(&timed, self.limits.has_timestamps)?;
        let spread = frame.spread(false).or_else(|| frame.spread(true));
        Ok(spread.map(|spread| spread.median))
    }

    /// True if a param of a setting has no effect under any light: without it the setting is the
    /// same.
    fn has_idle_param(&mut self, set: &Method) -> bool {
        let new = set.params.keys();
        let new = new.filter(|name| !self.method.params.contains_key(*name));
        let mut idle: Vec<&String> = new.collect();
        for view in self.one_of_each_light() {
            if idle.is_empty() {
                return false;
            }
            self.provider.set_view(&view.view, self.viewport);
            let Some(plan) = self.planned(set) else {
                return false;
            };
            let names = plan.idle_params();
            idle.retain(|name| names.contains(&name.as_str()));
        }
        !idle.is_empty()
    }

    async fn judged(&mut self, set: &Method, best: f64) -> Result<Trial, Stop> {
        let (mut error, mut planned) = (0.0, None);
        let mut errors: Vec<(f64, &TrialView)> = Vec::new();
        for view in self.views.clone() {
            self.provider.set_view(&view.view, self.viewport);
            let lights = kind_and_number(self.provider);
            if planned != Some(lights) {
                if !self.plan(set)? {
                    return Ok(Trial::Worse);
                }
                planned = Some(lights);
            }
            let wrong = self.error_on(set, view).await?;
            errors.push((wrong, view));
            error += wrong / self.counted(view);
            if error > best {
                return Ok(Trial::Worse);
            }
        }
        errors.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        self.views = errors.into_iter().map(|(_, view)| view).collect();
        Ok(Trial::Error(error))
    }

    /// The number that the wrong pixels of a view are divided by: views count alike, however many
    /// of their pixels face the light, but for those with hardly any, of which one pixel says
    /// little.
    fn counted(&self, view: &TrialView) -> f64 {
        let views = self.views.len() as f64;
        let least = (self.facing_light / (4.0 * views)).max(1.0);
        views * view.facing_light().max(least)
    }

    /// The plan of a setting under the light of the provider; `None` if there is none.
    fn planned(&self, set: &Method) -> Option<Plan> {
        let capabilities = Capabilities::new(self.session.gpu);
        set.plan(self.viewport, capabilities, self.provider).ok()
    }

    /// Plans a setting under the light of the provider; false if it cannot run, or if it remembers
    /// earlier frames: one frame shows nothing of a method that needs many.
    fn plan(&mut self, set: &Method) -> Result<bool, Stop> {
        self.left = self.left.saturating_sub(1);
        let Some(plan) = self.planned(set).filter(|plan| !plan.remembers()) else {
            return Ok(false);
        };
        self.executor = Some(match self.executor.take() {
            Some(mut executor) => {
                executor.replace_graph(plan, self.provider)?;
                executor
            }
            None => Executor::on(self.session.gpu, plan, self.provider)?,
        });
        Ok(true)
    }

    /// Error on one view, in pixels: wrong ones outside the band, or the sum of squared errors of
    /// the shares of light.
    async fn error_on(&mut self, set: &Method, view: &TrialView<'_>) -> Result<f64, Stop> {
        let Some(executor) = &mut self.executor else {
            return Ok(f64::INFINITY);
        };
        executor.refresh(self.provider)?;
        let growth = frame::grow(self.session, executor, self.provider).await?;
        let names = set.preset.judged();
        let request = Frame::new().with_all(true).with_read(&names);
        let (report, _) = frame::run(self.session, executor, &request).await?;
        self.left = self.left.saturating_sub(1 + u64::from(growth.frames));
        let layer = layer_of(executor.plan(), self.provider.light_number()).unwrap_or_default();
        let shown = (frame::contents(report.readbacks), layer);
        let truth = &view.truth.ground_truth;
        Ok(ground_truth::error(&set.preset, shown, truth)?)
    }
}
