// Maps laid over parts of light space: over all of the scene, a slab of the eye's frustum, or a box
// of receivers. `size` is the edge of the map in texels; texels are no smaller than rounding allows
// that moves a point of the scene by `rounding` of them.

#import "shared/camera.wgsl"
#import "shared/predicates.wgsl"
#import "shared/map_fit.wgsl"

// For layers that everybody may ask.
const ANY_DISTANCE: f32 = 3e38;

// True if texels stay where they are in light space while the eye moves.
override stable: bool = false;
// Lengths that change with what is seen go in steps then, as powers of two: texels keep their size
// for a while, and are at most a fifth larger than need be.
const STABLE_STEP: f32 = 0.25;

fn affine_fit(x: vec3<f32>, y: vec3<f32>, size: f32) -> MapFit {
    let scale = abs(vec2(x.x, y.x)) + abs(vec2(x.y, y.y));
    let reach = scale + abs(vec2(x.z, y.z));
    return MapFit(
        vec4(x, 0.0),
        vec4(y, 0.0),
        size,
        max(scale.x, scale.y),
        max(reach.x, reach.y),
        ANY_DISTANCE,
        vec4(0.0, 0.0, 1.0, 0.0),
    );
}

fn fit_over_scene(size: f32, rounding: f32) -> MapFit {
    let scale = min(0.5 * size, greatest_scale(0.0, rounding));
    return affine_fit(vec3(scale, 0.0, scale), vec3(0.0, -scale, scale), size);
}

// The least rectangle around a box of receivers, as receiver_box.wgsl has it.
fn fit_over_box(bits: vec4<u32>, size: f32, rounding: f32) -> MapFit {
    let box = bitcast<vec4<f32>>(bits);
    let high = box.xy;
    let low = 1.0 - box.zw;
    if any(high < low) {
        return fit_over_scene(size, rounding);
    }
    var share = max(high - low, vec2(1e-6));
    if stable {
        share = exp2(STABLE_STEP * ceil(log2(share) / STABLE_STEP));
    }
    return fit_over_shares(low, share, size, rounding);
}

// From `low` on, in shares of the scene's edges. Its texels are some of a grid over the scene:
// where their size stays, texels do.
fn fit_over_shares(
    low: vec2<f32>,
    share: vec2<f32>,
    size: f32,
    rounding: f32,
) -> MapFit {
    // A map of a few texels has no room to spare.
    if size < 8.0 {
        return fit_over_scene(size, rounding);
    }
    // Edges of the map if it went over the scene. Room for a box that begins within a texel, and
    // for rounding.
    let room = size - 4.0;
    let edges = floor(min(room / share, vec2(2.0 * greatest_scale(0.0, rounding))));
    let first = max(floor(low * edges) - 1.0, vec2(0.0));
    let half = 0.5 * edges;
    let x = vec3(half.x, 0.0, half.x - first.x);
    return affine_fit(x, vec3(0.0, -half.y, half.y - first.y), size);
}

// How far from the eye the maps reach; `wanted` is 0 for the far plane.
fn fit_end(wanted: f32) -> f32 {
    return max(select(camera.far, wanted, wanted > 0.0), camera.near);
}

// One of the eight corners of the eye's frustum between two distances: bits 0 and 1 say right and
// up, bit 2 the farther end.
fn frustum_corner(corner: u32, begin: f32, end: f32) -> vec3<f32> {
    let distance = select(end, begin, (corner & 4u) == 0u);
    let corner_clip = select(
        vec2(-1.0),
        vec2(1.0),
        vec2((corner & 1u) != 0u, (corner & 2u) != 0u),
    );
    let side = (corner_clip + camera.jitter_clip) * vec2(camera.half_width, camera.half_height);
    let way = camera.forward + side.x * camera.right + side.y * camera.up;
    return camera.eye + distance * way;
}

// Over the ball around a slab of the eye's frustum, so of one size whichever way the eye looks; cut
// to the scene. Valient, "Stable Rendering of Cascaded Shadow Maps", ShaderX6, 2008.
fn fit_over_ball(begin: f32, end: f32, size: f32, rounding: f32) -> MapFit {
    // The ball touches both ends' corners, or those of the far end alone if that is wide. `spread`:
    // how far a corner is from the axis at distance 1.
    let spread = length(vec2(camera.half_width, camera.half_height));
    let along = min(0.5 * (begin + end) * (1.0 + spread * spread), end);
    let radius = length(vec2(end - along, spread * end));
    let clip = light_clip(camera.eye + along * camera.forward).xy;
    // The scene's edges are two extents long.
    let share = min(radius / light.extent.xy, vec2(1.0));
    let middle = vec2(clip.x, -clip.y) * 0.5 + 0.5;
    let low = clamp(middle - 0.5 * share, vec2(0.0), 1.0 - share);
    return fit_over_shares(low, share, size, rounding);
}

