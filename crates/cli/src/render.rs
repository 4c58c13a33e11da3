//! The only code of the program that talks to a GPU: opening one, running frames, reading outputs.

use crate::{
    args::GpuArgs,
    error::CliError,
    interrupt,
    results::{Adapter, Cached, FrameTimes, Pass, Spread},
};
use skiagraph_graph::{
    Content, ExecuteError, Executor, Frame, FrameReport, FrameTiming, PlanRequest,
    gpu::{self, Gpu, GpuError},
    timing::{self, Trust},
};
use std::{
    collections::BTreeMap,
    error::Error,
    time::{Duration, Instant},
};

/// Opens the adapter asked for, or the best one, with those of the features that it offers.
///
/// # Errors
/// [`CliError::NoGpu`] with the way out.
pub fn open(asked: &GpuArgs, features: wgpu::Features) -> Result<Gpu, CliError> {
    let mut gpu = gpu::open_with(asked.adapter.as_deref(), features)
        .map_err(|error: GpuError| CliError::NoGpu(error.to_string()))?;
    let is_software = gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    gpu.memory = asked
        .memory_limit
        .or_else(|| is_software.then(free_memory).flatten());
    gpu.patience = (asked.timeout > 0).then(|| Duration::from_secs(asked.timeout));
    Ok(gpu)
}

/// Memory that the machine has free: a software adapter's. What it has besides is lent out by most systems before it is there,
/// and a process that then uses it is killed. `None` where the system does not say.
fn free_memory() -> Option<u64> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    if system.total_memory() == 0 {
        return None;
    }
    // A container may have less than the machine. What it holds as file cache is free for all that.
    let of_group = system.cgroup_limits().map_or(u64::MAX, |limits| {
        limits.total_memory.saturating_sub(limits.rss)
    });
    Some(system.available_memory().min(of_group))
}

/// What a graph is planned for.
#[derive(Clone, Debug)]
pub struct Abilities {
    /// Limits of a device.
    pub limits: wgpu::Limits,
    /// Its features.
    pub features: wgpu::Features,
    /// Bytes of memory for the graph, where that is known.
    pub memory: Option<u64>,
}

impl Abilities {
    /// Puts them into a request.
    pub fn ask(self, request: &mut PlanRequest<'_>) {
        request.limits = self.limits;
        request.features = self.features;
        request.memory_limit = self.memory;
    }
}

/// What the opened device can do.
pub fn abilities(gpu: &Gpu) -> Abilities {
    Abilities {
        limits: gpu.device.limits(),
        features: gpu.device.features(),
        memory: gpu.memory,
    }
}

/// What the most able adapters of today can do: a graph that cannot be planned for them is at fault itself.
pub fn greatest_abilities() -> Abilities {
    let limits = wgpu::Limits {
        max_texture_dimension_2d: 32768,
        max_texture_array_layers: 2048,
        max_compute_invocations_per_workgroup: 2048,
        ..wgpu::Limits::unlimited()
    };
    Abilities {
        limits,
        features: wgpu::Features::all(),
        memory: None,
    }
}

/// How results name the adapter; `trust` says whether its timestamps are true.
pub fn describe(gpu: &Gpu, trust: &Trust) -> Adapter {
    let info = gpu.adapter.get_info();
    Adapter {
        driver: driver(&info),
        backend: info.backend.to_str().into(),
        device_type: format!("{:?}", info.device_type),
        name: info.name,
        gpu_unavailable: match trust {
            Trust::Trusted => None,
            Trust::Untrusted { reason } => Some(reason.clone()),
        },
    }
}

/// Driver and version in one string.
pub fn driver(info: &wgpu::AdapterInfo) -> String {
    format!("{} {}", info.driver, info.driver_info)
        .trim()
        .into()
}

