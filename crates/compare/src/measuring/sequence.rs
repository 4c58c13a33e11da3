//! A method over the frames of a camera path, each judged.

use crate::error::CompareError;
use crate::graphs::ground_truth::{Judgement, judged};
use crate::graphs::method::Method;
use crate::graphs::shadow_method::Outputs;
use crate::measuring::camera_pose::CameraPose;
use crate::measuring::diagnostics::{Diagnostics, diagnose};
use crate::measuring::frame;
use crate::measuring::ground_truth::{GroundTruthView, heard, own_counts};
use crate::measuring::mesh_frames::MeshFrames;
use crate::measuring::run::{MeasureContext, Prepared};
use crate::measuring::stop::Stop;
use crate::measuring::timing::{Times, timed_frame};
use crate::records::results::Measured;
use crate::records::samples::TimedFrame;
use crate::records::sequence::{FrameCost, Remade, Sequence, SequenceFrame};
use crate::records::statistics::FrameTimes;
use crate::sink::{Sink, Step};
use skiagraph_gpu::{Executor, Frame, FrameReport};
use skiagraph_graph::Plan;
use skiagraph_passes::{Built, How, SceneProvider};
use skiagraph_reference::{
    BlockerCounts, EdgeDistances, Graded, JudgedPixels, Shimmer, Statistics,
    shimmer::{same_receivers, shimmer},
};
use std::time::Duration;

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// The frames of a path with their ground truth.
pub struct Path<'a> {
    /// From where.
    pub poses: Vec<CameraPose>,
    /// The mesh in each frame, where parts of it move.
    mesh_frames: Option<&'a MeshFrames>,
    /// The ground truth of each.
    pub truth_views: Vec<GroundTruthView<'a>>,
    /// Frames per second of the path's own time.
    frames_per_second: f64,
    /// For each frame but the first, where each pixel's receiver was in the frame before.
    same: Vec<Vec<u32>>,
}

impl<'a> Path<'a> {
    /// Finds receivers that are seen in two frames one after the other.
    ///
    /// # Errors
    /// Ctrl-C.
    pub fn new(
        (poses, frames_per_second): (Vec<CameraPose>, f64),
        mesh_frames: Option<&'a MeshFrames>,
        truth_views: Vec<GroundTruthView<'a>>,
        sink: &dyn Sink,
    ) -> Result<Self, CompareError> {
        let progress = heard(sink, &|_| ());
        let pairs = truth_views.windows(2);
        let same = pairs.map(|pair| same_receivers(pair[0].seen(), pair[1].seen(), progress));
        let same = same.collect::<Result<_, _>>();
        let same = same.map_err(|_| CompareError::interrupted())?;
        Ok(Self {
            poses,
            mesh_frames,
            truth_views,
            frames_per_second,
            same,
        })
    }

    /// Gives the provider a frame's camera, light and mesh.
    fn show(
        &self,
        index: usize,
        viewport: [u32; 2],
        provider: &mut SceneProvider,
    ) -> Result<(), CompareError> {
        self.poses[index].show(provider, viewport);
        match self.mesh_frames {
            Some(mesh_frames) => mesh_frames.show(index, provider),
            None => Ok(()),
        }
    }

    /// When a frame is.
    fn seconds(&self, index: usize) -> f32 {
        (index as f64 / self.frames_per_second) as f32
    }

    /// Pixels of all frames that show a surface which is not seen there.
    pub fn wrong_surfaces(&self) -> u64 {
        self.truth_views
            .iter()
            .map(|truth_view| truth_view.wrong_surfaces)
            .sum()
    }

    /// The reference's pixels of all frames together.
    pub fn own_counts(&self) -> Statistics {
        let mut all = Statistics::default();
        for truth_view in &self.truth_views {
            all += own_counts(&truth_view.ground_truth.pixels);
        }
        all
    }
}

/// A frame that was run.
struct Done {
    report: FrameReport,
    wall: Duration,
    remade: Vec<Remade>,
}

