//! All that is Skiagraph's: the visibility of the sun, from any preset.

use crate::{Failed, scene::Model, scene::Moment};
use skiagraph_host::passes::Depth;
use skiagraph_host::scene::{DirectionalLight, Indexed, Mesh, Movable};
use skiagraph_host::{
    EmbeddedSources, Executor, Eye, Frame, Pipelines, PlanRequest, SceneProvider, SceneView,
    load_unit_visibility, registry, wgpu,
};

pub struct Shadows {
    provider: SceneProvider,
    view: SceneView,
    executor: Executor,
}

impl Shadows {
    /// Reads the preset, plans it and compiles its shaders, which takes most of a program's start:
    /// on a thread of its own, while frames are drawn without it. `moment` has the first frame's
    /// camera, sun and places, `size` its width and height.
    pub fn new(
        (pipelines, queue): (&Pipelines, &wgpu::Queue),
        preset: &str,
        models: &[Model],
        (moment, size): (&Moment, [u32; 2]),
    ) -> Result<Self, Failed> {
        let meshes = models.iter().map(|model| {
            let indexed = Indexed {
                positions: &model.positions,
                normals: &model.normals,
                indices: &model.indices,
            };
            indexed.mesh()
        });
        let meshes: Vec<Mesh> = meshes.collect::<Result<_, _>>()?;
        let joined = Movable::joined(&meshes.iter().collect::<Vec<_>>());
        let mut provider = SceneProvider::from_parts(joined, sun(moment));
        provider.set_transforms(&moment.places)?;
        let view = SceneView::new(size, &eye(moment)?, sun(moment));

        let path = format!("pipelines/{preset}.ron");
        let graph = load_unit_visibility(&path, &registry(), &EmbeddedSources)?;
        let device = pipelines.device();
        let request = PlanRequest::new(size, view.apply(&mut provider))
            .with_device(device.limits(), device.features());
        let plan = graph.plan(&request)?;
        let executor = Executor::with_pipelines(pipelines, queue, plan, &mut provider)?;
        Ok(Self {
            provider,
            view,
            executor,
        })
    }

    /// Encodes the preset's passes and returns the share of the sun that each pixel sees, R8Unorm.
    /// The texture may be another one in the next frame.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        (moment, size): (&Moment, [u32; 2]),
    ) -> Result<wgpu::TextureView, Failed> {
        self.provider.set_transforms(&moment.places)?;
        self.view.set_size(size);
        self.view.set_eye(&eye(moment)?);
        self.view.set_light(sun(moment))?;
        self.view.refresh(&mut self.executor, &mut self.provider)?;
        self.executor.encode(encoder, &Frame::new())?;
        let visibility = self.executor.output_view("unit_visibility");
        visibility.ok_or_else(|| "the preset has no visibility".into())
    }
}

/// Wider than the real one, which has half a degree. Presets of hard shadows take its centre.
fn sun(moment: &Moment) -> DirectionalLight {
    DirectionalLight {
        direction: -moment.to_sun,
        angle_degrees: 3.0,
    }
}

fn eye(moment: &Moment) -> Result<Eye, Failed> {
    Ok(Eye::new(moment.view, moment.projection, Depth::Reversed)?)
}
