//! One run: a method on one view, executed, timed, judged and pictured.

use crate::error::CompareError;
use crate::files::fingerprint::Fingerprint;
use crate::graphs::faults::reasons;
use crate::graphs::ground_truth::{Judgement, judged};
use crate::graphs::method::Method;
use crate::graphs::planning::Capabilities;
use crate::graphs::shadow_method::Outputs;
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
use crate::records::results::{Answer, AreaReference, Cached, Images, Measured, Run};
use crate::records::steady::Steady;
use crate::sink::{Session, Step};
use skiagraph_gpu::{ExecuteError, Provider};
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

/// Results of a method's frames.
struct Executed {
    times: Times,
    cached: Option<Cached>,
    outputs: Outputs,
    judgement: Judgement,
    steady: Option<Steady>,
    memory: (u64, u64),
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
        let step = Step::begin(
            self.session.sink,
            &format!(
                "{}, {}",
                method.name,
                conditions(method, self.view, viewport)
            ),
            u64::from(self.warmup) + self.frames,
            "frames",
        );
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

    /// Runs, times and judges a method on one view.
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
        let executed = self.execute(method, plan, provider, step)?;
        Ok(self.judge(method, executed)?)
    }

    /// A run that says why there are no measurements.
    pub fn unavailable(&self, method: &Method, reason: String) -> Run {
        Run {
            unavailable: Some(reason),
            ..self.empty(method)
        }
    }

    /// Runs, times and judges frames. A method that remembers is judged first, in its steady state:
    /// what is timed behind that does not change what it shows.
    fn execute(
        &self,
        method: &Method,
        plan: Plan,
        provider: &mut dyn Provider,
        step: &Step,
    ) -> Result<Executed, Stop> {
        let mut executor = frame::executor(self.session, plan, provider)?;
        frame::grow(self.session, &mut executor, provider)?;
        let plan = executor.plan();
        let memory = (plan.memory_bytes(), plan.saved_bytes());
        let scene_bytes = self.scene_bytes(plan, provider)?;
        let names = method.preset.judged();
        let judge = |contents| {
            let outputs = self.decode(contents, self.truth_view);
            judged(&method.preset, outputs, &self.truth_view.ground_truth)
        };
        let mut settled = None;
        if executor.plan().remembers() {
            let mut steady = steady::settle(self.session, &mut executor)?;
            let worst = steady::judge(self.session, &mut executor, &names, &mut steady, judge)?;
            settled = Some((worst, steady));
        }
        let count = [self.warmup, self.frames as u32];
        let set_done = |frames| step.set_done(frames);
        let times = timing::times(
            self.session,
            &mut executor,
            FrameMode::AllPasses,
            count,
            set_done,
        )?;
        let times = times.ok_or_else(CompareError::interrupted)?;
        let cached = timing::cached(self.session, &mut executor, self.cached_frames)?;
        let cached = cached.ok_or_else(CompareError::interrupted)?;
        let ((outputs, judgement), steady) = match settled {
            Some((worst, steady)) => (worst, Some(steady)),
            // Only now: a readback would be timed, too.
            None => (
                judge(frame::read(self.session, &mut executor, &names)?)?,
                None,
            ),
        };
        Ok(Executed {
            times,
            cached,
            outputs,
            judgement,
            steady,
            memory,
            scene_bytes,
        })
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
    pub fn scene_bytes(
        &self,
        plan: &Plan,
        provider: &mut dyn Provider,
    ) -> Result<u64, ExecuteError> {
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

    fn judge(&self, method: &Method, executed: Executed) -> Result<Measured, CompareError> {
        let Executed {
            mut times,
            mut cached,
            outputs,
            judgement,
            steady,
            memory: (memory_bytes, saved_bytes),
            scene_bytes,
        } = executed;
        let ground_truth = &self.truth_view.ground_truth;
        let Judgement { counts, graded } = &judgement;
        let blockers = match counts.wrong.certain {
            0 => None,
            // Which pixels are wrong is a question of grades.
            _ if graded.is_some() => None,
            _ => Some(self.truth_view.blockers(&outputs)?),
        };
        if !self.timestamps {
            times.frame.gpu_ms = None;
            cached
                .iter_mut()
                .for_each(|cached| cached.frame.gpu_ms = None);
            times.passes.iter_mut().for_each(|pass| pass.gpu_ms = None);
        }
        let images = self.draw(method, None, ground_truth, (&outputs, &judgement))?;
        Ok(Measured {
            certain: counts.certain,
            uncertain: counts.uncertain,
            split: counts.split,
            rays: outputs.rays,
            wrong: counts.wrong,
            certain_wrong_blockers: blockers,
            facing_mismatch: counts.facing_mismatch,
            answer: match outputs.shares {
                Some(_) => Answer::Graded,
                None => Answer::Hard,
            },
            graded: *graded,
            passes: times.passes,
            frame: times.frame,
            cached,
            memory_bytes,
            saved_bytes,
            scene_bytes,
            steady,
            sequence: None,
            images,
        })
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
        (outputs, judgement): (&Outputs, &Judgement),
    ) -> Result<Option<Images>, CompareError> {
        let Some(pictures) = &self.pictures else {
            return Ok(None);
        };
        let place = PicturePlace {
            stem: stem(method, self.view, ground_truth.pixels.viewport),
            view: self.view,
            frame,
        };
        let (images, files) = draw_pictures(&place, ground_truth, outputs, judgement)?;
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
