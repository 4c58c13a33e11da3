// A triangle before the disk of a directional light, as a receiver sees it: which points of the
// disk it hides, as far as that is clear of rounding. Bounds: docs/light_buffer_area.md.

#import "shared/geometry.wgsl"
#import "shared/light_area.wgsl"
#import "shared/predicates.wgsl"

struct Cone {
    // Sides of the edges ab, bc and ca: at + right * x + up * y is positive where the point (x, y)
    // of the unit disk is inside.
    at: vec3<f32>,
    right: vec3<f32>,
    up: vec3<f32>,
    // Below this size only the tracer's own test tells a sign.
    error: f32,
    // True if a point inside of all edges is hidden and one outside of any is not.
    is_clear: bool,
    // True if it hides no point of the disk.
    is_beside: bool,
}

// Axes across the light's direction in which its disk is measured.
struct LightAxes {
    x: vec3<f32>,
    y: vec3<f32>,
}

fn light_axes() -> LightAxes {
    // Not to be divided by 0; of a light without extent nothing is clear.
    let scale = 1.0 / max(light_area.radius, 1e-30);
    return LightAxes(light_area.right * scale, light_area.up * scale);
}

// Place across the light and distance towards it.
fn seen_along_light(way: vec3<f32>, axes: LightAxes) -> vec3<f32> {
    return vec3(dot(way, axes.x), dot(way, axes.y), dot(way, light.to_light));
}

fn cone_of(receiver: vec3<f32>, primitive: u32, t_min: f32) -> Cone {
    let axes = light_axes();
    let radius = light_area.radius;
    let a = seen_along_light(corner_position(3u * primitive) - receiver, axes);
    let b = seen_along_light(corner_position(3u * primitive + 1u) - receiver, axes);
    let c = seen_along_light(corner_position(3u * primitive + 2u) - receiver, axes);
    // The farthest corner, and the farthest from any ray to the light.
    let size = sqrt(max(dot(a, a), max(dot(b, b), dot(c, c))));
    let across = sqrt(max(dot(a.xy, a.xy), max(dot(b.xy, b.xy), dot(c.xy, c.xy))));
    let beside = across + radius * size;
    let error = 128.0 * HALF_ULP * (1.0 + radius) * size * beside;

    let at = vec3(
        cross_2d(a.xy, b.xy - a.xy),
        cross_2d(b.xy, c.xy - b.xy),
        cross_2d(c.xy, a.xy - c.xy),
    );
    let right = radius * vec3(b.z * a.y - a.z * b.y, c.z * b.y - b.z * c.y, a.z * c.y - c.z * a.y);
    let up = radius * vec3(a.z * b.x - b.z * a.x, b.z * c.x - c.z * b.x, c.z * a.x - a.z * c.x);
    let change = sqrt(right * right + up * up) * 1.00001 + error;

    // Twice the area that the light sees, from its centre and from its rim: of one sign.
    let area = at.x + at.y + at.z;
    let area_slope = vec2(right.x + right.y + right.z, up.x + up.y + up.z);
    let area_change = length(area_slope) * 1.00001 + 4.0 * error;
    let turn = select(1.0, -1.0, area < 0.0);
    let nearest = min(a.z, min(b.z, c.z));
    let farthest = max(a.z, max(b.z, c.z));
    let room = 2.0 * beside + t_min + 16.0 * HALF_ULP * size;
    // Where rays meet its plane: volume / area.
    let volume = turn * (at.x * c.z + at.y * a.z + at.z * b.z);
    let most_area = abs(area) + area_change;
    let volume_error = 12.0 * error * size
        + (t_min + 32.0 * HALF_ULP * (1.0 + radius) * size) * most_area;
    let is_before = nearest > room || volume > volume_error;
    let is_behind = farthest < -room || volume < -volume_error;
    let has_side = abs(area) > area_change && radius > 0.0;

    let sides = turn * at;
    let is_out = any(sides + change < vec3(0.0));
    let is_mixed = is_out && any(sides - change > vec3(0.0));
    let is_beside = farthest < -room || is_mixed || (has_side && (is_out || is_behind));
    return Cone(sides, turn * right, turn * up, error, has_side && is_before, is_beside);
}
