//! Factors in the texels of Bevy's shadow maps: the pass that writes them, and the change to Bevy's
//! shader that reads them.

use bevy::{
    prelude::*,
    shader::{Shader, Source},
};

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering::Relaxed},
};

/// The function that looks a directional light's map up, and that of a spot light's.
const LOOKUPS: [&str; 2] = ["fn fetch_directional_shadow(", "fn fetch_spot_shadow("];

/// Tells both worlds whether Bevy's shader looks factors up.
#[derive(Resource, Clone, Default)]
pub struct IsPatched(Arc<AtomicBool>);

impl IsPatched {
    pub fn get(&self) -> bool {
        self.0.load(Relaxed)
    }
}

/// Puts the functions of `lookups.wesl` in the place of Bevy's, which they call for lights that are
/// not ours.
pub fn patch_shader(
    mut shaders: ResMut<Assets<Shader>>,
    mut is_done: Local<bool>,
    is_patched: Res<IsPatched>,
) {
    if *is_done {
        return;
    }
    let lookup = shaders
        .iter()
        .find(|(_, shader)| shader.path.ends_with("bevy_pbr/render/shadows.wesl"));
    let Some((id, _)) = lookup else {
        return; // not loaded yet
    };
    *is_done = true;
    let Some(mut shader) = shaders.get_mut(id) else {
        return;
    };
    let mut text = shader.source.as_str().to_owned();
    for lookup in LOOKUPS {
        if text.matches(lookup).count() != 1 {
            error!("SkiagraphShadows are not drawn: the shader of this Bevy has no `{lookup}`");
            return;
        }
        text = text.replace(lookup, &lookup.replace("_shadow(", "_shadow_by_map("));
    }
    text += include_str!("lookups.wesl");
    shader.source = Source::Wesl(text.into());
    is_patched.0.store(true, Relaxed);
}

/// Writes factors of pixels into the texels of layers of a map, one behind the other.
pub struct Writer {
    pipeline: wgpu::RenderPipeline,
    format: wgpu::TextureFormat,
}

impl Writer {
    /// A writer of `visibility`: integers or floats, 0 in shadow, 1 lit.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let is_integer = format.sample_type(None, None) == Some(wgpu::TextureSampleType::Uint);
        let number = if is_integer { "u32" } else { "f32" };
        let text = include_str!("write_map.wgsl").replace("NUMBER", number);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("skiagraph write map"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("skiagraph write map"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: None,
                compilation_options: default(),
                buffers: &[],
            },
            primitive: default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: default(),
                bias: default(),
            }),
            multisample: default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: None,
                compilation_options: default(),
                targets: &[],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline, format }
    }

    /// True if it writes visibility of this format.
    pub fn is_for(&self, format: wgpu::TextureFormat) -> bool {
        self.format == format
    }

    /// Records the passes, one for each layer.
    pub fn write(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        visibility: &wgpu::TextureView,
        layers: &[&wgpu::TextureView],
    ) {
        let side = layers.first().map_or(0, |layer| layer.texture().width());
        let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("skiagraph write map"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(visibility),
            }],
        });
        for (number, layer) in (0..).zip(layers) {
            let mut pass = begin(encoder, layer);
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &bound, &[]);
            let map = 8 * side + number;
            pass.draw(0..3, map..map + 1);
        }
    }
}

/// Makes all of a layer lit.
pub fn clear(encoder: &mut wgpu::CommandEncoder, layer: &wgpu::TextureView) {
    begin(encoder, layer);
}

fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    layer: &wgpu::TextureView,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("skiagraph write map"),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: layer,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(1.0),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        ..default()
    })
}
