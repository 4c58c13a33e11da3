//! Tiny graphs on the device: every value that comes back is known exactly.

#[path = "support/host.rs"]
mod host;
#[path = "../../graph/tests/support/mod.rs"]
mod support;

use skiagraph_graph::{
    Capture, Content, ExecuteError, Executor, Frame, FrameReport, PlanRequest, Provider, gpu,
    timing::{Trust, check},
};
use std::{
    sync::LazyLock,
    time::{Duration, Instant},
};
use support::{Files, Triangle, load};

static GPU: LazyLock<device::Gpu> =
    LazyLock::new(|| device::open(None).unwrap_or_else(|error| panic!("{error}")));

const SIZE: [u32; 2] = [13, 7];

fn request(provider: &dyn Provider) -> PlanRequest<'_> {
    let mut request = PlanRequest::new(SIZE, provider);
    request.limits = GPU.device.limits();
    request.features = GPU.device.features();
    request
}

fn executor(files: &Files, captures: &[(&str, Option<&str>)]) -> Result<Executor, ExecuteError> {
    let graph = load(files).unwrap_or_else(|errors| panic!("{errors}"));
    let mut request = request(&Triangle);
    let capture = |(material, after): &(&str, Option<&str>)| Capture {
        material: (*material).to_owned(),
        after: after.map(str::to_owned),
    };
    request.captures = captures.iter().map(capture).collect();
    let plan = graph
        .plan(&request)
        .unwrap_or_else(|errors| panic!("{errors}"));
    Executor::new(&GPU.device, &GPU.queue, plan, &mut Triangle)
}

fn frame(executor: &mut Executor, timing: bool, read: &[&str]) -> FrameReport {
    let mut encoder = GPU
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    executor
        .encode(
            &mut encoder,
            &Frame {
                timing,
                read,
                ..Frame::default()
            },
        )
        .unwrap_or_else(|error| panic!("{error}"));
    GPU.queue.submit([encoder.finish()]);
    executor
        .submitted()
        .unwrap_or_else(|error| panic!("{error}"));
    executor.finish().unwrap_or_else(|error| panic!("{error}"))
}

/// Runs two frames and hands out the contents, which must be the same.
fn run(files: &Files, read: &[&str]) -> Vec<Content> {
    run_with(files, &[], read)
}

fn run_with(files: &Files, captures: &[(&str, Option<&str>)], read: &[&str]) -> Vec<Content> {
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
    second
        .readbacks
        .into_iter()
        .map(|readback| readback.content)
        .collect()
}

fn document(materials: &str, passes: &str, outputs: &str) -> String {
    format!("(format: 2, materials: [{materials}], passes: [{passes}], outputs: [{outputs}])")
}

fn files(materials: &str, passes: &str, outputs: &str) -> Files {
    Files::new([]).with("graph.ron", document(materials, passes, outputs))
}

fn f32s(content: &Content) -> Vec<f32> {
    content.as_f32().expect("it holds floats")
}

fn u32s(content: &Content) -> Vec<u32> {
    content.as_u32().expect("it holds unsigned integers")
}

/// A value for each pixel, rows from the top.
fn pixels<T>([width, height]: [u32; 2], value: impl Fn(u32, u32) -> T) -> Vec<T> {
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| value(x, y))
        .collect()
}

const NUMBER: &str =
    "@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return floor(position.x) + 100.0 * floor(position.y);
}";

#[test]
fn a_full_screen_pass_writes_every_pixel_once() {
    let files = files(
        "Texture(name: \"image\", format: R32Float)",
        "Fullscreen(name: \"number\", color: [(target: \"image\", blend: Additive)])",
        "\"image\"",
    )
    .with("number.wgsl", NUMBER);
    // Additive blending on floats shows a pixel that is drawn twice; where the adapter cannot blend
    // them, plain writing.
    let blendable = wgpu::TextureFormat::R32Float
        .guaranteed_format_features(GPU.device.features())
        .flags;
    let files = match blendable.contains(wgpu::TextureFormatFeatureFlags::BLENDABLE) {
        true => files,
        false => Files(
            files
                .0
                .into_iter()
                .map(|(path, text)| (path, text.replace(", blend: Additive", "")))
                .collect(),
        ),
    };
    let expected = pixels(SIZE, |x, y| x as f32 + 100.0 * y as f32);
    assert_eq!(f32s(&run(&files, &["image"])[0]), expected);
}

