//! Runs one frame of a graph on a GPU, and reads its outputs back.
//!
//! ```no_run
//! use skiagraph_compare::{measuring::frame, sink::Session};
//! use skiagraph_gpu::{ExecuteError, Frame};
//! use skiagraph_graph::Plan;
//! use skiagraph_passes::SceneProvider;
//!
//! # type Done = Result<(), ExecuteError>;
//! # async fn time(session: Session<'_>, plan: Plan, scene: &mut SceneProvider) -> Done {
//! let (mut executor, growth) = frame::settled(session, plan, scene).await?;
//! print!("{}", growth.text());
//! for _ in 0..10 {
//!     let (report, wall) = frame::run(session, &mut executor, &Frame::default()).await?;
//!     println!("{wall:?}, without {}", report.skipped.join(", "));
//! }
//! # Ok(())
//! # }
//! ```

use crate::error::CompareError;
use crate::records::samples::Upkeep;
use crate::sink::Session;
use crate::wording::frames;
use skiagraph_gpu::{
    Content, ExecuteError, Executor, Frame, FrameReport, Provider, Readback, submitted_work,
};
use skiagraph_graph::Plan;
use skiagraph_passes::{Built, SceneProvider};
use std::{collections::BTreeMap, time::Duration};
use web_time::Instant;

/// Contents that were read back from a frame, by the names of the outputs and of the captures
/// (materials that the plan copies for the host after a pass).
pub type Contents = BTreeMap<String, Content>;

/// Creates the executor of a plan, with growing buffers (those whose size depends on the frame's
/// content) as large as a frame needs: in smaller ones the items that do not fit are lost. Runs
/// frames to find the sizes, and returns a report of them. A method that reuses results of earlier
/// frames then starts without any.
///
/// # Errors
/// The errors of the executor.
pub async fn settled(
    session: Session<'_>,
    plan: Plan,
    provider: &mut dyn Provider,
) -> Result<(Executor, Growth), ExecuteError> {
    let mut grown = Executor::on(session.gpu, plan, provider)?;
    let growth = grow(session, &mut grown, provider).await?;
    if growth.frames == 0 || !grown.plan().remembers() {
        return Ok((grown, growth));
    }
    let plan = grown.plan().with(|_| ())?;
    drop(grown);
    Ok((Executor::on(session.gpu, plan, provider)?, growth))
}

/// Runs one frame of a plan with an executor from [`settled`]. Returns the contents of the outputs
/// and captures that `names` lists, and the report of the frames that were run to find buffer
/// sizes.
///
/// # Errors
/// The errors of the executor.
pub async fn render(
    session: Session<'_>,
    plan: Plan,
    provider: &mut dyn Provider,
    names: &[&str],
) -> Result<(Contents, Growth), ExecuteError> {
    let (mut executor, growth) = settled(session, plan, provider).await?;
    Ok((read(session, &mut executor, names).await?, growth))
}

/// A frame that was drawn behind a change of the scene, and what the change cost.
pub struct Drawn<T> {
    /// The frame.
    pub frame: T,
    /// Work of the CPU between the change and the frame.
    pub upkeep: Upkeep,
    /// Resources of the scene that were made for the frame.
    pub made: Vec<Built>,
}

/// Draws a frame as a host does it: brings what the executor reads of the scene up to date, lets
/// `draw` run the frame, and lets buffers grow by the counts that have arrived.
///
/// # Errors
/// The errors of the executor and of `draw`.
pub async fn next<T>(
    executor: &mut Executor,
    provider: &mut SceneProvider,
    draw: impl AsyncFnOnce(&mut Executor) -> Result<T, ExecuteError>,
) -> Result<Drawn<T>, ExecuteError> {
    let (built, uploaded) = (provider.built().to_vec(), provider.work().uploaded);
    let earlier = |name| built.iter().find(|earlier| earlier.name == name);
    let times = |name| earlier(name).map_or(0, |earlier| earlier.times);
    let began = Instant::now();
    executor.refresh(provider)?;
    let time = began.elapsed();
    let is_new = |made: &&Built| made.times > times(made.name);
    let made = provider.built().iter().filter(is_new).copied().collect();
    let frame = draw(executor).await?;
    executor.grow(provider)?;
    let uploaded = provider.work().uploaded - uploaded;
    Ok(Drawn {
        frame,
        upkeep: Upkeep { time, uploaded },
        made,
    })
}

