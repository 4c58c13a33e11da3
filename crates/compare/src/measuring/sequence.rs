//! Runs a method over the frames of a camera path, and judges each frame.

use crate::error::CompareError;
use crate::graphs::ground_truth::{Judgement, judged};
use crate::graphs::method::Method;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::diagnostics::{Diagnostics, diagnose};
use crate::measuring::frame::{self, Contents};
use crate::measuring::run::MeasureContext;
use crate::measuring::stop::Stop;
use crate::measuring::timing::{Times, timed_frame};
use crate::records::results::Measured;
use crate::records::samples::TimedFrame;
use crate::records::sequence::{FrameCost, Remade, Sequence, SequenceFrame};
use crate::records::statistics::FrameTimes;
use crate::sink::Step;
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::Plan;
use skiagraph_passes::{Built, How, SceneProvider};
use skiagraph_reference::{
    BlockerCounts, EdgeDistances, Graded, JudgedPixels, Shimmer, Statistics, shimmer::shimmer,
};
use std::time::Duration;

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Lists the resources that were made between two moments.
fn remade(before: &[Built], now: &[Built]) -> Vec<Remade> {
    let times = |built: &Built| {
        let earlier = before.iter().find(|earlier| earlier.name == built.name);
        earlier.map_or(0, |earlier| earlier.times)
    };
    let made = now.iter().filter(|built| built.times > times(built));
    let remade = made.map(|built| Remade {
        name: built.name.to_owned(),
        how: match built.how {
            How::Made => "made",
            How::Refitted => "refitted",
        }
        .to_owned(),
        ms: ms(built.time),
    });
    remade.collect()
}

/// Figures of the frames so far.
#[derive(Default)]
struct Account {
    counts: Statistics,
    rays: Option<u64>,
    blockers: Option<BlockerCounts>,
    frames: Vec<SequenceFrame>,
    timed: Vec<TimedFrame>,
    /// Shares of light that the frame before showed.
    before: Option<Vec<f32>>,
    /// Errors of each frame's shares.
    graded: Vec<(Graded, JudgedPixels)>,
    edges: EdgeDistances,
    /// True if the method answers in shares.
    shares: bool,
    /// The worst frame that was seen yet, for its pictures.
    worst: Option<(usize, Outputs, Judgement)>,
}

/// Runs a method over a camera path and judges each frame; passes whose inputs have not changed are
/// skipped. Before the path begins, its first frame is drawn for the protocol's warm-up frames, or,
/// by a method that reuses results of earlier frames, until its picture repeats.
///
/// # Errors
/// A method that the device refuses; an early end; a lost device; outputs whose size, format or
/// values a shadow method must not have; a picture that cannot be encoded.
pub fn follow(
    context: &MeasureContext,
    method: &Method,
    plan: Plan,
    provider: &mut SceneProvider,
    step: &Step,
) -> Result<Measured, Stop> {
    let (path, warmup) = (context.path, context.protocol.warmup);
    path.frames.show(0, plan.viewport(), provider)?;
    let mut prepared = context.prepare(plan, provider)?;
    if prepared.steady.is_none() {
        let request = Frame::new().with_all(true);
        for _ in 0..warmup {
            frame::run(context.session, &mut prepared.executor, &request)?;
        }
    }
    let mut walk = Walk {
        context,
        method,
        executor: &mut prepared.executor,
        provider,
        account: Account::default(),
    };
    for index in 0..path.frames.poses.len() {
        walk.judge(index)?;
        step.set_done(u64::from(warmup) + index as u64 + 1);
    }
    let every_pass = walk.every_pass()?;
    let account = walk.account;
    let times = Times::new(account.timed)?;
    let (mut images, mut diagnostics) = (None, Diagnostics::default());
    if let Some((index, outputs, judgement)) = &account.worst {
        let truth_view = &path.truth_views[*index];
        let ground_truth = &truth_view.ground_truth;
        path.frames
            .show(*index, ground_truth.pixels.viewport, provider)?;
        let answer = (outputs, context.layer(prepared.executor.plan()));
        diagnostics = diagnose(context.session, method, truth_view, answer, provider)?;
        images = context.draw(
            method,
            Some(*index),
            ground_truth,
            (outputs, judgement, &diagnostics),
        )?;
    }
    let mut total = Shimmer::default();
    for frame in &account.frames {
        total += frame.shimmer.unwrap_or_default();
    }
    Ok(Measured {
        rays: account.rays,
        certain_wrong_blockers: account.blockers,
        graded: Graded::together(account.graded),
        edges: account.edges,
        images,
        texels: diagnostics.texels,
        layer_jump: diagnostics.layer_jump,
        sequence: Some(Sequence {
            frames: account.frames,
            shimmer: total,
            every_pass,
        }),
        ..context.measured(&prepared, times, &account.counts, account.shares)
    })
}

