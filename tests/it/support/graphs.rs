//! Runs graphs for tests.

use super::brute::{Hit, Ray};
use skiagraph_gpu::{
    Content, Executor, Frame, FrameReport, Provider,
    device::{self, Gpu},
};
use skiagraph_graph::{Describe, Graph, LayeredSources, MemorySources, Plan, PlanRequest, Sources};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use skiagraph_scene::{DirectionalLight, Mesh, Scene, View};
pub use skiagraph_tests::extended::Extended;
use std::sync::{Arc, LazyLock};

/// Paths and texts before the embedded files.
pub fn layered(files: &[(&str, &str)]) -> LayeredSources {
    MemorySources::new(files.iter().copied()).over(EmbeddedSources)
}

/// Runs a document given as text once, and returns one output's bytes.
pub fn run_text(document: &str, provider: &mut dyn Provider, output: &str) -> Vec<u8> {
    run_files(&[("test.ron", document)], provider, output)
}

/// The same with shaders that are given as text: paths and texts, the document's path is
/// `test.ron`.
pub fn run_files(files: &[(&str, &str)], provider: &mut dyn Provider, output: &str) -> Vec<u8> {
    let plan = plan_files(files, provider, [1, 1]);
    let report = run(plan, provider, &[output]);
    match report.readbacks.into_iter().next().unwrap().content {
        Content::Buffer(bytes) | Content::Texture { bytes, .. } => bytes,
    }
}

/// Plans a document given as text, `test.ron`, with all outputs.
pub fn plan_files(files: &[(&str, &str)], provider: &dyn Describe, viewport: [u32; 2]) -> Plan {
    let graph = Graph::load("test.ron", &registry(), &layered(files))
        .unwrap_or_else(|error| panic!("{error}"));
    let mut request = PlanRequest::new(viewport, provider);
    allow_ray_queries(&mut request);
    graph
        .plan(&request)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Traces on the GPU through a graph of one `Trace` pass: the first `count` rays, each past its
/// primitive in `skip`.
pub fn trace(mesh: &Mesh, rays: &[Ray], skip: Option<&[u32]>, count: u32, mode: &str) -> Vec<Hit> {
    let fields = format!("mode: {mode}");
    trace_by(&fields, glam::DVec3::NEG_Y, mesh, rays, skip, count)
}

/// The same by a pass with these fields, under a light of this direction.
pub fn trace_by(
    fields: &str,
    light: glam::DVec3,
    mesh: &Mesh,
    rays: &[Ray],
    skip: Option<&[u32]>,
    count: u32,
) -> Vec<Hit> {
    let scene = Scene {
        name: "test".into(),
        mesh: mesh.clone(),
        views: vec![],
        lights: vec![DirectionalLight::new(light).into()],
    };
    let mut provider = Extended::new(SceneProvider::new(Arc::new(scene)));
    provider.add("test.rays", rays);
    provider.add("test.number", &[count]);
    if let Some(skip) = skip {
        provider.add("test.skip", skip);
    }
    let skip = if skip.is_some() {
        r#"skip: "test.skip", "#
    } else {
        ""
    };
    let document = format!(
        r#"(
            format: 3,
            description: "rays in, hits out",
            materials: [Buffer(name: "hits", count: "test.rays.count")],
            passes: [
                Trace(
                    name: "trace", rays: "test.rays", hits: "hits", count: "test.number",
                    {skip}{fields},
                ),
            ],
            outputs: ["hits"],
        )"#
    );
    bytemuck::pod_collect_to_vec(&run_text(&document, &mut provider, "hits"))
}

/// All of them, past nothing.
pub fn trace_all(mesh: &Mesh, rays: &[Ray], mode: &str) -> Vec<Hit> {
    trace(mesh, rays, None, rays.len() as u32, mode)
}

/// Plans a preset for a scene, all outputs, after `adjust` has had its say.
pub fn plan(
    path: &str,
    provider: &SceneProvider,
    viewport: [u32; 2],
    adjust: impl FnOnce(&mut PlanRequest),
) -> Plan {
    plan_with(&EmbeddedSources, path, provider, viewport, adjust)
}

