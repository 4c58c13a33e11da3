//! The provider that records into an encoder of the host, as executors ask it.

use super::InEncoder;
use super::build::build_structure;
use crate::buffers::On;
use skiagraph_gpu::{CpuWork, DeviceIdentity, Provider, ProviderError};
use skiagraph_graph::{Describe, Provided};
use std::sync::Arc;

impl Describe for InEncoder<'_> {
    fn names(&self) -> Vec<String> {
        self.provider.names()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        self.provider.describe(name)
    }
}

impl Provider for InEncoder<'_> {
    fn version(&self, name: &str) -> u64 {
        self.provider.version(name)
    }

    fn has_versions(&self) -> bool {
        self.provider.has_versions()
    }

    fn device(&self) -> Option<&DeviceIdentity> {
        self.provider.device()
    }

    fn missing(&self, name: &str) -> Option<String> {
        self.provider.missing(name)
    }

    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        self.provider.build(name, device, queue)
    }

    fn write_uniform(&mut self, name: &str, content: &mut [u8]) -> Result<bool, ProviderError> {
        self.provider.write_uniform(name, content)
    }

    fn submit_built(
        &mut self,
        device: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<(), ProviderError> {
        let buffers = &mut self.provider.uploads.buffers;
        buffers.record_into(self.encoder, device)
    }

    fn build_acceleration_structure(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Tlas, ProviderError> {
        let on = On { device, queue };
        build_structure(self.provider, name, on, Some(self.encoder))
    }

    fn build_cpu_work(&mut self, name: &str) -> Result<Arc<dyn CpuWork>, ProviderError> {
        self.provider.build_cpu_work(name)
    }
}
