//! The engines of `Trace`, and the rays that `rt` traces.

use super::{Engine, Ray, Rays};
use skiagraph_gpu::{Executor, Frame, FrameReport, Provider, ProviderError, device::Gpu};
use skiagraph_graph::{
    Capture, Describe, Graph, Plan, PlanRequest, Provided, ProvidedBinding, Sources,
};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use skiagraph_scene::Scene;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};
use wgpu::util::DeviceExt;

/// A scene with rays.
struct Given<'a> {
    scene: SceneProvider,
    rays: &'a Rays,
    count: [u32; 1],
}

impl Given<'_> {
    fn content(&self, name: &str) -> Option<(&[u8], u64)> {
        match name {
            "bench.rays" => Some((bytemuck::cast_slice(&self.rays.rays), 32)),
            "bench.skip" => Some((bytemuck::cast_slice(&self.rays.skip), 4)),
            "bench.number" => Some((bytemuck::cast_slice(&self.count), 4)),
            _ => None,
        }
    }
}

impl Describe for Given<'_> {
    fn names(&self) -> Vec<String> {
        self.scene.names()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let Some((content, stride)) = self.content(name) else {
            return self.scene.describe(name);
        };
        Some(Provided::new(
            ProvidedBinding::Storage,
            Some(content.len() as u64 / stride),
            stride,
        ))
    }
}

impl Provider for Given<'_> {
    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        let Some((contents, _)) = self.content(name) else {
            return self.scene.build(name, device, queue);
        };
        let descriptor = wgpu::util::BufferInitDescriptor {
            label: Some(name),
            contents,
            usage: wgpu::BufferUsages::STORAGE,
        };
        Ok(device.create_buffer_init(&descriptor))
    }

    fn submit_built(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<(), skiagraph_gpu::ProviderError> {
        self.scene.submit_built(device, queue)
    }

    fn build_acceleration_structure(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Tlas, ProviderError> {
        let scene = &mut self.scene;
        scene.build_acceleration_structure(name, device, queue)
    }
}

/// The document alone; its shaders are the embedded ones.
struct Document(String);

impl Sources for Document {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        match path {
            "any_hits.ron" => Ok(Some(self.0.as_str().into())),
            _ => EmbeddedSources.read(path),
        }
    }

    fn list(&self, folder: &str) -> Vec<String> {
        EmbeddedSources.list(folder)
    }
}

fn plan(path: &str, sources: &dyn Sources, request: &PlanRequest<'_>) -> Plan {
    let graph = Graph::load(path, &registry(), sources).unwrap_or_else(|why| panic!("{why}"));
    graph.plan(request).unwrap_or_else(|why| panic!("{why}"))
}

fn executor(gpu: &Gpu, plan: Plan, provider: &mut dyn Provider) -> Executor {
    Executor::new(&gpu.device, &gpu.queue, plan, provider).unwrap_or_else(|why| panic!("{why}"))
}

/// A frame, and how long it took from its submission to its end.
fn frame(gpu: &Gpu, executor: &mut Executor, read: &[&str]) -> (Duration, FrameReport) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let frame = Frame::new().with_all(true);
    let done = |why| panic!("{why}");
    executor.encode(&mut encoder, &frame).unwrap_or_else(done);
    let begin = Instant::now();
    gpu.queue.submit([encoder.finish()]);
    executor.finish().unwrap_or_else(|why| panic!("{why}"));
    let time = begin.elapsed();
    // Read back by a frame of its own, which is not timed.
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let frame = Frame::new().with_read(read);
    executor.encode(&mut encoder, &frame).unwrap_or_else(done);
    gpu.queue.submit([encoder.finish()]);
    let report = executor.finish().unwrap_or_else(|why| panic!("{why}"));
    (time, report)
}

/// The rays that `rt` fills at `edge` × `edge` pixels of the scene's first view.
pub fn shadow_rays(gpu: &Gpu, name: &'static str, scene: &Arc<Scene>, edge: u32) -> Rays {
    let mut provider = SceneProvider::new(Arc::clone(scene));
    provider.set_view(&scene.views[0], [edge; 2]);
    let mut request = PlanRequest::new([edge; 2], &provider);
    let captured = ["rays", "ray_primitives", "ray_count"];
    for material in captured {
        request.captures.push(Capture::new(material));
    }
    request.outputs = Some(vec![]);
    let plan = plan("pipelines/rt.ron", &EmbeddedSources, &request);
    let mut executor = executor(gpu, plan, &mut provider);
    let (_, report) = frame(gpu, &mut executor, &captured);
    let words = |index: usize| report.readbacks[index].content.as_u32().unwrap_or_default();
    let mut rays: Vec<Ray> = bytemuck::pod_collect_to_vec(&words(0));
    let (mut skip, count) = (words(1), words(2)[0] as usize);
    rays.truncate(count);
    skip.truncate(count);
    assert!(!rays.is_empty(), "{name} has no rays");
    Rays {
        name,
        scene: Arc::clone(scene),
        rays,
        skip,
        to_light: true,
    }
}

/// One engine of `Trace`; what it builds of the scene is one of these resources, or its
/// acceleration structure.
pub fn engine<'a>(gpu: &'a Gpu, rays: &'a Rays, name: &str, builds: &[&str]) -> Engine<'a> {
    let mut provider = Given {
        scene: SceneProvider::new(Arc::clone(&rays.scene)),
        rays,
        count: [rays.rays.len() as u32],
    };
    let direction = if rays.to_light {
        ", direction: Light"
    } else {
        ""
    };
    let skip = if rays.skip.is_empty() {
        ""
    } else {
        ", skip: \"bench.skip\""
    };
    let document = Document(format!(
        r#"(
            format: 3,
            materials: [Buffer(name: "hits", count: "bench.rays.count")],
            passes: [
                Trace(
                    name: "trace", rays: "bench.rays", hits: "hits", count: "bench.number",
                    mode: Any, engine: {name}{direction}{skip},
                ),
            ],
            outputs: ["hits"],
        )"#
    ));
    let (device, queue) = (&gpu.device, &gpu.queue);
    let wait = || drop(device.poll(wgpu::PollType::wait_indefinitely()));
    // All engines share the mesh's uploads.
    for shared in ["scene.positions", "scene.indices"] {
        let built = provider.build(shared, device, queue);
        built.unwrap_or_else(|why| panic!("{why}"));
    }
    wait();
    let begin = Instant::now();
    for name in builds {
        let built = provider.build(name, device, queue);
        built.unwrap_or_else(|why| panic!("{why}"));
    }
    if builds.is_empty() {
        let built = provider.build_acceleration_structure("scene.tlas", device, queue);
        built.unwrap_or_else(|why| panic!("{why}"));
    }
    wait();
    let built = begin.elapsed();
    let mut request = PlanRequest::new([1, 1], &provider);
    request.features = device.features();
    request.limits = device.limits();
    let plan = plan("any_hits.ron", &document, &request);
    let mut executor = executor(gpu, plan, &mut provider);
    let trace = move || {
        let (time, report) = frame(gpu, &mut executor, &["hits"]);
        let words = report.readbacks[0].content.as_u32().unwrap_or_default();
        let hits = words.chunks_exact(4);
        (time, hits.map(|hit| hit[1] != u32::MAX).collect())
    };
    Engine {
        name: name.to_owned(),
        built,
        trace: Box::new(trace),
        blocked: Vec::new(),
    }
}