/// Whether this device's timestamps are true.
pub fn trust(gpu: &Gpu) -> Trust {
    timing::check(&gpu.device, &gpu.queue).unwrap_or_else(|error| Trust::Untrusted {
        reason: format!("the check of its timestamps failed: {}", chain(&error)),
    })
}

/// Runs one frame to its end; returns what it reports and the time from the start of encoding until the GPU was done.
///
/// # Errors
/// Those of the executor.
pub fn frame(
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
    executor.submitted(&gpu.queue)?;
    let report = wait(gpu, executor)?;
    Ok((report, began.elapsed()))
}

/// How often Ctrl-C is looked for while a frame is under way.
const LOOK: Duration = Duration::from_millis(100);

/// Waits for a submitted frame, but no longer than [`Gpu::patience`], and not after Ctrl-C. The device of a frame that is given up is
/// of no more use.
fn wait(gpu: &Gpu, executor: &mut Executor) -> Result<FrameReport, ExecuteError> {
    let began = Instant::now();
    loop {
        let passes = match executor.finish_within(Some(LOOK)) {
            Err(ExecuteError::Unfinished { passes, .. }) => passes,
            done => return done,
        };
        let after = began.elapsed();
        if interrupt::raised() || gpu.patience.is_some_and(|patience| after >= patience) {
            // wgpu waits for the queue when its last handle is dropped, and there would be no end to that either.
            std::mem::forget(gpu.queue.clone());
            return Err(ExecuteError::Unfinished { after, passes });
        }
    }
}

/// Why a command ends that was about to run `graph`.
pub fn failed(graph: &str, error: ExecuteError) -> CliError {
    match error {
        ExecuteError::Unfinished { .. } if interrupt::raised() => CliError::Interrupted {
            kept: String::new(),
        },
        error => CliError::Gpu {
            graph: graph.to_owned(),
            source: Box::new(error),
        },
    }
}

/// Whether the device is of no more use after an error, for any graph.
pub fn is_fatal(error: &(dyn Error + 'static)) -> bool {
    matches!(
        error.downcast_ref(),
        Some(ExecuteError::DeviceLost(_) | ExecuteError::Unfinished { .. })
    )
}

/// A frame that was timed.
pub struct TimedFrame {
    /// When its encoding began, from that of the first timed frame on.
    pub began: Duration,
    /// Times of its passes.
    pub timing: FrameTiming,
    /// From the start of encoding until the GPU was done.
    pub wall: Duration,
    /// The passes that did not run.
    pub skipped: Vec<String>,
}

/// What frames are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Every pass runs in every frame.
    All,
    /// The camera moves before every frame, and passes run by their conditions.
    CameraMoves,
}

/// Runs `warmup` frames, then `frames` timed ones. `done` hears how many frames are over. Ctrl-C
/// ends it early; what was timed until then is returned.
///
/// # Errors
/// Those of the executor.
pub fn sample(
    gpu: &Gpu,
    executor: &mut Executor,
    work: Work,
    warmup: u32,
    frames: u32,
    done: impl Fn(u64),
) -> Result<Vec<TimedFrame>, ExecuteError> {
    let mut timed = Vec::new();
    let mut first = Instant::now();
    for index in 0..u64::from(warmup) + u64::from(frames) {
        if interrupt::raised() {
            break;
        }
        if index == u64::from(warmup) {
            first = Instant::now();
        }
        let began = first.elapsed();
        // Warm-up frames are timed too: they then do the same work, only nobody looks at the figures.
        if work == Work::CameraMoves && executor.plan().provided().contains(&"camera") {
            executor.touch("camera")?;
        }
        let request = Frame {
            timing: true,
            all: work == Work::All,
            ..Frame::default()
        };
        let (report, wall) = match frame(gpu, executor, &request) {
            Err(ExecuteError::Unfinished { .. }) if interrupt::raised() => break,
            done => done?,
        };
        if index >= u64::from(warmup) {
            let timing = report.timing.ok_or(ExecuteError::Internal(
                "a timed frame came back without times",
            ))?;
            timed.push(TimedFrame {
                began,
                timing,
                wall,
                skipped: report.skipped,
            });
        }
        done(index + 1);
    }
    Ok(timed)
}

