// Stage to add the rays of a further share of the pixels to those before; a single thread.

var<storage, read> count: u32;
var<storage, read_write> ray_count: u32;

@compute @workgroup_size(1)
fn main() {
    ray_count += count;
}
