//! A provider that records what the GPU writes into an encoder of the host.

use super::SceneProvider;
use crate::buffers::On;
use crate::ray_query::Structures;
use skiagraph_gpu::{CpuWork, DeviceIdentity, ExecuteError, Provider, ProviderError};
use skiagraph_graph::{Describe, Provided};
use std::sync::Arc;

/// A [`SceneProvider`] that submits nothing: what its GPU work writes comes into an encoder of the
/// host, between the commands that are there. [`SceneProvider::in_encoder`] makes it.
pub struct InEncoder<'a> {
    provider: &'a mut SceneProvider,
    encoder: &'a mut wgpu::CommandEncoder,
}

impl SceneProvider {
    /// Returns this provider as one for [`refresh`](skiagraph_gpu::Executor::refresh) whose GPU
    /// work comes into an encoder of the host, and not into a submission of its own:
    ///
    /// ```no_run
    /// # fn frame(provider: &mut skiagraph_passes::SceneProvider,
    /// #     executor: &mut skiagraph_gpu::Executor, gpu: &skiagraph_gpu::device::Gpu)
    /// #     -> Result<(), Box<dyn std::error::Error>> {
    /// let mut encoder = gpu.device.create_command_encoder(&Default::default());
    /// // Record the host's skinning here, into the same encoder.
    /// executor.refresh(&mut provider.in_encoder(&mut encoder)?)?;
    /// executor.encode(&mut encoder, &skiagraph_gpu::Frame::new())?;
    /// gpu.queue.submit([encoder.finish()]);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// Parts of [hosts' buffers](Self::add_host_part) are read as the commands before have left
    /// them, so vertices may be written in the same encoder. Where few parts have changed, only
    /// these are written, into the buffers that executors have bound. So encoders must be submitted
    /// in the order in which they were recorded, and each executor of the provider be refreshed
    /// before its next frame: the scene is that of the last refresh, also for executors that have
    /// not seen it. Buffers that a [branch](Self::branch) shares are copied first.
    ///
    /// What an encoder held that was dropped is recorded again by the next call of this method and
    /// the refresh that follows it, and executors run all passes that read it. The same holds for
    /// one that wgpu refused or that was submitted after a later one, once the GPU has finished.
    /// Frames that were submitted meanwhile lack it.
    ///
    /// # Errors
    /// [`ExecuteError::DeviceLost`] if the device of the provider is lost.
    pub fn in_encoder<'a>(
        &'a mut self,
        encoder: &'a mut wgpu::CommandEncoder,
    ) -> Result<InEncoder<'a>, ExecuteError> {
        let device = self.device.as_ref().map(|own| own.device().clone());
        if let Some(device) = device
            && self.uploads.buffers.record_lost(&device)?
        {
            self.structures = Structures::default();
            self.uploads.versions.change_mesh();
        }
        Ok(InEncoder {
            provider: self,
            encoder,
        })
    }
}

impl InEncoder<'_> {
    /// Does something with the provider, whose buffers are written where they are.
    fn in_place<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        self.provider.uploads.buffers.in_place = true;
        let done = act(self);
        self.provider.uploads.buffers.in_place = false;
        done
    }
}

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
        self.in_place(|own| own.provider.build(name, device, queue))
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
        self.in_place(|own| own.provider.build_structure(name, on, Some(own.encoder)))
    }

    fn build_cpu_work(&mut self, name: &str) -> Result<Arc<dyn CpuWork>, ProviderError> {
        self.provider.build_cpu_work(name)
    }
}