/// Vertices are pulled from the provider's buffers; one triangle covers everything at depth 0.25.
#[test]
fn a_triangle_of_the_provider_with_depth() {
    let files = files(
        "Texture(name: \"image\", format: R32Uint), Texture(name: \"depth\", \
         format: Depth32Float)",
        "Raster(name: \"draw\", fragment: \"fragment\", draw: \"scene.indices.count\", color: \
         [(target: \"image\", load: Clear(9, 0, 0, 0))],
            depth: (target: \"depth\", load: Clear(1.0), compare: Less)),
         Raster(name: \"behind\", shader: \"draw\", fragment: \"other\", draw: \
             \"scene.indices.count\", color: [(target: \"image\", load: Load)],
            depth: (target: \"depth\", load: Load, compare: Less, write: false))",
        "\"image\", \"depth\"",
    )
    .with(
        "draw.wgsl",
        "var<storage, read> scene_positions: array<vec4<f32>>;
         var<storage, read> scene_indices: array<u32>;
         @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
             return scene_positions[scene_indices[index]];
         }
         @fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) u32 { return 7u; }
         @fragment fn other() -> @location(0) u32 { return 8u; }",
    );
    let contents = run(&files, &["image", "depth"]);
    assert_eq!(
        u32s(&contents[0]),
        pixels(SIZE, |_, _| 7),
        "the second draw is as deep, so it is not nearer"
    );
    assert_eq!(f32s(&contents[1]), pixels(SIZE, |_, _| 0.25));
}

/// A pass with neither colour target nor fragment stage; another samples its depth while it is
/// tested against, read only.
#[test]
fn depth_only_and_depth_read_while_tested() {
    let files = files(
        "Texture(name: \"depth\", format: Depth32Float), Texture(name: \"image\", \
         format: R32Float)",
        "Raster(name: \"occlude\", draw: Vertices(3), depth: \"depth\"),
         Raster(name: \"shade\", draw: Vertices(3), color: [(target: \"image\", load: Clear(5, 0, \
             0, 0))],
            depth: (target: \"depth\", load: Load, compare: LessEqual, write: false))",
        "\"image\", \"depth\"",
    )
    .with(
        "occlude.wgsl",
        "@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
             return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
         }",
    )
    .with(
        "shade.wgsl",
        "var depth: texture_depth_2d;
         @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
             return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.25, 1.0);
         }
         @fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
             return textureLoad(depth, vec2<u32>(position.xy), 0) * 2.0;
         }",
    );
    let contents = run(&files, &["image", "depth"]);
    assert_eq!(f32s(&contents[0]), pixels(SIZE, |_, _| 1.0));
    assert_eq!(
        f32s(&contents[1]),
        pixels(SIZE, |_, _| 0.5),
        "the second pass writes no depth"
    );
}

/// Of a shader with two fragment stages, a pass without colour targets runs the one without
/// colours; it discards and sets depths.
#[test]
fn a_depth_only_pass_runs_the_fragment_stage_without_colours() {
    let files = files(
        "Texture(name: \"depth\", format: Depth32Float)",
        "Raster(name: \"halves\", draw: Vertices(3), depth: \"depth\")",
        "\"depth\"",
    )
    .with(
        "halves.wgsl",
        "@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
             return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
         }
         @fragment fn coloured() -> @location(0) f32 { return 1.0; }
         @fragment fn fragment(@builtin(position) position: vec4<f32>) -> @builtin(frag_depth) f32 {
             if position.x > 3.0 { discard; }
             return position.y / 64.0;
         }",
    );
    let expected = pixels(
        SIZE,
        |x, y| {
            if x < 3 { (y as f32 + 0.5) / 64.0 } else { 1.0 }
        },
    );
    assert_eq!(f32s(&run(&files, &["depth"])[0]), expected);
}

