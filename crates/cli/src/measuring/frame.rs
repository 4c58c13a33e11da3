//! One frame of a graph on a GPU.

use crate::error::CliError;
use crate::terminal::interrupt;
use skiagraph_gpu::{
    Content, ExecuteError, Executor, Frame, FrameReport, Provider, Readback, device::Gpu,
};
use skiagraph_graph::Plan;
use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

/// What was read of a frame, by its name.
pub type Contents = BTreeMap<String, Content>;

/// Makes what a plan needs on a GPU.
///
/// # Errors
/// Those of the executor.
pub fn executor(
    gpu: &Gpu,
    plan: Plan,
    provider: &mut dyn Provider,
) -> Result<Executor, ExecuteError> {
    Executor::new(&gpu.device, &gpu.queue, plan, provider)
}

/// Runs one frame of `graph` and reads outputs and captures by name.
///
/// # Errors
/// Why it cannot run.
pub fn render(
    gpu: &Gpu,
    graph: &str,
    plan: Plan,
    provider: &mut dyn Provider,
    names: &[&str],
) -> Result<Contents, CliError> {
    executor(gpu, plan, provider)
        .and_then(|mut executor| read(gpu, &mut executor, names))
        .map_err(|error| failed(graph, error))
}

/// Runs one frame to its end; returns what it reports and the time from the start of encoding until
/// the GPU was done.
///
/// # Errors
/// Those of the executor.
pub fn run(
    gpu: &Gpu,
    executor: &mut Executor,
    frame: &Frame,
) -> Result<(FrameReport, Duration), ExecuteError> {
    let began = Instant::now();
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("frame"),
        });
    executor.encode(&mut encoder, frame)?;
    gpu.queue.submit([encoder.finish()]);
    let report = wait(gpu, executor)?;
    Ok((report, began.elapsed()))
}

/// Frames after which buffers are as large as they get: each brings the count of the one before.
const GROWING: usize = 8;

/// Runs frames until the buffers that grow have room for all that a frame needs.
///
/// # Errors
/// Those of the executor.
pub fn grow(
    gpu: &Gpu,
    executor: &mut Executor,
    provider: &mut dyn Provider,
) -> Result<(), ExecuteError> {
    for _ in 0..GROWING {
        if executor.plan().growing().is_empty() {
            break;
        }
        run(gpu, executor, &Frame::default())?;
        if executor.grow(provider)?.is_none() {
            break;
        }
    }
    Ok(())
}

/// How often Ctrl-C is looked for while a frame is under way.
const POLL_INTERVAL: Duration = Duration::from_millis(100);

/// Waits for a submitted frame, but no longer than the GPU's timeout, and not after Ctrl-C. The
/// device of a frame that is given up is of no more use.
fn wait(gpu: &Gpu, executor: &mut Executor) -> Result<FrameReport, ExecuteError> {
    let began = Instant::now();
    loop {
        let passes = match executor.finish_within(Some(POLL_INTERVAL)) {
            Err(ExecuteError::Unfinished { passes, .. }) => passes,
            done => return done,
        };
        let after = began.elapsed();
        if interrupt::raised() || gpu.timeout.is_some_and(|timeout| after >= timeout) {
            // wgpu waits for the queue when its last handle is dropped, and there would be no end
            // to that either.
            std::mem::forget(gpu.queue.clone());
            return Err(ExecuteError::Unfinished { after, passes });
        }
    }
}

/// Why a command ends that was about to run `graph`.
pub fn failed(graph: &str, error: ExecuteError) -> CliError {
    match error {
        ExecuteError::Unfinished { .. } if interrupt::raised() => CliError::interrupted(),
        error => CliError::Gpu {
            graph: graph.to_owned(),
            source: Box::new(error),
        },
    }
}

/// Runs one frame and reads outputs and captures by name.
///
/// # Errors
/// Those of the executor.
pub fn read(gpu: &Gpu, executor: &mut Executor, names: &[&str]) -> Result<Contents, ExecuteError> {
    let frame = Frame {
        read: names,
        ..Frame::default()
    };
    let (report, _) = run(gpu, executor, &frame)?;
    Ok(contents(report.readbacks))
}

/// Readbacks by their names.
pub fn contents(readbacks: Vec<Readback>) -> Contents {
    let readbacks = readbacks.into_iter();
    readbacks
        .map(|readback| (readback.name, readback.content))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::shared::GpuArgs;
    use crate::error::{explain, is_fatal};
    use crate::graphs::planning::{Capabilities, placeholder};
    use crate::graphs::preset;
    use crate::measuring::device;

    /// As a driver's reset does it, but on demand.
    #[test]
    fn a_lost_device_is_an_error_of_its_own_exit_code() {
        let args = GpuArgs {
            adapter: None,
            memory_limit: None,
            timeout: 300,
        };
        let gpu = device::open(&args, []).unwrap_or_else(|error| panic!("{error}"));
        let preset = preset::load_all(&["nsm".into()], &preset::sources()).unwrap();
        let mut provider = placeholder([16, 16], &preset[0].graph);
        let request = Capabilities::of(&gpu).request([16, 16], &provider);
        let plan = preset[0].graph.plan(&request).unwrap();
        let mut executor = executor(&gpu, plan, &mut provider).unwrap();
        run(&gpu, &mut executor, &Frame::default()).unwrap();
        gpu.device.destroy();
        let Err(lost) = run(&gpu, &mut executor, &Frame::default()) else {
            panic!("a destroyed device ran a frame");
        };
        assert!(is_fatal(&lost), "{lost}");
        assert!(explain(&lost).starts_with("the device was lost"), "{lost}");
        assert_eq!(failed("nsm", lost).exit_code(), 3);
    }
}