/// Runs a method on each frame of a path, judges it, and adds the figures to `account`.
struct Walk<'a> {
    context: &'a MeasureContext<'a>,
    method: &'a Method,
    executor: &'a mut Executor,
    provider: &'a mut SceneProvider,
    account: Account,
}

impl Walk<'_> {
    /// The path once more with every pass run in every frame, where some were skipped: its pictures
    /// have been judged by then, and what it keeps may change.
    fn every_pass(&mut self) -> Result<Option<FrameTimes>, Stop> {
        let mut frames = self.account.frames.iter();
        let skips = frames.any(|frame| !frame.skipped.is_empty());
        if !skips || self.context.protocol.cached_frames == 0 {
            return Ok(None);
        }
        // The first one brings the camera back, and is no frame of the path.
        self.run(0, true)?;
        let mut timed = Vec::new();
        for index in 0..self.account.frames.len() {
            timed.push(self.run(index, true)?.1);
        }
        for (index, timed) in timed.iter().enumerate() {
            self.account.frames[index].every_pass = Some(self.cost(timed));
        }
        let mut times = Times::new(timed)?.frame;
        self.context.distrust(&mut times);
        Ok(Some(times))
    }

    /// The time of a frame, the GPU's if it can be trusted.
    fn cost(&self, frame: &TimedFrame) -> FrameCost {
        let gpu = frame.timing.gpu().filter(|_| self.context.timestamps);
        FrameCost {
            gpu_ms: gpu.map(ms),
            wall_ms: ms(frame.wall),
        }
    }

    /// Runs a frame, with every pass if `all_passes` is true; returns its outputs, times,
    /// and the resources that were made for it.
    fn run(
        &mut self,
        index: usize,
        all_passes: bool,
    ) -> Result<(Contents, TimedFrame, Vec<Remade>), Stop> {
        let (session, frames) = (self.context.session, self.context.path.frames);
        session.check_stopped()?;
        let viewport = self.executor.plan().viewport();
        frames.show(index, viewport, self.provider)?;
        let before = self.provider.built().to_vec();
        self.executor.refresh(self.provider)?;
        let remade = remade(&before, self.provider.built());
        let read = self.method.preset.judged();
        let request = Frame::new()
            .with_timing(true)
            .with_all(all_passes)
            .with_read(&read)
            .with_seconds(frames.seconds(index));
        let (mut report, wall) = frame::run(session, self.executor, &request)?;
        // As a host does it: between frames, by what has arrived.
        self.executor.grow(self.provider)?;
        let contents = frame::contents(std::mem::take(&mut report.readbacks));
        Ok((contents, timed_frame(report, Duration::ZERO, wall)?, remade))
    }

    /// Runs and judges a frame.
    fn judge(&mut self, index: usize) -> Result<(), Stop> {
        let (contents, timed, remade) = self.run(index, false)?;
        let (path, cost) = (self.context.path, self.cost(&timed));
        let (truth_view, account) = (&path.truth_views[index], &mut self.account);
        let layer = self.context.layer(self.executor.plan());
        let outputs = Outputs::from_contents(contents, layer, &truth_view.ground_truth.pixels);
        let (outputs, judgement) = judged(&self.method.preset, outputs, &truth_view.ground_truth)?;
        let counts = judgement.counts;
        account.edges = account.edges.with(truth_view.edges(&outputs)?);
        if counts.wrong.certain > 0 && judgement.is_hard {
            *account.blockers.get_or_insert_default() += truth_view.blockers(&outputs)?;
        }
        let shown = outputs.shown().into_owned();
        let changed = match &account.before {
            None => None,
            Some(before) => {
                let ground_truth = [
                    &path.truth_views[index - 1].ground_truth,
                    &truth_view.ground_truth,
                ];
                let counts = shimmer(&path.same[index - 1], [before, &shown], ground_truth);
                Some(counts.map_err(|error| CompareError::Input(format!("no shimmer: {error}")))?)
            }
        };
        account.frames.push(SequenceFrame {
            facing_light: counts.pixels.facing_light,
            wrong: counts.wrong.total,
            wrong_outside_band: counts.wrong.total - counts.wrong.in_band,
            graded: judgement.graded,
            rays: outputs.rays,
            cost,
            shimmer: changed,
            skipped: timed.skipped.clone(),
            remade,
            every_pass: None,
        });
        account.timed.push(timed);
        account.counts += counts;
        if let Some(rays) = outputs.rays {
            account.rays = Some(account.rays.unwrap_or(0) + rays);
        }
        account.before = Some(shown);
        account.shares |= outputs.shares.is_some();
        let pixels = JudgedPixels {
            facing_light: counts.pixels.facing_light,
            in_band: counts.band,
        };
        account.graded.push((judgement.graded, pixels));
        // Only a frame that is worse than all before it: of equal ones the first counts.
        let error = account.frames[index].error();
        let worst = account.worst.as_ref();
        if worst.is_none_or(|(worst, ..)| error > account.frames[*worst].error()) {
            account.worst = Some((index, outputs, judgement));
        }
        Ok(())
    }
}
