//! Times many frames of graphs. Methods that are compared take turns: a turn is one frame of each
//! of them, with the same camera, light and meshes.

use crate::comparison::Protocol;
use crate::error::{CompareError, Result};
use crate::measuring::frame::{self, Contents};
use crate::measuring::frame_sequence::FrameSequence;
use crate::measuring::scene_motion::{self, regimes};
use crate::measuring::stop::Stop;
use crate::measuring::view_or_path::ViewOrPath;
use crate::records::regimes::{Regime, RegimeTimes};
use crate::records::results::Pass;
use crate::records::samples::{PassSamples, Samples, TimedFrame, Upkeep};
use crate::records::statistics::{FrameTimes, Spread};
use crate::sink::Session;
use skiagraph_gpu::{ExecuteError, Executor, Frame, FrameReport, FrameTiming};
use skiagraph_passes::{Built, SceneProvider};
use std::collections::BTreeMap;
use std::time::Duration;
use web_time::Instant;

/// Frames that are timed together: the same is shown, or has moved since the frame before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Every pass runs.
    EveryPass,
    /// Frames of a camera path in their order.
    Path,
    /// Frames before which the same has moved.
    Moved(Regime),
}

/// One turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// The choice of frames that it belongs to.
    pub kind: Kind,
    /// Index of the frame that is shown.
    pub frame: usize,
    /// True if the times count; false for a frame that warms up, or brings back what has moved.
    pub is_kept: bool,
}

impl Turn {
    /// Creates a turn from the values of its fields.
    pub fn new(kind: Kind, frame: usize, is_kept: bool) -> Self {
        Self {
            kind,
            frame,
            is_kept,
        }
    }
}

/// Returns the turns of a view or path: of a view, frames in which every pass runs, and after each
/// of them a frame of each regime; of a path, all its frames, then frames of each regime at places
/// spread over it.
pub fn schedule(view: &ViewOrPath, frames: &FrameSequence, protocol: &Protocol) -> Vec<Turn> {
    let (warmup, timed) = (protocol.warmup, protocol.frames);
    let regime_frames = protocol.regime_frames;
    let every_pass = |frame, is_kept| Turn::new(Kind::EveryPass, frame, is_kept);
    let regimes = |frame| {
        let moved = move |regime: &Regime| {
            // Before the parts are moved by maps, those that were bent are brought to their rest.
            let brings = *regime == Regime::AllMeshes;
            let brought = brings.then(|| Turn::new(Kind::Moved(*regime), frame, false));
            brought
                .into_iter()
                .chain([Turn::new(Kind::Moved(*regime), frame, true)])
        };
        regimes(frames).iter().flat_map(moved)
    };
    let mut turns: Vec<Turn> = (0..warmup).map(|_| every_pass(0, false)).collect();
    let count = frames.poses.len();
    match view {
        ViewOrPath::Still(_) => {
            for round in 0..timed.max(regime_frames) {
                turns.push(every_pass(0, round < timed));
                turns.extend(regimes(0).filter(|_| round < regime_frames));
            }
        }
        ViewOrPath::Path(_) => {
            turns.extend((0..count).map(|frame| Turn::new(Kind::Path, frame, true)));
            for round in 0..regime_frames as usize {
                let frame = round * count / regime_frames as usize;
                turns.push(every_pass(frame, false));
                turns.extend(regimes(frame));
            }
        }
    }
    turns
}

/// Timed frames of one method by their kind, each list in the order of the turns.
pub type TimedKinds = BTreeMap<Kind, Vec<TimedFrame>>;

/// Methods that take turns on a scene of their own, which moves.
pub struct Takes<'t, 'e> {
    session: Session<'t>,
    frames: &'t FrameSequence,
    viewport: [u32; 2],
    provider: SceneProvider,
    takes: Vec<Take<'e>>,
    /// Names of the outputs that are read back.
    read: &'t [&'t str],
    /// Contents of these, of the frame that was drawn last.
    shown: Option<Contents>,
    /// Resources of the scene that were made in the last turn.
    made: Vec<Built>,
    first: Instant,
    turns: usize,
}

/// One method that takes turns: its executor, and its frames so far or the error that ended it.
struct Take<'e> {
    executor: &'e mut Executor,
    timed: Result<TimedKinds, ExecuteError>,
}

impl<'t, 'e> Takes<'t, 'e> {
    /// Prepares turns of executors. `provider` is the one that they were made with; it does not
    /// move itself.
    pub fn new(
        session: Session<'t>,
        frames: &'t FrameSequence,
        viewport: [u32; 2],
        provider: &SceneProvider,
        executors: impl IntoIterator<Item = &'e mut Executor>,
    ) -> Self {
        let take = |executor| Take {
            executor,
            timed: Ok(BTreeMap::new()),
        };
        Self {
            session,
            frames,
            viewport,
            provider: provider.branch(),
            takes: executors.into_iter().map(take).collect(),
            read: &[],
            shown: None,
            made: Vec::new(),
            first: Instant::now(),
            turns: 0,
        }
    }