/// Runs one frame and waits for its end. Returns the frame's report, and the time from the start of
/// encoding until the GPU was done.
///
/// # Errors
/// The errors of the executor; [`ExecuteError::Unfinished`] for a frame that was abandoned after
/// the GPU's timeout, or because the session's sink asked for an early end. The device cannot be
/// used after that.
pub async fn run(
    session: Session<'_>,
    executor: &mut Executor,
    frame: &Frame<'_>,
) -> Result<(FrameReport, Duration), ExecuteError> {
    let began = Instant::now();
    submit(session, executor, frame)?;
    let report = wait(session, executor).await?;
    Ok((report, began.elapsed()))
}

/// Encodes and submits a frame, which [`wait`] waits for.
///
/// # Errors
/// Those of [`run`].
pub(crate) fn submit(
    session: Session,
    executor: &mut Executor,
    frame: &Frame,
) -> Result<(), ExecuteError> {
    let began = Instant::now();
    let gives_up = || is_over(session, began);
    let submitted = executor.submit(frame, &gives_up);
    if let Err(ExecuteError::Unfinished { .. }) = submitted {
        abandon(session);
    }
    submitted.map(drop)
}

/// Frames after which buffers are as large as they get: each brings the count of the one before.
const GROWING: u32 = 8;

/// Report of the frames that were run until growing buffers (those whose size depends on the
/// frame's content) had room for everything that a frame writes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Growth {
    /// Number of frames that were run; 0 if the graph has no buffers whose size depends on the
    /// frame's content.
    pub frames: u32,
    /// Full names of the graph's buffers and textures whose size depends on the frame's content.
    pub buffers: Vec<String>,
    /// True if the last of these frames needed no larger buffers. False if eight frames were not
    /// enough.
    pub is_settled: bool,
}

impl Growth {
    /// Returns the report as a line of text for a terminal; empty if no frame was run.
    pub fn text(&self) -> String {
        let (frames, buffers) = (frames(self.frames), self.buffers.join(", "));
        match (self.frames, self.is_settled) {
            (0, _) => String::new(),
            (_, true) => format!(
                "  warmed up: {frames} before this one, until {buffers} had room for all that a \
                 frame needs\n"
            ),
            (_, false) => format!(
                "  warmed up: {frames} before this one, and {buffers} still grew: what has no room \
                 is chance\n"
            ),
        }
    }
}

/// Runs up to eight frames, until the executor's growing buffers (those whose size depends on the
/// frame's content) have room for everything that a frame writes.
///
/// # Errors
/// The errors of the executor.
pub async fn grow(
    session: Session<'_>,
    executor: &mut Executor,
    provider: &mut dyn Provider,
) -> Result<Growth, ExecuteError> {
    let plan = executor.plan();
    let names = plan.growing().into_iter();
    let names = names.map(|(id, _)| plan.resource(id).name.clone());
    let mut growth = Growth {
        buffers: names.collect(),
        ..Growth::default()
    };
    while !growth.buffers.is_empty() && !growth.is_settled && growth.frames < GROWING {
        run(session, executor, &Frame::default()).await?;
        growth.frames += 1;
        growth.is_settled = executor.grow(provider)?.is_none();
    }
    Ok(growth)
}

