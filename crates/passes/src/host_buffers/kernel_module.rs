//! The kernels over one way of decoding vertices.

use std::sync::OnceLock;

/// Entry points of place.wgsl that write parts.
pub(super) const ENTRIES: [&str; 5] = [
    "place_positions",
    "place_normals",
    "fit_nodes",
    "find_beyond",
    "move_parts",
];

/// The module of kernels that decode vertices in one way, and its pipelines.
#[derive(Debug)]
pub(super) struct KernelModule {
    module: wgpu::ShaderModule,
    pipelines: [OnceLock<wgpu::ComputePipeline>; ENTRIES.len()],
}

impl KernelModule {
    /// Makes the module, with one that decodes vertices.
    pub fn new(device: &wgpu::Device, decode: &str) -> Self {
        let source = format!("{decode}\n{}", include_str!("place.wgsl"));
        Self {
            module: device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("parts of hosts' buffers"),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            }),
            pipelines: Default::default(),
        }
    }

    /// Makes the pipeline of an entry point.
    pub fn compile(&self, entry: &str, device: &wgpu::Device) -> wgpu::ComputePipeline {
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: None,
            module: &self.module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        })
    }

    /// The pipeline of an entry of [`ENTRIES`] by its number, made when it is first asked for.
    pub fn pipeline(&self, entry: usize, device: &wgpu::Device) -> wgpu::ComputePipeline {
        let make = || self.compile(ENTRIES[entry], device);
        self.pipelines[entry].get_or_init(make).clone()
    }
}
