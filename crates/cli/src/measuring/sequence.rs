//! A method over the frames of a camera path, each judged.

use crate::error::CliError;
use crate::graphs::contract::{Judgement, Outputs, judged};
use crate::graphs::method::Method;
use crate::measuring::frame;
use crate::measuring::reference::{Judge, own_counts};
use crate::measuring::run::{Attempt, MeasureContext, refused};
use crate::measuring::timing;
use crate::pictures::run_pictures::{save_pictures, stem};
use crate::records::results::{Answer, Measured};
use crate::records::samples::TimedFrame;
use crate::records::sequence::{Sequence, SequenceFrame};
use crate::terminal::interrupt;
use crate::terminal::progress::Step;
use skiagraph_gpu::{ExecuteError, Executor, Frame, FrameReport};
use skiagraph_graph::Plan;
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{
    BlockerCounts, Graded, Progress, Shimmer, Statistics,
    shimmer::{same_receivers, shimmer},
};
use skiagraph_scene::{Mesh, View};
use std::time::Duration;

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// The frames of a path with their right answers.
pub struct Path<'a> {
    /// The camera's places.
    pub views: Vec<View>,
    /// The right answers.
    pub judges: Vec<Judge<'a>>,
    /// For each frame but the first, where each pixel's receiver was in the frame before.
    same: Vec<Vec<u32>>,
}

impl<'a> Path<'a> {
    /// Finds receivers that are seen in two frames one after the other.
    ///
    /// # Errors
    /// Ctrl-C.
    pub fn new(mesh: &Mesh, views: Vec<View>, judges: Vec<Judge<'a>>) -> Result<Self, CliError> {
        let progress = Progress {
            rows_done: &|_| (),
            interrupted: interrupt::flag(),
        };
        let pairs = judges.windows(2);
        let same = pairs.map(|pair| same_receivers(mesh, pair[0].seen(), pair[1].seen(), progress));
        let same = same.collect::<Result<_, _>>();
        let same = same.map_err(|_| CliError::interrupted())?;
        Ok(Self {
            views,
            judges,
            same,
        })
    }

    /// The reference's pixels of all frames together.
    pub fn own_counts(&self) -> Statistics {
        let mut all = Statistics::default();
        for judge in &self.judges {
            all += own_counts(&judge.right.reference);
        }
        all
    }
}

/// What is known of the frames so far.
#[derive(Default)]
struct Account {
    counts: Statistics,
    rays: Option<u64>,
    blockers: Option<BlockerCounts>,
    frames: Vec<SequenceFrame>,
    timed: Vec<TimedFrame>,
    /// What the frame before showed.
    before: Option<Vec<f32>>,
    /// Where answers or the light are graded: of each frame.
    graded: Vec<(Graded, u64)>,
    /// Whether the method answers in shares.
    shares: bool,
    /// The worst frame that was seen yet, for its pictures.
    worst: Option<(usize, Outputs, Judgement)>,
}

