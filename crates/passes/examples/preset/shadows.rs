use glam::{DAffine3, DVec3};
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::{Graph, PlanRequest};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use skiagraph_scene::{Camera, DirectionalLight, Mesh, Movable};
use wgpu::{CommandEncoder, Device, Queue, TextureView};

type Failed = Box<dyn std::error::Error>;

pub struct Shadows {
    pub provider: SceneProvider,
    executor: Executor,
}

impl Shadows {
    /// Creates the shadows of these meshes, for pictures of the given size in pixels.
    pub fn new(on: (&Device, &Queue), size: [u32; 2], meshes: &[&Mesh]) -> Result<Self, Failed> {
        let light = DirectionalLight::new(DVec3::NEG_Y);
        let mut provider = SceneProvider::from_parts(Movable::joined(meshes), light);
        let graph = Graph::load("pipelines/light_buffer.ron", &registry(), &EmbeddedSources)?;
        let request = PlanRequest::new(size, &provider);
        let plan = graph.plan(&request.with_device(on.0.limits(), on.0.features()))?;
        Ok(Self {
            executor: Executor::new(on.0, on.1, plan, &mut provider)?,
            provider,
        })
    }

    /// Writes 1 for each pixel that sees the light, else 0; `places` has a map for each mesh.
    pub fn frame(
        &mut self,
        encoder: &mut CommandEncoder,
        camera: &Camera,
        light: DVec3,
        places: &[DAffine3],
    ) -> Result<TextureView, Failed> {
        self.provider.set_camera(camera);
        self.provider.set_light(DirectionalLight::new(light).into());
        self.provider.set_transforms(places)?;
        self.executor
            .refresh(&mut self.provider.in_encoder(encoder)?)?;
        self.executor.encode(encoder, &Frame::default())?;
        let visibility = self.executor.output_view("visibility");
        visibility.ok_or_else(|| "the preset has no visibility".into())
    }
}