    /// Has frames from now on read back outputs.
    pub fn read(&mut self, names: &'t [&'t str]) {
        self.read = names;
    }

    /// Returns what the frame that was drawn last has shown, and the resources of the scene that
    /// were made in its turn; `None` behind an error.
    pub fn shown(&mut self) -> Option<(Contents, &[Built])> {
        Some((self.shown.take()?, &self.made))
    }

    /// Has each executor draw a frame. Each turn begins with another of them, so that none always
    /// follows the same one. An executor that fails takes no further part.
    ///
    /// The executors share what is made of the scene, such as a hierarchy: the first that needs it
    /// makes it. Its time counts for each that reads it, as if each had made its own.
    ///
    /// # Errors
    /// An early end; positions that are not finite.
    pub async fn take(&mut self, turn: Turn) -> Result<()> {
        match turn.kind {
            Kind::EveryPass | Kind::Path => {
                self.frames
                    .show(turn.frame, self.viewport, &mut self.provider)?;
            }
            Kind::Moved(regime) => {
                let (step, shown) = ((regime, self.turns), (self.frames, turn.frame));
                scene_motion::step(step, shown, self.viewport, &mut self.provider)?;
            }
        }
        let count = self.takes.len();
        self.made.clear();
        for place in 0..count {
            self.session.check_stopped()?;
            let index = (place + self.turns) % count;
            if self.takes[index].timed.is_err() {
                continue;
            }
            let frame = self.frame(index, turn).await;
            let take = &mut self.takes[index];
            match (frame, &mut take.timed) {
                (Err(ExecuteError::Unfinished { .. }), _) if self.session.is_stopped() => {
                    return Err(CompareError::interrupted());
                }
                (Err(error), timed) => *timed = Err(error),
                (Ok(frame), Ok(timed)) if turn.is_kept => {
                    timed.entry(turn.kind).or_default().push(frame);
                }
                (Ok(_), _) => {}
            }
        }
        self.turns += 1;
        if turn.is_kept && turn.kind != Kind::EveryPass {
            for take in &mut self.takes {
                take.charge(turn.kind, &self.made);
            }
        }
        Ok(())
    }

    /// Times a frame of one executor.
    async fn frame(&mut self, index: usize, turn: Turn) -> Result<TimedFrame, ExecuteError> {
        let (executor, provider) = (&mut *self.takes[index].executor, &mut self.provider);
        let (session, first) = (self.session, self.first);
        let request = Frame::new().with_seconds(self.frames.seconds(turn.frame));
        let request = request.with_read(self.read);
        let draw = async |executor: &mut Executor| {
            // A frame with timing is never left out.
            if turn.kind == Kind::Moved(Regime::Nothing)
                && let Some((frame, cpu)) = rest(session, executor, &request).await?
            {
                return Ok((frame, cpu, Contents::new()));
            }
            let is_whole = turn.kind == Kind::EveryPass;
            let request = request.with_timing(true).with_all(is_whole);
            let began = first.elapsed();
            let (mut report, wall) = frame::run(session, executor, &request).await?;
            let contents = frame::contents(std::mem::take(&mut report.readbacks));
            Ok((timed_frame(report, began, wall)?, Duration::ZERO, contents))
        };
        let drawn = frame::next(executor, provider, draw).await?;
        let ((frame, rested, shown), upkeep) = (drawn.frame, drawn.upkeep);
        // Resources that no pass reads, made for others that one does, stay this method's own.
        let read = executor.plan().provided();
        let own = drawn.made.iter().filter(|built| is_read(built, &read));
        let shared: Duration = own.clone().map(|built| built.time).sum();
        let shared_bytes: u64 = own.clone().map(|built| built.uploaded).sum();
        self.shown = Some(shown);
        self.made.extend(&drawn.made);
        let upkeep = (turn.kind != Kind::EveryPass).then(|| Upkeep {
            time: (upkeep.time + rested).saturating_sub(shared),
            uploaded: upkeep.uploaded.saturating_sub(shared_bytes),
        });
        Ok(TimedFrame { upkeep, ..frame })
    }

    /// Returns for each executor, in their order, its timed frames, or the error that ended it.
    pub fn end(self) -> Vec<Result<TimedKinds, ExecuteError>> {
        self.takes.into_iter().map(|take| take.timed).collect()
    }
}