/// Waits for a submitted frame, but no longer than the GPU's timeout, and not after Ctrl-C. The
/// device of a frame that is given up is of no more use.
pub(crate) async fn wait(
    session: Session<'_>,
    executor: &mut Executor,
) -> Result<FrameReport, ExecuteError> {
    let began = Instant::now();
    let (mut is_over, mut patience) = (false, Duration::ZERO);
    loop {
        let passes = match executor.finish_within(Some(patience)) {
            Err(ExecuteError::Unfinished { passes, .. }) => passes,
            done => return done,
        };
        if is_over {
            abandon(session);
            let after = began.elapsed();
            return Err(ExecuteError::Unfinished { after, passes });
        }
        submitted_work(&session.gpu.device, &session.gpu.queue).await;
        // A frame that is done by now counts, and its report may come a moment after it.
        is_over = self::is_over(session, began);
        patience = Duration::from_millis(1);
    }
}

/// True after Ctrl-C, and when a frame that began then has reached the GPU's timeout.
fn is_over(session: Session, began: Instant) -> bool {
    let timeout = session.gpu.timeout;
    session.is_stopped() || timeout.is_some_and(|timeout| began.elapsed() >= timeout)
}

/// Keeps the queue of a frame that is given up: wgpu waits for it when its last handle is dropped,
/// and there would be no end to that either.
fn abandon(session: Session) {
    std::mem::forget(session.gpu.queue.clone());
}

/// Converts an executor's error into the error that ends the command on the graph named `graph`: an
/// early end if the sink asked for it, otherwise [`CompareError::Gpu`].
pub fn failed(session: Session, graph: &str, error: ExecuteError) -> CompareError {
    match error {
        ExecuteError::Unfinished { .. } if session.is_stopped() => CompareError::interrupted(),
        error => CompareError::Gpu {
            graph: graph.to_owned(),
            source: Box::new(error),
        },
    }
}

/// Runs one frame, and returns the contents of the outputs and captures that `names` lists.
///
/// # Errors
/// The errors of the executor.
pub async fn read(
    session: Session<'_>,
    executor: &mut Executor,
    names: &[&str],
) -> Result<Contents, ExecuteError> {
    let frame = Frame::new().with_read(names);
    let (report, _) = run(session, executor, &frame).await?;
    Ok(contents(report.readbacks))
}

/// Returns the contents of readbacks by their names.
pub fn contents(readbacks: Vec<Readback>) -> Contents {
    let named = |readback: Readback| (readback.name, readback.content);
    readbacks.into_iter().map(named).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{explain, is_fatal};
    use crate::graphs::planning::{Capabilities, placeholder};
    use crate::graphs::preset;
    use crate::measuring::device::{self, GpuRequest};
    use crate::sink::Silent;
    use skiagraph_gpu::block_on;

    /// As a driver's reset does it, but on demand.
    #[test]
    fn a_lost_device_is_an_error_of_its_own() {
        let gpu =
            device::open(&GpuRequest::default(), []).unwrap_or_else(|error| panic!("{error}"));
        let session = Session::new(&gpu, &Silent);
        let preset = preset::load_all(&["nsm".into()], &preset::sources(&Silent)).unwrap();
        let mut provider = placeholder([16, 16], &preset[0].graph);
        let request = Capabilities::new(&gpu).request([16, 16], &provider);
        let plan = preset[0].graph.plan(&request).unwrap();
        let mut executor = Executor::on(&gpu, plan, &mut provider).unwrap();
        block_on(run(session, &mut executor, &Frame::default())).unwrap();
        gpu.device.destroy();
        let Err(lost) = block_on(run(session, &mut executor, &Frame::default())) else {
            panic!("a destroyed device ran a frame");
        };
        assert!(is_fatal(&lost), "{lost}");
        assert!(explain(&lost).starts_with("the device was lost"), "{lost}");
        let failed = failed(session, "nsm", lost);
        assert!(matches!(failed, CompareError::Gpu { .. }), "{failed:?}");
    }
}
