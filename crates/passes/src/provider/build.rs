//! The resources of a scene as plans and executors ask for them.

use super::SceneProvider;
#[cfg(feature = "embree")]
use crate::error::Error;
use crate::{buffers::On, built::How, lights, names::*, ray_query::Source};
#[cfg(feature = "embree")]
use skiagraph_gpu::CpuWork;
use skiagraph_gpu::{DeviceIdentity, Provider, ProviderError};
use skiagraph_graph::{Describe, Provided};
#[cfg(feature = "embree")]
use std::sync::Arc;

impl Describe for SceneProvider {
    fn names(&self) -> Vec<String> {
        let lights = lights::names(self.lights().len());
        self.uploads.names().chain(lights).collect()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let resource = self.uploads.find(name)?;
        (resource.describe)(&self.uploads, name)
    }
}

impl Provider for SceneProvider {
    fn version(&self, name: &str) -> u64 {
        if name == TLAS {
            return self.structures.version(self.uploads.versions.shape);
        }
        self.uploads.version(name)
    }

    fn has_versions(&self) -> bool {
        true
    }

    fn device(&self) -> Option<&DeviceIdentity> {
        self.device.as_ref()
    }

    fn missing(&self, name: &str) -> Option<String> {
        let made_from = self.uploads.find(name)?.made_from;
        let is_free = matches!(
            made_from,
            MadeFrom::Eye | MadeFrom::Light | MadeFrom::Winding | MadeFrom::Mesh
        );
        let is_placed = !is_free && self.describe(name).is_some();
        (self.uploads.geometry.is_unplaced() && is_placed).then(|| {
            "the parts of the mesh have no places yet: call `SceneProvider::set_transforms`, then \
             `Executor::refresh`"
                .to_owned()
        })
    }

    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        self.check_device(device)?;
        Ok(self.uploads.buffer(name, On { device, queue })?)
    }

    fn write_uniform(&mut self, name: &str, content: &mut [u8]) -> Result<bool, ProviderError> {
        let Some(bytes) = self.uploads.uniform(name)? else {
            return Ok(false);
        };
        // A provider around this one may describe it otherwise.
        if bytes.len() != content.len() {
            let [described, own] = [content.len(), bytes.len()];
            let why = format!("it was described as {described} bytes, and has {own}");
            return Err(ProviderError::new(why));
        }
        content.copy_from_slice(&bytes);
        Ok(true)
    }

    fn submit_built(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<(), ProviderError> {
        self.record_lost(device)
            .map_err(ProviderError::from_error)?;
        Ok(self.uploads.buffers.submit(On { device, queue })?)
    }

    fn build_acceleration_structure(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Tlas, ProviderError> {
        build_structure(self, name, On { device, queue }, None)
    }

    #[cfg(feature = "embree")]
    fn build_cpu_work(&mut self, name: &str) -> Result<Arc<dyn CpuWork>, ProviderError> {
        if name != EMBREE {
            return Err(self.uploads.unknown(name).into());
        }
        let version = self.uploads.version(EMBREE);
        if let Some((embree, held)) = &self.embree
            && *held == version
        {
            return Ok(embree.clone());
        }
        if let Some(part) = self.uploads.geometry.a_host_part() {
            return Err(Error::OnDevice(EMBREE, part).into());
        }
        let began = self.uploads.begin();
        self.uploads.bring();
        let embree = Arc::new(crate::embree::Embree::build(&self.uploads.scene)?);
        self.embree = Some((embree.clone(), version));
        self.uploads.note(EMBREE, How::Made, began);
        Ok(embree)
    }
}

/// Builds the acceleration structure of that name, in an encoder of the host or a submission of
/// its own.
pub(super) fn build_structure(
    provider: &mut SceneProvider,
    name: &str,
    on: On,
    mut encoder: Option<&mut wgpu::CommandEncoder>,
) -> Result<wgpu::Tlas, ProviderError> {
    if name != TLAS {
        return Err(provider.uploads.unknown(name).into());
    }
    provider.check_device(on.device)?;
    if encoder.is_none() {
        let settled = provider.record_lost(on.device);
        settled.map_err(ProviderError::from_error)?;
        if provider.uploads.buffers.is_open() {
            // The last one may be in an encoder that is not submitted yet.
            provider.structures = Default::default();
        }
    }
    let vertices = provider.uploads.buffer(POSITIONS, on)?;
    let indices = provider.uploads.buffer(INDICES, on)?;
    // It is built of what they hold.
    match &mut encoder {
        Some(encoder) => provider.uploads.buffers.record_into(encoder, on.device)?,
        None => provider.uploads.buffers.submit(on)?,
    }
    let began = provider.uploads.begin();
    let source = Source {
        mesh: &provider.uploads.scene.mesh,
        geometry: &provider.uploads.geometry,
        buffers: [&vertices, &indices],
        shape: provider.uploads.versions.shape,
        on,
    };
    let (tlas, triangles) = provider.structures.get(source, encoder.as_deref_mut())?;
    if let Some(encoder) = encoder.filter(|_| triangles.is_some()) {
        provider.uploads.buffers.follow(encoder, on.device)?;
    }
    if let Some(triangles) = triangles {
        provider.uploads.geometry.work.triangles += triangles as u64;
        provider.uploads.note(TLAS, How::Made, began);
    }
    Ok(tlas)
}