impl Take<'_> {
    /// Adds to the upkeep of the last frame of a kind what was made of the scene for its passes.
    fn charge(&mut self, kind: Kind, made: &[Built]) {
        let read = self.executor.plan().provided();
        let timed = self.timed.as_mut().ok();
        let frame = timed.and_then(|timed| timed.get_mut(&kind)?.last_mut());
        let Some(upkeep) = frame.and_then(|frame| frame.upkeep.as_mut()) else {
            return;
        };
        for built in made.iter().filter(|built| is_read(built, &read)) {
            upkeep.time += built.time;
            upkeep.uploaded += built.uploaded;
        }
    }
}

/// True if a build has made one of the resources that a plan reads.
fn is_read(built: &Built, read: &[&str]) -> bool {
    read.iter().any(|name| built.makes(name))
}

/// Runs a frame without timing. If no pass ran, returns a frame without times, and the time that
/// the CPU took.
async fn rest(
    session: Session<'_>,
    executor: &mut Executor,
    request: &Frame<'_>,
) -> Result<Option<(TimedFrame, Duration)>, ExecuteError> {
    let began = Instant::now();
    frame::submit(session, executor, request)?;
    let cpu = began.elapsed();
    let report = frame::wait(session, executor).await?;
    let passes = executor.plan().passes().len();
    let frame = || TimedFrame {
        began: Duration::ZERO,
        timing: FrameTiming::new(Vec::new()),
        wall: Duration::ZERO,
        upkeep: None,
        skipped: report.skipped.clone(),
    };
    Ok((report.skipped.len() == passes).then(|| (frame(), cpu)))
}

/// Runs `warmup` frames of one method, then `timed` timed ones, with every pass, on the first of
/// `frames`. `done` is called with the number of finished frames. If the session's sink asks for an
/// early end, the frames timed until then are returned.
///
/// # Errors
/// Those of the executor.
pub async fn sample(
    session: Session<'_>,
    frames: &FrameSequence,
    (executor, provider): (&mut Executor, &SceneProvider),
    [warmup, timed]: [u32; 2],
    done: impl Fn(u64),
) -> Result<Vec<TimedFrame>, Stop> {
    let viewport = executor.plan().viewport();
    let mut takes = Takes::new(session, frames, viewport, provider, [executor]);
    for index in 0..u64::from(warmup) + u64::from(timed) {
        // Warm-up frames are timed too: they then do the same work.
        let is_kept = index >= u64::from(warmup);
        match takes.take(Turn::new(Kind::EveryPass, 0, is_kept)).await {
            Err(CompareError::Interrupted { .. }) => break,
            taken => taken?,
        }
        done(index + 1);
    }
    let kinds = takes.end().pop().transpose()?.unwrap_or_default();
    Ok(kinds.into_values().flatten().collect())
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
    let none = ExecuteError::Internal("a timed frame came back without times");
    let timing = report.timing.ok_or(none)?;
    Ok(TimedFrame {
        began,
        timing,
        wall,
        upkeep: None,
        skipped: report.skipped,
    })
}

/// Summarises the times of some frames, of whole ones and of each pass in the order in which they
/// ran; without GPU times unless `has_gpu`.
///
/// # Errors
/// [`CompareError::Interrupted`] if there are no frames.
pub fn times(timed: &[TimedFrame], has_gpu: bool) -> Result<(FrameTimes, Vec<Pass>)> {
    let samples = Samples::new(timed, has_gpu);
    let frame = FrameTimes::new(samples.gpu, samples.upkeep, samples.wall);
    let pass = |PassSamples { name, gpu, cpu }| Pass {
        name,
        gpu_ms: gpu.and_then(Spread::new),
        cpu_ms: Spread::new(cpu).expect("a pass is named by its first sample"),
    };
    let passes = samples.passes.into_iter().map(pass).collect();
    Ok((frame.ok_or_else(CompareError::interrupted)?, passes))
}

/// Summarises the frames of each regime; without GPU times unless `has_gpu`.
///
/// # Errors
/// [`CompareError::Interrupted`] for a regime without frames.
pub fn regime_times(timed: &TimedKinds, has_gpu: bool) -> Result<Vec<RegimeTimes>> {
    let of_regimes = timed.iter().filter_map(|(kind, frames)| match kind {
        Kind::Moved(regime) => Some((*regime, frames)),
        Kind::EveryPass | Kind::Path => None,
    });
    let summary = |(regime, frames): (Regime, &Vec<TimedFrame>)| {
        let upkeeps = frames.iter().filter_map(|frame| frame.upkeep.as_ref());
        let mut uploaded: Vec<u64> = upkeeps.map(|upkeep| upkeep.uploaded).collect();
        uploaded.sort_unstable();
        let median = uploaded.get(uploaded.len() / 2).copied();
        let skipped = frames.first().map(|frame| frame.skipped.clone());
        Ok(RegimeTimes {
            regime,
            frame: times(frames, has_gpu)?.0,
            uploaded_bytes: median.unwrap_or_default(),
            skipped: skipped.unwrap_or_default(),
        })
    };
    of_regimes.map(summary).collect()
}
