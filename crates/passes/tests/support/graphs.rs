//! Runs graphs for tests.

use skiagraph_graph::{
    Content, Executor, Frame, FrameReport, Graph, LayeredSources, Plan, PlanRequest, Provided, Provider, ProviderError,
    Sources, gpu,
};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use std::{collections::BTreeMap, sync::Arc};
use wgpu::util::DeviceExt;

/// A scene and some buffers of the test's own.
pub struct Extended {
    scene: SceneProvider,
    buffers: BTreeMap<String, (Vec<u8>, u64)>,
}

impl Extended {
    pub fn new(scene: SceneProvider) -> Self {
        Self { scene, buffers: BTreeMap::new() }
    }

    pub fn add<T: bytemuck::NoUninit>(&mut self, name: &str, items: &[T]) {
        let content = bytemuck::cast_slice(items).to_vec();
        self.buffers.insert(name.to_owned(), (content, size_of::<T>() as u64));
    }
}

impl Provider for Extended {
    fn names(&self) -> Vec<String> {
        self.scene.names().into_iter().chain(self.buffers.keys().cloned()).collect()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let Some((content, stride)) = self.buffers.get(name) else { return self.scene.describe(name) };
        Some(Provided { items: Some(content.len() as u64 / stride), stride: *stride, uniform: false })
    }

    fn build(&mut self, name: &str, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<wgpu::Buffer, ProviderError> {
        let Some((content, _)) = self.buffers.get(name) else { return self.scene.build(name, device, queue) };
        Ok(device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(name),
            contents: content,
            usage: wgpu::BufferUsages::STORAGE,
        }))
    }
}

/// One document that is on no disk.
struct Document(String);

impl Sources for Document {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        Ok((path == "test.ron").then(|| self.0.as_str().into()))
    }

    fn list(&self, _: &str) -> Vec<String> {
        vec![]
    }
}

/// Runs a document given as text once, and returns one output's bytes.
pub fn run_text(document: &str, provider: &mut dyn Provider, output: &str) -> Vec<u8> {
    let sources = LayeredSources(vec![Box::new(Document(document.to_owned())), Box::new(EmbeddedSources)]);
    let graph = Graph::load("test.ron", &registry(), &sources).unwrap_or_else(|error| panic!("{error}"));
    let plan = graph.plan(&PlanRequest::new([1, 1], provider)).unwrap_or_else(|error| panic!("{error}"));
    let report = run(plan, provider, &[output], false);
    match report.readbacks.into_iter().next().unwrap().content {
        Content::Buffer(bytes) | Content::Texture { bytes, .. } => bytes,
    }
}

/// Runs one frame of a plan on a device of its own.
pub fn run(plan: Plan, provider: &mut dyn Provider, read: &[&str], timing: bool) -> FrameReport {
    let gpu = gpu::open(None).unwrap_or_else(|error| panic!("{error}"));
    let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, provider).unwrap_or_else(|error| panic!("{error}"));
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    executor.encode(&mut encoder, &Frame { timing, read }).unwrap();
    gpu.queue.submit([encoder.finish()]);
    executor.submitted(&gpu.queue).unwrap();
    executor.finish().unwrap()
}

/// The integers of an output.
pub fn values(report: &FrameReport, name: &str) -> Vec<u32> {
    let readback = report.readbacks.iter().find(|readback| readback.name == name).unwrap();
    readback.content.as_u32().unwrap()
}