/// Times of some frames, per pass and whole.
pub struct Times {
    /// Per pass.
    pub passes: Vec<Pass>,
    /// Whole frames.
    pub frame: FrameTimes,
}

/// [`sample`], but all `frames` of them: `None` if Ctrl-C came first.
fn sample_all(
    gpu: &Gpu,
    executor: &mut Executor,
    work: Work,
    [warmup, frames]: [u32; 2],
    done: impl Fn(u64),
) -> Result<Option<Vec<TimedFrame>>, ExecuteError> {
    let timed = sample(gpu, executor, work, warmup, frames, done)?;
    Ok((timed.len() == frames as usize).then_some(timed))
}

/// [`sample`] in short; `None` if Ctrl-C came first.
///
/// # Panics
/// If `frames` is 0, which the arguments forbid.
///
/// # Errors
/// Those of the executor.
pub fn time(
    gpu: &Gpu,
    executor: &mut Executor,
    warmup: u32,
    frames: u32,
    done: impl Fn(u64),
) -> Result<Option<Times>, ExecuteError> {
    let timed = sample_all(gpu, executor, Work::All, [warmup, frames], done)?;
    Ok(timed.map(|timed| Samples::of(&timed).times()))
}

/// The times of frames in which only the camera moves: `None` if Ctrl-C came first, `Some(None)` if every pass runs then too.
///
/// # Errors
/// Those of the executor.
pub fn cached(
    gpu: &Gpu,
    executor: &mut Executor,
    frames: u32,
) -> Result<Option<Option<Cached>>, ExecuteError> {
    if frames == 0 {
        return Ok(Some(None));
    }
    let Some(first) = sample_all(gpu, executor, Work::CameraMoves, [0, 1], |_| {})? else {
        return Ok(None);
    };
    let Some(TimedFrame { skipped, .. }) =
        first.into_iter().find(|frame| !frame.skipped.is_empty())
    else {
        return Ok(Some(None));
    };
    let timed = sample_all(gpu, executor, Work::CameraMoves, [0, frames], |_| {})?;
    Ok(timed.map(|timed| {
        Some(Cached {
            frame: Samples::of(&timed).times().frame,
            skipped,
        })
    }))
}

/// The times of several frames, sorted by what they are times of.
#[derive(Default)]
pub struct Samples {
    /// Each pass, in the order in which they ran.
    pub passes: Vec<PassSamples>,
    /// From the first begin to the last end on the GPU.
    pub gpu: Vec<Option<Duration>>,
    /// Encoding of all passes.
    pub cpu: Vec<Duration>,
    /// From the start of encoding until the GPU was done.
    pub wall: Vec<Duration>,
}

/// The times of one pass in several frames.
pub struct PassSamples {
    /// Its name.
    pub name: String,
    /// Between its timestamps.
    pub gpu: Vec<Option<Duration>>,
    /// Encoding.
    pub cpu: Vec<Duration>,
}

impl Samples {
    /// Of some frames.
    pub fn of(frames: &[TimedFrame]) -> Self {
        let mut samples = Self::default();
        for TimedFrame { timing, wall, .. } in frames {
            samples.wall.push(*wall);
            samples.gpu.push(timing.gpu());
            samples.cpu.push(timing.cpu());
            for pass in &timing.passes {
                let known = |samples: &PassSamples| samples.name == pass.name;
                let index = samples.passes.iter().position(known).unwrap_or_else(|| {
                    samples.passes.push(PassSamples {
                        name: pass.name.clone(),
                        gpu: Vec::new(),
                        cpu: Vec::new(),
                    });
                    samples.passes.len() - 1
                });
                samples.passes[index].gpu.push(pass.gpu);
                samples.passes[index].cpu.push(pass.cpu);
            }
        }
        samples
    }

