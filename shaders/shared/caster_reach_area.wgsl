// As shared/caster_reach.wgsl, of a light with an extent. What is d nearer to the light than a
// receiver shades it from d times the light's radius beside it, where depths are linear across the
// map: `map_depths`. All bounds are linear in the caster's points, so that its corners have the
// extremes: docs/light_buffer_area.md.

#import "shared/light_triangle.wgsl"
#import "shared/light_area.wgsl"

struct Reach {
    // How far the light moves the edges ab, bc and ca, times their lengths, that are a depth of 1
    // nearer to it than a receiver.
    spread: vec3<f32>,
    // The depth of receivers from which on the edges count as moved.
    from_depth: vec3<f32>,
    // The box around receivers of depth F: low - F * box_spread to high + F * box_spread.
    low: vec2<f32>,
    high: vec2<f32>,
    box_spread: vec2<f32>,
    // The depth of the nearest corner.
    least: f32,
    // How steep the plane is: at 1 as steep as the light's outermost rays.
    steepness: f32,
}

// Bits of the depth of the farthest receiver of all.
var<uniform> max_depth_bits: u32;

// From this steepness on only the corners tell how near to the light a caster may be.
const STEEPEST_PLANE: f32 = 0.9;
// The most that `point_spread` may be: sqrt(3) in a corner of the face, 3.42 near the lamp.
const MOST_POINT_SPREAD: f32 = 6.0;

// Returns true if a receiver of that depth's bits is one that bounds hold for.
fn is_bounded(receiver: vec3<f32>, depth_bits: u32) -> bool {
    // Two shaders may round it differently. No branch on a uniform: Mesa 22.3 crashed on one.
    return (depth_bits <= max_depth_bits) & !is_inside_light(receiver);
}

fn traced() -> f32 {
    if light_kind != LIGHT_DIRECTIONAL {
        return 48.0 * HALF_ULP;
    }
    return 16.0 * HALF_ULP * (1.0 + light_area.radius);
}

fn light_beyond() -> f32 {
    return light_area.radius * (1.0 + light_spread());
}

// Depths that are linear across the map, of casters and of receivers: rounded apart. Those of spot
// and point lights are shares of `range`, so the negative reciprocals of such.
fn map_depths(depth: vec3<f32>) -> vec3<f32> {
    if light_kind == LIGHT_DIRECTIONAL {
        return depth;
    }
    return -1.000001 / max(depth, vec3(1e-9));
}

fn map_depth_of_receiver(depth: f32) -> f32 {
    if light_kind == LIGHT_DIRECTIONAL {
        return depth;
    }
    return -0.999999 / max(depth, 1e-9);
}

struct Rim {
    right: vec2<f32>,
    up: vec2<f32>,
}

// In texels, where the light's rim moves what is a depth of 1 nearer to it; for rounding, more.
fn rim_shifts() -> Rim {
    let x = map_fit.x.xy * 1.0001;
    let y = map_fit.y.xy * 1.0001;
    if light_kind == LIGHT_POINT {
        let radius = light_area.radius / light.range;
        return Rim(radius * vec2(x.x, y.x), radius * vec2(x.y, y.y));
    }
    let scale = select(1.0 / light.range, light.extent.z, light_kind == LIGHT_DIRECTIONAL);
    let right = (light.clip_from_relative * vec4(light_area.right, 0.0)).xy * scale;
    let up = (light.clip_from_relative * vec4(light_area.up, 0.0)).xy * scale;
    return Rim(vec2(dot(x, right), dot(y, right)), vec2(dot(x, up), dot(y, up)));
}

// A point light's disk faces each receiver: for one in the direction (p, 1) of a face it is up to
// sqrt(1 + p²) times as wide across the face, and w / (w - s) times where a point of it is nearer
// by s than its centre, seen along the face's axis. For receivers of the tile around a place.
fn point_spread(point: vec2<f32>, max_depth: f32) -> f32 {
    if light_kind != LIGHT_POINT {
        return 1.0;
    }
    let away = abs(point - vec2(map_fit.x.z, map_fit.y.z)) + 0.5 * f32(TILE) + 0.5;
    let across = min(away / map_fit.scale, vec2(1.0));
    return sqrt(1.0 + dot(across, across)) * near_spread(max_depth);
}

// Least where the receiver is farthest. Nearer ones than twice the radius ask rays.
fn near_spread(max_depth: f32) -> f32 {
    // sqrt(2/3): the most of the disk's radius that is along the axis.
    let share = 0.8165 * light_area.radius / (light.range * max(max_depth, 1e-9));
    return 1.00001 / (1.0 - min(share, 0.7072));
}

fn steepness_of(plane: DepthPlane) -> f32 {
    let rim = rim_shifts();
    return length(vec2(dot(plane.slope, rim.right), dot(plane.slope, rim.up)));
}