/// Several targets at once, of formats whose rows are padded in different ways when they are read
/// back.
#[test]
fn several_targets_of_several_formats() {
    let formats = [
        "R8Uint",
        "R32Uint",
        "R16Float",
        "R8Unorm",
        "Rgba8Unorm",
        "R16Uint",
        "Rg32Float",
    ];
    let materials: Vec<String> = formats
        .map(|format| format!("Texture(name: \"t{format}\", format: {format})"))
        .to_vec();
    let targets: Vec<String> = formats
        .map(|format| format!("(target: \"t{format}\")"))
        .to_vec();
    let outputs: Vec<String> = formats
        .map(|format| format!("(name: \"t{format}\")"))
        .to_vec();
    let pass = format!("Fullscreen(name: \"all\", color: [{}])", targets.join(", "));
    let files = files(&materials.join(", "), &pass, &outputs.join(", ")).with(
        "all.wgsl",
        "struct Outputs {
             @location(0) byte: u32, @location(1) word: u32, @location(2) half: f32, @location(3) fraction: f32,
             @location(4) rgba: vec4<f32>, @location(5) short: u32, @location(6) pair: vec2<f32>,
         }
         @fragment fn fragment(@builtin(position) position: vec4<f32>) -> Outputs {
             let x = u32(position.x);
             let y = u32(position.y);
             return Outputs(x + 16u * y, 0xfffffff0u + x, f32(x) * 0.5 - 2.0, f32(x) / 255.0,
                 vec4<f32>(f32(x), f32(y), 255.0, 0.0) / 255.0, 60000u + x, vec2<f32>(f32(x), f32(y)));
         }",
    );
    let names: Vec<String> = formats.map(|format| format!("t{format}")).to_vec();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let contents = run(&files, &names);
    assert_eq!(u32s(&contents[0]), pixels(SIZE, |x, y| x + 16 * y));
    assert_eq!(u32s(&contents[1]), pixels(SIZE, |x, _| 0xffff_fff0 + x));
    assert_eq!(
        f32s(&contents[2]),
        pixels(SIZE, |x, _| x as f32 * 0.5 - 2.0)
    );
    assert_eq!(f32s(&contents[3]), pixels(SIZE, |x, _| x as f32 / 255.0));
    assert_eq!(
        contents[4].bytes(),
        pixels(SIZE, |x, y| [x as u8, y as u8, 255, 0]).concat()
    );
    assert_eq!(u32s(&contents[5]), pixels(SIZE, |x, _| 60_000 + x));
    assert_eq!(
        f32s(&contents[6]),
        pixels(SIZE, |x, y| [x as f32, y as f32]).concat()
    );
    assert_eq!(contents[4].as_u32(), None);
    assert_eq!(contents[0].as_f32(), None);
}

/// 13×7 texels in workgroups of 8×4: the ones that hang over must not be lost, nor written twice.
#[test]
fn compute_over_a_texture_that_is_no_multiple_of_the_workgroup() {
    let files = files(
        "Texture(name: \"image\", format: R32Uint), Buffer\"runs\"",
        "Clear(name: \"reset\", target: \"runs\"), Compute(name: \"number\", dispatch: \
         Over(\"image\"))",
        "\"image\", \"runs\"",
    )
    .with(
        "number.wgsl",
        "var image: texture_storage_2d<r32uint, write>;
         var<storage, read_write> runs: atomic<u32>;
         @compute @workgroup_size(8, 4) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
             if any(id.xy >= textureDimensions(image)) { return; }
             atomicAdd(&runs, 1u);
             textureStore(image, id.xy, vec4<u32>(id.x + 100u * id.y));
         }",
    );
    let contents = run(&files, &["image", "runs"]);
    assert_eq!(u32s(&contents[0]), pixels(SIZE, |x, y| x + 100 * y));
    assert_eq!(u32s(&contents[1]), [SIZE[0] * SIZE[1]]);
}