/// The same preset from other files.
pub fn plan_with(
    sources: &dyn Sources,
    path: &str,
    provider: &SceneProvider,
    viewport: [u32; 2],
    adjust: impl FnOnce(&mut PlanRequest),
) -> Plan {
    let graph = Graph::load(path, &registry(), sources).unwrap_or_else(|error| panic!("{error}"));
    let mut request = PlanRequest::new(viewport, provider);
    adjust(&mut request);
    graph
        .plan(&request)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Provides a scene under one of its views.
pub fn provider(scene: &Arc<Scene>, view: &View, viewport: [u32; 2]) -> SceneProvider {
    let mut provider = SceneProvider::new(Arc::clone(scene));
    provider.set_view(view, viewport);
    provider
}

/// Runs one frame of a plan.
pub fn run(plan: Plan, provider: &mut dyn Provider, read: &[&str]) -> FrameReport {
    run_on(&open(), plan, provider, read)
}

/// Features that the tests of engines ask for beyond the baseline.
pub const RAY_QUERY: wgpu::Features = wgpu::Features::EXPERIMENTAL_RAY_QUERY;

/// Lets a plan use ray queries where the device has them.
pub fn allow_ray_queries(request: &mut PlanRequest<'_>) {
    let device = open().device;
    request.features = device.features() & RAY_QUERY;
    request.limits.max_acceleration_structures_per_shader_stage =
        device.limits().max_acceleration_structures_per_shader_stage;
}

/// The device that all tests share, with ray queries where the adapter has them; a machine without
/// an adapter fails the test with the way out.
pub fn open() -> Gpu {
    static GPU: LazyLock<Gpu> = LazyLock::new(|| {
        let wanted = device::Wanted::default().with_features(RAY_QUERY);
        device::open_with(&wanted).unwrap_or_else(|error| panic!("{error}"))
    });
    GPU.clone()
}

/// Runs one frame of a plan on a device.
pub fn run_on(gpu: &Gpu, plan: Plan, provider: &mut dyn Provider, read: &[&str]) -> FrameReport {
    let mut executor = Executor::on(gpu, plan, provider).unwrap_or_else(|error| panic!("{error}"));
    frame(gpu, &mut executor, read)
}

/// Runs one frame, passes by their run conditions.
pub fn frame(gpu: &Gpu, executor: &mut Executor, read: &[&str]) -> FrameReport {
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let frame = Frame::new().with_read(read);
    executor.encode(&mut encoder, &frame).unwrap();
    gpu.queue.submit([encoder.finish()]);
    executor.finish().unwrap()
}

/// The integers of an output.
pub fn values(report: &FrameReport, name: &str) -> Vec<u32> {
    let readback = report
        .readbacks
        .iter()
        .find(|readback| readback.name == name)
        .unwrap();
    readback.content.as_u32().unwrap()
}

/// The numbers of an output, whole or not.
pub fn shares(report: &FrameReport, name: &str) -> Vec<f32> {
    let mut readbacks = report
        .readbacks
        .iter()
        .filter(|readback| readback.name == name);
    let content = &readbacks.next().unwrap().content;
    let whole = || {
        content
            .as_u32()?
            .into_iter()
            .map(|value| Some(value as f32))
            .collect()
    };
    content.as_f32().or_else(whole).unwrap()
}

/// Reads a resource of a provider back.
pub fn resource_bytes(gpu: &Gpu, provider: &mut SceneProvider, name: &str) -> Vec<u8> {
    let buffer = provider.build(name, &gpu.device, &gpu.queue).unwrap();
    provider.submit_built(&gpu.device, &gpu.queue).unwrap();
    buffer_bytes(gpu, &buffer)
}

/// Reads a buffer back.
pub fn buffer_bytes(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<u8> {
    let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: buffer.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, None);
    gpu.queue.submit([encoder.finish()]);
    copy.map_async(wgpu::MapMode::Read, .., |done| done.unwrap());
    let waited = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    waited.unwrap();
    copy.get_mapped_range(..).unwrap().to_vec()
}
