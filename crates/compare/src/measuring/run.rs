//! Measures one run: executes a method on one view or camera path, judges, times and pictures it.

use crate::comparison::Protocol;
use crate::error::{CompareError, Result};
use crate::graphs::contract::{layer_of, layers};
use crate::graphs::ground_truth::{Judgement, judged};
use crate::graphs::method::Method;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::diagnostics::{Diagnostics, diagnose};
use crate::measuring::ground_truth::{GroundTruthFrames, GroundTruthView};
use crate::measuring::sequence::{Account, WorstSecond, cost};
use crate::measuring::stop::{Stop, attempt};
use crate::measuring::timing::{self, Kind, Takes, TimedKinds, Turn};
use crate::measuring::view_or_path::ViewOrPath;
use crate::measuring::{date, frame, guarantee, hint, steady};
use crate::pictures::run_pictures::{PictureFile, PicturePlace, data_files, draw_pictures, stem};
use crate::records::hint::Hint;
use crate::records::regimes::RegimeTimes;
use crate::records::results::{AreaReference, Images, Measured, Run};
use crate::records::samples::TimedFrame;
use crate::records::sequence::Remade;
use crate::records::statistics::{FrameTimes, ms};
use crate::records::turns::Turns;
use crate::sink::{Session, Step};
use skiagraph_gpu::{ExecuteError, Executor, Provider};
use skiagraph_graph::Plan;
use skiagraph_passes::{Built, How, SceneProvider};
use skiagraph_reference::{GroundTruth, Statistics};

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
}

/// A method that was judged on a view or path. Its times are not those of its turns yet.
pub struct Judged {
    /// The method, with its params.
    pub method: Method,
    planned: Run,
    executor: Executor,
    /// The measurements so far.
    pub measured: Measured,
    /// Pictures of the method, to be written with its run.
    pub pictures: Vec<PictureFile>,
}

