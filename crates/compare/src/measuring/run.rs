//! One run: a method on one view, executed, timed, judged and pictured.

use crate::error::CompareError;
use crate::files::fingerprint::Fingerprint;
use crate::graphs::faults::reasons;
use crate::graphs::ground_truth::{Judgement, judged};
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::diagnostics::{Diagnostics, diagnose};
use crate::measuring::ground_truth::GroundTruthView;
use crate::measuring::steady;
use crate::measuring::stop::{Stop, attempt};
use crate::measuring::timing::{self, FrameMode, Times};
use crate::measuring::{
    date,
    frame::{self, Contents},
    guarantee,
};
use crate::pictures::run_pictures::{PictureFile, PicturePlace, conditions, draw_pictures, stem};
use crate::records::results::{Answer, AreaReference, Images, Measured, Run};
use crate::records::statistics::FrameTimes;
use crate::records::steady::Steady;
use crate::sink::{Session, Step};
use skiagraph_gpu::{ExecuteError, Executor, Provider};
use skiagraph_graph::Plan;
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{GroundTruth, Statistics};
use std::cell::RefCell;

/// Context shared by all methods on one view and viewport.
pub struct MeasureContext<'a> {
    /// The GPU, and who hears of the work.
    pub session: Session<'a>,
    /// True if its timestamps are true.
    pub timestamps: bool,
    /// Name of the view.
    pub view: &'a str,
    /// Which of the view's lights it is under.
    pub light: usize,
    /// Hash of mesh, light and view.
    pub fingerprint: Fingerprint,
    /// The ground truth, and where it is from; of a path's first frame.
    pub truth_view: &'a GroundTruthView<'a>,
    /// The reference's own pixels, of all frames of a path.
    pub own: Statistics,
    /// Pixels that show a surface which is not seen there, of all frames of a path.
    pub wrong_surfaces: u64,
    /// Timed frames.
    pub frames: u64,
    /// Frames before them.
    pub warmup: u32,
    /// Timed frames in which only the camera moves.
    pub cached_frames: u32,
    /// The pictures of the last run, if there are to be any.
    pub pictures: Option<RefCell<Vec<PictureFile>>>,
}

/// A method whose buffers have grown, in its steady state where it remembers.
pub struct Prepared {
    /// Runs it.
    pub executor: Executor,
    /// Where it remembers.
    pub steady: Option<Steady>,
    memory: [u64; 2],
    scene_bytes: u64,
}

