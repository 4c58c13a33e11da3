// Stage to start a thread for each pixel with a long list; a single thread.

#import "shared/groups.wgsl"

// How many there are, then which.
var<storage, read> long_pixels: array<u32>;
var<storage, read_write> long_groups: array<u32, 3>;

@compute @workgroup_size(1)
fn main() {
    long_groups = groups_for(long_pixels[0]);
}
