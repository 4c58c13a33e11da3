//! The only code of the program that talks to a GPU: opening one, running frames, reading outputs.

use crate::{
    error::CliError,
    interrupt,
    results::{Adapter, FrameTimes, Pass, Spread},
};
use skiagraph_graph::{
    Content, ExecuteError, Executor, Frame, FrameReport,
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
pub fn open(name: Option<&str>, features: wgpu::Features) -> Result<Gpu, CliError> {
    gpu::open_with(name, features).map_err(|error: GpuError| CliError::NoGpu(error.to_string()))
}

/// What the opened device can do.
pub fn abilities(gpu: &Gpu) -> (wgpu::Limits, wgpu::Features) {
    (gpu.device.limits(), gpu.device.features())
}

/// What the most able adapters of today can do: a graph that cannot be planned for them is at fault itself.
pub fn greatest_abilities() -> (wgpu::Limits, wgpu::Features) {
    let limits = wgpu::Limits {
        max_texture_dimension_2d: 32768,
        max_texture_array_layers: 2048,
        max_compute_invocations_per_workgroup: 2048,
        ..wgpu::Limits::unlimited()
    };
    (limits, wgpu::Features::all())
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
    let report = executor.finish()?;
    Ok((report, began.elapsed()))
}

/// Times of some frames, per pass and whole.
pub struct Times {
    /// Per pass.
    pub passes: Vec<Pass>,
    /// Whole frames.
    pub frame: FrameTimes,
}

/// Runs `warmup` frames, then `frames` timed ones, every pass in every frame. `done` hears how many frames are over.
/// `None` if Ctrl-C came first.
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
    let mut samples = Samples::default();
    for index in 0..u64::from(warmup) + u64::from(frames) {
        if interrupt::raised() {
            return Ok(None);
        }
        // Warm-up frames are timed too: they then do the same work, only nobody looks at the figures.
        let (report, wall) = frame(
            gpu,
            executor,
            &Frame {
                timing: true,
                all: true,
                ..Frame::default()
            },
        )?;
        if index >= u64::from(warmup) {
            samples.add(report, wall);
        }
        done(index + 1);
    }
    Ok(Some(samples.times()))
}

#[derive(Default)]
struct Samples {
    names: Vec<String>,
    gpu: Vec<Vec<Option<Duration>>>,
    cpu: Vec<Vec<Duration>>,
    frame_gpu: Vec<Option<Duration>>,
    frame_wall: Vec<Duration>,
}

impl Samples {
    fn add(&mut self, report: FrameReport, wall: Duration) {
        self.frame_wall.push(wall);
        let Some(timing) = report.timing else {
            self.frame_gpu.push(None);
            return;
        };
        self.frame_gpu.push(timing.gpu());
        for pass in timing.passes {
            let index = self
                .names
                .iter()
                .position(|name| *name == pass.name)
                .unwrap_or_else(|| {
                    self.names.push(pass.name.clone());
                    self.gpu.push(Vec::new());
                    self.cpu.push(Vec::new());
                    self.names.len() - 1
                });
            self.gpu[index].push(pass.gpu);
            self.cpu[index].push(pass.cpu);
        }
    }

    fn times(self) -> Times {
        let passes = self.names.into_iter().zip(self.gpu).zip(self.cpu);
        let passes = passes
            .map(|((name, gpu), cpu)| Pass {
                name,
                gpu_ms: Spread::of_all(&gpu),
                cpu_ms: Spread::of(&cpu).expect("a pass is named by its first sample"),
            })
            .collect();
        let frame = FrameTimes {
            gpu_ms: Spread::of_all(&self.frame_gpu),
            wall_ms: Spread::of(&self.frame_wall).expect("at least one frame is timed"),
        };
        Times { passes, frame }
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

    #[test]
    fn out_of_memory_comes_with_advice_and_nothing_else_does() {
        let full = ExecuteError::OutOfMemory { name: "map".into() };
        assert!(explain(&full).ends_with("; use a smaller --size or --map-size"));
        let other = ExecuteError::Readback { name: "map".into() };
        assert_eq!(explain(&other), chain(&other));
    }
}
