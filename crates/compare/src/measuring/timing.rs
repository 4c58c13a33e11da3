//! Times many frames of graphs.

use crate::error::CompareError;
use crate::measuring::frame;
use crate::records::results::{Cached, Pass};
use crate::records::samples::{PassSamples, Samples, TimedFrame};
use crate::records::statistics::{FrameTimes, Spread};
use crate::sink::Session;
use skiagraph_gpu::{ExecuteError, Executor, Frame, FrameReport};
use std::time::{Duration, Instant};

/// Choice of the passes that run in timed frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameMode {
    /// Every pass runs in every frame.
    AllPasses,
    /// Only the camera counts as changed before every frame, so that a pass is skipped if none of
    /// its inputs has changed.
    CameraMoves,
}

/// Runs `warmup` frames, then `frames` timed ones. `done` is called with the number of finished
/// frames. If the session's sink asks for an early end, the frames timed until then are returned.
///
/// # Errors
/// Those of the executor.
pub fn sample(
    session: Session,
    executor: &mut Executor,
    mode: FrameMode,
    [warmup, frames]: [u32; 2],
    done: impl Fn(u64),
) -> Result<Vec<TimedFrame>, ExecuteError> {
    let mut timed = Vec::new();
    let mut first = Instant::now();
    for index in 0..u64::from(warmup) + u64::from(frames) {
        if session.is_stopped() {
            break;
        }
        if index == u64::from(warmup) {
            first = Instant::now();
        }
        // Warm-up frames are timed too: they then do the same work, only their figures are not
        // kept.
        let frame = match one_frame(session, executor, mode, first) {
            Err(ExecuteError::Unfinished { .. }) if session.is_stopped() => break,
            done => done?,
        };
        if index >= u64::from(warmup) {
            timed.push(frame);
        }
        done(index + 1);
    }
    Ok(timed)
}

/// Times a frame; `first` is the begin of the first one.
fn one_frame(
    session: Session,
    executor: &mut Executor,
    mode: FrameMode,
    first: Instant,
) -> Result<TimedFrame, ExecuteError> {
    let began = first.elapsed();
    if mode == FrameMode::CameraMoves && executor.plan().provided().contains(&"camera") {
        executor.touch("camera")?;
    }
    let request = Frame::new()
        .with_timing(true)
        .with_all(mode == FrameMode::AllPasses);
    let (report, wall) = frame::run(session, executor, &request)?;
    timed_frame(report, began, wall)
}

/// Runs frames of several executors in turns: `warmup` turns, then `frames` timed ones. Each turn
/// begins with another of them, so that none always follows the same one. `done` is called with the
/// number of finished turns. Returns an entry per executor, in the same order: its timed frames, or
/// the error that ended it. An executor that fails takes no further part, and its times are
/// dropped.
///
/// # Errors
/// An early end; all times are dropped then.
pub fn in_turns(
    session: Session,
    executors: &mut [&mut Executor],
    mode: FrameMode,
    [warmup, frames]: [u32; 2],
    done: impl Fn(u64),
) -> Result<Vec<Result<Vec<TimedFrame>, ExecuteError>>, CompareError> {
    let mut outcomes: Vec<Result<Vec<TimedFrame>, ExecuteError>> =
        executors.iter().map(|_| Ok(Vec::new())).collect();
    let first = Instant::now();
    let turns = u64::from(warmup) + u64::from(frames);
    for turn in 0..turns {
        for place in 0..executors.len() {
            session.check_stopped()?;
            let index = (place + turn as usize) % executors.len();
            let Ok(timed) = &mut outcomes[index] else {
                continue;
            };
            match one_frame(session, executors[index], mode, first) {
                Err(ExecuteError::Unfinished { .. }) if session.is_stopped() => {
                    return Err(CompareError::interrupted());
                }
                Err(error) => outcomes[index] = Err(error),
                Ok(_) if turn < u64::from(warmup) => {}
                Ok(frame) => timed.push(frame),
            }
        }
        done(turn + 1);
    }
    Ok(outcomes)
}

