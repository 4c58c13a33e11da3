//! Measures one run: executes a method on one view or camera path, judges, times and pictures it.

use crate::comparison::Protocol;
use crate::error::CompareError;
use crate::graphs::contract::layer_of;
use crate::graphs::ground_truth::{Judgement, judged};
use crate::graphs::method::Method;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::diagnostics::{Diagnostics, diagnose};
use crate::measuring::ground_truth::{GroundTruthFrames, GroundTruthView};
use crate::measuring::steady;
use crate::measuring::stop::{Stop, attempt};
use crate::measuring::timing::{self, FrameMode, Times};
use crate::measuring::view_or_path::ViewOrPath;
use crate::measuring::{date, frame, guarantee, hint};
use crate::pictures::run_pictures::{PictureFile, PicturePlace, data_files, draw_pictures, stem};
use crate::records::hint::Hint;
use crate::records::results::{Answer, AreaReference, Images, Measured, Run};
use crate::records::statistics::FrameTimes;
use crate::records::steady::Steady;
use crate::records::turns::Turns;
use crate::sink::Session;
use skiagraph_gpu::{ExecuteError, Executor, Provider};
use skiagraph_graph::Plan;
use skiagraph_reference::{
    BlockerCounts, EdgeDistances, GroundTruth, LayerJump, Statistics, TexelsPerPixel,
};
use std::cell::RefCell;

/// Data that all methods share when they are measured on one view or path in one viewport.
pub struct MeasureContext<'a> {
    /// The GPU, and the sink for progress.
    pub session: Session<'a>,
    /// True if the GPU's timestamps can be trusted.
    pub timestamps: bool,
    /// View or path on which methods are measured.
    pub view: &'a ViewOrPath,
    /// Frames of the view or path, with their ground truth.
    pub path: &'a GroundTruthFrames<'a>,
    /// The ground truth of the first frame.
    pub truth_view: &'a GroundTruthView<'a>,
    /// Index, among the view's lights, of the light under which methods are judged.
    pub light: usize,
    /// Counts of the reference's pixels over all frames ([`GroundTruthFrames::own_counts`]).
    pub own: Statistics,
    /// Settings of how methods are run and timed.
    pub protocol: Protocol,
    /// True to look for a setting that makes most of a method's wrong pixels right ([`Hint`]).
    pub hints: bool,
    /// Pictures and data files of the run that was judged last, not written yet; `None` to make
    /// none.
    pub pictures: Option<RefCell<Vec<PictureFile>>>,
}

/// A method that was judged on a view, and not timed yet.
pub struct Judged {
    /// The method, with its params.
    pub method: Method,
    planned: Run,
    prepared: Prepared,
    judgement: Judgement,
    edges: EdgeDistances,
    rays: Option<u64>,
    answers_in_shares: bool,
    blockers: Option<BlockerCounts>,
    hint: Option<Hint>,
    texels: Option<TexelsPerPixel>,
    layer_jump: Option<LayerJump>,
    images: Option<Images>,
    /// Pictures of the method, to be written with its run.
    pub pictures: Vec<PictureFile>,
}

impl Judged {
    /// Returns the bytes of the textures and buffers that the graph makes, without those of the
    /// scene.
    pub fn bytes(&self) -> u64 {
        self.prepared.memory[0]
    }
}

/// A method that is ready to run. Buffers whose size depends on the frame's content have grown; a
/// method that reuses results of earlier frames has run until its picture repeats.
pub struct Prepared {
    /// Executor of the method's plan.
    pub executor: Executor,
    /// Steady state of a method that reuses results of earlier frames; `None` for others.
    pub steady: Option<Steady>,
    memory: [u64; 2],
    scene_bytes: u64,
}

