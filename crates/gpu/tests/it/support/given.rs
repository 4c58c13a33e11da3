//! Textures and buffers of a host, and a graph that adds two of them.

#![allow(dead_code, reason = "each test file uses a part of it")]

use crate::{
    host::{GPU, executor, request},
    support::Files,
};
use skiagraph_gpu::{Executor, Provider, ProviderError, import};
use skiagraph_graph::{Describe, NoProvider, PlanRequest, Provided, ProvidedBinding};
use wgpu::util::DeviceExt;

/// The numbers in a buffer of the host.
pub fn content(buffer: &wgpu::Buffer, mut encoder: wgpu::CommandEncoder) -> Vec<u32> {
    let arrived = GPU.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    encoder.copy_buffer_to_buffer(buffer, 0, &arrived, 0, None);
    GPU.queue.submit([encoder.finish()]);
    arrived.map_async(wgpu::MapMode::Read, .., |result| {
        result.expect("a buffer that was just made can be mapped");
    });
    GPU.device
        .poll(wgpu::PollType::wait_indefinitely())
        .expect("the device is there");
    let bytes = arrived
        .get_mapped_range(..)
        .expect("it was mapped")
        .to_vec();
    bytemuck::pod_collect_to_vec(&bytes)
}

pub const SAMPLED: wgpu::TextureUsages = wgpu::TextureUsages::TEXTURE_BINDING;
pub const STORAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE;

pub struct Kind {
    pub format: wgpu::TextureFormat,
    pub edge: u32,
    pub mips: u32,
    pub layers: u32,
    pub usage: wgpu::TextureUsages,
}

/// Kind of the texture that [`sums`] reads.
pub const KIND: Kind = Kind {
    format: wgpu::TextureFormat::R32Uint,
    edge: 8,
    mips: 1,
    layers: 1,
    usage: SAMPLED,
};

/// A texture of the host, every texel of its first mip and layer `value`.
pub fn texture(kind: &Kind, value: u32) -> wgpu::Texture {
    let texture = GPU.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d {
            width: kind.edge,
            height: kind.edge,
            depth_or_array_layers: kind.layers,
        },
        mip_level_count: kind.mips,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: kind.format,
        usage: kind.usage | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels = vec![value; (kind.edge * kind.edge) as usize];
    GPU.queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&texels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(kind.edge * 4),
            rows_per_image: None,
        },
        wgpu::Extent3d {
            width: kind.edge,
            height: kind.edge,
            depth_or_array_layers: 1,
        },
    );
    texture
}

/// A buffer of the host.
pub fn buffer(numbers: &[u32], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    GPU.device
        .create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(numbers),
            usage: usage | wgpu::BufferUsages::COPY_SRC,
        })
}

/// Writes a number into a buffer of the host.
pub fn write(buffer: &wgpu::Buffer, number: u32) {
    GPU.queue.write_buffer(buffer, 0, &number.to_ne_bytes());
}

/// An executor of a graph whose shaders read `more`, a buffer that the host hands in with a number.
pub fn with_more(files: Files, number: u32) -> (Executor, wgpu::Buffer) {
    let inputs = "inputs: [Buffer(name: \"more\")], materials:";
    let files = files.edited("graph.ron", "materials:", inputs);
    let more = buffer(&[number], STORAGE | wgpu::BufferUsages::COPY_DST);
    let mut request = request(&NoProvider);
    let described = import::buffer(&more, None);
    request.imports.insert("more".to_owned(), described);
    let mut executor = executor(&files, &request);
    executor.import_buffer("more", &more).unwrap();
    (executor, more)
}

/// ```text
/// image, more ─▶ add ─▶ sum
/// ```
pub fn sums() -> Files {
    Files::graph(
        r#"
    inputs: [Texture(name: "image", format: R32Uint), Buffer(name: "more")],
    materials: [Texture(name: "sum", format: R32Uint)],
    passes: [Fullscreen(name: "add", color: ["sum"])],
    outputs: ["sum"],
"#,
    )
    .with(
        "add.wgsl",
        "var image: texture_2d<u32>;
         var<storage, read> more: array<u32>;
         @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 {
             return textureLoad(image, vec2<u32>(at.xy), 0).x + more[0];
         }",
    )
}

pub fn sums_request() -> PlanRequest<'static> {
    let mut request = request(&NoProvider);
    let (image, more) = (texture(&KIND, 0), buffer(&[0], STORAGE));
    request.imports.extend([
        ("image".to_owned(), import::texture(&image)),
        ("more".to_owned(), import::buffer(&more, None)),
    ]);
    request
}

/// A provider of one number, in the same buffer or in another one for each version.
pub struct Number {
    pub buffer: wgpu::Buffer,
    pub value: u32,
    pub in_place: bool,
    /// Answer of [`Provider::has_versions`].
    pub has_versions: bool,
}

impl Number {
    pub fn new(in_place: bool) -> Self {
        let number = Self {
            buffer: buffer(&[0], STORAGE | wgpu::BufferUsages::COPY_DST),
            value: 1,
            in_place,
            has_versions: false,
        };
        number.fill();
        number
    }

    pub fn fill(&self) {
        write(&self.buffer, self.value);
    }
}

impl Describe for Number {
    fn names(&self) -> Vec<String> {
        vec!["host.number".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        (name == "host.number").then_some(Provided::new(ProvidedBinding::Storage, Some(1), 4))
    }
}

impl Provider for Number {
    fn version(&self, _: &str) -> u64 {
        u64::from(self.value)
    }

    fn has_versions(&self) -> bool {
        self.has_versions
    }

    fn build(
        &mut self,
        _: &str,
        _: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        if !self.in_place {
            self.buffer = buffer(&[0], STORAGE | wgpu::BufferUsages::COPY_DST);
        }
        self.fill();
        Ok(self.buffer.clone())
    }
}