fn has_usable_plane(plane: DepthPlane) -> bool {
    // NaN has none.
    return steepness_of(plane) < STEEPEST_PLANE;
}

fn reach_of(triangle: LightTriangle, plane: DepthPlane, tolerance: f32) -> Reach {
    let a = triangle.a.xy;
    let b = triangle.b.xy;
    let c = triangle.c.xy;
    let depths = map_depths(vec3(triangle.a.z, triangle.b.z, triangle.c.z) - tolerance);
    let rim = rim_shifts();
    let spread = vec3(spread_of(b - a, rim), spread_of(c - b, rim), spread_of(a - c, rim));
    // The corner opposite an edge counts from where it shows beyond it.
    let most = spread * select(1.0, MOST_POINT_SPREAD, light_kind == LIGHT_POINT);
    let opposite = depths.zxy + vec3(triangle.area) / max(most, vec3(1e-30));
    let own = min(depths, depths.yzx);
    let box = reach_box(rim);
    let low = min(a + depths.x * box, min(b + depths.y * box, c + depths.z * box));
    let high = max(a - depths.x * box, max(b - depths.y * box, c - depths.z * box));
    let least = min(depths.x, min(depths.y, depths.z));
    return Reach(spread, min(own, opposite), low, high, box, least, steepness_of(plane));
}

fn reach_of_whole_face() -> Reach {
    return Reach(vec3(0.0), vec3(0.0), vec2(-1e30), vec2(1e30), vec2(0.0), 0.0, 0.0);
}

fn cluster_reach(nearest: f32) -> vec2<f32> {
    let depth = map_depths(vec3(nearest)).x;
    let box = reach_box(rim_shifts());
    return 1.001 * box * max(shift_of(depth, bitcast<f32>(max_depth_bits)) - depth, 0.0);
}

// Across the light, of what is a depth of 1 nearer to it.
fn reach_box(rim: Rim) -> vec2<f32> {
    return vec2(length(vec2(rim.right.x, rim.up.x)), length(vec2(rim.right.y, rim.up.y)))
        * select(1.0, 1.7321, light_kind == LIGHT_POINT);
}

// The depth of the farthest receivers, deeper where they see more of the light.
fn shift_of(least: f32, max_depth: f32) -> f32 {
    let depth = map_depth_of_receiver(max_depth);
    if light_kind != LIGHT_POINT {
        return depth;
    }
    return depth + (near_spread(max_depth) - 1.0) * max(depth - least, 0.0);
}

fn spread_of(edge: vec2<f32>, rim: Rim) -> f32 {
    return length(vec2(cross_2d(edge, rim.right), cross_2d(edge, rim.up)));
}

fn shaded_box(triangle: LightTriangle, reach: Reach) -> vec4<f32> {
    return box_at(reach, bitcast<f32>(max_depth_bits));
}

fn box_at(reach: Reach, max_depth: f32) -> vec4<f32> {
    let shift = shift_of(reach.least, max_depth);
    return vec4(reach.low - shift * reach.box_spread, reach.high + shift * reach.box_spread);
}

fn shaded_texels(caster: Binned, max_depth: f32) -> vec4<u32> {
    let box = box_at(caster.reach, max_depth);
    let end = vec2(map_fit.size - 1.0);
    let low = floor(box.xy - caster.dilation);
    let high = floor(box.zw + caster.dilation);
    // None if its parts that are beside each other are farther from the light than the receivers.
    let is_none = any(high < low) || any(high < vec2(0.0)) || any(low > end);
    let first = vec2<u32>(clamp(low, vec2(0.0), end));
    let last = vec2<u32>(clamp(high, vec2(0.0), end));
    return select(vec4(first, last), vec4(1u, 1u, 0u, 0u), is_none);
}

fn shading_functions(caster: Binned, point: vec2<f32>, max_depth: f32) -> vec3<f32> {
    let reach = caster.reach;
    let way = max(vec3(map_depth_of_receiver(max_depth)) - reach.from_depth, vec3(0.0));
    let moved = reach.spread * way * point_spread(point, max_depth);
    return edge_functions(caster.triangle, point) + moved;
}

fn shaded_depth(texel: u32) -> f32 {
    return bitcast<f32>(atomicLoad(&texels[texel].max_receiver_depth));
}

fn cover_inset(caster: Binned, centre: vec2<f32>, max_depth: f32) -> vec3<f32> {
    let nearest = depth_bound(caster.plane, centre, 0.5, NEAREST) - caster.depth_tolerance;
    // A ray at the rim meets a plane that leans away from it later than the ray to the centre.
    let way = max(max_depth - nearest, 0.0) / (1.0 - caster.reach.steepness);
    return caster.reach.spread * way * 1.001;
}
