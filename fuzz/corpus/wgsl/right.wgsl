#import "shared/scene.wgsl"
// Ein Modul: größer → ∞
struct Params { sun: vec3<f32>, bias: f32, cull: u32, edge: u32 }
var<uniform> params: Params;
var image: texture_2d<f32>;
var number: texture_storage_2d<r32uint, write>;
var depth: texture_depth_2d;
var layers: texture_2d_array<f32>;
var nearest: sampler;
var compared: sampler_comparison;
var<storage, read_write> items: array<u32>;
var<storage, read_write> total: atomic<u32>;
override steps: u32 = 4u;
const table = array<f32, 3>(1.0, 2.0, 3.0 / 7.0);
@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    for (var i = 0u; i < steps; i++) {
        if id.x + i < arrayLength(&items) { items[id.x + i] = id.x << 3u; atomicAdd(&total, 1u); } else { break; }
    }
    textureStore(number, id.xy, vec4<u32>(u32(table[id.x % 3u]), 0u, 0u, 0u));
}
@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return camera * corner(index) + vec4<f32>(params.sun, params.bias);
}
@fragment fn no_colour() {}
@fragment fn fragment(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    let shade = textureSampleCompareLevel(depth, compared, place.xy, 0.5);
    return shade * textureSampleLevel(layers, nearest, place.xy, 1, 0.0) + vec4(params.bias);
}
