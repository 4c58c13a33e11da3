//! A program with a preset's shadows: `cargo run -p skiagraph-passes --example preset`. It has no
//! window; one would give `main` its device and the pictures that `Shadows::frame` is asked for.

use glam::{DAffine3, DVec3};
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::{Graph, PlanRequest};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use skiagraph_scene::{Camera, DirectionalLight, Indexed, Mesh, Movable, View};
use std::error::Error;

pub struct Shadows {
    parts: Movable,
    pub provider: SceneProvider,
    executor: Executor,
}

impl Shadows {
    /// Of these meshes, for pictures of `size` pixels.
    pub fn new(
        gpu: (&wgpu::Device, &wgpu::Queue),
        size: [u32; 2],
        meshes: &[&Mesh],
    ) -> Result<Self, Box<dyn Error>> {
        let parts = Movable::joined(meshes);
        let light = DirectionalLight::new(DVec3::NEG_Y);
        let mut provider = SceneProvider::of_mesh(parts.rest.clone(), light);
        let graph = Graph::load("pipelines/light_buffer.ron", &registry(), &EmbeddedSources)?;
        let mut request = PlanRequest::new(size, &provider);
        request.limits = gpu.0.limits();
        request.features = gpu.0.features();
        let plan = graph.plan(&request)?;
        let executor = Executor::new(gpu.0, gpu.1, plan, &mut provider)?;
        Ok(Self {
            parts,
            provider,
            executor,
        })
    }

    /// Where the light reaches what the camera sees: 0 or 1 per pixel, once `encoder` is submitted.
    pub fn frame(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        camera: &Camera,
        light: DVec3,
        places: &[DAffine3],
    ) -> Result<wgpu::TextureView, Box<dyn Error>> {
        self.provider.set_camera(camera);
        self.provider.set_light(DirectionalLight::new(light).into());
        self.provider.set_transforms(&self.parts, places)?;
        self.executor.refresh(&mut self.provider)?;
        self.executor.encode(encoder, &Frame::default())?;
        Ok(self
            .executor
            .output_view("visibility")
            .ok_or("no visibility")?)
    }
}
