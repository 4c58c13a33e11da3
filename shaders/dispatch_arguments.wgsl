// Stage to turn the number of rays on the GPU into the arguments of an indirect dispatch of
// `trace_rays`; a single thread.

#import "shared/groups.wgsl"

var<storage, read> count: u32;
var<storage, read_write> groups: array<u32, 3>;

@compute @workgroup_size(1)
fn main() {
    groups = groups_for(count);
}
