// The light and its light space. Laid out as `LightUniform` in crates/passes/src/uniforms.rs.

struct Light {
    // From a position relative to `centre` to the light's clip space; affine, z in 0..1 grows away
    // from the light. For a spot or point light: see `light_homogeneous`.
    clip_from_relative: mat4x4<f32>,
    // Unit vector towards the light; of a spot light, against its axis; of a point light, 0.
    to_light: vec3<f32>,
    // No two points of the scene are farther apart.
    max_distance: f32,
    // Centre of the scene's box: subtracted before the matrix, so that far-off scenes keep their
    // precision. w: the most that is summed up, sizes alone, for clip x or y of a point in the box.
    centre: vec4<f32>,
    // World units per unit of clip x, y, z; of a spot or point light, at its `range`. w: as of
    // `centre`, for z.
    extent: vec4<f32>,
    // Place of a spot or point light, and the remainder of rounding it to f32.
    position: vec3<f32>,
    // Cosine of the angle between a spot light's axis and the edge of its cone.
    edge_cosine: f32,
    position_low: vec3<f32>,
    // Range of a spot or point light: no point of the scene is farther from it.
    range: f32,
}

var<uniform> light: Light;

// Kind of the light: known when the graph is planned, so that the other kinds cost nothing.
override light_kind: u32 = 0u;
const LIGHT_DIRECTIONAL: u32 = 0u;
const LIGHT_SPOT: u32 = 1u;
const LIGHT_POINT: u32 = 2u;

// Share that a shadow ray to a place leaves out of its way, as `LIGHT_GAP` in
// crates/scene/src/light_kind.rs.
const LIGHT_GAP: f32 = 0.0000152587890625;

// From a position to the place of a spot or point light.
fn light_way(position: vec3<f32>) -> vec3<f32> {
    return (light.position - position) + light.position_low;
}

// Unit vector from a position towards the light.
fn to_light_from(position: vec3<f32>) -> vec3<f32> {
    if light_kind == LIGHT_DIRECTIONAL {
        return light.to_light;
    }
    let way = light_way(position);
    return way * inverseSqrt(max(dot(way, way), 1e-37));
}

// How far along `to_light_from` a shadow ray from there goes.
fn light_distance(position: vec3<f32>) -> f32 {
    if light_kind == LIGHT_DIRECTIONAL {
        return light.max_distance;
    }
    return length(light_way(position)) * (1.0 - LIGHT_GAP);
}

// Returns true if the light shines on a position at all, were nothing in between.
fn light_shines_on(position: vec3<f32>) -> bool {
    if light_kind != LIGHT_SPOT {
        return true;
    }
    let way = light_way(position);
    return dot(way, light.to_light) >= light.edge_cosine * length(way);
}

// The face of the light's map that a position lies in: of a point light the cube's, +x, -x, +y, -y,
// +z, -z; otherwise 0.
fn light_face(position: vec3<f32>) -> u32 {
    if light_kind != LIGHT_POINT {
        return 0u;
    }
    let from_light = -light_way(position);
    let size = abs(from_light);
    let cube_face = select(select(4u, 2u, size.y >= size.z), 0u, size.x >= max(size.y, size.z));
    return cube_face + select(0u, 1u, from_light[cube_face / 2u] < 0.0);
}

// A position as a face of the light's map sees it: x and y, of which w is the half width of the
// map, and w; z, not to be divided by w, is the share of `range`, in 0..1 before the light. For a
// spot light w is the distance along the axis, for a point light along the face's. Behind the light
// w is negative.
fn light_homogeneous(position: vec3<f32>, cube_face: u32) -> vec4<f32> {
    if light_kind == LIGHT_DIRECTIONAL {
        return light.clip_from_relative * vec4(position - light.centre.xyz, 1.0);
    }
    let from_light = -light_way(position);
    if light_kind == LIGHT_SPOT {
        return light.clip_from_relative * vec4(from_light, 0.0);
    }
    // As cube textures have it, y up.
    let v = from_light;
    var rotated = vec3(-v.x, v.y, -v.z);
    switch cube_face {
        case 0u: { rotated = vec3(-v.z, v.y, v.x); }
        case 1u: { rotated = vec3(v.z, v.y, -v.x); }
        case 2u: { rotated = vec3(v.x, -v.z, v.y); }
        case 3u: { rotated = vec3(v.x, v.z, -v.y); }
        case 4u: { rotated = vec3(v.x, v.y, v.z); }
        default: {}
    }
    return vec4(rotated.xy, rotated.z / light.range, rotated.z);
}

// Maps a place in the world into the map's face that it lies in: x and y in -1..1 over the map, y
// up, z in 0..1 away from the light. A spot light's x and y are infinite beside the light.
fn light_clip(position: vec3<f32>) -> vec3<f32> {
    if light_kind == LIGHT_DIRECTIONAL {
        return (light.clip_from_relative * vec4(position - light.centre.xyz, 1.0)).xyz;
    }
    let seen = light_homogeneous(position, light_face(position));
    return vec3(seen.xy / seen.w, seen.z);
}

// 4 half ulps: what clip space is off by, for each unit of what is summed up. Valid if products are
// fused.
const CLIP_ROUNDING: f32 = 2.3841858e-7;

// All that is summed up, sizes alone, for clip x or y, and for clip z, of a receiver and of the
// corners of its casters.
fn light_clip_summands(receiver: vec3<f32>) -> vec2<f32> {
    let matrix = transpose(light.clip_from_relative);
    let size = abs(receiver) + abs(light.centre.xyz);
    let across = max(dot(abs(matrix[0].xyz), size), dot(abs(matrix[1].xyz), size));
    return vec2(across + light.centre.w, dot(abs(matrix[2].xyz), size) + light.extent.w);
}

// The same, of any receiver in the scene: |receiver| is at most |centre| and half of the box.
fn light_clip_summands_of_scene() -> vec2<f32> {
    let half = vec2(light.centre.w, light.extent.w);
    return light_clip_summands(light.centre.xyz) + half;
}
