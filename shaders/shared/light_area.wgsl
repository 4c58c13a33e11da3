// How far the light reaches around its centre. Laid out as `LightAreaUniform` in
// crates/passes/src/uniforms.rs.

#import "shared/light.wgsl"

struct LightArea {
    // From the light's centre to its rim, of a directional light at distance 1; 0 of a point light,
    // whose disk faces each receiver.
    right: vec3<f32>,
    // Radius of the disk that `right` and `up` span; 0 for a light without extent.
    radius: f32,
    // As `right`, at a right angle to it.
    up: vec3<f32>,
    padding: f32,
}

var<uniform> light_area: LightArea;

// From the light's centre to a point of the unit disk, as a receiver sees it that has the light's
// centre in that direction.
fn across_light(point: vec2<f32>, to_light: vec3<f32>) -> vec3<f32> {
    if light_kind != LIGHT_POINT {
        return light_area.right * point.x + light_area.up * point.y;
    }
    let axes = axes_across(to_light);
    return light_area.radius * (axes.x * point.x + axes.y * point.y);
}

// Unit vectors across a direction and each other.
struct AxesAcross {
    x: vec3<f32>,
    y: vec3<f32>,
}

fn axes_across(to_light: vec3<f32>) -> AxesAcross {
    // Any axis across will do; this one is never along the light.
    let helper = select(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), abs(to_light.x) > 0.5);
    let x = normalize(cross(to_light, helper));
    return AxesAcross(x, cross(x, to_light));
}

// A bit beyond the number of samples that were seen: one of them has no answer.
const UNANSWERED_SAMPLE: u32 = 0x80000000u;

// A light without extent looks the same from each of its points: one sample does.
fn samples_needed(wanted: u32) -> u32 {
    return select(wanted, 1u, light_area.radius == 0.0);
}

// Wider lights than the bounds of light_cone.wgsl hold for: of more than 126 degrees.
const WIDEST: f32 = 2.0;

fn is_too_wide() -> bool {
    return light_kind == LIGHT_DIRECTIONAL && light_area.radius > WIDEST;
}

// True within twice a lamp's radius: lists and bounds are for receivers beyond.
fn is_inside_light(receiver: vec3<f32>) -> bool {
    let way = light_way(receiver);
    return light_kind != LIGHT_DIRECTIONAL
        && !(dot(way, way) > 4.004 * light_area.radius * light_area.radius);
}
