// Stage to find the farthest receiver of all; one thread per tile.

var<storage, read> tiles: array<vec4<u32>>;
var<storage, read_write> max_depth_bits: atomic<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    if thread.x < arrayLength(&tiles) {
        atomicMax(&max_depth_bits, tiles[thread.x].x);
    }
}
