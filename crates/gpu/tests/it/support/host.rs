//! A host program in small: a device, frames that are submitted and waited for.

#![allow(dead_code, reason = "each test file uses a part of it")]

use crate::support::{Files, load, right};
use skiagraph_gpu::{Executor, Frame, FrameReport, device};
use skiagraph_graph::{Describe, NoProvider, ParamValue, Plan, PlanRequest};
use std::sync::LazyLock;

/// A device of wgpu's default limits, whatever the adapter could do, so that it is known what it
/// refuses.
pub static GPU: LazyLock<device::Gpu> = LazyLock::new(|| {
    let mut gpu = device::open(None).unwrap_or_else(|error| panic!("{error}"));
    let made = pollster::block_on(gpu.adapter.request_device(&Default::default()));
    (gpu.device, gpu.queue) = made.unwrap_or_else(|error| panic!("{error}"));
    gpu
});

/// A request for 8×8 pixels and the limits of [`GPU`].
pub fn request(provider: &dyn Describe) -> PlanRequest<'_> {
    let mut request = PlanRequest::new([8, 8], provider);
    request.limits = GPU.device.limits();
    request
}

/// The plan of `graph.ron` of the files.
pub fn planned(files: &Files, request: &PlanRequest<'_>) -> Plan {
    right(right(load(files)).plan(request))
}

/// An executor of `graph.ron` of the files, which needs no provider.
pub fn executor(files: &Files, request: &PlanRequest<'_>) -> Executor {
    let plan = planned(files, request);
    Executor::new(&GPU.device, &GPU.queue, plan, &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// An encoder of the host.
pub fn encoder() -> wgpu::CommandEncoder {
    GPU.device.create_command_encoder(&Default::default())
}

/// Ways in which a frame never runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Loss {
    Dropped,
    FinishRefused,
    SubmitRefused,
    /// It is finished, and the commands are dropped.
    NotSubmitted,
}

pub const LOSSES: [Loss; 4] = [
    Loss::Dropped,
    Loss::FinishRefused,
    Loss::SubmitRefused,
    Loss::NotSubmitted,
];

/// Loses what is encoded.
pub fn lose(mut encoder: wgpu::CommandEncoder, loss: Loss) {
    let buffer = || {
        GPU.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage: wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    let refusal = GPU.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let is_refused = matches!(loss, Loss::FinishRefused | Loss::SubmitRefused);
    match loss {
        Loss::Dropped => drop(encoder),
        Loss::NotSubmitted => drop(encoder.finish()),
        Loss::FinishRefused => {
            encoder.copy_buffer_to_buffer(&buffer(), 0, &buffer(), 0, 4);
            GPU.queue.submit([encoder.finish()]);
        }
        Loss::SubmitRefused => {
            let cleared = buffer();
            encoder.clear_buffer(&cleared, 0, None);
            let commands = encoder.finish();
            cleared.destroy();
            GPU.queue.submit([commands]);
        }
    }
    let refused = pollster::block_on(refusal.pop());
    assert_eq!(refused.is_some(), is_refused, "{loss:?}: {refused:?}");
}

/// Encodes a frame that never runs and returns its number.
pub fn lost(executor: &mut Executor, frame: &Frame<'_>, loss: Loss) -> u32 {
    let mut encoder = encoder();
    let index = executor.encode(&mut encoder, frame);
    lose(encoder, loss);
    index.unwrap_or_else(|error| panic!("{error}"))
}

/// A frame that is submitted and waited for.
pub fn frame(executor: &mut Executor, read: &[&str]) -> FrameReport {
    let frame = Frame::new().with_read(read);
    submit(executor, &frame)
}

/// A frame of every kind that is submitted and waited for.
pub fn submit(executor: &mut Executor, frame: &Frame<'_>) -> FrameReport {
    let mut encoder = encoder();
    executor
        .encode(&mut encoder, frame)
        .unwrap_or_else(|error| panic!("{error}"));
    GPU.queue.submit([encoder.finish()]);
    executor.finish().unwrap_or_else(|error| panic!("{error}"))
}

/// The numbers of an output after a frame.
pub fn numbers(executor: &mut Executor, output: &str) -> Vec<u32> {
    let report = frame(executor, &[output]);
    words(&report, 0)
}

/// The numbers of a readback.
pub fn words(report: &FrameReport, index: usize) -> Vec<u32> {
    let content = &report.readbacks[index].content;
    content.as_u32().expect("it holds numbers")
}

/// Sets a param of a graph that needs no provider.
pub fn set(executor: &mut Executor, name: &str, value: ParamValue) {
    executor
        .set_param(name, value, &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"));
}