    fn times(self) -> Times {
        let pass = |PassSamples { name, gpu, cpu }| Pass {
            name,
            gpu_ms: Spread::of_all(&gpu),
            cpu_ms: Spread::of(&cpu).expect("a pass is named by its first sample"),
        };
        let frame = FrameTimes {
            gpu_ms: Spread::of_all(&self.gpu),
            wall_ms: Spread::of(&self.wall).expect("at least one frame is timed"),
        };
        Times {
            passes: self.passes.into_iter().map(pass).collect(),
            frame,
        }
    }
}

/// Runs one frame and reads outputs and captures by name.
///
/// # Errors
/// Those of the executor.
pub fn read(
    gpu: &Gpu,
    executor: &mut Executor,
    names: &[&str],
) -> Result<BTreeMap<String, Content>, ExecuteError> {
    let (report, _) = frame(
        gpu,
        executor,
        &Frame {
            read: names,
            ..Frame::default()
        },
    )?;
    Ok(report
        .readbacks
        .into_iter()
        .map(|readback| (readback.name, readback.content))
        .collect())
}

/// Which arguments may avert an error.
pub fn advice(error: &(dyn Error + 'static)) -> Option<&'static str> {
    match error.downcast_ref() {
        Some(ExecuteError::OutOfMemory { .. }) => Some("use a smaller --size or --map-size"),
        Some(ExecuteError::Unfinished { .. }) => Some(
            "it was given up: a loop of one of its shaders may never end; if it only takes long, give it a larger --timeout, or --timeout 0 to wait for ever",
        ),
        Some(ExecuteError::DeviceLost(_)) => Some(
            "the driver resets a GPU that does not answer in time: a shader may never end, or take too long for this GPU",
        ),
        _ => None,
    }
}

/// An error, its causes and what may avert it in one line.
pub fn explain(error: &(dyn Error + 'static)) -> String {
    let text = chain(error);
    match advice(error) {
        Some(advice) => format!("{text}; {advice}"),
        None => text,
    }
}

/// An error and its causes in one line.
pub fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text.push_str(&format!(": {error}"));
        cause = error.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As a driver's reset does it, but on demand.
    #[test]
    fn a_lost_device_is_an_error_of_its_own_exit_code() {
        let asked = GpuArgs {
            adapter: None,
            memory_limit: None,
            timeout: 300,
        };
        let gpu = open(&asked, wgpu::Features::empty()).unwrap_or_else(|error| panic!("{error}"));
        let registry = skiagraph_passes::registry();
        let sources = crate::preset::sources();
        let graph = skiagraph_graph::Graph::load("pipelines/nsm.ron", &registry, &sources).unwrap();
        let mut provider = crate::commands::check::provider([16, 16]);
        let mut request = PlanRequest::new([16, 16], &provider);
        abilities(&gpu).ask(&mut request);
        let plan = graph.plan(&request).unwrap();
        let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut provider).unwrap();
        frame(&gpu, &mut executor, &Frame::default()).unwrap();
        gpu.device.destroy();
        let Err(lost) = frame(&gpu, &mut executor, &Frame::default()) else {
            panic!("a destroyed device ran a frame");
        };
        assert!(is_fatal(&lost), "{lost}");
        assert!(explain(&lost).starts_with("the device was lost"), "{lost}");
        assert_eq!(failed("nsm", lost).exit_code(), 3);
    }

    #[test]
    fn out_of_memory_comes_with_advice_and_nothing_else_does() {
        let full = ExecuteError::OutOfMemory {
            name: "map".into(),
            table: String::new(),
        };
        assert!(explain(&full).ends_with("; use a smaller --size or --map-size"));
        let other = ExecuteError::Readback { name: "map".into() };
        assert_eq!(explain(&other), chain(&other));
    }
}