/// Returns the times of a frame that was run with timing. `began` is the time from the start of the
/// first timed frame to the start of this one, `wall` that from the start of encoding until the GPU
/// was done.
///
/// # Errors
/// The report has no times, as the frame was run without timing.
pub fn timed_frame(
    report: FrameReport,
    began: Duration,
    wall: Duration,
) -> Result<TimedFrame, ExecuteError> {
    let timing = report.timing.ok_or(ExecuteError::Internal(
        "a timed frame came back without times",
    ))?;
    Ok(TimedFrame {
        began,
        timing,
        wall,
        skipped: report.skipped,
    })
}

/// Order statistics of the times of some frames, of each pass and of whole frames.
pub struct Times {
    /// Order statistics of the times of each pass, in the order in which the passes ran.
    pub passes: Vec<Pass>,
    /// Order statistics of the times of whole frames, and the time of each frame.
    pub frame: FrameTimes,
    /// Names of the passes that did not run in the first of the frames.
    pub skipped: Vec<String>,
}

impl Times {
    /// Summarises the times of some frames.
    ///
    /// # Errors
    /// [`CompareError::Interrupted`] if there are no frames.
    pub fn new(timed: Vec<TimedFrame>) -> Result<Self, CompareError> {
        let samples = Samples::new(&timed);
        let pass = |PassSamples { name, gpu, cpu }| Pass {
            name,
            gpu_ms: Spread::from_all(&gpu),
            cpu_ms: Spread::new(&cpu).expect("a pass is named by its first sample"),
        };
        let first = timed.into_iter().next();
        Ok(Self {
            frame: FrameTimes::new(&samples.gpu, &samples.wall)
                .ok_or_else(CompareError::interrupted)?,
            passes: samples.passes.into_iter().map(pass).collect(),
            skipped: first.map_or_else(Vec::new, |first| first.skipped),
        })
    }
}

/// Times frames in which only the camera moves: one frame of each executor to find out if it skips
/// a pass, then `frames` timed ones, the executors taking turns. Returns an entry per executor, in
/// the same order: its times, or the error that ended it. The entry is `None` for an executor that
/// skips no pass in such a frame, as its times would equal those of frames in which every pass
/// runs; all are `None` if `frames` is 0.
///
/// # Errors
/// An early end.
pub fn cached(
    session: Session,
    executors: &mut [&mut Executor],
    frames: u32,
) -> Result<Vec<Option<Result<Cached, ExecuteError>>>, CompareError> {
    let mut outcomes: Vec<Option<Result<Cached, ExecuteError>>> =
        executors.iter().map(|_| None).collect();
    if frames == 0 {
        return Ok(outcomes);
    }
    let moves = FrameMode::CameraMoves;
    let tried = in_turns(session, executors, moves, [0, 1], |_| {})?;
    let skips = |timed: &Result<Vec<TimedFrame>, ExecuteError>| match timed {
        Ok(frames) => frames.iter().any(|frame| !frame.skipped.is_empty()),
        Err(_) => true,
    };
    let skips: Vec<bool> = tried.iter().map(skips).collect();
    let executors = executors.iter_mut().zip(&skips);
    let mut those: Vec<&mut Executor> = executors
        .filter(|(_, skips)| **skips)
        .map(|(executor, _)| &mut **executor)
        .collect();
    let places = (0..skips.len()).filter(|index| skips[*index]);
    let timed = in_turns(session, &mut those, moves, [0, frames], |_| {})?;
    for (place, timed) in places.zip(timed) {
        let times = timed
            .map(Times::new)
            .map(|times| times.map(|Times { frame, skipped, .. }| Cached { frame, skipped }));
        outcomes[place] = match times {
            Ok(times) => Some(Ok(times?)),
            Err(error) => Some(Err(error)),
        };
    }
    Ok(outcomes)
}