impl MeasureContext<'_> {
    /// Runs and judges a method by `plan`, its plan for the view or path; [`times`](Self::times)
    /// times it together with others. `planned` is its [`Run`] without measurements. `provider` has
    /// the context's view and light already. The times of the result are provisional: of a still
    /// view one frame, of a path the frames that were judged.
    ///
    /// A method that reuses results of earlier frames runs first until its picture repeats, at most
    /// 256 frames. On a still view, of the pictures of one period (16 pictures if none repeats) the
    /// worst is judged, and [`Steady`](crate::records::steady::Steady) has the means of all.
    ///
    /// # Errors
    /// A method that the device refuses; outputs whose size, format or values a shadow method must
    /// not have ([`CompareError::InvalidOutputs`]); an early end, a lost device.
    pub async fn judge(
        &self,
        (method, planned): (&Method, &Run),
        plan: Plan,
        provider: &mut SceneProvider,
        step: &Step<'_>,
    ) -> Result<Judged, Stop> {
        let session = self.session;
        let (mut executor, _) = frame::settled(session, plan, provider).await?;
        let plan = executor.plan();
        let (memory_bytes, saved_bytes) = (plan.memory_bytes(), plan.saved_bytes());
        let (scene_bytes, layer) = (scene_bytes(session, plan, provider)?, self.layer(plan));
        let lights = Some(layers(plan)).filter(|lights| *lights > 1);
        let truth = (&self.truth_view.ground_truth, layer);
        let mut steady = steady::settle(session, (&method.preset, &mut executor), truth).await?;
        let mut account = Account::default();
        let timed = match self.view {
            ViewOrPath::Still(_) => {
                let drawn = (&*method.preset, &mut executor);
                let (outputs, judgement) =
                    steady::judge(session, drawn, steady.as_mut(), truth).await?;
                account.add(self.path, 0, outputs, judgement)?;
                step.set_done(1);
                let drawn = (&mut executor, &*provider);
                timing::sample(session, self.path.frames, drawn, [0, 1], |_| ()).await?
            }
            ViewOrPath::Path(_) => {
                let walked = (method, steady.is_some());
                self.follow(walked, &mut executor, provider, (&mut account, step))
                    .await?
            }
        };
        let (frame, passes) = timing::times(&timed, self.timestamps)?;
        let (index, outputs, judgement) = account.worst.take().ok_or_else(|| {
            CompareError::Input(format!("the path {} has no frames", self.view.name()))
        })?;
        let truth_view = &self.path.truth_views[index];
        let viewport = truth_view.ground_truth.pixels.viewport;
        self.path.frames.show(index, viewport, provider)?;
        let is_path = matches!(self.view, ViewOrPath::Path(_));
        let counts = &account.counts;
        let hint = self.hint((method, layer), &account, provider).await?;
        let diagnostics =
            diagnose(session, method, truth_view, (&outputs, layer), provider).await?;
        let place = is_path.then_some(index);
        let shown = (&outputs, &judgement, &diagnostics);
        let (mut images, mut pictures) =
            self.draw(method, place, &truth_view.ground_truth, shown)?;
        if let Some(images) = &mut images {
            file_second(&mut pictures, std::mem::take(&mut account.second), images);
        }
        let measured = Measured {
            certain: counts.certain,
            uncertain: counts.uncertain,
            split: counts.split,
            rays: account.rays,
            wrong: counts.wrong,
            certain_wrong_blockers: account.blockers,
            hint,
            facing_mismatch: counts.facing_mismatch,
            lights,
            answer: account.answer,
            graded: account.graded(),
            edges: account.edges,
            memory_bytes,
            saved_bytes,
            scene_bytes,
            steady,
            texels: diagnostics.texels,
            layer_jump: diagnostics.layer_jump,
            sequence: is_path.then(|| account.sequence()),
            images,
            frame,
            passes,
            ..Measured::default()
        };
        Ok(Judged {
            method: method.clone(),
            planned: planned.clone(),
            executor,
            measured,
            pictures,
        })
    }

    /// Looks for a setting that makes most of the wrong pixels of a still view right.
    async fn hint(
        &self,
        (method, layer): (&Method, usize),
        account: &Account,
        provider: &mut SceneProvider,
    ) -> Result<Option<Hint>> {
        let is_still = matches!(self.view, ViewOrPath::Still(_));
        let Some(blockers) = account.blockers.filter(|_| self.hints && is_still) else {
            return Ok(None);
        };
        let wrong = account.counts.wrong;
        let wrong = (wrong.total.saturating_sub(wrong.in_band), blockers);
        let seen = (self.truth_view, layer);
        hint::find(self.session, method, seen, wrong, provider).await
    }

    /// Runs a method over a camera path and judges each frame; passes whose inputs have not changed
    /// are skipped. Before the path begins, its first frame is drawn for the protocol's warm-up
    /// frames, unless the method has `remembered` it already. Returns the times of the frames.
    ///
    /// # Errors
    /// A method that the device refuses; an early end; a lost device; outputs whose size, format or
    /// values a shadow method must not have.
    async fn follow(
        &self,
        (method, remembered): (&Method, bool),
        executor: &mut Executor,
        provider: &mut SceneProvider,
        (account, step): (&mut Account, &Step<'_>),
    ) -> Result<Vec<TimedFrame>, Stop> {
        let (warmup, layer) = (self.protocol.warmup, self.layer(executor.plan()));
        let (frames, viewport) = (self.path.frames, executor.plan().viewport());
        let names = method.preset.judged();
        let mut takes = Takes::new(self.session, frames, viewport, provider, [executor]);
        for _ in 0..if remembered { 0 } else { warmup } {
            takes.take(Turn::new(Kind::EveryPass, 0, false)).await?;
        }
        let mut second = WorstSecond::new(frames.second());
        takes.read(&names);
        for (frame, truth_view) in self.path.truth_views.iter().enumerate() {
            takes.take(Turn::new(Kind::Path, frame, true)).await?;
            let Some((contents, made)) = takes.shown() else {
                break;
            };
            let truth = &truth_view.ground_truth;
            let (outputs, judgement) = judged(&method.preset, (contents, layer), truth)?;
            account.add(self.path, frame, outputs, judgement)?;
            let judged = &mut account.frames[frame];
            judged.remade = made.iter().map(remade).collect();
            if let Some(shown) = account.shown.as_ref().filter(|_| self.protocol.pictures) {
                let place = self.place(method, Some(frame), viewport);
                let changed = judged.shimmer.map_or(0, |shimmer| shimmer.changed);
                second.add(changed, place.shaded(shown, &truth.pixels)?);
            }
            step.set_done(u64::from(warmup) + frame as u64 + 1);
        }
        account.second = second.pictures;
        let kinds = takes.end().pop().transpose()?.unwrap_or_default();
        let times: Vec<TimedFrame> = kinds.into_values().flatten().collect();
        for (frame, timed) in account.frames.iter_mut().zip(&times) {
            frame.cost = cost(timed, self.timestamps);
            frame.skipped.clone_from(&timed.skipped);
        }
        Ok(times)
    }

    /// Where the pictures of a method are filed.
    fn place(&self, method: &Method, frame: Option<usize>, viewport: [u32; 2]) -> PicturePlace<'_> {
        PicturePlace {
            stem: stem(method, self.view.name(), viewport),
            view: self.view.name(),
            frame,
        }
    }

    /// Returns the run of a judged method with its provisional times: it stays in the results if
    /// the work ends before [`times`](Self::times).
    pub fn judged_run(&self, judged: &Judged) -> Run {
        self.run(&judged.method, &judged.planned, Ok(judged.measured.clone()))
    }

    /// Times judged methods in turns, frame by frame, and returns the run of each, in order.
    /// `group` is the index of this group, from 0, among those into which the methods of the view
    /// and viewport are split to fit the memory. The first method is the anchor: it is in every
    /// group, so that groups can be compared ([`Turns`]). `done` is called with the number of
    /// finished turns, of those that [`schedule`](Self::schedule) lists.
    ///
    /// # Errors
    /// An early end, a lost device.
    pub async fn times(
        &self,
        methods: &mut [Judged],
        group: u32,
        provider: &SceneProvider,
        done: impl Fn(u64),
    ) -> Result<Vec<Run>> {
        let viewport = self.truth_view.ground_truth.pixels.viewport;
        let executors = methods.iter_mut().map(|judged| &mut judged.executor);
        let frames = self.path.frames;
        let mut takes = Takes::new(self.session, frames, viewport, provider, executors);
        for (turn, count) in self.schedule().into_iter().zip(1..) {
            takes.take(turn).await?;
            done(count);
        }
        let timed = takes.end();
        let mut anchor = None;
        let mut runs = Vec::new();
        for (judged, timed) in methods.iter().zip(timed) {
            let timed = timed.map_err(Stop::from);
            let measured = timed.and_then(|timed| {
                let mut measured = judged.measured.clone();
                self.set_timed(&mut measured, &timed)?;
                let (anchor, regimes): &(FrameTimes, Vec<RegimeTimes>) = anchor
                    .get_or_insert_with(|| (measured.frame.clone(), measured.regimes.clone()));
                measured.turns = Some(Turns {
                    group,
                    anchor: anchor.clone(),
                    regimes: regimes.clone(),
                });
                Ok(measured)
            });
            let outcome = attempt(self.session, &judged.method, measured)?;
            runs.push(self.run(&judged.method, &judged.planned, outcome));
        }
        Ok(runs)
    }

    /// Returns the turns that methods are timed in here.
    pub fn schedule(&self) -> Vec<Turn> {
        timing::schedule(self.view, self.path.frames, &self.protocol)
    }

    /// Writes the times of a method's turns into its measurements.
    fn set_timed(&self, measured: &mut Measured, timed: &TimedKinds) -> Result<()> {
        let kind = match &mut measured.sequence {
            Some(sequence) => {
                let frames = timed.get(&Kind::Path).into_iter().flatten();
                for (frame, timed) in sequence.frames.iter_mut().zip(frames) {
                    frame.cost = cost(timed, self.timestamps);
                }
                Kind::Path
            }
            None => Kind::EveryPass,
        };
        let frames = timed.get(&kind).map_or(&[][..], Vec::as_slice);
        (measured.frame, measured.passes) = timing::times(frames, self.timestamps)?;
        measured.regimes = timing::regime_times(timed, self.timestamps)?;
        Ok(())
    }

    /// Creates the run of a method from `planned`, its [`Run`] without measurements, and its
    /// measurements or the reason why there are none.
    pub fn run(&self, method: &Method, planned: &Run, outcome: Result<Measured, String>) -> Run {
        let ground_truth = &self.truth_view.ground_truth;
        let (truth, area) = (&ground_truth.pixels, ground_truth.area.as_ref());
        let unavailable = outcome.as_ref().err().cloned();
        Run {
            date: date::today(),
            promise: guarantee::promise(method),
            pixels: self.own.pixels,
            band: self.own.band,
            wrong_surface: self.path.wrong_surfaces(),
            area: area.map(|area| AreaReference::new(area, truth)),
            measured: outcome.ok(),
            unavailable,
            ..planned.clone()
        }
    }

    /// Returns the layer of a plan's outputs that is judged: the one of [`light`](Self::light).
    pub fn layer(&self, plan: &Plan) -> usize {
        layer_of(plan, self.light).unwrap_or_default()
    }

    /// Makes the pictures and data files that the protocol asks for, of a view or of the frame with
    /// the index `frame` of a path. Returns the names of the pictures, `None` without pictures, and
    /// the files.
    ///
    /// # Errors
    /// Outputs of another size than the reference.
    pub fn draw(
        &self,
        method: &Method,
        frame: Option<usize>,
        ground_truth: &GroundTruth,
        (outputs, judgement, diagnostics): (&Outputs, &Judgement, &Diagnostics),
    ) -> Result<(Option<Images>, Vec<PictureFile>)> {
        let place = self.place(method, frame, ground_truth.pixels.viewport);
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
        Ok((images, files))
    }
}

/// Adds the pictures of a path's worst second to those of a run; the worst frame may be among them.
fn file_second(pictures: &mut Vec<PictureFile>, second: Vec<PictureFile>, images: &mut Images) {
    for picture in second {
        images.worst_second.push(picture.name.clone());
        if images.shaded != picture.name {
            pictures.push(picture);
        }
    }
}

/// The record of a resource that was made for a frame.
fn remade(built: &Built) -> Remade {
    Remade {
        name: built.name.to_owned(),
        how: match built.how {
            How::Made => "made",
            How::Refitted => "refitted",
        }
        .to_owned(),
        ms: ms(built.time),
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
