// Stage to have the passes run that answer uncertain receivers, if there are any; a single thread.

#import "shared/groups.wgsl"
#import "shared/pending.wgsl"

struct Params {
    casters: u32,
}

var<uniform> params: Params;
// The first item is 1 if a receiver is uncertain.
var<storage, read> is_any_uncertain: array<u32>;
var<storage, read> texels: array<vec4<u32>>;
var<storage, read> tiles: array<vec4<u32>>;
var status: texture_2d<u32>;
var<storage, read_write> calls: array<Call>;

@compute @workgroup_size(1)
fn main() {
    let size = textureDimensions(status);
    call(CALL_TEXELS, groups_for(arrayLength(&texels)));
    call(CALL_PIXELS, array((size.x + 7u) / 8u, (size.y + 7u) / 8u, 1u));
    call(CALL_TILES, groups_for(arrayLength(&tiles) + 1u));
    call(CALL_RECEIVERS, groups_for(size.x * size.y));
    call(CALL_CLUSTERS, groups_for(clusters_of(params.casters)));
    call(CALL_RAYS, array((size.x + 31u) / 32u, (size.y + 31u) / 32u, 1u));
}

fn call(number: u32, groups: array<u32, 3>) {
    calls[number].x = groups[0];
    calls[number].y = groups[1];
    calls[number].z = select(0u, groups[2], is_any_uncertain[0] != 0u);
}
