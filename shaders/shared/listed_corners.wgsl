// The corners of listed casters, by their numbers, in the place of those of all triangles.

#import "shared/listed_casters.wgsl" instead "shared/geometry.wgsl"

var<storage, read> scene_positions: array<vec4<f32>>;

fn corner_position(corner: u32) -> vec3<f32> {
    return scene_positions[scene_casters[corner / 3u][corner % 3u]].xyz;
}
