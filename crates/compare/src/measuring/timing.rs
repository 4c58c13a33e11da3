//! Many frames of a graph, timed.

use crate::error::CompareError;
use crate::measuring::frame;
use crate::measuring::stop::Stop;
use crate::records::results::{Cached, Pass};
use crate::records::samples::{PassSamples, Samples, TimedFrame};
use crate::records::statistics::{FrameTimes, Spread};
use crate::sink::Session;
use skiagraph_gpu::{ExecuteError, Executor, Frame, FrameReport};
use std::time::{Duration, Instant};

/// Kinds of frames that are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameMode {
    /// Every pass runs in every frame.
    AllPasses,
    /// The camera moves before every frame, and passes run by their conditions.
    CameraMoves,
}

/// Runs `warmup` frames, then `frames` timed ones. `done` hears how many frames are over. Ctrl-C
/// ends it early; what was timed until then is returned.
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
        let began = first.elapsed();
        // Warm-up frames are timed too: they then do the same work, only their figures are not
        // kept.
        if mode == FrameMode::CameraMoves && executor.plan().provided().contains(&"camera") {
            executor.touch("camera")?;
        }
        let request = Frame {
            timing: true,
            all: mode == FrameMode::AllPasses,
            ..Frame::default()
        };
        let (report, wall) = match frame::run(session, executor, &request) {
            Err(ExecuteError::Unfinished { .. }) if session.is_stopped() => break,
            done => done?,
        };
        if index >= u64::from(warmup) {
            timed.push(timed_frame(report, began, wall)?);
        }
        done(index + 1);
    }
    Ok(timed)
}

/// The times of a frame that was run with timing.
///
/// # Errors
/// There are none.
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

/// Times of some frames, per pass and whole.
pub struct Times {
    /// Per pass.
    pub passes: Vec<Pass>,
    /// Whole frames.
    pub frame: FrameTimes,
    /// The passes that did not run in the first frame.
    pub skipped: Vec<String>,
}

impl Times {
    /// The times of some frames in short.
    ///
    /// # Errors
    /// Ctrl-C came before there were any.
    pub fn new(timed: Vec<TimedFrame>) -> Result<Self, CompareError> {
        let samples = Samples::new(&timed);
        let pass = |PassSamples { name, gpu, cpu }| Pass {
            name,
            gpu_ms: Spread::from_all(&gpu),
            cpu_ms: Spread::new(&cpu).expect("a pass is named by its first sample"),
        };
        let first = timed.into_iter().next();
        Ok(Self {
            frame: FrameTimes {
                gpu_ms: Spread::from_all(&samples.gpu),
                wall_ms: Spread::new(&samples.wall).ok_or_else(CompareError::interrupted)?,
            },
            passes: samples.passes.into_iter().map(pass).collect(),
            skipped: first.map_or_else(Vec::new, |first| first.skipped),
        })
    }
}

/// [`sample`] in short.
///
/// # Errors
/// Those of the executor, Ctrl-C.
pub fn times(
    session: Session,
    executor: &mut Executor,
    mode: FrameMode,
    [warmup, frames]: [u32; 2],
    done: impl Fn(u64),
) -> Result<Times, Stop> {
    let timed = sample(session, executor, mode, [warmup, frames], done)?;
    if timed.len() < frames as usize {
        return Err(CompareError::interrupted().into());
    }
    Ok(Times::new(timed)?)
}

/// The times of frames in which only the camera moves; none if every pass runs then too.
///
/// # Errors
/// Those of the executor, Ctrl-C.
pub fn cached(
    session: Session,
    executor: &mut Executor,
    frames: u32,
) -> Result<Option<Cached>, Stop> {
    if frames == 0 {
        return Ok(None);
    }
    let moves = FrameMode::CameraMoves;
    let mut times = |frames| times(session, executor, moves, [0, frames], |_| {});
    let skipped = times(1)?.skipped;
    if skipped.is_empty() {
        return Ok(None);
    }
    let frame = times(frames)?.frame;
    Ok(Some(Cached { frame, skipped }))
}
