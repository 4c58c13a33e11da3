//! The program's own renderer: one forward pass with reversed depth. It knows nothing of Skiagraph.

use crate::scene::{Model, Moment};
use skiagraph_host::wgpu::{self, util::DeviceExt};
use std::ops::Range;

const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

pub struct Renderer {
    pipeline: wgpu::RenderPipeline,
    uniform: wgpu::Buffer,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    parts: Vec<Part>,
    depth: wgpu::Texture,
}

/// A model's range in the index buffer, and the number of its first vertex.
struct Part {
    indices: Range<u32>,
    base_vertex: i32,
    color: [f32; 4],
}

impl Renderer {
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat, models: &[Model]) -> Self {
        let (mut vertices, mut indices, mut parts) = (vec![], Vec::<u32>::new(), vec![]);
        for model in models {
            let first = indices.len() as u32;
            parts.push(Part {
                indices: first..first + model.indices.len() as u32,
                base_vertex: vertices.len() as i32,
                color: model.color,
            });
            vertices.extend(
                model
                    .positions
                    .iter()
                    .zip(&model.normals)
                    .map(|(p, n)| [*p, *n]),
            );
            indices.extend(&model.indices);
        }
        let buffer = |contents: &[u8], usage| {
            let label = None;
            let descriptor = wgpu::util::BufferInitDescriptor {
                label,
                contents,
                usage,
            };
            device.create_buffer_init(&descriptor)
        };
        let floats = 16 + 4 + 20 * models.len();
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        Self {
            pipeline: pipeline(device, format),
            uniform: buffer(&vec![0; 4 * floats], usage),
            vertices: buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer(bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
            parts,
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
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::Texture,
        moment: &Moment,
        visibility: &wgpu::TextureView,
    ) {
        let clip_from_world = (moment.projection * moment.view).as_mat4();
        let mut uniform = clip_from_world.to_cols_array().to_vec();
        uniform.extend(moment.to_sun.as_vec3().extend(0.0).to_array());
        for (part, place) in self.parts.iter().zip(&moment.places) {
            let place = skiagraph_host::glam::DMat4::from(*place).as_mat4();
            uniform.extend(place.to_cols_array());
            uniform.extend(part.color);
        }
        // Frames that were submitted before keep what was written for them.
        queue.write_buffer(&self.uniform, 0, bytemuck::cast_slice(&uniform));
        if self.depth.size() != target.size() {
            let size = [target.width(), target.height()];
            self.depth = texture(device, size, DEPTH, wgpu::TextureUsages::RENDER_ATTACHMENT);
        }
        let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: self.uniform.as_entire_binding(),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(visibility),
                },
            ],
        });
        let color = wgpu::Color {
            r: 0.45,
            g: 0.6,
            b: 0.8,
            a: 1.0,
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.create_view(&Default::default()),
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(color),
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
        for (number, part) in (0..).zip(&self.parts) {
            pass.draw_indexed(part.indices.clone(), part.base_vertex, number..number + 1);
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
            ..Default::default()
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}
