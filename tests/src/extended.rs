//! A provider of a scene with further buffers, for graphs that read what no scene has.

use skiagraph_gpu::{Provider, ProviderError};
use skiagraph_graph::{Describe, Provided, ProvidedBinding};
use skiagraph_passes::SceneProvider;
use std::collections::BTreeMap;
use wgpu::util::DeviceExt;

/// A scene and some buffers beside it.
pub struct Extended {
    scene: SceneProvider,
    buffers: BTreeMap<String, (Vec<u8>, u64)>,
}

impl Extended {
    /// Creates a provider of a scene alone.
    pub fn new(scene: SceneProvider) -> Self {
        Self {
            scene,
            buffers: BTreeMap::new(),
        }
    }

    /// Adds a buffer, or replaces what a resource of the scene holds.
    pub fn add<T: bytemuck::NoUninit>(&mut self, name: &str, items: &[T]) {
        let content = bytemuck::cast_slice(items).to_vec();
        self.buffers
            .insert(name.to_owned(), (content, size_of::<T>() as u64));
    }
}

impl Describe for Extended {
    fn names(&self) -> Vec<String> {
        let mut names = self.scene.names();
        names.retain(|name| !self.buffers.contains_key(name));
        names.extend(self.buffers.keys().cloned());
        names
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let of_scene = self.scene.describe(name);
        let Some((content, stride)) = self.buffers.get(name).filter(|_| of_scene.is_none()) else {
            return of_scene;
        };
        Some(Provided::new(
            ProvidedBinding::Storage,
            Some(content.len() as u64 / stride),
            *stride,
        ))
    }
}

impl Provider for Extended {
    fn build_acceleration_structure(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Tlas, ProviderError> {
        self.scene.build_acceleration_structure(name, device, queue)
    }

    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        let Some((content, _)) = self.buffers.get(name) else {
            return self.scene.build(name, device, queue);
        };
        Ok(
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(name),
                contents: content,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::UNIFORM,
            }),
        )
    }

    fn submit_built(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<(), ProviderError> {
        self.scene.submit_built(device, queue)
    }
}
