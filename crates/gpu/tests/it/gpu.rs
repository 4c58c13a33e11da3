//! Tiny graphs on the device: every value that comes back is known exactly.

use crate::support::Files;
use crate::tiny::{GPU, NUMBER, SIZE, covering, executor, f32s, pixels, run, run_with, u32s};

/// Additive blending on floats shows a pixel that is drawn twice; where the adapter cannot blend
/// them, plain writing.
#[test]
fn a_full_screen_pass_writes_every_pixel_once() {
    let blendable = wgpu::TextureFormat::R32Float
        .guaranteed_format_features(GPU.device.features())
        .flags;
    let blend = if blendable.contains(wgpu::TextureFormatFeatureFlags::BLENDABLE) {
        ", blend: Additive"
    } else {
        ""
    };
    let files = Files::graph(&format!(
        r#"
    materials: [Texture(name: "image", format: R32Float)],
    passes: [
        Clear(name: "reset", target: "image"),
        Fullscreen(name: "number", color: [(target: "image", load: Load{blend})]),
    ],
    outputs: ["image"],
"#
    ))
    .with("number.wgsl", NUMBER);
    let expected = pixels(SIZE, |x, y| x as f32 + 100.0 * y as f32);
    assert_eq!(f32s(&run(&files, &["image"])[0]), expected);
}

