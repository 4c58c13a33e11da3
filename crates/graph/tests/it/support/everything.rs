//! A graph with some of everything, right as it stands.

use crate::support::Files;

pub const DOCUMENT: &str = r#"(
    format: 3,
    description: "größer → ∞",
    params: [
        U32(name: "edge", default: 16, min: 1, max: 64, description: "texels"),
        F32(name: "bias", default: -0.5),
        Choice(name: "cull", words: [none, front, back], default: front),
        Vec3(name: "sun", default: (0, 1, 0)),
        Bool(name: "twice", default: "edge > 8 && !has(SUBGROUP)"),
    ],
    materials: [
        Texture(name: "depth", format: Depth32Float, size: "edge"),
        Texture(name: "image", format: R32Float, mips: 2, layers: 1),
        Texture(name: "small", format: R32Float, size: "max(viewport.size / 2, 1)"),
        Texture(name: "same", format: "small.format", size: "small.size"),
        Texture(name: "noise", format: R8Unorm, file: "noise.png"),
        Buffer(name: "items", count: "2 * small.count"),
        Buffer(name: "kept", count: "items.count", keep: true),
        Buffer(name: "total"),
        Buffer(name: "kernel", data: [0.25, 0.5, 0.25]),
        Sampler(name: "nearest", filter: Nearest, address: Repeat),
    ],
    passes: [
        Raster(
            name: "occlude",
            draw: "scene.indices.count",
            depth: (target: "depth", load: Clear(1.0), compare: Less, bias: (constant: 1)),
            cull: "cull",
            run: OnChange,
        ),
        Clear(name: "reset", target: "total"),
        Compute(name: "number", dispatch: Over("items.count")),
        Copy(name: "keep", from: "items", to: "kept"),
        Compute(
            name: "again",
            shader: "number",
            bind: {"items": "kept"},
            dispatch: Groups(1, 2, 3),
        ),
        Fullscreen(name: "shade", color: [(target: "image.mip[0]", load: Clear(0, 0, 0, 0))]),
        Fullscreen(name: "reduce", bind: {"fine": "image.mip[0]"}, color: ["small"]),
        Copy(name: "copy", from: "small", to: "same"),
        Group(
            name: "ring",
            repeat: "twice ? 2 : 1",
            passes: [
                Include(graph: "blur.ron", bind: {"image": "same"}, set: {"radius": "index + 1"}),
            ],
        ),
    ],
    outputs: [
        (name: "result", material: "same"),
        (name: "top", material: "image.mip[0]"),
        "kept",
        (name: "total", if: "edge > 0"),
    ],
)
"#;

const BLUR: &str = r#"(
    format: 3,
    params: [U32(name: "radius")],
    inputs: [Texture(name: "image")],
    materials: [Texture(name: "across", format: "image.format", size: "image.size")],
    passes: [
        Fullscreen(
            name: "x",
            shader: "blur",
            bind: {"fine": "image", "old": "across.previous"},
            color: ["across"],
        ),
        Fullscreen(
            name: "y",
            shader: "blur",
            bind: {"fine": "across", "old": "image.previous"},
            color: [(target: "image", load: Load)],
            area: (0, 0, 1, 1),
        ),
    ],
    outputs: ["image"],
)
"#;

const OCCLUDE: &str = "#import \"shared/scene.wgsl\"
override bias: f32 = 0.0;
@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return scene_positions[scene_indices[index]] + vec4<f32>(0.0, 0.0, bias, 0.0);
}
";

const SCENE: &str = "// Ein Modul: größer → ∞
var<storage, read> scene_positions: array<vec4<f32>>;
var<storage, read> scene_indices: array<u32>;
";

const NUMBER: &str = "var<storage, read_write> items: array<u32>;
var<storage, read_write> total: atomic<u32>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&items) { items[id.x] = id.x; atomicAdd(&total, 1u); }
}
";

const SHADE: &str = "struct Params { sun: vec3<f32>, bias: f32, cull: u32, edge: u32 }
var<uniform> params: Params;
var depth: texture_2d<f32>;
var noise: texture_2d<f32>;
var nearest: sampler;
var<storage, read> kernel: array<f32>;
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    let sampled = textureSampleLevel(depth, nearest, position.xy, 0.0).x * kernel[1];
    let loaded = textureLoad(noise, vec2(0u), 0).x * f32(params.cull + CULL_BACK);
    return sampled + loaded + params.sun.y + params.bias + f32(params.edge);
}
";

const REDUCE: &str = "var fine: texture_2d<f32>;
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureLoad(fine, 2u * vec2<u32>(position.xy), 0).x;
}
";

const BLURRED: &str = "struct Params { radius: u32 }
var<uniform> params: Params;
var fine: texture_2d<f32>;
var old: texture_2d<f32>;
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    let at = vec2<u32>(position.xy);
    return textureLoad(fine, at + params.radius, 0).x + textureLoad(old, at, 0).x;
}
";

/// All of its files.
pub fn files() -> Files {
    Files::new([
        ("graph.ron", DOCUMENT),
        ("blur.ron", BLUR),
        ("occlude.wgsl", OCCLUDE),
        ("shared/scene.wgsl", SCENE),
        ("number.wgsl", NUMBER),
        ("shade.wgsl", SHADE),
        ("reduce.wgsl", REDUCE),
        ("blur.wgsl", BLURRED),
    ])
    .picture("noise.png", 2, &[0, 64, 128, 255])
}