/// Lists the resources that were made between two moments.
fn remade(before: &[Built], now: &[Built]) -> Vec<Remade> {
    let times = |of: &Built| {
        let known = before.iter().find(|known| known.name == of.name);
        known.map_or(0, |known| known.times)
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

/// Runs a method over a path, with what it keeps from frame to frame.
///
/// # Errors
/// A method that the device refuses, Ctrl-C, a lost device, outputs that are not a shadow
/// method's, a picture that cannot be written.
pub fn follow(
    context: &MeasureContext<'_>,
    method: &Method,
    plan: Plan,
    path: &Path,
    provider: &mut SceneProvider,
    step: &Step,
) -> Result<Measured, Stop> {
    let mut prepared = begin(context, plan, path, provider)?;
    let executor = &mut prepared.executor;
    let mut account = Account::default();
    let names = method.preset.judged();
    for index in 0..path.poses.len() {
        let done = run_frame(context, executor, path, index, (&names, false), provider)?;
        add(context, method, path, index, done, &mut account)?;
        step.set_done(u64::from(context.warmup) + index as u64 + 1);
    }
    let every_pass = every_pass(context, executor, path, &names, provider, &mut account)?;
    let times = Times::new(account.timed)?;
    let (mut images, mut found) = (None, Diagnostics::default());
    if let Some((index, outputs, judgement)) = &account.worst {
        let truth_view = &path.truth_views[*index];
        let ground_truth = &truth_view.ground_truth;
        path.show(*index, ground_truth.pixels.viewport, provider)?;
        found = diagnose(
            context.session,
            method,
            truth_view,
            (outputs, context.light),
            provider,
        )?;
        images = context.draw(
            method,
            Some(*index),
            ground_truth,
            (outputs, judgement, &found),
        )?;
    }
    let mut all = Shimmer::default();
    for frame in &account.frames {
        all += frame.shimmer.unwrap_or_default();
    }
    Ok(Measured {
        rays: account.rays,
        certain_wrong_blockers: account.blockers,
        graded: Graded::together(account.graded),
        edges: account.edges,
        images,
        texels: found.texels,
        layer_jump: found.layer_jump,
        sequence: Some(Sequence {
            frames: account.frames,
            shimmer: all,
            every_pass,
        }),
        ..context.measured(prepared, times, &account.counts, account.shares)
    })
}

/// An executor that stands still at the path's begin until it is warm, or, of a method that
/// remembers, until it is in its steady state: so all flags give the same pictures.
fn begin(
    context: &MeasureContext<'_>,
    plan: Plan,
    path: &Path,
    provider: &mut SceneProvider,
) -> Result<Prepared, Stop> {
    path.show(0, context.truth_view.ground_truth.pixels.viewport, provider)?;
    let mut prepared = context.prepare(plan, provider)?;
    if prepared.steady.is_none() {
        for _ in 0..context.warmup {
            frame::run(context.session, &mut prepared.executor, &Frame::default())?;
        }
    }
    Ok(prepared)
}

/// The path once more with every pass run in every frame, where some were skipped: its pictures
/// have been judged by then, and what it keeps may change.
fn every_pass(
    context: &MeasureContext<'_>,
    executor: &mut Executor,
    path: &Path,
    names: &[&str],
    provider: &mut SceneProvider,
    account: &mut Account,
) -> Result<Option<FrameTimes>, Stop> {
    let skips = account.frames.iter().any(|frame| !frame.skipped.is_empty());
    if !skips || context.cached_frames == 0 {
        return Ok(None);
    }
    let mut timed = Vec::new();
    // The first one brings the camera back, and is no frame of the path.
    for index in std::iter::once(0).chain(0..path.poses.len()) {
        let done = run_frame(context, executor, path, index, (names, true), provider)?;
        timed.push(timed_frame(done.report, Duration::ZERO, done.wall)?);
    }
    let timed = timed.split_off(1);
    for (frame, timed) in account.frames.iter_mut().zip(&timed) {
        frame.every_pass = Some(FrameCost {
            gpu_ms: gpu_ms(context, timed),
            wall_ms: ms(timed.wall),
        });
    }
    let mut times = Times::new(timed)?.frame;
    context.distrust(&mut times);
    Ok(Some(times))
}

/// The GPU's time of a frame, if it can be trusted.
fn gpu_ms(context: &MeasureContext<'_>, frame: &TimedFrame) -> Option<f64> {
    frame.timing.gpu().filter(|_| context.timestamps).map(ms)
}

fn run_frame(
    context: &MeasureContext<'_>,
    executor: &mut Executor,
    path: &Path,
    index: usize,
    (read, all): (&[&str], bool),
    provider: &mut SceneProvider,
) -> Result<Done, Stop> {
    context.session.check_stopped()?;
    let viewport = context.truth_view.ground_truth.pixels.viewport;
    path.show(index, viewport, provider)?;
    let before = provider.built().to_vec();
    executor.refresh(provider)?;
    let remade = remade(&before, provider.built());
    let request = Frame {
        timing: true,
        statistics: false,
        all,
        read,
        seconds: path.seconds(index),
    };
    let (report, wall) = frame::run(context.session, executor, &request)?;
    // As a host does it: between frames, by what has arrived.
    executor.grow(provider)?;
    Ok(Done {
        report,
        wall,
        remade,
    })
}

fn add(
    context: &MeasureContext<'_>,
    method: &Method,
    path: &Path,
    index: usize,
    done: Done,
    account: &mut Account,
) -> Result<(), Stop> {
    let Done {
        mut report,
        wall,
        remade,
    } = done;
    let truth_view = &path.truth_views[index];
    let contents = frame::contents(std::mem::take(&mut report.readbacks));
    let timed = timed_frame(report, Duration::ZERO, wall)?;
    let outputs = context.decode(contents, truth_view);
    let (outputs, judgement) = judged(&method.preset, outputs, &truth_view.ground_truth)?;
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
        gpu_ms: gpu_ms(context, &timed),
        wall_ms: ms(wall),
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
