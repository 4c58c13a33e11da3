//! The graph between Bevy's passes.

use crate::{Visibility, casters::Casters};
use bevy::{
    core_pipeline::prepass::ViewPrepassTextures,
    prelude::*,
    render::{
        render_asset::RenderAssets,
        renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery},
        texture::GpuImage,
        view::ExtractedView,
    },
};
use glam::DMat4;
use skiagraph_gpu::{Executor, Frame, import};
use skiagraph_graph::{Graph, LayeredSources, MemorySources, PlanRequest};
use skiagraph_passes::{Depth, EmbeddedSources, Eye, SceneProvider, registry};
use skiagraph_scene::{DirectionalLight, Movable};
use std::sync::{Arc, Mutex};

/// `light_buffer` on a host's depth and normals.
const DOCUMENT: &str = r#"(
    format: 3,
    extends: "light_buffer.ron",
    inputs: [Texture(name: "depth"), Texture(name: "normal")],
    passes: [Change(pass: "gbuffer", graph: "shared/from_depth.ron", set: {"unsigned": true})],
)"#;

/// The graph once there is something to run it on.
#[derive(Resource, Default)]
pub struct Shadows(Mutex<Option<Running>>);

struct Running {
    provider: SceneProvider,
    executor: Executor,
    parts: Arc<Movable>,
}

/// Textures that Bevy's prepass has drawn.
struct Prepass<'a> {
    depth: &'a wgpu::Texture,
    normal: &'a wgpu::Texture,
}

/// Encodes the graph behind the prepass, and copies what it finds to the materials' image.
pub fn encode(
    view: ViewQuery<(&ExtractedView, &ViewPrepassTextures)>,
    casters: Res<Casters>,
    visibility: Res<Visibility>,
    images: Res<RenderAssets<GpuImage>>,
    on: (Res<RenderDevice>, Res<RenderQueue>),
    shadows: Res<Shadows>,
    mut context: RenderContext,
) -> Result {
    let (view, textures) = view.into_inner();
    let (Some(depth), Some(normal)) = (&textures.depth, &textures.normal) else {
        return Err("the camera needs DepthPrepass and NormalPrepass".into());
    };
    let prepass = Prepass {
        depth: &depth.texture.texture,
        normal: &normal.texture.texture,
    };
    let (Some(parts), Some(image)) = (&casters.parts, images.get(&visibility.0)) else {
        return Ok(()); // nothing is loaded yet
    };
    let mut shadows = shadows
        .0
        .lock()
        .map_err(|_| "a frame before this one panicked")?;
    let running = match &mut *shadows {
        Some(running) => running,
        None => shadows.insert(Running::new(&on.0, &on.1, parts, &prepass)?),
    };
    running.follow(&casters, parts, view)?;
    let Running { executor, .. } = running;
    executor.import_texture("depth", prepass.depth)?;
    executor.import_texture("normal", prepass.normal)?;
    let encoder = context.command_encoder();
    executor.encode(encoder, &Frame::default())?;
    let output = executor.output_view("visibility").ok_or("no visibility")?;
    let output = output.texture();
    encoder.copy_texture_to_texture(
        output.as_image_copy(),
        image.texture.as_image_copy(),
        output.size(),
    );
    Ok(())
}

impl Running {
    fn new(
        device: &RenderDevice,
        queue: &RenderQueue,
        parts: &Arc<Movable>,
        prepass: &Prepass,
    ) -> Result<Self> {
        let light = DirectionalLight::new(glam::DVec3::NEG_Y);
        let mut provider = SceneProvider::from_parts(Arc::clone(parts), light);
        let document = MemorySources::new([("shadows.ron", DOCUMENT)]);
        let sources = LayeredSources(vec![Box::new(document), Box::new(EmbeddedSources)]);
        let graph = Graph::load("shadows.ron", &registry(), &sources)?;
        let size = prepass.depth.size();
        let mut request = PlanRequest::new([size.width, size.height], &provider);
        let device = device.wgpu_device();
        request.limits = device.limits();
        request.features = device.features();
        request.imports.extend([
            ("depth".to_owned(), import::texture(prepass.depth)),
            ("normal".to_owned(), import::texture(prepass.normal)),
        ]);
        let plan = graph.plan(&request)?;
        Ok(Self {
            executor: Executor::new(device, queue, plan, &mut provider)?,
            provider,
            parts: Arc::clone(parts),
        })
    }

    /// Camera, light and casters as they are in this frame.
    fn follow(&mut self, casters: &Casters, parts: &Arc<Movable>, view: &ExtractedView) -> Result {
        let matrix = |matrix: Mat4| DMat4::from_cols_array(&matrix.to_cols_array().map(f64::from));
        let world_from_view = matrix(view.world_from_view.to_matrix());
        let projection = matrix(view.clip_from_view);
        let eye = Eye::new(world_from_view.inverse(), projection, Depth::Reversed)?;
        self.provider.set_eye(&eye);
        if let Some(light) = casters.light {
            self.provider.set_light(DirectionalLight::new(light).into());
        }
        let is_another = !Arc::ptr_eq(parts, &self.parts);
        if is_another {
            self.provider.set_parts(Arc::clone(parts));
            self.parts = Arc::clone(parts);
        }
        self.provider.set_transforms(&casters.maps)?;
        if is_another {
            let plan = self
                .executor
                .plan()
                .with(|request| request.provider = &self.provider)?;
            self.executor.replace_graph(plan, &mut self.provider)?;
        }
        self.executor.refresh(&mut self.provider)?;
        Ok(())
    }
}
