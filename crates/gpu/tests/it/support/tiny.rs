//! Frames of small graphs with the scene of [`Triangle`], on a device of all that the adapter has.

#![allow(dead_code, reason = "each test file uses a part of it")]

use crate::support::{Files, Triangle, load, right};
use skiagraph_gpu::{
    Content, ExecuteError, Executor, Frame, FrameReport, Provider, ProviderError, device,
};
use skiagraph_graph::{Capture, Describe, PlanRequest};
use std::sync::LazyLock;

pub static GPU: LazyLock<device::Gpu> =
    LazyLock::new(|| device::open(None).unwrap_or_else(|error| panic!("{error}")));

/// The viewport.
pub const SIZE: [u32; 2] = [13, 7];

/// Writes x + 100·y.
pub const NUMBER: &str = "
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return floor(position.x) + 100.0 * floor(position.y);
}";

/// One pass that draws [`NUMBER`] to `image`.
pub fn image() -> Files {
    Files::graph(
        r#"
    materials: [Texture(name: "image", format: R32Float)],
    passes: [Fullscreen(name: "number", color: ["image"])],
    outputs: ["image"],
"#,
    )
    .with("number.wgsl", NUMBER)
}

/// A vertex stage whose three vertices cover everything, at that depth.
pub fn covering(depth: f32) -> String {
    format!(
        "@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {{
             let corner = vec2<f32>(vec2(index & 1u, index >> 1u));
             return vec4<f32>(corner * 4.0 - 1.0, {depth:?}, 1.0);
         }}"
    )
}

impl Provider for Triangle {
    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        let positions: [[f32; 4]; 3] = [
            [-1.0, -1.0, 0.25, 1.0],
            [3.0, -1.0, 0.25, 1.0],
            [-1.0, 3.0, 0.25, 1.0],
        ];
        let bytes = match name {
            "scene.positions" => bytemuck::cast_slice(&positions).to_vec(),
            "scene.indices" => bytemuck::cast_slice(&[0u32, 1, 2]).to_vec(),
            "scene.stream" => vec![0; 64],
            "camera" => vec![0; 64],
            "light" => vec![0; 256],
            "lights" => (0..3u32)
                .flat_map(|light| (10 + light).to_ne_bytes().repeat(64))
                .collect(),
            _ => return Err(ProviderError::new(format!("there is no `{name}`"))),
        };
        let described = self.describe(name).expect("what is built is described");
        let copied = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(name),
            size: bytes.len() as u64,
            usage: described.binding.usages() | copied,
            mapped_at_creation: false,
        });
        queue.write_buffer(&buffer, 0, &bytes);
        Ok(buffer)
    }
}

pub fn request(provider: &dyn Describe) -> PlanRequest<'_> {
    let mut request = PlanRequest::new(SIZE, provider);
    request.limits = GPU.device.limits();
    request.features = GPU.device.features();
    request
}

/// An executor of `graph.ron` of the files, with captures: a material, after a pass or at the end.
pub fn executor(
    files: &Files,
    captures: &[(&str, Option<&str>)],
) -> Result<Executor, ExecuteError> {
    let mut request = request(&Triangle);
    let capture = |(material, after): &(&str, Option<&str>)| {
        let capture = Capture::new(*material);
        match after {
            Some(pass) => capture.with_after(*pass),
            None => capture,
        }
    };
    request.captures = captures.iter().map(capture).collect();
    let plan = right(right(load(files)).plan(&request));
    Executor::new(&GPU.device, &GPU.queue, plan, &mut Triangle)
}

/// An executor that there is.
pub fn made(files: &Files) -> Executor {
    executor(files, &[]).unwrap_or_else(|error| panic!("{error}"))
}

pub fn encoder() -> wgpu::CommandEncoder {
    GPU.device.create_command_encoder(&Default::default())
}

/// A frame that is submitted and waited for.
pub fn frame(executor: &mut Executor, timing: bool, read: &[&str]) -> FrameReport {
    let mut encoder = encoder();
    let frame = Frame::new().with_timing(timing).with_read(read);
    executor
        .encode(&mut encoder, &frame)
        .unwrap_or_else(|error| panic!("{error}"));
    GPU.queue.submit([encoder.finish()]);
    executor.finish().unwrap_or_else(|error| panic!("{error}"))
}

/// Runs two frames and hands out the contents, which must be the same.
pub fn run(files: &Files, read: &[&str]) -> Vec<Content> {
    run_with(files, &[], read)
}

/// [`run`] with captures.
pub fn run_with(files: &Files, captures: &[(&str, Option<&str>)], read: &[&str]) -> Vec<Content> {
    let mut executor = executor(files, captures).unwrap_or_else(|error| panic!("{error}"));
    let first = frame(&mut executor, false, read);
    let second = frame(&mut executor, true, read);
    assert_eq!(
        first.readbacks, second.readbacks,
        "two frames of one graph differ"
    );
    let names: Vec<&str> = second
        .readbacks
        .iter()
        .map(|readback| readback.name.as_str())
        .collect();
    assert_eq!(names, read);
    let readbacks = second.readbacks.into_iter();
    readbacks.map(|readback| readback.content).collect()
}

pub fn f32s(content: &Content) -> Vec<f32> {
    content.as_f32().expect("it holds floats")
}

pub fn u32s(content: &Content) -> Vec<u32> {
    content.as_u32().expect("it holds unsigned integers")
}

/// A value for each pixel, rows from the top.
pub fn pixels<T>([width, height]: [u32; 2], value: impl Fn(u32, u32) -> T) -> Vec<T> {
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| value(x, y))
        .collect()
}
