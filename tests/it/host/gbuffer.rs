//! A host that draws depth, normals and primitives with matrices of its own.

use glam::{DMat4, DVec3};
use skiagraph_gpu::device::Gpu;
use skiagraph_passes::Depth;
use skiagraph_scene::Mesh;
use wgpu::util::DeviceExt;

const SHADER: &str = r"
struct Corner {
    @builtin(position) place: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) @interpolate(flat) primitive: u32,
}

struct Seen {
    @location(0) normal: vec4<f32>,
    @location(1) primitive: u32,
}

@group(0) @binding(0) var<uniform> clip_from_world: mat4x4<f32>;

@vertex
fn vertex(
    @builtin(vertex_index) index: u32,
    @location(0) place: vec3<f32>,
    @location(1) normal: vec3<f32>,
) -> Corner {
    return Corner(clip_from_world * vec4(place, 1.0), normal, index / 3u);
}

@fragment
fn fragment(corner: Corner) -> Seen {
    return Seen(vec4(normalize(corner.normal), 0.0), corner.primitive);
}
";

/// Buffers that such a host has drawn.
pub struct GBuffer {
    pub depth: wgpu::Texture,
    pub normal: wgpu::Texture,
    pub primitive: wgpu::Texture,
}

/// Corners with their normals, none shared.
pub fn corners(mesh: &Mesh) -> Vec<[f32; 6]> {
    let corners = mesh.triangles.iter().zip(&mesh.normal_indices);
    let corners = corners.flat_map(|(triangle, normals)| {
        [0, 1, 2].map(|i| {
            let place = mesh.positions[triangle[i] as usize].to_array();
            let normal = mesh.normals[normals[i] as usize].to_array();
            std::array::from_fn(|k| if k < 3 { place[k] } else { normal[k - 3] })
        })
    });
    corners.collect()
}

pub fn draw(gpu: &Gpu, mesh: &Mesh, matrix: DMat4, depth: Depth, size: [u32; 2]) -> GBuffer {
    let [width, height] = size;
    draw_part(gpu, mesh, (matrix, depth), (size, [0, 0, width, height]))
}

/// Draws into a part of textures: left and upper edge, width and height.
pub fn draw_part(
    gpu: &Gpu,
    mesh: &Mesh,
    (matrix, depth): (DMat4, Depth),
    (size, part): ([u32; 2], [u32; 4]),
) -> GBuffer {
    let device = &gpu.device;
    let texture = |format, usage| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width: size[0],
                height: size[1],
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
            view_formats: &[],
        })
    };
    let sampled = wgpu::TextureUsages::TEXTURE_BINDING;
    let drawn = GBuffer {
        depth: texture(wgpu::TextureFormat::Depth32Float, sampled),
        normal: texture(wgpu::TextureFormat::Rgba32Float, sampled),
        primitive: texture(wgpu::TextureFormat::R32Uint, wgpu::TextureUsages::COPY_SRC),
    };
    let buffer = |content: &[u8], usage| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: content,
            usage,
        })
    };
    let vertices = corners(mesh);
    let count = vertices.len() as u32;
    let vertices = buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX);
    let matrix = matrix.as_mat4().to_cols_array();
    let matrix = buffer(bytemuck::cast_slice(&matrix), wgpu::BufferUsages::UNIFORM);
    let pipeline = pipeline(device, depth);
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: matrix.as_entire_binding(),
        }],
    });
    let views = [&drawn.normal, &drawn.primitive].map(|it| it.create_view(&Default::default()));
    let depth_view = drawn.depth.create_view(&Default::default());
    let far = if depth == Depth::Reversed { 0.0 } else { 1.0 };
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &views.each_ref().map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })
        }),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth_view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(far),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    let [x, y, width, height] = part.map(|edge| edge as f32);
    pass.set_viewport(x, y, width, height, 0.0, 1.0);
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.set_vertex_buffer(0, vertices.slice(..));
    pass.draw(0..count, 0..1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    drawn
}

fn pipeline(device: &wgpu::Device, depth: Depth) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    let formats = [
        wgpu::TextureFormat::Rgba32Float,
        wgpu::TextureFormat::R32Uint,
    ];
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
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(match depth {
                Depth::Standard => wgpu::CompareFunction::Less,
                Depth::Reversed => wgpu::CompareFunction::Greater,
            }),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            targets: &formats.map(|format| Some(format.into())),
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Where the ray through a pixel's centre meets the plane of a primitive, and that plane's normal
/// on the side that is seen.
pub fn receiver(mesh: &Mesh, primitive: u32, matrix: DMat4, ndc: [f64; 2]) -> [DVec3; 2] {
    let inverse = matrix.inverse();
    let at = |depth: f64| inverse.project_point3(DVec3::new(ndc[0], ndc[1], depth));
    let (from, through) = (at(0.75), at(0.25));
    let [a, b, c] = mesh.corners(primitive);
    let normal = (b - a).cross(c - a).normalize();
    let way = through - from;
    [
        from + way * ((a - from).dot(normal) / way.dot(normal)),
        normal,
    ]
}
