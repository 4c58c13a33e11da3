//! A host program in small: a device, frames that are submitted and waited for.

use super::{Files, load};
use skiagraph_graph::{Executor, Frame, FrameReport, NoProvider, Plan, PlanRequest, Provider, gpu};
use std::sync::LazyLock;

/// A device of wgpu's default limits, whatever the adapter could do, so that it is known what it
/// refuses.
pub static GPU: LazyLock<gpu::Gpu> = LazyLock::new(|| {
    let mut gpu = gpu::open(None).unwrap_or_else(|error| panic!("{error}"));
    let made = pollster::block_on(gpu.adapter.request_device(&Default::default()));
    (gpu.device, gpu.queue) = made.unwrap_or_else(|error| panic!("{error}"));
    gpu
});

/// A request for 8×8 pixels and the limits of [`GPU`].
pub fn request(provider: &dyn Provider) -> PlanRequest<'_> {
    let mut request = PlanRequest::new([8, 8], provider);
    request.limits = GPU.device.limits();
    request
}

/// The plan of `graph.ron` of the files.
pub fn planned(files: &Files, request: &PlanRequest<'_>) -> Plan {
    let graph = load(files).unwrap_or_else(|errors| panic!("{errors}"));
    graph
        .plan(request)
        .unwrap_or_else(|errors| panic!("{errors}"))
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

/// A frame that is submitted and waited for.
pub fn frame(executor: &mut Executor, read: &[&str]) -> FrameReport {
    let mut encoder = encoder();
    let frame = Frame {
        read,
        ..Frame::default()
    };
    executor
        .encode(&mut encoder, &frame)
        .unwrap_or_else(|error| panic!("{error}"));
    GPU.queue.submit([encoder.finish()]);
    executor
        .submitted(&GPU.queue)
        .unwrap_or_else(|error| panic!("{error}"));
    executor.finish().unwrap_or_else(|error| panic!("{error}"))
}

/// The numbers of an output after a frame.
pub fn numbers(executor: &mut Executor, output: &str) -> Vec<u32> {
    let report = frame(executor, &[output]);
    report.readbacks[0]
        .content
        .as_u32()
        .expect("it holds numbers")
}
