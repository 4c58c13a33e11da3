//! All that is Skiagraph's: the visibility of the sun, from any preset.

use crate::Failed;
use crate::scene::{Moment, PARTS, models};
use skiagraph_host::scene::{DirectionalLight, Indexed, Mesh, Movable};
use skiagraph_host::{
    EmbeddedSources, Executor, Eye, Frame, PlanRequest, SceneProvider, SceneView,
    load_unit_visibility, passes::Depth, registry, wgpu,
};

pub struct Shadows {
    provider: SceneProvider,
    view: SceneView,
    executor: Executor,
}

impl Shadows {
    /// Reads a preset, plans it for the first frame's `moment` and compiles its shaders, which
    /// takes most of a program's start. It may run on a thread, while frames have no shadows.
    pub fn new(
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        preset: &str,
        moment: &Moment,
    ) -> Result<Self, Failed> {
        let meshes = models().map(|model| {
            let indexed = Indexed {
                positions: &model.positions,
                normals: &model.normals,
                indices: &model.indices,
            };
            indexed.mesh()
        });
        let meshes: Vec<Mesh> = meshes.into_iter().collect::<Result<_, _>>()?;
        let parts = Movable::joined(&PARTS.map(|(model, _)| &meshes[model]));
        let mut provider = SceneProvider::from_parts(parts, sun(moment));
        let view = SceneView::new(moment.size, &eye(moment)?, sun(moment));

        let path = format!("pipelines/{preset}.ron");
        let graph = load_unit_visibility(&path, &registry(), &EmbeddedSources)?;
        let request = PlanRequest::new(moment.size, view.apply(&mut provider));
        let plan = graph.plan(&request.with_device(device.limits(), device.features()))?;
        Ok(Self {
            executor: Executor::new(device, queue, plan, &mut provider)?,
            provider,
            view,
        })
    }

    /// Encodes the preset's passes and returns the share of the sun that each pixel sees, R8Unorm.
    /// The texture may be another one in the next frame.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        moment: &Moment,
    ) -> Result<wgpu::TextureView, Failed> {
        self.provider.set_transforms(&moment.places)?;
        self.view.set_size(moment.size);
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