impl MeasureContext<'_> {
    /// Runs and judges a method on one still view by `plan`, its plan there; [`times`](Self::times)
    /// times it together with others. `planned` is its [`Run`] without measurements. `provider` has
    /// the context's view and light already. A method that reuses results of earlier frames runs
    /// first until its picture repeats, at most 256 frames. Of the pictures of one period (16
    /// pictures if none repeats) the worst is judged, and [`Steady`] has the means of all.
    ///
    /// # Errors
    /// A method that the device refuses; outputs whose size, format or values a shadow method must
    /// not have ([`CompareError::InvalidOutputs`]); an early end, a lost device.
    pub fn judge(
        &self,
        (method, planned): (&Method, &Run),
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<Judged, Stop> {
        let mut prepared = self.prepare(plan, provider)?;
        let executor = &mut prepared.executor;
        let ground_truth = &self.truth_view.ground_truth;
        let names = method.preset.judged();
        let layer = self.layer(executor.plan());
        let judge = |contents| {
            let outputs = Outputs::from_contents(contents, layer, &ground_truth.pixels);
            judged(&method.preset, outputs, ground_truth)
        };
        let (outputs, judgement) = match &mut prepared.steady {
            Some(steady) => steady::judge(self.session, executor, &names, steady, judge)?,
            None => judge(frame::read(self.session, executor, &names)?)?,
        };
        let has_blockers = judgement.is_hard && judgement.counts.wrong.certain > 0;
        let blockers = has_blockers.then(|| self.truth_view.blockers(&outputs));
        let blockers = blockers.transpose()?;
        let wrong = &judgement.counts.wrong;
        let wrong = wrong.total.saturating_sub(wrong.in_band);
        let hint = match blockers.filter(|_| self.hints) {
            Some(blockers) => {
                let seen = (self.truth_view, layer);
                hint::find(self.session, method, seen, (wrong, blockers), provider)?
            }
            None => None,
        };
        let diagnostics = diagnose(
            self.session,
            method,
            self.truth_view,
            (&outputs, layer),
            provider,
        )?;
        let images = self.draw(
            method,
            None,
            ground_truth,
            (&outputs, &judgement, &diagnostics),
        )?;
        Ok(Judged {
            method: method.clone(),
            planned: planned.clone(),
            prepared,
            edges: self.truth_view.edges(&outputs)?,
            rays: outputs.rays,
            answers_in_shares: outputs.shares.is_some(),
            blockers,
            hint,
            texels: diagnostics.texels,
            layer_jump: diagnostics.layer_jump,
            pictures: self
                .pictures
                .as_ref()
                .map(RefCell::take)
                .unwrap_or_default(),
            images,
            judgement,
        })
    }

    /// Times a single frame of a judged method and returns its run, which stays in the results if
    /// the work ends before [`times`](Self::times).
    ///
    /// # Errors
    /// An early end, a lost device.
    pub fn first_frame(&self, judged: &mut Judged) -> Result<Run, CompareError> {
        let executors = &mut [&mut judged.prepared.executor];
        let timed = timing::in_turns(
            self.session,
            executors,
            FrameMode::AllPasses,
            [0, 1],
            |_| (),
        );
        let timed = timed?.pop().unwrap_or_else(|| Ok(Vec::new()));
        let times = timed
            .map_err(Stop::from)
            .and_then(|timed| Ok(Times::new(timed)?));
        let measured = times.map(|times| self.timed(judged, times));
        Ok(match attempt(self.session, &judged.method, measured)? {
            Ok(measured) => self.run(&judged.method, &judged.planned, measured),
            Err(reason) => self.unavailable(&judged.method, &judged.planned, reason),
        })
    }

    /// Times judged methods in turns, frame by frame, and returns the run of each, in order.
    /// `group` is the index of this group, from 0, among those into which the methods of the view
    /// and viewport are split to fit the memory. The first method is the anchor: it is in every
    /// group, so that groups can be compared ([`Turns`]). `done` is called with the number of
    /// finished turns.
    ///
    /// # Errors
    /// An early end, a lost device.
    pub fn times(
        &self,
        methods: &mut [Judged],
        group: u32,
        done: impl Fn(u64),
    ) -> Result<Vec<Run>, CompareError> {
        let executors = methods
            .iter_mut()
            .map(|judged| &mut judged.prepared.executor);
        let mut executors: Vec<&mut Executor> = executors.collect();
        let (warmup, frames) = (self.protocol.warmup, self.protocol.frames);
        let (count, mode) = ([warmup, frames], FrameMode::AllPasses);
        let timed = timing::in_turns(self.session, &mut executors, mode, count, done)?;
        let cached = timing::cached(self.session, &mut executors, self.protocol.cached_frames)?;
        let mut anchor = None;
        let mut runs = Vec::new();
        for ((judged, timed), cached) in methods.iter().zip(timed).zip(cached) {
            let times = timed
                .map_err(Stop::from)
                .and_then(|timed| Ok(Times::new(timed)?));
            let measured = times.and_then(|times| {
                let mut measured = self.timed(judged, times);
                let anchor = anchor.get_or_insert_with(|| measured.frame.clone());
                measured.turns = Some(Turns {
                    group,
                    anchor: anchor.clone(),
                });
                measured.cached = cached.transpose()?;
                if let Some(cached) = &mut measured.cached {
                    self.distrust(&mut cached.frame);
                }
                Ok(measured)
            });
            runs.push(match attempt(self.session, &judged.method, measured)? {
                Ok(measured) => self.run(&judged.method, &judged.planned, measured),
                Err(reason) => self.unavailable(&judged.method, &judged.planned, reason),
            });
        }
        Ok(runs)
    }

    /// The measurements of a judged method.
    fn timed(&self, judged: &Judged, times: Times) -> Measured {
        Measured {
            rays: judged.rays,
            certain_wrong_blockers: judged.blockers,
            hint: judged.hint.clone(),
            graded: judged.judgement.graded,
            edges: judged.edges,
            texels: judged.texels,
            layer_jump: judged.layer_jump,
            images: judged.images.clone(),
            ..self.measured(
                &judged.prepared,
                times,
                &judged.judgement.counts,
                judged.answers_in_shares,
            )
        }
    }

    /// Makes the executor of a method's plan, and runs frames until its buffers have grown and, if
    /// it reuses results of earlier frames, its picture repeats.
    ///
    /// # Errors
    /// A method that the device refuses, an early end, a lost device.
    pub fn prepare(&self, plan: Plan, provider: &mut dyn Provider) -> Result<Prepared, Stop> {
        let mut executor = frame::executor(self.session, plan, provider)?;
        frame::grow(self.session, &mut executor, provider)?;
        let plan = executor.plan();
        let memory = [plan.memory_bytes(), plan.saved_bytes()];
        let scene_bytes = scene_bytes(self.session, plan, provider)?;
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

    /// Creates the measurements that still views and paths have in common; all others are absent or
    /// 0. `counts` compares the method's pixels with the reference, `answers_in_shares` is true if
    /// its visibility is a share of light.
    pub fn measured(
        &self,
        prepared: &Prepared,
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
            wrong: counts.wrong,
            facing_mismatch: counts.facing_mismatch,
            answer: if answers_in_shares {
                Answer::Graded
            } else {
                Answer::Hard
            },
            passes: times.passes,
            frame: times.frame,
            memory_bytes,
            saved_bytes,
            scene_bytes: prepared.scene_bytes,
            steady: prepared.steady.clone(),
            ..Measured::default()
        }
    }

    /// Sets the GPU times in `frame` to `None` if timestamps cannot be trusted.
    pub fn distrust(&self, frame: &mut FrameTimes) {
        if !self.timestamps {
            frame.without_gpu();
        }
    }

    /// Creates the run of a method from `planned`, its [`Run`] without measurements, and its
    /// measurements.
    pub fn run(&self, method: &Method, planned: &Run, measured: Measured) -> Run {
        Run {
            measured: Some(measured),
            ..self.empty(method, planned)
        }
    }

    /// Creates the run of a method from `planned`, its [`Run`] without measurements, and the reason
    /// why there are none.
    pub fn unavailable(&self, method: &Method, planned: &Run, reason: String) -> Run {
        Run {
            unavailable: Some(reason),
            ..self.empty(method, planned)
        }
    }

    /// Returns the layer of a plan's outputs that is judged: the one of [`light`](Self::light).
    pub fn layer(&self, plan: &Plan) -> usize {
        layer_of(plan, self.light).unwrap_or_default()
    }

    /// Makes the pictures and data files that the protocol asks for, of a view or of the frame with
    /// the index `frame` of a path, and puts them into [`pictures`](Self::pictures). Returns the
    /// names of the pictures; `None` without pictures.
    ///
    /// # Errors
    /// Outputs of another size than the reference.
    pub fn draw(
        &self,
        method: &Method,
        frame: Option<usize>,
        ground_truth: &GroundTruth,
        (outputs, judgement, diagnostics): (&Outputs, &Judgement, &Diagnostics),
    ) -> Result<Option<Images>, CompareError> {
        let Some(pictures) = &self.pictures else {
            return Ok(None);
        };
        let place = PicturePlace {
            stem: stem(method, self.view.name(), ground_truth.pixels.viewport),
            view: self.view.name(),
            frame,
        };
        let (mut images, mut files) = (None, Vec::new());
        if self.protocol.pictures {
            let footprints = diagnostics.footprints.as_deref();
            let answers = (outputs, judgement);
            let (drawn, pictures) = draw_pictures(&place, ground_truth, answers, footprints)?;
            (images, files) = (Some(drawn), pictures);
        }
        if let Some(format) = self.protocol.data {
            files.extend(data_files(&place, ground_truth, outputs, format)?);
        }
        pictures.replace(files);
        Ok(images)
    }

    /// The run with nothing measured.
    fn empty(&self, method: &Method, planned: &Run) -> Run {
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

/// Returns the bytes of the scene's buffers that a plan reads, such as positions and indices. An
/// acceleration structure is not a buffer and does not tell its size.
///
/// # Errors
/// A resource that cannot be built.
pub fn scene_bytes(
    session: Session,
    plan: &Plan,
    provider: &mut dyn Provider,
) -> Result<u64, ExecuteError> {
    let mut bytes = 0;
    let provided = plan.provided().into_iter();
    // Last frame's camera is a copy of the executor's own.
    let is_buffer = |name: &&str| {
        let described = provider.describe(name);
        described.is_some_and(|provided| !provided.binding.usages().is_empty())
    };
    for name in provided.filter(is_buffer).collect::<Vec<_>>() {
        let built = provider.build(name, &session.gpu.device, &session.gpu.queue);
        let buffer = built.map_err(|error| ExecuteError::Provider {
            name: name.to_owned(),
            why: error,
        })?;
        bytes += buffer.size();
    }
    let submitted = provider.submit_built(&session.gpu.device, &session.gpu.queue);
    submitted.map_err(|why| ExecuteError::Provider {
        name: "what the provider copies".to_owned(),
        why,
    })?;
    Ok(bytes)
}
