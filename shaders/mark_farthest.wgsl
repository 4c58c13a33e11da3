// Stage to find the farthest receiver of all, and how many texels hold one; one thread per tile.

var<storage, read> tiles: array<vec4<u32>>;
var<storage, read_write> max_depth_bits: atomic<u32>;
var<storage, read_write> estimate: array<atomic<u32>, 3>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    if thread.x < arrayLength(&tiles) {
        let tile = tiles[thread.x];
        if tile.x != 0u {
            atomicMax(&max_depth_bits, tile.x);
            atomicAdd(&estimate[1], countOneBits(tile.y) + countOneBits(tile.z));
        }
    }
}
