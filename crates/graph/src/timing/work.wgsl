// Stage to keep the device busy, one invocation per item: `rounds` steps of a linear congruential generator.
struct Params { rounds: u32 }
var<uniform> params: Params;
var color: texture_2d<f32>;
var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&sums) { return; }
    var state = id.x + u32(textureLoad(color, vec2<u32>(id.x % 64u, 0u), 0).x);
    for (var round = 0u; round < params.rounds; round++) {
        state = state * 1664525u + 1013904223u;
    }
    sums[id.x] = state;
}