impl MeasureContext<'_> {
    /// Plans and runs a method by `run`: [`still`](Self::still), or
    /// [`follow`](crate::measuring::sequence). One that this adapter cannot run yields a [`Run`]
    /// that says why.
    ///
    /// # Errors
    /// Ctrl-C, a lost device, a picture that cannot be written, outputs that are not a shadow
    /// method's ([`CompareError::InvalidOutputs`]).
    pub fn measure(
        &self,
        method: &Method,
        provider: &mut SceneProvider,
        run: impl FnOnce(&Method, Plan, &mut SceneProvider, &Step) -> Result<Measured, Stop>,
    ) -> Result<Run, CompareError> {
        let viewport = self.truth_view.ground_truth.pixels.viewport;
        let plan = match method.plan(viewport, Capabilities::new(self.session.gpu), provider) {
            Ok(plan) => plan,
            // The graph itself is sound: that was checked before anything ran.
            Err(diagnostics) => return Ok(self.unavailable(method, reasons(&diagnostics))),
        };
        let name = conditions(method, self.view, viewport);
        let name = format!("{}, {name}", method.name);
        let frames = u64::from(self.warmup) + self.frames;
        let step = Step::begin(self.session.sink, &name, frames, "frames");
        let came = run(method, plan, provider, &step);
        let run = match attempt(self.session, method, came)? {
            Ok(measured) => Run {
                measured: Some(measured),
                ..self.empty(method)
            },
            Err(reason) => self.unavailable(method, reason),
        };
        step.end();
        Ok(run)
    }

    /// Runs, times and judges a method on one view. A method that remembers is judged first, in its
    /// steady state: what is timed behind that does not change what it shows.
    ///
    /// # Errors
    /// A method that the device refuses, and those of [`measure`](Self::measure).
    pub fn still(
        &self,
        method: &Method,
        plan: Plan,
        provider: &mut dyn Provider,
        step: &Step,
    ) -> Result<Measured, Stop> {
        let mut prepared = self.prepare(plan, provider)?;
        let executor = &mut prepared.executor;
        let ground_truth = &self.truth_view.ground_truth;
        let names = method.preset.judged();
        let judge = |contents| {
            let outputs = self.decode(contents, self.truth_view);
            judged(&method.preset, outputs, ground_truth)
        };
        let worst = match &mut prepared.steady {
            Some(steady) => Some(steady::judge(
                self.session,
                executor,
                &names,
                steady,
                judge,
            )?),
            None => None,
        };
        let (count, all) = ([self.warmup, self.frames as u32], FrameMode::AllPasses);
        let set_done = |frames| step.set_done(frames);
        let times = timing::times(self.session, executor, all, count, set_done)?;
        let mut cached = timing::cached(self.session, executor, self.cached_frames)?;
        if let Some(cached) = &mut cached {
            self.distrust(&mut cached.frame);
        }
        let (outputs, judgement) = match worst {
            Some(worst) => worst,
            // Only now: a readback would be timed, too.
            None => judge(frame::read(self.session, executor, &names)?)?,
        };
        let counts = &judgement.counts;
        let has_blockers = judgement.is_hard && counts.wrong.certain > 0;
        let blockers = has_blockers.then(|| self.truth_view.blockers(&outputs));
        let found = diagnose(
            self.session,
            method,
            self.truth_view,
            (&outputs, self.light),
            provider,
        )?;
        Ok(Measured {
            rays: outputs.rays,
            certain_wrong_blockers: blockers.transpose()?,
            graded: judgement.graded,
            edges: self.truth_view.edges(&outputs)?,
            cached,
            images: self.draw(method, None, ground_truth, (&outputs, &judgement, &found))?,
            texels: found.texels,
            layer_jump: found.layer_jump,
            ..self.measured(prepared, times, counts, outputs.shares.is_some())
        })
    }

    /// Makes a method's executor, and lets it run until it is in its steady state where it
    /// remembers.
    ///
    /// # Errors
    /// A method that the device refuses, Ctrl-C, a lost device.
    pub fn prepare(&self, plan: Plan, provider: &mut dyn Provider) -> Result<Prepared, Stop> {
        let mut executor = frame::executor(self.session, plan, provider)?;
        frame::grow(self.session, &mut executor, provider)?;
        let plan = executor.plan();
        let memory = [plan.memory_bytes(), plan.saved_bytes()];
        let scene_bytes = self.scene_bytes(plan, provider)?;
        let remembers = plan.remembers();
        let settle = || steady::settle(self.session, &mut executor);
        let steady = remembers.then(settle).transpose()?;
        Ok(Prepared {
            executor,
            steady,
            memory,
            scene_bytes,
        })
    }

    /// The part of the measurements that a view and a path have alike.
    pub fn measured(
        &self,
        prepared: Prepared,
        mut times: Times,
        counts: &Statistics,
        answers_in_shares: bool,
    ) -> Measured {
        self.distrust(&mut times.frame);
        if !self.timestamps {
            times.passes.iter_mut().for_each(|pass| pass.gpu_ms = None);
        }
        let [memory_bytes, saved_bytes] = prepared.memory;
        Measured {
            certain: counts.certain,
            uncertain: counts.uncertain,
            split: counts.split,
            rays: None,
            wrong: counts.wrong,
            certain_wrong_blockers: None,
            facing_mismatch: counts.facing_mismatch,
            answer: if answers_in_shares {
                Answer::Graded
            } else {
                Answer::Hard
            },
            graded: Default::default(),
            edges: Default::default(),
            passes: times.passes,
            frame: times.frame,
            cached: None,
            memory_bytes,
            saved_bytes,
            scene_bytes: prepared.scene_bytes,
            steady: prepared.steady,
            texels: None,
            layer_jump: None,
            sequence: None,
            images: None,
        }
    }

    /// Leaves out the GPU's time of a frame if timestamps are not true.
    pub fn distrust(&self, frame: &mut FrameTimes) {
        frame.gpu_ms = frame.gpu_ms.filter(|_| self.timestamps);
    }

    /// A run that says why there are no measurements.
    pub fn unavailable(&self, method: &Method, reason: String) -> Run {
        Run {
            unavailable: Some(reason),
            ..self.empty(method)
        }
    }

    /// Decodes the outputs that were read, of the light that is judged.
    pub fn decode(
        &self,
        contents: Contents,
        truth_view: &GroundTruthView,
    ) -> Result<Outputs, String> {
        Outputs::from_contents(contents, self.light, &truth_view.ground_truth.pixels)
    }

    /// Bytes of what the scene gives to the plan.
    fn scene_bytes(&self, plan: &Plan, provider: &mut dyn Provider) -> Result<u64, ExecuteError> {
        let mut bytes = 0;
        let provided = plan.provided().into_iter();
        // Last frame's camera is a copy of the executor's own.
        for name in provided
            .filter(|name| provider.describe(name).is_some())
            .collect::<Vec<_>>()
        {
            let built = provider.build(name, &self.session.gpu.device, &self.session.gpu.queue);
            let buffer = built.map_err(|error| ExecuteError::Provider {
                name: name.to_owned(),
                why: error.to_string(),
            })?;
            bytes += buffer.size();
        }
        Ok(bytes)
    }

    /// Draws the pictures of a view, or of a frame of a path, where there are to be any.
    ///
    /// # Errors
    /// Outputs that do not fit the reference.
    pub fn draw(
        &self,
        method: &Method,
        frame: Option<usize>,
        ground_truth: &GroundTruth,
        (outputs, judgement, found): (&Outputs, &Judgement, &Diagnostics),
    ) -> Result<Option<Images>, CompareError> {
        let Some(pictures) = &self.pictures else {
            return Ok(None);
        };
        let place = PicturePlace {
            stem: stem(method, self.view, ground_truth.pixels.viewport),
            view: self.view,
            frame,
        };
        let (images, files) = draw_pictures(
            &place,
            ground_truth,
            (outputs, judgement),
            found.footprints.as_deref(),
        )?;
        pictures.replace(files);
        Ok(Some(images))
    }

    /// The run with nothing measured.
    fn empty(&self, method: &Method) -> Run {
        let ground_truth = &self.truth_view.ground_truth;
        let (truth, area) = (&ground_truth.pixels, ground_truth.area.as_ref());
        let counts = self.own;
        Run {
            preset: method.name.clone(),
            view: self.view.into(),
            viewport: truth.viewport,
            map_size: method.map_size,
            params: method.all_params(),
            fingerprint: method.fingerprint(self.fingerprint),
            date: date::today(),
            promise: guarantee::promise(method),
            pixels: counts.pixels,
            band: counts.band,
            wrong_surface: self.wrong_surfaces,
            area: area.map(|area| AreaReference::new(area, truth)),
            measured: None,
            unavailable: None,
            published: Vec::new(),
        }
    }
}
