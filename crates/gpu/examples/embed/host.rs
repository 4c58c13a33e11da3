//! The host's side, without a word of the graph: device, scene, G-buffer and shading in plain wgpu.

use std::error::Error;
use wgpu::util::DeviceExt;

/// Half of the ground's edge.
pub const GROUND: f32 = 4.0;
/// Edge and height of the box.
pub const BOX: [f32; 2] = [2.0, 1.5];

/// The host's buffers of scene and light.
pub struct Scene {
    /// Four floats each, triangle by triangle.
    pub vertices: wgpu::Buffer,
    /// The matrix from the world to the light's clip space.
    pub light: wgpu::Buffer,
}

/// A program with a device of its own.
pub struct Host {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub scene: Scene,
    pub light: [f32; 2],
    gbuffer: wgpu::RenderPipeline,
    camera: wgpu::BindGroup,
    shade: wgpu::ComputePipeline,
}

impl Host {
    pub fn new(light: [f32; 2]) -> Result<Self, Box<dyn Error>> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        // wgpu's flags of a debug build hand labels to the driver, on which the software driver of
        // Mesa 22.3 crashes.
        descriptor.flags = wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL.with_env();
        let instance = wgpu::Instance::new(descriptor);
        let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
        let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;
        let module = device.create_shader_module(wgpu::include_wgsl!("host.wgsl"));
        let gbuffer = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("gbuffer"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: 16,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &wgpu::vertex_attr_array![0 => Float32x4],
                })],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("gbuffer"),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::TextureFormat::Rgba32Float.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let shade = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("shade"),
            layout: None,
            module: &module,
            entry_point: Some("shade"),
            compilation_options: Default::default(),
            cache: None,
        });
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents,
                usage,
            })
        };
        let uniform = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let camera = buffer(bytemuck::cast_slice(&view([0.0; 2], GROUND)), uniform);
        let vertices = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE;
        let scene = Scene {
            vertices: buffer(bytemuck::cast_slice(&triangles()), vertices),
            light: buffer(bytemuck::cast_slice(&view(light, 2.0 * GROUND)), uniform),
        };
        let camera = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("camera"),
            layout: &gbuffer.get_bind_group_layout(0),
            entries: &[entry(0, camera.as_entire_binding())],
        });
        Ok(Self {
            device,
            queue,
            scene,
            light,
            gbuffer,
            camera,
            shade,
        })
    }

    pub fn gbuffer(&self, [width, height]: [u32; 2]) -> GBuffer {
        let texture = |format| {
            self.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("gbuffer"),
                size: wgpu::Extent3d {
                    width,
                    height,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        };
        GBuffer {
            depth: texture(wgpu::TextureFormat::Depth32Float),
            position: texture(wgpu::TextureFormat::Rgba32Float),
        }
    }

    pub fn set_light(&mut self, light: [f32; 2]) {
        let matrix = view(light, 2.0 * GROUND);
        self.queue
            .write_buffer(&self.scene.light, 0, bytemuck::cast_slice(&matrix));
        self.light = light;
    }

    pub fn draw(&self, encoder: &mut wgpu::CommandEncoder, gbuffer: &GBuffer) {
        let position = gbuffer.position.create_view(&Default::default());
        let depth = gbuffer.depth.create_view(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("gbuffer"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &position,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.gbuffer);
        pass.set_bind_group(0, &self.camera, &[]);
        pass.set_vertex_buffer(0, self.scene.vertices.slice(..));
        pass.draw(0..(self.scene.vertices.size() / 16) as u32, 0..1);
    }

    /// Encodes the host's shading, one letter per pixel, and returns the buffer that they arrive
    /// in.
    pub fn shade(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        gbuffer: &GBuffer,
        visibility: &wgpu::TextureView,
    ) -> wgpu::Buffer {
        let [width, height] = [gbuffer.position.width(), gbuffer.position.height()];
        let buffer = |usage| {
            let size = u64::from(width * height * 4);
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("letters"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let letters = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let arrived = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        let position = gbuffer.position.create_view(&Default::default());
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("shade"),
            layout: &self.shade.get_bind_group_layout(0),
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(&position)),
                entry(1, wgpu::BindingResource::TextureView(visibility)),
                entry(2, letters.as_entire_binding()),
            ],
        });
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.shade);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(width.div_ceil(8), height.div_ceil(8), 1);
        drop(pass);
        encoder.copy_buffer_to_buffer(&letters, 0, &arrived, 0, None);
        arrived
    }
}

/// Buffers that the host draws before the graph's passes run.
pub struct GBuffer {
    pub depth: wgpu::Texture,
    pub position: wgpu::Texture,
}

fn entry(binding: u32, resource: wgpu::BindingResource<'_>) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource }
}

/// The columns of the matrix that slides the world along (x, -1, z) onto the ground, 2·half of
/// which fill the picture; depth is 0 five units above the ground and 1 as far below.
fn view([x, z]: [f32; 2], half: f32) -> [[f32; 4]; 4] {
    [
        [1.0 / half, 0.0, 0.0, 0.0],
        [x / half, -z / half, -0.1, 0.0],
        [0.0, -1.0 / half, 0.0, 0.0],
        [0.0, 0.0, 0.5, 1.0],
    ]
}

/// The ground, and the box without its bottom.
fn triangles() -> Vec<[f32; 4]> {
    let ([w, h], g) = ([BOX[0] / 2.0, BOX[1]], GROUND);
    let quads = [
        [[-g, 0.0, -g], [g, 0.0, -g], [g, 0.0, g], [-g, 0.0, g]],
        [[-w, h, -w], [w, h, -w], [w, h, w], [-w, h, w]],
        [[-w, 0.0, -w], [w, 0.0, -w], [w, h, -w], [-w, h, -w]],
        [[-w, 0.0, w], [w, 0.0, w], [w, h, w], [-w, h, w]],
        [[-w, 0.0, -w], [-w, 0.0, w], [-w, h, w], [-w, h, -w]],
        [[w, 0.0, -w], [w, 0.0, w], [w, h, w], [w, h, -w]],
    ];
    let corners = |quad: [[f32; 3]; 4]| [0, 1, 2, 0, 2, 3].map(|corner| quad[corner]);
    let corners = quads.into_iter().flat_map(corners);
    corners.map(|[x, y, z]| [x, y, z, 1.0]).collect()
}
