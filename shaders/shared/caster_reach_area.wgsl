// As shared/caster_reach.wgsl, of a directional light with an extent. What is d nearer to the light
// than a receiver shades it from d times the light's radius beside it. All bounds are linear in the
// caster's points, so that its corners have the extremes: docs/light_buffer_area.md.

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
    // How steep the plane is: at 1 as steep as the light's outermost rays.
    steepness: f32,
}

// Bits of the depth of the farthest receiver of all.
var<uniform> max_depth_bits: u32;

// From this steepness on only the corners tell how near to the light a caster may be.
const STEEPEST_PLANE: f32 = 0.9;

fn traced() -> f32 {
    return 16.0 * HALF_ULP * (1.0 + light_area.radius);
}

// In texels, where the light's rim moves what is a depth of 1 nearer to it; for rounding, more.
fn rim_shift(rim: vec3<f32>) -> vec2<f32> {
    let clip = (light.clip_from_relative * vec4(rim, 0.0)).xy * light.extent.z * 1.0001;
    return vec2(dot(map_fit.x.xy, clip), dot(map_fit.y.xy, clip));
}

fn steepness_of(plane: DepthPlane) -> f32 {
    let right = rim_shift(light_area.right);
    let up = rim_shift(light_area.up);
    return length(vec2(dot(plane.slope, right), dot(plane.slope, up)));
}

fn has_usable_plane(plane: DepthPlane) -> bool {
    // NaN has none.
    return steepness_of(plane) < STEEPEST_PLANE;
}

fn reach_of(triangle: LightTriangle, plane: DepthPlane, tolerance: f32) -> Reach {
    let a = triangle.a;
    let b = triangle.b;
    let c = triangle.c;
    let right = rim_shift(light_area.right);
    let up = rim_shift(light_area.up);
    let spread = vec3(
        spread_of(b.xy - a.xy, right, up),
        spread_of(c.xy - b.xy, right, up),
        spread_of(a.xy - c.xy, right, up),
    );
    // The corner opposite an edge counts from where it shows beyond it.
    let opposite = vec3(c.z, a.z, b.z) + vec3(triangle.area) / max(spread, vec3(1e-30));
    let own = vec3(min(a.z, b.z), min(b.z, c.z), min(c.z, a.z));
    let box = vec2(length(vec2(right.x, up.x)), length(vec2(right.y, up.y)));
    let low = min(a.xy + a.z * box, min(b.xy + b.z * box, c.xy + c.z * box));
    let high = max(a.xy - a.z * box, max(b.xy - b.z * box, c.xy - c.z * box));
    return Reach(
        spread, min(own, opposite) - tolerance, low - tolerance * box, high + tolerance * box, box,
        steepness_of(plane),
    );
}

fn spread_of(edge: vec2<f32>, right: vec2<f32>, up: vec2<f32>) -> f32 {
    return length(vec2(cross_2d(edge, right), cross_2d(edge, up)));
}

fn shaded_box(triangle: LightTriangle, reach: Reach) -> vec4<f32> {
    return box_at(reach, bitcast<f32>(max_depth_bits));
}

fn box_at(reach: Reach, max_depth: f32) -> vec4<f32> {
    let shift = max_depth * reach.box_spread;
    return vec4(reach.low - shift, reach.high + shift);
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
    let moved = reach.spread * max(vec3(max_depth) - reach.from_depth, vec3(0.0));
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
