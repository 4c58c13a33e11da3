// Stage to estimate how many entries the lists would have: counts those of one caster in 31, a
// large one's in some of its tiles; one thread for each.

#import "shared/numbered_casters.wgsl"
#import "shared/groups.wgsl"
#import "shared/bin_texels.wgsl"

// Not a power of two, as meshes may repeat themselves.
const ONE_IN: u32 = 31u;
const MOST_TILES: u32 = 32u;

var<storage, read_write> estimate: array<atomic<u32>, 3>;

@compute @workgroup_size(GROUP_SIZE)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let number = ((group.y * groups.x + group.x) * GROUP_SIZE + lane) * ONE_IN;
    if number >= caster_count() {
        return;
    }
    let caster = caster_of(number);
    if any(caster.last < caster.first) {
        return;
    }
    let columns = tiles_of(caster).x;
    let count = columns * tiles_of(caster).y;
    let step = (count + MOST_TILES - 1u) / MOST_TILES;
    var entries_here = 0u;
    for (var number = 0u; number < count; number += step) {
        let tile = caster.first / TILE + vec2(number % columns, number / columns);
        var inside = texels_in(caster, tile);
        while any(inside != vec2(0u)) {
            let texel = tile * TILE + first_of(inside);
            let centre = vec2<f32>(texel) + 0.5;
            let place = texel_number(binned_layer, texel);
            let max_depth = atomicLoad(&texels[place].max_receiver_depth);
            let is_one = may_shade_texel(caster, centre, max_depth);
            entries_here += select(0u, step, is_one);
            inside &= ~first_bit(inside);
        }
    }
    // The sum fits 32 bits whatever the mesh: of 10 million triangles each counts 2,200 at most.
    let casters = caster_count() / ONE_IN + 1u;
    atomicAdd(&estimate[0], min(entries_here, 0xffffffffu / (6u * casters)));
}
