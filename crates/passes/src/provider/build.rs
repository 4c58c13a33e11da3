//! The resources of a scene as plans and executors ask for them.

use super::{
    SceneProvider,
    uploads::{known, unknown},
};
use crate::{
    buffers::On,
    built::How,
    error::Error,
    lights,
    names::*,
    ray_query::Source,
    uniforms::{CameraUniform, LightAreaUniform, LightUniform, UnprojectionUniform},
};
#[cfg(feature = "embree")]
use skiagraph_gpu::CpuWork;
use skiagraph_gpu::{DeviceIdentity, Provider, ProviderError};
use skiagraph_graph::{Describe, Provided, ProvidedBinding};
#[cfg(feature = "embree")]
use std::sync::Arc;

impl Describe for SceneProvider {
    fn names(&self) -> Vec<String> {
        known().chain(lights::names(self.lights().len())).collect()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let mesh = &self.uploads.scene.mesh;
        let corners = 3 * mesh.triangles.len();
        let bound = |binding, items: Option<usize>, stride: usize| {
            Some(Provided::new(
                binding,
                items.map(|items| items as u64),
                stride as u64,
            ))
        };
        let array = |items, stride| bound(ProvidedBinding::Storage, items, stride);
        let uniform = |bytes| bound(ProvidedBinding::Uniform, Some(1), bytes);
        match name {
            POSITIONS => array(Some(mesh.positions.len()), 16),
            INDICES | NORMAL_INDICES | ADJACENCY => array(Some(corners), 4),
            NORMALS => array(Some(mesh.normals.len()), 16),
            // Known only once the hierarchy is built.
            BVH_NODES | LIGHT_SPACE_NODES => array(None, 32),
            BVH_PRIMITIVES | LIGHT_SPACE_PRIMITIVES => array(Some(mesh.triangles.len()), 4),
            TLAS => Some(Provided::ACCELERATION_STRUCTURE),
            EMBREE => cfg!(feature = "embree").then_some(Provided::CPU_WORK),
            MASKS => array(Some(self.uploads.masks.len()), 4),
            SHEETS => array(Some(self.uploads.sheets.words().len()), 4),
            UVS => array(Some(mesh.surfaces.uvs.len()), 8),
            UV_INDICES => array(Some(3 * mesh.surfaces.uv_indices.len()), 4),
            MATERIALS => array(Some(mesh.surfaces.materials.len()), 32),
            MATERIAL_INDICES => array(Some(mesh.surfaces.of.len()), 4),
            // Known only once the textures are read.
            TEXELS => array(None, 4),
            CAMERA => uniform(size_of::<CameraUniform>()),
            UNPROJECTION => uniform(size_of::<UnprojectionUniform>()),
            LIGHT => uniform(size_of::<LightUniform>())
                .map(|light| light.with_kind(lights::provided_kind(&self.light()))),
            LIGHT_AREA => uniform(size_of::<LightAreaUniform>()),
            name => lights::describe(name, self.lights()),
        }
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
        let is_of_shape = is_of_shape(name) || lights::describe(name, self.lights()).is_some();
        (self.uploads.geometry.is_unplaced() && is_of_shape).then(|| {
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
        let checked = self.check_device(device);
        let buffer = checked.and_then(|()| self.uploads.buffer(name, On { device, queue }));
        buffer.map_err(ProviderError::from_error)
    }

    fn submit_built(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<(), ProviderError> {
        let submitted = self.uploads.buffers.submit(On { device, queue });
        submitted.map_err(ProviderError::from_error)
    }

    fn build_acceleration_structure(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Tlas, ProviderError> {
        let why = |error: Error| ProviderError::from_error(error);
        if name != TLAS {
            return Err(why(unknown(name)));
        }
        self.check_device(device).map_err(why)?;
        let on = On { device, queue };
        let vertices = self.uploads.buffer(POSITIONS, on).map_err(why)?;
        let indices = self.uploads.buffer(INDICES, on).map_err(why)?;
        // It is built of what they hold.
        self.submit_built(device, queue)?;
        let began = self.uploads.begin();
        let tlas = self.structures.get(Source {
            mesh: &self.uploads.scene.mesh,
            geometry: &self.uploads.geometry,
            buffers: [&vertices, &indices],
            shape: self.uploads.versions.shape,
            device,
            queue,
        });
        let (tlas, triangles) = tlas.map_err(why)?;
        if let Some(triangles) = triangles {
            self.uploads.geometry.work.triangles += triangles as u64;
            self.uploads.note(TLAS, How::Made, began);
        }
        Ok(tlas)
    }

    #[cfg(feature = "embree")]
    fn build_cpu_work(&mut self, name: &str) -> Result<Arc<dyn CpuWork>, ProviderError> {
        let why = |error: Error| ProviderError::from_error(error);
        if name != EMBREE {
            return Err(why(unknown(name)));
        }
        let version = self.uploads.versions.get(EMBREE);
        if let Some((embree, held)) = &self.embree
            && *held == version
        {
            return Ok(embree.clone());
        }
        if let Some(part) = self.uploads.geometry.a_host_part() {
            return Err(why(Error::OnDevice(EMBREE, part)));
        }
        let began = self.uploads.begin();
        let embree = Arc::new(crate::embree::Embree::build(&self.uploads.scene).map_err(why)?);
        self.embree = Some((embree.clone(), version));
        self.uploads.note(EMBREE, How::Made, began);
        Ok(embree)
    }
}
