// The program's own shading: diffuse light of a sun times its visibility, and a sky.

struct Moment {
    clip_from_world: mat4x4<f32>,
    to_sun: vec4<f32>,
    parts: array<Part, 5>,
}
struct Part {
    world_from_model: mat4x4<f32>,
    color: vec4<f32>,
}
@group(0) @binding(0) var<uniform> moment: Moment;
@group(0) @binding(1) var visibility: texture_2d<f32>;

struct Seen {
    @builtin(position) position: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) color: vec3<f32>,
}

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @builtin(instance_index) index: u32,
) -> Seen {
    let part = moment.parts[index];
    let world = part.world_from_model * vec4(position, 1.0);
    // Boxes are stretched along their own edges, which leaves the directions of their normals.
    let turned = part.world_from_model * vec4(normal, 0.0);
    return Seen(moment.clip_from_world * world, turned.xyz, part.color.rgb);
}

@fragment
fn fragment(seen: Seen) -> @location(0) vec4<f32> {
    // Without shadows the texture is a single texel.
    let texel = min(vec2<u32>(seen.position.xy), textureDimensions(visibility) - 1u);
    let normal = normalize(seen.normal);
    let sun = textureLoad(visibility, texel, 0).r * max(dot(normal, moment.to_sun.xyz), 0.0);
    let sky = 0.12 + 0.08 * normal.y;
    return vec4(seen.color * (sun + sky), 1.0);
}