/// More workgroups than one dimension holds: they are folded to two, and the item number is found
/// as the document says.
#[test]
fn compute_over_more_items_than_one_dimension_has_workgroups() {
    let items = 70_000u32;
    let files = files(
        &format!("Buffer(name: \"items\", count: {items})"),
        "Clear(name: \"reset\", target: \"items\"), Compute(name: \"number\", dispatch: \
         Over(\"items\"))",
        "\"items\"",
    )
    .with(
        "number.wgsl",
        "var<storage, read_write> items: array<atomic<u32>>;
         @compute @workgroup_size(1) fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
             let item = group.y * groups.x + group.x;
             if item < arrayLength(&items) { atomicAdd(&items[item], item + 1u); }
         }",
    );
    assert_eq!(
        u32s(&run(&files, &["items"])[0]),
        (1..=items).collect::<Vec<_>>()
    );
}

/// Sizes of a dispatch and of a draw that an earlier pass wrote.
#[test]
fn indirect_dispatch_and_draw() {
    let files = files(
        "Buffer\"groups\", Buffer\"vertices\", Buffer(name: \"items\", count: 8),
         Texture(name: \"image\", format: R32Uint)",
        "Compute(name: \"decide\", dispatch: Groups(1, 1, 1)), Clear(name: \"reset\", target: \
         \"items\"),
         Compute(name: \"work\", dispatch: Indirect(\"groups\")),
         Raster(name: \"draw\", draw: Indirect(\"vertices\"), color: [\"image\"])",
        "\"items\", \"image\"",
    )
    .with(
        "decide.wgsl",
        "var<storage, read_write> groups: array<u32, 3>;
         var<storage, read_write> vertices: array<u32, 4>;
         @compute @workgroup_size(1) fn main() {
             groups = array<u32, 3>(5u, 1u, 1u);
             vertices = array<u32, 4>(3u, 1u, 0u, 0u);
         }",
    )
    .with(
        "work.wgsl",
        "var<storage, read_write> items: array<u32>;
         @compute @workgroup_size(1) fn main(@builtin(workgroup_id) group: vec3<u32>) { items[group.x] = 10u + group.x; }",
    )
    .with(
        "draw.wgsl",
        "@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
             return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
         }
         @fragment fn fragment() -> @location(0) u32 { return 3u; }",
    );
    let contents = run(&files, &["items", "image"]);
    assert_eq!(u32s(&contents[0]), [10, 11, 12, 13, 14, 0, 0, 0]);
    assert_eq!(u32s(&contents[1]), pixels(SIZE, |_, _| 3));
}

#[test]
fn clears_and_copies() {
    let textures = [
        "R32Uint",
        "R32Float",
        "Depth32Float",
        "R8Uint",
        "Rgba32Float",
    ];
    let texture = |format: &&str| {
        format!(
            "Texture(name: \"a{format}\", format: {format}), Texture(name: \
             \"b{format}\", format: {format})"
        )
    };
    let mut materials: Vec<String> = textures.iter().map(texture).collect();
    materials
        .push("Buffer(name: \"items\", count: 5), Buffer(name: \"kept\", count: 5)".to_owned());
    let passes = "Clear(name: \"c0\", target: \"aR32Uint\", value: (4294967295, 0, 0, 0)),
        Clear(name: \"c1\", target: \"aR32Float\", value: (-0.5, 0, 0, 0)),
        Clear(name: \"c2\", target: \"aDepth32Float\", value: (0.75, 0, 0, 0)),
        Clear(name: \"c3\", target: \"aR8Uint\", value: (255, 0, 0, 0)),
        Clear(name: \"c4\", target: \"aRgba32Float\", value: (1, 2, 3, 4)),
        Compute(name: \"number\", dispatch: Over(\"items\")),
        Copy(name: \"keep\", from: \"items\", to: \"kept\"),
        Clear(name: \"wipe\", target: \"items\")"
        .to_owned();
    let copies: Vec<String> = textures
        .iter()
        .map(|format| {
            format!("Copy(name: \"copy{format}\", from: \"a{format}\", to: \"b{format}\")")
        })
        .collect();
    let outputs: Vec<String> = textures
        .iter()
        .map(|format| format!("(name: \"b{format}\")"))
        .collect();
    let files = files(
        &materials.join(", "),
        &format!("{passes}, {}", copies.join(", ")),
        &format!("{}, \"kept\", \"items\"", outputs.join(", ")),
    )
    .with(
        "number.wgsl",
        "var<storage, read_write> items: array<u32>;
         @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
             if id.x < arrayLength(&items) { items[id.x] = id.x + 1u; }
         }",
    );
    let contents = run(
        &files,
        &[
            "bR32Uint",
            "bR32Float",
            "bDepth32Float",
            "bR8Uint",
            "bRgba32Float",
            "kept",
            "items",
        ],
    );
    assert_eq!(u32s(&contents[0]), pixels(SIZE, |_, _| u32::MAX));
    assert_eq!(f32s(&contents[1]), pixels(SIZE, |_, _| -0.5));
    assert_eq!(f32s(&contents[2]), pixels(SIZE, |_, _| 0.75));
    assert_eq!(u32s(&contents[3]), pixels(SIZE, |_, _| 255));
    assert_eq!(
        f32s(&contents[4]),
        pixels(SIZE, |_, _| [1.0, 2.0, 3.0, 4.0]).concat()
    );
    assert_eq!(u32s(&contents[5]), [1, 2, 3, 4, 5]);
    assert_eq!(u32s(&contents[6]), [0; 5]);
}

/// Mip 0 is drawn, mip 1 made of it, layer by layer; views name the parts. Sampled as an array,
/// read back by view.
#[test]
fn mips_and_layers_through_views() {
    let files = files(
        "Texture(name: \"pyramid\", format: R32Float, size: 4, mips: 2, layers: 2, views: [
             (name: \"l0m0\", mip: 0, mips: 1, layer: 0, layers: 1), (name: \"l0m1\", mip: 1, \
                 mips: 1, layer: 0, layers: 1),
             (name: \"l1m0\", mip: 0, mips: 1, layer: 1, layers: 1), (name: \"l1m1\", mip: 1, \
                 mips: 1, layer: 1, layers: 1)]),
         Texture(name: \"sum\", format: R32Float, size: 2)",
        "Fullscreen(name: \"number\", color: [\"l0m0\"]),
         Clear(name: \"flat\", target: \"l1m0\", value: (4, 0, 0, 0)),
         Fullscreen(name: \"reduce0\", shader: \"reduce\", bind: {\"fine\": \"l0m0\"}, color: \
             [\"l0m1\"]),
         Fullscreen(name: \"reduce1\", shader: \"reduce\", bind: {\"fine\": \"l1m0\"}, color: \
             [\"l1m1\"]),
         Fullscreen(name: \"add\", color: [\"sum\"])",
        "\"sum\", (name: \"coarse\", material: \"l0m1\"), (name: \"flat\", material: \
         \"l1m1\")",
    )
    .with("number.wgsl", NUMBER)
    .with(
        "reduce.wgsl",
        "var fine: texture_2d<f32>;
         @fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
             return textureLoad(fine, 2u * vec2<u32>(position.xy), 0).x;
         }",
    )
    .with(
        "add.wgsl",
        "var pyramid: texture_2d_array<f32>;
         @fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
             let at = vec2<u32>(position.xy);
             return textureLoad(pyramid, at, 0, 1).x + textureLoad(pyramid, at, 1, 1).x;
         }",
    );
    let contents = run(&files, &["sum", "coarse", "flat"]);
    let coarse = [0.0, 2.0, 200.0, 202.0];
    assert_eq!(f32s(&contents[1]), coarse);
    assert_eq!(f32s(&contents[2]), [4.0; 4]);
    assert_eq!(f32s(&contents[0]), coarse.map(|value| value + 4.0));
}

#[test]
fn samplers() {
    let files = files(
        "Texture(name: \"source\", format: R8Unorm, size: (2, 1)), Texture(name: \"depth\", \
         format: Depth32Float, size: 1),
         Texture(name: \"image\", format: Rgba32Float, size: 1),
         Sampler\"near\", Sampler(name: \"linear\", filter: Linear), Sampler(name: \
             \"around\", address: Repeat),
         Sampler(name: \"shadow\", filter: Linear, compare: LessEqual)",
        "Fullscreen(name: \"step\", color: [\"source\"]), Clear(name: \"reset\", \
         target: \"depth\", value: (0.5, 0, 0, 0)),
         Fullscreen(name: \"sample\", color: [\"image\"])",
        "\"image\"",
    )
    .with(
        "step.wgsl",
        "@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 { \
         return floor(position.x); }",
    )
    .with(
        "sample.wgsl",
        "var source: texture_2d<f32>;
         var depth: texture_depth_2d;
         var near: sampler;
         var linear: sampler;
         var around: sampler;
         var shadow: sampler_comparison;
         @fragment fn fragment() -> @location(0) vec4<f32> {
             let at = vec2<f32>(0.5, 0.5);
             return vec4<f32>(textureSample(source, near, vec2<f32>(0.9, 0.5)).x, textureSample(source, linear, at).x,
                 textureSample(source, around, vec2<f32>(1.25, 0.5)).x, textureSampleCompare(depth, shadow, at, 0.25));
         }",
    );
    let sampled = f32s(&run(&files, &["image"])[0]);
    assert_eq!([sampled[0], sampled[2], sampled[3]], [1.0, 0.0, 1.0]);
    assert!(
        (sampled[1] - 0.5).abs() <= 1.0 / 255.0,
        "half way between 0 and 1 lies {}",
        sampled[1]
    );
}

/// A material as it stood after each of the passes that change it.
#[test]
fn captures() {
    let files = files(
        "Buffer\"total\", Buffer\"unused\"",
        "Clear(name: \"wipe\", target: \"unused\"),
         Clear(name: \"reset\", target: \"total\"), Compute(name: \"add1\", shader: \"add\", \
             dispatch: Groups(1, 1, 1)),
         Compute(name: \"add2\", shader: \"add\", dispatch: Groups(1, 1, 1)),
         Compute(name: \"aside\", shader: \"add\", bind: {\"total\": \"unused\"}, dispatch: \
             Groups(1, 1, 1))",
        "\"total\"",
    )
    .with(
        "add.wgsl",
        "var<storage, read_write> total: u32;
         @compute @workgroup_size(1) fn main() { total = total + 1u; }",
    );
    let captures = [
        ("total", Some("reset")),
        ("total", Some("add1")),
        ("total", Some("add1")),
        ("unused", None),
        ("total", None),
    ];
    let read = ["total@reset", "total@add1", "total", "unused"];
    let values: Vec<u32> = run_with(&files, &captures, &read)
        .iter()
        .map(|content| u32s(content)[0])
        .collect();
    assert_eq!(values, [0, 1, 2, 1]);
    let culled = executor(&files, &[]).unwrap_or_else(|error| panic!("{error}"));
    let names: Vec<&str> = culled
        .plan()
        .culled()
        .iter()
        .map(|pass| pass.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["wipe", "aside"],
        "without the capture nobody needs it"
    );
}

#[test]
fn every_pass_is_timed_or_the_reason_is_known() {
    let files = files(
        "Texture(name: \"image\", format: R32Float), Texture(name: \"copy\", \
         format: R32Float)",
        "Fullscreen(name: \"number\", color: [\"image\"]), Copy(name: \"keep\", from: \
         \"image\", to: \"copy\")",
        "\"copy\"",
    )
    .with("number.wgsl", NUMBER);
    let mut executor = executor(&files, &[]).unwrap_or_else(|error| panic!("{error}"));
    for timing in [false, true, false, true, true] {
        let report = frame(&mut executor, timing, &[]);
        assert_eq!(report.timing.is_some(), timing);
        let Some(times) = report.timing else { continue };
        let names: Vec<&str> = times.passes.iter().map(|pass| pass.name.as_str()).collect();
        assert_eq!(names, ["number", "keep"]);
        // A copy is timed between passes, which not every adapter can.
        let features = GPU.device.features();
        let times_copies = features.contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS);
        let mut timed = times.passes.iter();
        let untimed = timed.any(|pass| pass.gpu.is_none() && (times_copies || pass.name != "keep"));
        if untimed {
            match check(&GPU.device, &GPU.queue).unwrap_or_else(|error| panic!("{error}")) {
                Trust::Untrusted { reason } => assert!(!reason.is_empty()),
                Trust::Trusted => panic!("timestamps are trusted, but a pass has none"),
            }
        } else {
            let longest = times.passes.iter().filter_map(|pass| pass.gpu).max();
            assert!(
                times.gpu() >= longest,
                "the frame is as long as its longest pass"
            );
            let begins = times.passes.iter().filter_map(|pass| pass.begin);
            assert_eq!(begins.min(), Some(Duration::ZERO));
            let ends = times
                .passes
                .iter()
                .map(|pass| Some(pass.begin? + pass.gpu?));
            assert_eq!(
                ends.max(),
                Some(times.gpu()),
                "the frame ends with its last pass"
            );
        }
    }
}

/// A host may submit several frames before it asks, and one that drops an encoder, which it should
/// not, still gets what it asked for.
#[test]
fn frames_that_are_not_finished_one_by_one() {
    let files = files(
        "Texture(name: \"image\", format: R32Float)",
        "Fullscreen(name: \"number\", color: [\"image\"])",
        "\"image\"",
    )
    .with("number.wgsl", NUMBER);
    let mut executor = executor(&files, &[]).unwrap_or_else(|error| panic!("{error}"));
    let mut start = Instant::now();
    for timing in [true, false, true] {
        start = Instant::now();
        let mut dropped = GPU
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        executor
            .encode(
                &mut dropped,
                &Frame {
                    timing,
                    read: &["image"],
                    ..Frame::default()
                },
            )
            .unwrap_or_else(|error| panic!("{error}"));
        drop(dropped);
        let mut encoder = GPU
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        executor
            .encode(
                &mut encoder,
                &Frame {
                    timing,
                    read: &["image"],
                    ..Frame::default()
                },
            )
            .unwrap_or_else(|error| panic!("{error}"));
        GPU.queue.submit([encoder.finish()]);
        // Once is enough, twice is harmless.
        for _ in 0..2 {
            executor
                .submitted()
                .unwrap_or_else(|error| panic!("{error}"));
        }
    }
    let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(report.readbacks.len(), 1);
    let times = report.timing.expect("the last frame is timed");
    if GPU
        .device
        .features()
        .contains(wgpu::Features::TIMESTAMP_QUERY)
    {
        // Its own times, not from the begin of a dropped frame that never ran.
        let gpu = times.gpu().expect("a pass that draws has times");
        assert!(gpu < 2 * start.elapsed(), "{gpu:?}");
    }
    // Nothing is under way now.
    assert!(
        executor
            .finish()
            .unwrap_or_else(|error| panic!("{error}"))
            .readbacks
            .is_empty()
    );
}

#[test]
fn an_output_that_the_plan_does_not_have() {
    let files = files(
        "Texture(name: \"image\", format: R32Float)",
        "Fullscreen(name: \"number\", color: [\"image\"])",
        "\"image\"",
    )
    .with("number.wgsl", NUMBER);
    let mut executor = executor(&files, &[]).unwrap_or_else(|error| panic!("{error}"));
    let mut encoder = GPU
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let error = executor
        .encode(
            &mut encoder,
            &Frame {
                timing: false,
                read: &["imgae"],
                ..Frame::default()
            },
        )
        .expect_err("there is none");
    assert_eq!(
        error.to_string(),
        "the plan has no output `imgae`; it has image"
    );
}

/// Right as WGSL, but this device was not opened with what it needs: an error that names the pass,
/// and no panic.
#[test]
fn a_shader_that_the_device_refuses() {
    let files = files(
        "Buffer\"total\"",
        "Compute(name: \"precise\", dispatch: Groups(1, 1, 1))",
        "\"total\"",
    )
    .with(
        "precise.wgsl",
        "var<storage, read_write> total: f32;
         @compute @workgroup_size(1) fn main() { var sum: f64 = 1.0lf; sum = sum * 0.1lf; total = f32(sum); }",
    );
    match executor(&files, &[]).expect_err("f64 was not asked for") {
        ExecuteError::Gpu {
            pass,
            place,
            message,
        } => {
            assert_eq!(pass, "precise");
            assert!(place.starts_with("graph.ron:1:"), "{place}");
            assert!(!message.is_empty());
        }
        other => panic!("{other}"),
    }
}

/// What a provider hands out is checked when it is bound; what it refuses is told in its words.
#[test]
fn a_provider_that_fails() {
    struct Broken;
    impl Provider for Broken {
        fn names(&self) -> Vec<String> {
            vec!["items".to_owned()]
        }
        fn describe(&self, name: &str) -> Option<skiagraph_graph::Provided> {
            (name == "items").then_some(skiagraph_graph::Provided {
                items: Some(4),
                stride: 4,
                uniform: false,
            })
        }
        fn build(
            &mut self,
            _: &str,
            device: &wgpu::Device,
            _: &wgpu::Queue,
        ) -> Result<wgpu::Buffer, skiagraph_graph::ProviderError> {
            // A buffer without the usage that binding needs.
            Ok(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("items"),
                size: 16,
                usage: wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }))
        }
    }
    let files = files(
        "Buffer\"total\"",
        "Compute(name: \"sum\", dispatch: Groups(1, 1, 1))",
        "\"total\"",
    )
    .with(
        "sum.wgsl",
        "var<storage, read> items: array<u32>;
         var<storage, read_write> total: u32;
         @compute @workgroup_size(1) fn main() { total = items[0]; }",
    );
    let graph = load(&files).unwrap_or_else(|errors| panic!("{errors}"));
    let plan = graph
        .plan(&request(&Broken))
        .unwrap_or_else(|errors| panic!("{errors}"));
    match Executor::new(&GPU.device, &GPU.queue, plan, &mut Broken).expect_err("it cannot be bound")
    {
        ExecuteError::Gpu { pass, .. } => assert_eq!(pass, "sum"),
        other => panic!("{other}"),
    }
    let plan = graph
        .plan(&request(&Broken))
        .unwrap_or_else(|errors| panic!("{errors}"));
    let error = Executor::new(
        &GPU.device,
        &GPU.queue,
        plan,
        &mut skiagraph_graph::NoProvider,
    )
    .expect_err("nothing is provided");
    assert!(
        matches!(&error, ExecuteError::Provider { name, .. } if name == "items"),
        "{error}"
    );
}

/// Terabytes: an error that names the texture, with the planner's table of what takes the most.
#[test]
fn more_memory_than_there_is() {
    let limits = GPU.device.limits();
    let (edge, layers) = (
        limits.max_texture_dimension_2d,
        limits.max_texture_array_layers,
    );
    let files = files(
        &format!(
            "Texture(name: \"image\", format: Rgba32Float, size: Square({edge}), layers: {layers})"
        ),
        "Clear(name: \"reset\", target: \"image\")",
        "\"image\"",
    );
    match executor(&files, &[]).expect_err("no device has as much") {
        ExecuteError::OutOfMemory { name, table } => {
            assert_eq!(name, "image");
            let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
            let gib = (u64::from(edge).pow(2) * u64::from(layers) * 16) >> 30;
            let rows = [
                format!("image {edge}×{edge}, {layers} layers Rgba32Float {gib}.00 GiB"),
                format!("all together {gib}.00 GiB"),
            ];
            assert_eq!(table.lines().map(words).collect::<Vec<_>>(), rows);
        }
        other => panic!("{other}"),
    }
}
