// Stage to begin a chain.
var<storage, read_write> out: array<u32>;

@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&out) {
        out[id.x] = id.x * 2654435761u;
    }
}