// World units along the sides of rectangles per unit of clip x and y.
struct Axes {
    u: vec2<f32>,
    v: vec2<f32>,
}

// Axes of upright rectangles, as seen from the light.
fn upright() -> Axes {
    // Clip x and y to world units along the rectangle's sides.
    let matrix = transpose(light.clip_from_relative);
    let forward = -light.to_light;
    let helper = select(vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0), abs(forward.y) > 0.999);
    let right = normalize(cross(forward, helper));
    let up = cross(right, forward);
    let clip_right = matrix[0].xyz * light.extent.x;
    let clip_up = matrix[1].xyz * light.extent.y;
    let u = vec2(dot(right, clip_right), dot(right, clip_up)) * light.extent.xy;
    let v = vec2(dot(up, clip_right), dot(up, clip_up)) * light.extent.xy;
    return Axes(u, v);
}

// Axes along the sides of light space.
fn along_scene() -> Axes {
    return Axes(vec2(light.extent.x, 0.0), vec2(0.0, light.extent.y));
}

// True if boxes of receivers may lie along the way that the eye looks, where they are narrower.
override turned: bool = false;

fn along_view() -> Axes {
    let way = (light.clip_from_relative * vec4(camera.forward, 0.0)).xy * light.extent.xy;
    let size = length(way);
    // Any axes where the eye looks along the light.
    let along = select(vec2(1.0, 0.0), way / size, size > 1e-3);
    return Axes(along * light.extent.xy, vec2(-along.y, along.x) * light.extent.xy);
}

// Where a place lies between the sides of a square around the scene along these axes.
fn share_along(axes: Axes, clip: vec2<f32>) -> vec2<f32> {
    let place = vec2(dot(axes.u, clip), dot(axes.v, clip));
    return place / length(light.extent.xy) * 0.5 + 0.5;
}

// A rectangle in those units.
struct Rectangle {
    low: vec2<f32>,
    high: vec2<f32>,
}

// Around the eye's frustum between two distances.
fn around_frustum(axes: Axes, begin: f32, end: f32) -> Rectangle {
    var low = vec2(3e38);
    var high = vec2(-3e38);
    for (var corner = 0u; corner < 8u; corner++) {
        let clip = light_clip(frustum_corner(corner, begin, end)).xy;
        let place = vec2(dot(axes.u, clip), dot(axes.v, clip));
        low = min(low, place);
        high = max(high, place);
    }
    return Rectangle(low, high);
}

fn fit_over_rectangle(axes: Axes, over: Rectangle, size: f32, rounding: f32) -> MapFit {
    let across = size / max(over.high - over.low, vec2(1e-30));
    let rows = mat2x2(axes.u * across.x, -axes.v * across.y);
    let scale = max(abs(rows[0].x) + abs(rows[0].y), abs(rows[1].x) + abs(rows[1].y));
    // Around its middle, where rounding wants it larger.
    let shrunk = min(1.0, greatest_scale(size, rounding) / scale);
    let middle = 0.5 * (over.low + over.high) * across;
    return affine_fit(
        vec3(rows[0] * shrunk, 0.5 * size - middle.x * shrunk),
        vec3(rows[1] * shrunk, 0.5 * size + middle.y * shrunk),
        size,
    );
}

// The greatest MapFit.scale for which `texel_error_bound_of` is at most `rounding`, anywhere in the
// scene. For a map within the scene |x.z| is no more than the scale; `beyond` is the number of
// texels more.
fn greatest_scale(beyond: f32, rounding: f32) -> f32 {
    // Half the scene's box away from its centre; the bound of no receiver is greater.
    let matrix = transpose(light.clip_from_relative);
    let centre = abs(light.centre.xyz);
    let summed = max(dot(abs(matrix[0].xyz), centre), dot(abs(matrix[1].xyz), centre));
    let room = rounding / CLIP_ROUNDING - beyond;
    // The proof for edges holds in maps of up to 8,192 texels across the scene.
    let most = select(4096.0, 524288.0, rounding > SLACK);
    return clamp(room / (2.0 * (summed + light.centre.w) + 2.0), 0.5, most);
}
