//! One run: a method on one view, executed, timed, judged and pictured.

use crate::comparison::Protocol;
use crate::error::CompareError;
use crate::graphs::ground_truth::{Judgement, judged};
use crate::graphs::method::Method;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::ground_truth::{GroundTruthFrames, GroundTruthView};
use crate::measuring::steady;
use crate::measuring::stop::Stop;
use crate::measuring::timing::{self, FrameMode, Times};
use crate::measuring::view_or_path::ViewOrPath;
use crate::measuring::{
    date,
    frame::{self, Contents},
    guarantee,
};
use crate::pictures::run_pictures::{PictureFile, PicturePlace, draw_pictures, stem};
use crate::records::results::{Answer, AreaReference, Images, Measured, Run};
use crate::records::statistics::FrameTimes;
use crate::records::steady::Steady;
use crate::sink::{Session, Step};
use skiagraph_gpu::{ExecuteError, Executor, Provider};
use skiagraph_graph::Plan;
use skiagraph_reference::{GroundTruth, Statistics};
use std::cell::RefCell;

/// Context shared by all methods on one view and viewport.
pub struct MeasureContext<'a> {
    /// The GPU, and who hears of the work.
    pub session: Session<'a>,
    /// True if its timestamps are true.
    pub timestamps: bool,
    /// View or path on which it is measured.
    pub view: &'a ViewOrPath,
    /// Its frames with their ground truth.
    pub path: &'a GroundTruthFrames<'a>,
    /// The ground truth of the first frame.
    pub truth_view: &'a GroundTruthView<'a>,
    /// Which of the view's lights it is under.
    pub light: usize,
    /// The reference's own pixels, of all frames.
    pub own: Statistics,
    /// How long it is measured.
    pub protocol: Protocol,
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
        let settled = prepared.steady.as_mut();
        let worst = settled.map(|of| steady::judge(self.session, executor, &names, of, judge));
        let worst = worst.transpose()?;
        let (count, all) = (
            [self.protocol.warmup, self.protocol.frames],
            FrameMode::AllPasses,
        );
        let set_done = |frames| step.set_done(frames);
        let times = timing::times(self.session, executor, all, count, set_done)?;
        let mut cached = timing::cached(self.session, executor, self.protocol.cached_frames)?;
        if let Some(cached) = &mut cached {
            self.distrust(&mut cached.frame);
        }
        let (outputs, judgement) = match worst {
            Some(worst) => worst,
            // Only now: a readback would be timed, too.
            None => judge(frame::read(self.session, executor, &names)?)?,
        };
        let Judgement { counts, graded } = &judgement;
        let blockers = match counts.wrong.certain {
            0 => None,
            // Which pixels are wrong is a question of grades.
            _ if graded.is_some() => None,
            _ => Some(self.truth_view.blockers(&outputs)?),
        };
        Ok(Measured {
            rays: outputs.rays,
            certain_wrong_blockers: blockers,
            graded: *graded,
            cached,
            images: self.draw(method, None, ground_truth, (&outputs, &judgement))?,
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
            graded: None,
            passes: times.passes,
            frame: times.frame,
            cached: None,
            memory_bytes,
            saved_bytes,
            scene_bytes: prepared.scene_bytes,
            steady: prepared.steady,
            sequence: None,
            images: None,
        }
    }

    /// Leaves out the GPU's time of a frame if timestamps are not true.
    pub fn distrust(&self, frame: &mut FrameTimes) {
        frame.gpu_ms = frame.gpu_ms.filter(|_| self.timestamps);
    }

    /// A run that says why there are no measurements.
    pub fn unavailable(&self, method: &Method, planned: &Run, reason: String) -> Run {
        Run {
            unavailable: Some(reason),
            ..self.empty(method, planned)
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
        (outputs, judgement): (&Outputs, &Judgement),
    ) -> Result<Option<Images>, CompareError> {
        let Some(pictures) = &self.pictures else {
            return Ok(None);
        };
        let place = PicturePlace {
            stem: stem(method, self.view.name(), ground_truth.pixels.viewport),
            view: self.view.name(),
            frame,
        };
        let (images, files) = draw_pictures(&place, ground_truth, outputs, judgement)?;
        pictures.replace(files);
        Ok(Some(images))
    }

    /// The run with nothing measured.
    pub fn empty(&self, method: &Method, planned: &Run) -> Run {
        let ground_truth = &self.truth_view.ground_truth;
        let (truth, area) = (&ground_truth.pixels, ground_truth.area.as_ref());
        Run {
            date: date::today(),
            promise: guarantee::promise(method),
            pixels: self.own.pixels,
            band: self.own.band,
            wrong_surface: self.path.wrong_surfaces(),
            area: area.map(|area| AreaReference::new(area, truth)),
            unavailable: None,
            ..planned.clone()
        }
    }
}
