// Stage to find the clusters that may shade a receiver of the layer: all but those beside the map,
// and those over few tiles whose receivers are nearer to the light. A corner of a cluster's box is
// a point in the scene's box, so that bounds on the rounding of casters' corners hold for it:
// docs/light_buffer_errors.md. One thread per cluster.

#import "shared/binned_caster.wgsl"
#import "shared/clusters.wgsl"
#import "shared/groups.wgsl"
#import "shared/steps.wgsl"

var<storage, read> cluster_boxes: array<ClusterBox>;
var<storage, read> tiles: array<vec4<u32>>;
var<storage, read_write> texels: array<BinnedTexel>;
var<storage, read_write> live_clusters: LiveClusters;
var<storage, read_write> live_groups: array<atomic<u32>, 3>;

// True for receivers that no list answers. Of them `texels` counts last those without a texel, for
// which all casters are tested with the first layer.
override for_pending: bool = false;
// Over more tiles a cluster counts as live.
const MOST_TILES: u32 = 64u;

// The cluster's casters, as the map sees them; not tighter than bin_casters.wgsl has any of them.
struct Bounds {
    // Least x and y in texels, then the greatest.
    box: vec4<f32>,
    nearest: f32,
    // True if it is nowhere in the map, or could be anywhere in it.
    beside: bool,
    anywhere: bool,
}

var<workgroup> live_here: atomic<u32>;
var<workgroup> first_slot: u32;

@compute @workgroup_size(GROUP_SIZE)
fn main(thread: Thread) {
    start_rounds(thread.lane);
    let cluster = number_of(thread);
    let last = atomicLoad(&texels[arrayLength(&texels) - 1u].length);
    // Lists that all lack a caster are read by none.
    var is_one = cluster < arrayLength(&cluster_boxes) && (last & LIST_LACKS) == 0u;
    if is_one && !(for_pending && binned_layer == 0u && last != 0u) {
        is_one = is_live(cluster_boxes[cluster]);
    }
    var slot = 0u;
    if is_one {
        count_step(GROUP_STEP);
        slot = atomicAdd(&live_here, 1u);
    }
    count_step(GROUP_STEP);
    workgroupBarrier();
    if thread.lane == 0u {
        let count = atomicLoad(&live_here);
        if count != 0u {
            count_step(GROUP_STEP);
            first_slot = atomicAdd(&live_clusters.count, count);
            let groups = groups_for(GROUP_SIZE * (first_slot + count));
            atomicMax(&live_groups[0], groups[0]);
            atomicMax(&live_groups[1], groups[1]);
            atomicMax(&live_groups[2], 1u);
        }
    }
    count_step(GROUP_STEP);
    workgroupBarrier();
    if is_one {
        live_clusters.numbers[first_slot + slot] = cluster;
    }
    store_rounds();
}

fn is_live(box: ClusterBox) -> bool {
    var bounds: Bounds;
    if light_kind == LIGHT_DIRECTIONAL {
        bounds = bounds_of(box);
    } else {
        bounds = bounds_in_face(box);
    }
    let around = cluster_reach(bounds.nearest);
    let low = floor(bounds.box.xy - around);
    let high = floor(bounds.box.zw + around);
    let end = map_fit.size - 1.0;
    if bounds.beside || (!bounds.anywhere && (any(high < vec2(0.0)) || any(low > vec2(end)))) {
        return false;
    }
    let first = vec2<u32>(clamp(low, vec2(0.0), vec2(end)));
    let last = vec2<u32>(clamp(high, vec2(0.0), vec2(end)));
    let corner = first / TILE;
    let size = last / TILE - corner + 1u;
    if bounds.anywhere || size.x * size.y > MOST_TILES {
        return true;
    }
    let count = size.x * size.y;
    for (var number = 0u; number < count; number += 4u) {
        count_step(TILE_STEP);
        // None waits for the one before it.
        var is_one = false;
        for (var i = 0u; i < 4u; i++) {
            let at = min(number + i, count - 1u);
            let tile = corner + vec2(at % size.x, at / size.x);
            let marked = tiles[tile_number(binned_layer, tile)];
            let bits = tile_bits(first, last, tile) & marked.yz;
            is_one |= any(bits != vec2(0u)) && depth_bits(bounds.nearest) <= marked.x;
        }
        if is_one {
            return true;
        }
    }
    return false;
}

fn corner_of(box: ClusterBox, number: u32) -> vec3<f32> {
    return select(box.low, box.high, (vec3(number) & vec3(1u, 2u, 4u)) != vec3(0u));
}

// Under a directional light.
fn bounds_of(box: ClusterBox) -> Bounds {
    var low = vec3(3e38);
    var high = vec3(-3e38);
    for (var number = 0u; number < 8u; number++) {
        let at = light_texel(corner_of(box, number));
        low = min(low, at);
        high = max(high, at);
    }
    // Casters and the box are rounded apart, and texels are taken larger for casters.
    let around = 3.0 * max(SLACK, edge_tolerance());
    let error = texel_error_of_summands(map_fit, light_clip_summands_of_scene());
    // The greatest `depth_tolerance`: `weights_error` of a triangle that is LOWEST high.
    let longest = high.xy - low.xy + 2.0 * around;
    let weights_error = 12.0 * HALF_ULP / LOWEST * dot(longest, longest);
    let tolerance = traced() * light.max_distance / light.extent.z
        + (edge_tolerance() + weights_error) * max_depth_slope() + 2.0 * error.y;
    return Bounds(
        vec4(low.xy - around, high.xy + around), saturate(low.z) - tolerance, false, false,
    );
}

// In a face of a spot or point light's map.
fn bounds_in_face(box: ClusterBox) -> Bounds {
    var low = vec2(3e38);
    var high = vec2(-3e38);
    var nearest = vec2(3e38);
    var ratio = 0.0;
    var sides = ALL_SIDES;
    for (var number = 0u; number < 8u; number++) {
        let seen = light_homogeneous(corner_of(box, number), binned_layer);
        let at = face_texel(seen).xy;
        low = min(low, at);
        high = max(high, at);
        nearest = min(nearest, seen.zw);
        ratio = max(ratio, max_projected_ratio(seen));
        sides &= sides_beyond(seen, light_beyond());
    }
    // Rounding may have casters nearer to the light, by half of that.
    let rounding = 4.0 * CLIP_ROUNDING * (1.0 + light_spread()) * light.range;
    let around = 6.0 * face_dilation(0.5 * nearest.y, ratio);
    let is_placed = nearest.y > rounding && around < 0.125 * map_fit.size;
    let error = texel_error_of_summands(map_fit, light_clip_summands_of_scene());
    let tolerance = traced() * light.max_distance / light.range + 2.0 * error.y;
    return Bounds(
        vec4(low - around, high + around), saturate(nearest.x) - tolerance, sides != 0u, !is_placed,
    );
}
