// Stage to make a buffer of a chain from the one before.
var<storage, read> input: array<u32>;
var<storage, read_write> out: array<u32>;

@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&out) {
        out[id.x] = 3u * input[id.x % arrayLength(&input)] + id.x;
    }
}