/// Vertices are pulled from the provider's buffers; one triangle covers everything at depth 0.25.
#[test]
fn a_triangle_of_the_provider_with_depth() {
    let files = Files::graph(
        r#"
    materials: [
        Texture(name: "image", format: R32Uint),
        Texture(name: "depth", format: Depth32Float),
    ],
    passes: [
        Raster(
            name: "draw",
            fragment: "fragment",
            draw: "scene.indices.count",
            color: [(target: "image", load: Clear(9))],
            depth: (target: "depth", load: Clear(1), compare: Less),
        ),
        Raster(
            name: "behind",
            shader: "draw",
            fragment: "other",
            draw: "scene.indices.count",
            color: [(target: "image", load: Load)],
            depth: (target: "depth", load: Load, compare: Less, write: false),
        ),
    ],
    outputs: ["image", "depth"],
"#,
    )
    .with(
        "draw.wgsl",
        "var<storage, read> scene_positions: array<vec4<f32>>;
         var<storage, read> scene_indices: array<u32>;
         @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
             return scene_positions[scene_indices[index]];
         }
         @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 { return 7u; }
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
    let files = Files::graph(
        r#"
    materials: [
        Texture(name: "depth", format: Depth32Float),
        Texture(name: "image", format: R32Float),
    ],
    passes: [
        Raster(name: "occlude", draw: 3, depth: "depth"),
        Raster(
            name: "shade",
            draw: 3,
            color: [(target: "image", load: Clear(5))],
            depth: (target: "depth", load: Load, compare: LessEqual, write: false),
        ),
    ],
    outputs: ["image", "depth"],
"#,
    )
    .with("occlude.wgsl", covering(0.5))
    .with(
        "shade.wgsl",
        covering(0.25)
            + "
var depth: texture_depth_2d;
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

/// If a shader has two fragment stages, a pass without colour targets runs the one without colours;
/// it discards and sets depths.
#[test]
fn a_depth_only_pass_runs_the_fragment_stage_without_colours() {
    let files = Files::graph(
        r#"
    materials: [Texture(name: "depth", format: Depth32Float)],
    passes: [Raster(name: "halves", draw: 3, depth: "depth")],
    outputs: ["depth"],
"#,
    )
    .with(
        "halves.wgsl",
        covering(0.5)
            + "
@fragment fn coloured() -> @location(0) f32 { return 1.0; }
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @builtin(frag_depth) f32 {
    if position.x > 3.0 { discard; }
    return position.y / 64.0;
}",
    );
    let expected = pixels(
        SIZE,
        |x, y| if x < 3 { (y as f32 + 0.5) / 64.0 } else { 1.0 },
    );
    assert_eq!(f32s(&run(&files, &["depth"])[0]), expected);
}

/// Several targets at once, of formats whose rows are padded in different ways when they are read
/// back.
#[test]
fn several_targets_of_several_formats() {
    let formats = [
        ("byte", "R8Uint"),
        ("word", "R32Uint"),
        ("half", "R16Float"),
        ("fraction", "R8Unorm"),
        ("rgba", "Rgba8Unorm"),
        ("short", "R16Uint"),
        ("pair", "Rg32Float"),
    ];
    let materials: String = formats
        .iter()
        .map(|(name, format)| format!("Texture(name: \"{name}\", format: {format}), "))
        .collect();
    let names = formats.map(|(name, _)| name);
    let files = Files::graph(&format!(
        "materials: [{materials}], passes: [Fullscreen(name: \"all\", color: {names:?})], \
         outputs: {names:?}"
    ))
    .with(
        "all.wgsl",
        "struct Outputs {
             @location(0) byte: u32, @location(1) word: u32, @location(2) half: f32,
             @location(3) fraction: f32, @location(4) rgba: vec4<f32>, @location(5) short: u32,
             @location(6) pair: vec2<f32>,
         }
         @fragment fn fragment(@builtin(position) position: vec4<f32>) -> Outputs {
             let x = u32(position.x);
             let y = u32(position.y);
             let at = vec2<f32>(f32(x), f32(y));
             return Outputs(x + 16u * y, 0xfffffff0u + x, at.x * 0.5 - 2.0, at.x / 255.0,
                 vec4<f32>(at, 255.0, 0.0) / 255.0, 60000u + x, at);
         }",
    );
    let contents = run(&files, &names);
    let [byte, word, half, fraction, rgba, short, pair] = contents.as_slice() else {
        panic!("{} contents", contents.len());
    };
    assert_eq!(u32s(byte), pixels(SIZE, |x, y| x + 16 * y));
    assert_eq!(u32s(word), pixels(SIZE, |x, _| 0xffff_fff0 + x));
    assert_eq!(f32s(half), pixels(SIZE, |x, _| x as f32 * 0.5 - 2.0));
    assert_eq!(f32s(fraction), pixels(SIZE, |x, _| x as f32 / 255.0));
    let bytes = pixels(SIZE, |x, y| [x as u8, y as u8, 255, 0]).concat();
    assert_eq!(rgba.bytes(), bytes);
    assert_eq!(u32s(short), pixels(SIZE, |x, _| 60_000 + x));
    let floats = pixels(SIZE, |x, y| [x as f32, y as f32]).concat();
    assert_eq!(f32s(pair), floats);
    assert_eq!(rgba.as_u32(), None);
    assert_eq!(byte.as_f32(), None);
}

/// 13×7 texels in workgroups of 8×4: the ones that hang over must not be lost, nor written twice.
#[test]
fn compute_over_a_texture_that_is_no_multiple_of_the_workgroup() {
    let files = Files::graph(
        r#"
    materials: [Texture(name: "image", format: R32Uint), Buffer(name: "runs")],
    passes: [
        Clear(name: "reset", target: "runs"),
        Compute(name: "number", dispatch: Over("image.size")),
    ],
    outputs: ["image", "runs"],
"#,
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
    let files = Files::graph(&format!(
        r#"
    materials: [Buffer(name: "items", count: {items})],
    passes: [
        Clear(name: "reset", target: "items"),
        Compute(name: "number", dispatch: Over("items.count")),
    ],
    outputs: ["items"],
"#
    ))
    .with(
        "number.wgsl",
        "var<storage, read_write> items: array<atomic<u32>>;
         @compute @workgroup_size(1) fn main(
             @builtin(workgroup_id) group: vec3<u32>,
             @builtin(num_workgroups) groups: vec3<u32>,
         ) {
             let item = group.y * groups.x + group.x;
             if item < arrayLength(&items) { atomicAdd(&items[item], item + 1u); }
         }",
    );
    let expected: Vec<u32> = (1..=items).collect();
    assert_eq!(u32s(&run(&files, &["items"])[0]), expected);
}

/// Workgroups that the document counts are dispatched once in a frame, not twice.
#[test]
fn counted_workgroups_run_once_a_frame() {
    let files = Files::graph(
        r#"
    materials: [Buffer(name: "runs")],
    passes: [
        Clear(name: "reset", target: "runs"),
        Compute(name: "count", dispatch: Groups(2, 3, 4)),
    ],
    outputs: ["runs"],
"#,
    )
    .with(
        "count.wgsl",
        "var<storage, read_write> runs: atomic<u32>;
         @compute @workgroup_size(5) fn main() { atomicAdd(&runs, 1u); }",
    );
    assert_eq!(u32s(&run(&files, &["runs"])[0]), [2 * 3 * 4 * 5]);
}

/// Sizes of a dispatch and of a draw that an earlier pass wrote.
#[test]
fn indirect_dispatch_and_draw() {
    let files = Files::graph(
        r#"
    materials: [
        Buffer(name: "groups"),
        Buffer(name: "vertices"),
        Buffer(name: "items", count: 8),
        Texture(name: "image", format: R32Uint),
    ],
    passes: [
        Compute(name: "decide", dispatch: Groups(1, 1, 1)),
        Clear(name: "reset", target: "items"),
        Compute(name: "work", dispatch: Indirect("groups")),
        Raster(name: "draw", draw: Indirect("vertices"), color: ["image"]),
    ],
    outputs: ["items", "image"],
"#,
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
         @compute @workgroup_size(1) fn main(@builtin(workgroup_id) group: vec3<u32>) {
             items[group.x] = 10u + group.x;
         }",
    )
    .with(
        "draw.wgsl",
        covering(0.5) + "@fragment fn fragment() -> @location(0) u32 { return 3u; }",
    );
    let contents = run(&files, &["items", "image"]);
    assert_eq!(u32s(&contents[0]), [10, 11, 12, 13, 14, 0, 0, 0]);
    assert_eq!(u32s(&contents[1]), pixels(SIZE, |_, _| 3));
}

#[test]
fn clears_and_copies() {
    let textures = [
        ("word", "R32Uint", "4294967295"),
        ("number", "R32Float", "-0.5"),
        ("depth", "Depth32Float", "0.75"),
        ("byte", "R8Uint", "255"),
        ("four", "Rgba32Float", "(1, 2, 3, 4)"),
    ];
    let (mut materials, mut passes) = (String::new(), String::new());
    for (name, format, value) in textures {
        materials += &format!(
            "Texture(name: \"{name}\", format: {format}), \
             Texture(name: \"{name}_copy\", format: {format}), "
        );
        passes += &format!(
            "Clear(name: \"clear_{name}\", target: \"{name}\", value: {value}), \
             Copy(name: \"copy_{name}\", from: \"{name}\", to: \"{name}_copy\"), "
        );
    }
    let copies = textures.map(|(name, ..)| format!("{name}_copy"));
    let mut read: Vec<&str> = copies.iter().map(String::as_str).collect();
    read.extend(["kept", "items"]);
    let files = Files::graph(&format!(
        r#"
    materials: [{materials} Buffer(name: "items", count: 5), Buffer(name: "kept", count: 5)],
    passes: [
        {passes}
        Compute(name: "number", dispatch: Over("items.count")),
        Copy(name: "keep", from: "items", to: "kept"),
        Clear(name: "wipe", target: "items"),
    ],
    outputs: {read:?},
"#
    ))
    .with(
        "number.wgsl",
        "var<storage, read_write> items: array<u32>;
         @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
             if id.x < arrayLength(&items) { items[id.x] = id.x + 1u; }
         }",
    );
    let contents = run(&files, &read);
    assert_eq!(u32s(&contents[0]), pixels(SIZE, |_, _| u32::MAX));
    assert_eq!(f32s(&contents[1]), pixels(SIZE, |_, _| -0.5));
    assert_eq!(f32s(&contents[2]), pixels(SIZE, |_, _| 0.75));
    assert_eq!(u32s(&contents[3]), pixels(SIZE, |_, _| 255));
    let four = pixels(SIZE, |_, _| [1.0, 2.0, 3.0, 4.0]).concat();
    assert_eq!(f32s(&contents[4]), four);
    assert_eq!(u32s(&contents[5]), [1, 2, 3, 4, 5]);
    assert_eq!(u32s(&contents[6]), [0; 5]);
}

/// Mip 0 is drawn, mip 1 made of it, layer by layer. Sampled as an array, read back in parts.
#[test]
fn mips_and_layers_by_reference() {
    let files = Files::graph(
        r#"
    materials: [
        Texture(name: "pyramid", format: R32Float, size: 4, mips: 2, layers: 2),
        Texture(name: "sum", format: R32Float, size: 2),
    ],
    passes: [
        Fullscreen(name: "number", color: ["pyramid[0].mip[0]"]),
        Clear(name: "flat", target: "pyramid[1].mip[0]", value: 4),
        Fullscreen(
            name: "reduce",
            repeat: 2,
            bind: {"fine": "pyramid[index].mip[0]"},
            color: ["pyramid[index].mip[1]"],
        ),
        Fullscreen(name: "add", color: ["sum"]),
    ],
    outputs: [
        "sum",
        (name: "coarse", material: "pyramid[0].mip[1]"),
        (name: "flat", material: "pyramid[1].mip[1]"),
    ],
"#,
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
    let files = Files::graph(
        r#"
    materials: [
        Texture(name: "source", format: R8Unorm, size: (2, 1)),
        Texture(name: "depth", format: Depth32Float, size: 1),
        Texture(name: "image", format: Rgba32Float, size: 1),
        Sampler(name: "near"),
        Sampler(name: "linear", filter: Linear),
        Sampler(name: "around", address: Repeat),
        Sampler(name: "shadow", filter: Linear, compare: LessEqual),
    ],
    passes: [
        Fullscreen(name: "step", color: ["source"]),
        Clear(name: "reset", target: "depth", value: 0.5),
        Fullscreen(name: "sample", color: ["image"]),
    ],
    outputs: ["image"],
"#,
    )
    .with(
        "step.wgsl",
        "@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
             return floor(position.x);
         }",
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
             return vec4<f32>(
                 textureSample(source, near, vec2<f32>(0.9, 0.5)).x,
                 textureSample(source, linear, at).x,
                 textureSample(source, around, vec2<f32>(1.25, 0.5)).x,
                 textureSampleCompare(depth, shadow, at, 0.25),
             );
         }",
    );
    let sampled = f32s(&run(&files, &["image"])[0]);
    assert_eq!([sampled[0], sampled[2], sampled[3]], [1.0, 0.0, 1.0]);
    let half = sampled[1];
    assert!(
        (half - 0.5).abs() <= 1.0 / 255.0,
        "half way between 0 and 1 lies {half}"
    );
}

/// A material as it stood after each of the passes that change it.
#[test]
fn captures() {
    let files = Files::graph(
        r#"
    materials: [Buffer(name: "total"), Buffer(name: "unused")],
    passes: [
        Clear(name: "wipe", target: "unused"),
        Clear(name: "reset", target: "total"),
        Compute(name: "add1", shader: "add", dispatch: Groups(1, 1, 1)),
        Compute(name: "add2", shader: "add", dispatch: Groups(1, 1, 1)),
        Compute(
            name: "aside",
            shader: "add",
            bind: {"total": "unused"},
            dispatch: Groups(1, 1, 1),
        ),
    ],
    outputs: ["total"],
"#,
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
    let contents = run_with(&files, &captures, &read);
    let values: Vec<u32> = contents.iter().map(|content| u32s(content)[0]).collect();
    assert_eq!(values, [0, 1, 2, 1]);
    let culled = executor(&files, &[]).unwrap_or_else(|error| panic!("{error}"));
    let culled = culled.plan().culled().iter();
    let names: Vec<&str> = culled.map(|pass| pass.name.as_str()).collect();
    let why = "without the capture nobody needs it";
    assert_eq!(names, ["wipe", "aside"], "{why}");
}
