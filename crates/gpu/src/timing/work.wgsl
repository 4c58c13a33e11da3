// Stage to keep the device busy, one invocation per item: `rounds` steps of a linear congruential
// generator. It reads nothing that the raster pass made: a barrier between them would hide the
// fault that it is to show.
struct Params { rounds: u32 }
var<uniform> params: Params;
var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&sums) { return; }
    var state = id.x;
    for (var round = 0u; round < params.rounds; round++) {
        state = state * 1664525u + 1013904223u;
    }
    sums[id.x] = state;
}