impl MeasureContext<'_> {
    /// Runs a method over a path, with what it keeps from frame to frame.
    ///
    /// # Errors
    /// Ctrl-C, a lost device, outputs that break the contract, a picture that cannot be written.
    pub fn follow(
        &self,
        method: &Method,
        plan: Plan,
        path: &Path,
        provider: &mut SceneProvider,
        step: &Step,
    ) -> Attempt {
        let (memory, scene_bytes, mut executor) = match self.begin(plan, path, provider) {
            Ok(begun) => begun,
            Err(error) => return refused(method, error),
        };
        let mut account = Account::default();
        for (index, view) in path.views.iter().enumerate() {
            if interrupt::raised() {
                return Err(CliError::interrupted());
            }
            let names = method.preset.judged();
            let (report, wall) = match self.frame(&mut executor, view, &names, provider) {
                Ok(done) => done,
                Err(error) => return refused(method, error),
            };
            self.account(method, path, index, (report, wall), &mut account)?;
            step.set_done(u64::from(self.warmup) + index as u64 + 1);
        }
        let times = timing::of(account.timed);
        let mut times = times.ok_or_else(CliError::interrupted)?;
        if !self.timestamps {
            times.frame.gpu_ms = None;
            times.passes.iter_mut().for_each(|pass| pass.gpu_ms = None);
            account
                .frames
                .iter_mut()
                .for_each(|frame| frame.gpu_ms = None);
        }
        let images = match (self.pictures, &account.worst) {
            (Some(folder), Some((index, outputs, judgement))) => {
                let right = &path.judges[*index].right;
                let stem = stem(method, self.view, right.reference.viewport);
                Some(save_pictures(folder, &stem, right, outputs, judgement)?)
            }
            _ => None,
        };
        let mut all = Shimmer::default();
        for frame in &account.frames {
            all += frame.shimmer.unwrap_or_default();
        }
        let counts = account.counts;
        Ok(Ok(Measured {
            certain: counts.certain,
            uncertain: counts.uncertain,
            split: counts.split,
            rays: account.rays,
            wrong: counts.wrong,
            certain_wrong_blockers: account.blockers,
            facing_mismatch: counts.facing_mismatch,
            answer: match account.shares {
                true => Answer::Graded,
                false => Answer::Hard,
            },
            graded: (!account.graded.is_empty()).then(|| Graded::together(account.graded)),
            passes: times.passes,
            frame: times.frame,
            cached: None,
            memory_bytes: memory.0,
            saved_bytes: memory.1,
            scene_bytes,
            images,
            sequence: Some(Sequence {
                frames: account.frames,
                shimmer: all,
            }),
        }))
    }

    /// An executor that stands still at the path's begin until it is warm.
    fn begin(
        &self,
        plan: Plan,
        path: &Path,
        provider: &mut SceneProvider,
    ) -> Result<((u64, u64), u64, Executor), ExecuteError> {
        if let Some(view) = path.views.first() {
            provider.set_view(view, self.judge.right.reference.viewport);
        }
        let mut executor = frame::executor(self.gpu, plan, provider)?;
        frame::grow(self.gpu, &mut executor, provider)?;
        for _ in 0..self.warmup {
            frame::run(self.gpu, &mut executor, &Frame::default())?;
        }
        let plan = executor.plan();
        let memory = (plan.memory_bytes(), plan.saved_bytes());
        let scene_bytes = self.scene_bytes(plan, provider)?;
        Ok((memory, scene_bytes, executor))
    }

    fn frame(
        &self,
        executor: &mut Executor,
        view: &View,
        read: &[&str],
        provider: &mut SceneProvider,
    ) -> Result<(FrameReport, Duration), ExecuteError> {
        provider.set_view(view, self.judge.right.reference.viewport);
        executor.refresh(provider)?;
        let request = Frame {
            timing: true,
            read,
            ..Frame::default()
        };
        let done = frame::run(self.gpu, executor, &request)?;
        // As a host does it: between frames, by what has arrived.
        executor.grow(provider)?;
        Ok(done)
    }

    fn account(
        &self,
        method: &Method,
        path: &Path,
        index: usize,
        (report, wall): (FrameReport, Duration),
        account: &mut Account,
    ) -> Result<(), CliError> {
        let judge = &path.judges[index];
        let contents = frame::contents(report.readbacks);
        let outputs = self.decode(contents, judge);
        let (outputs, judgement) = judged(method.preset, outputs, &judge.right)?;
        let counts = judgement.counts;
        if counts.wrong.certain > 0 && judgement.graded.is_none() {
            *account.blockers.get_or_insert_default() += judge.blockers(&outputs)?;
        }
        let shown = outputs.shown().into_owned();
        let changed = match &account.before {
            None => None,
            Some(before) => {
                let right = [&path.judges[index - 1].right, &judge.right];
                let counts = shimmer(&path.same[index - 1], [before, &shown], right);
                Some(counts.map_err(|error| CliError::Input(format!("no shimmer: {error}")))?)
            }
        };
        let Some(timing) = report.timing else {
            return Err(CliError::Input(
                "a timed frame came back without times".into(),
            ));
        };
        account.frames.push(SequenceFrame {
            facing_light: counts.pixels.facing_light,
            wrong: counts.wrong.total,
            wrong_outside_band: counts.wrong.total - counts.wrong.in_band,
            graded: judgement.graded,
            rays: outputs.rays,
            gpu_ms: timing.gpu().map(ms),
            wall_ms: ms(wall),
            shimmer: changed,
            skipped: report.skipped.clone(),
        });
        account.timed.push(TimedFrame {
            began: Duration::ZERO,
            timing,
            wall,
            skipped: report.skipped,
        });
        account.counts += counts;
        if let Some(rays) = outputs.rays {
            account.rays = Some(account.rays.unwrap_or(0) + rays);
        }
        account.before = Some(shown);
        account.shares |= outputs.shares.is_some();
        let graded = judgement
            .graded
            .map(|graded| (graded, counts.pixels.facing_light));
        account.graded.extend(graded);
        let worst = account.worst.as_ref();
        if worst.is_none_or(|(.., worst)| judgement.is_worse_than(worst)) {
            account.worst = Some((index, outputs, judgement));
        }
        Ok(())
    }
}
