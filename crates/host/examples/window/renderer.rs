//! The program's own renderer: one forward pass with reversed depth. It knows nothing of Skiagraph.

use crate::scene::{Moment, PARTS, models};
use skiagraph_host::wgpu::{self, util::DeviceExt};
use std::ops::Range;

const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const SKY: wgpu::Color = wgpu::Color {
    r: 0.45,
    g: 0.6,
    b: 0.8,
    a: 1.0,
};

pub struct Renderer {
    pipeline: wgpu::RenderPipeline,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    /// Range of each model in the index buffer, and the number of its first vertex.
    models: Vec<(Range<u32>, i32)>,
    depth: wgpu::Texture,
}

impl Renderer {
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let (mut vertices, mut indices, mut ranges) = (vec![], Vec::<u32>::new(), vec![]);
        for model in models() {
            let range = indices.len() as u32..(indices.len() + model.indices.len()) as u32;
            ranges.push((range, vertices.len() as i32));
            let normals = model.normals.iter();
            vertices.extend(model.positions.iter().zip(normals).map(|(p, n)| [*p, *n]));
            indices.extend(&model.indices);
        }
        let vertex = wgpu::BufferUsages::VERTEX;
        Self {
            pipeline: pipeline(device, format),
            vertices: buffer(device, bytemuck::cast_slice(&vertices), vertex),
            indices: buffer(
                device,
                bytemuck::cast_slice(&indices),
                wgpu::BufferUsages::INDEX,
            ),
            models: ranges,
            depth: texture(
                device,
                [1, 1],
                DEPTH,
                wgpu::TextureUsages::RENDER_ATTACHMENT,
            ),
        }
    }

    /// Draws the scene at a moment into `target`, lit by a sun of that visibility.
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::Texture,
        moment: &Moment,
        visibility: &wgpu::TextureView,
    ) {
        let clip_from_world = (moment.projection * moment.view).as_mat4();
        let mut uniform = clip_from_world.to_cols_array().to_vec();
        uniform.extend(moment.to_sun.as_vec3().extend(0.0).to_array());
        for ((_, color), place) in PARTS.iter().zip(moment.places) {
            let place = skiagraph_host::glam::DMat4::from(place).as_mat4();
            uniform.extend(place.to_cols_array());
            uniform.extend(color);
        }
        let uniform = bytemuck::cast_slice(&uniform);
        let uniform = buffer(device, uniform, wgpu::BufferUsages::UNIFORM);
        if self.depth.size() != target.size() {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
            self.depth = texture(device, moment.size, DEPTH, usage);
        }
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                entry(0, uniform.as_entire_binding()),
                entry(1, wgpu::BindingResource::TextureView(visibility)),
            ],
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.create_view(&Default::default()),
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(SKY),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth.create_view(&Default::default()),
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bound, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (number, (model, _)) in (0..).zip(PARTS) {
            let (indices, first) = self.models[model].clone();
            pass.draw_indexed(indices, first, number..number + 1);
        }
    }
}

fn pipeline(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("shade.wgsl"));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: 24,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
            })],
        },
        primitive: wgpu::PrimitiveState {
            cull_mode: Some(wgpu::Face::Back),
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn buffer(device: &wgpu::Device, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents,
        usage,
    })
}

pub fn texture(
    device: &wgpu::Device,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}
