// A triangle before the disk of a light, as a receiver sees it: which points of the disk it hides,
// as far as that is clear of rounding. Bounds: docs/light_buffer_area.md.

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

// The light as a receiver sees it: a disk at distance 1 and at right angles to the way to its
// centre, which the light's own disk lies in.
struct Sight {
    receiver: vec3<f32>,
    // Nearer hits do not count.
    t_min: f32,
    x: vec3<f32>,
    y: vec3<f32>,
    to_light: vec3<f32>,
    radius: f32,
    // How far away the disk's nearest and farthest point are. A directional light's is beyond all.
    nearest: f32,
    farthest: f32,
}

fn sight_of(receiver: vec3<f32>, t_min: f32) -> Sight {
    let radius = light_area.radius;
    if light_kind == LIGHT_DIRECTIONAL {
        // Not to be divided by 0; of a light without extent nothing is clear.
        let scale = 1.0 / max(radius, 1e-30);
        let x = light_area.right * scale;
        let y = light_area.up * scale;
        return Sight(receiver, t_min, x, y, light.to_light, radius, 3e38, 3e38);
    }
    let to_light = to_light_from(receiver);
    let distance = length(light_way(receiver));
    // As `across_light` has them.
    let axes = axes_across(to_light);
    if light_kind == LIGHT_POINT {
        let seen = radius / distance;
        return Sight(receiver, t_min, axes.x, axes.y, to_light, seen, distance, distance);
    }
    // The sphere around the disk has this radius.
    let seen = radius * inverseSqrt(distance * distance - radius * radius) * 1.00001;
    return Sight(
        receiver, t_min, axes.x, axes.y, to_light, seen, distance - radius, distance + radius,
    );
}

// A point of the light's unit disk on that of a receiver's sight.
fn seen_point(sight: Sight, point: vec2<f32>) -> vec2<f32> {
    if light_kind != LIGHT_SPOT {
        return point;
    }
    let across = across_light(point, sight.to_light);
    let distance = 0.5 * (sight.nearest + sight.farthest) + dot(across, sight.to_light);
    let seen = vec2(dot(across, sight.x), dot(across, sight.y)) / (distance * sight.radius);
    return select(seen, point, light_area.radius == 0.0);
}

// Place across the light and distance towards it.
fn seen_along_light(sight: Sight, position: vec3<f32>) -> vec3<f32> {
    let way = position - sight.receiver;
    return vec3(dot(way, sight.x), dot(way, sight.y), dot(way, sight.to_light));
}

fn cone_of(sight: Sight, primitive: u32) -> Cone {
    let radius = sight.radius;
    let t_min = sight.t_min;
    let a = seen_along_light(sight, corner_position(3u * primitive));
    let b = seen_along_light(sight, corner_position(3u * primitive + 1u));
    let c = seen_along_light(sight, corner_position(3u * primitive + 2u));
    // The farthest corner, and the farthest from any ray to the light.
    let size = sqrt(max(dot(a, a), max(dot(b, b), dot(c, c))));
    let across = sqrt(max(dot(a.xy, a.xy), max(dot(b.xy, b.xy), dot(c.xy, c.xy))));
    let beside = across + radius * size;
    let roundings = select(256.0, 144.0, light_kind == LIGHT_DIRECTIONAL);
    let error = roundings * HALF_ULP * (1.0 + radius) * size * beside;

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
    var ends_beyond = true;
    var is_beyond = false;
    if light_kind != LIGHT_DIRECTIONAL {
        let end = sight.nearest * (1.0 - 2.0 * LIGHT_GAP);
        let least_area = max(abs(area) - area_change, 0.0);
        ends_beyond = farthest + room < end || volume + volume_error < end * least_area;
        is_beyond = nearest - room > sight.farthest;
    }

    let sides = turn * at;
    let is_out = any(sides + change < vec3(0.0));
    let is_mixed = is_out && any(sides - change > vec3(0.0));
    let is_elsewhere = farthest < -room || is_beyond || is_mixed;
    let is_beside = is_elsewhere || (has_side && (is_out || is_behind));
    let is_clear = has_side && is_before && ends_beyond;
    return Cone(sides, turn * right, turn * up, error, is_clear, is_beside);
}

// Returns two bits for each of four samples: certainly inside of all edges; and, since a triangle
// that is not clear may be turned either way, not certainly inside of one and outside of another.
fn sides_of(cone: Cone, x: vec4<f32>, y: vec4<f32>) -> vec2<u32> {
    let ab = cone.at.x + cone.right.x * x + cone.up.x * y;
    let bc = cone.at.y + cone.right.y * x + cone.up.y * y;
    let ca = cone.at.z + cone.right.z * x + cone.up.z * y;
    let least = lesser(ab, lesser(bc, ca));
    let most = greater(ab, greater(bc, ca));
    let bits = vec4(1u, 2u, 4u, 8u);
    let hit = select(vec4(0u), bits, least > vec4(cone.error));
    let is_mixed = (least < vec4(-cone.error)) & (most > vec4(cone.error));
    let perhaps = select(bits, vec4(0u), is_mixed);
    return vec2(hit.x | hit.y | hit.z | hit.w, perhaps.x | perhaps.y | perhaps.z | perhaps.w);
}

// llvmpipe looks for NaN in `min` and `max`.
fn lesser(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    return select(b, a, a < b);
}

fn greater(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    return select(b, a, a > b);
}
