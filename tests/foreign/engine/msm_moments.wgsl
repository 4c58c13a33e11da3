// Stage to write the first four moments of each texel's depth.

#import "map_moments.wgsl"

fn stored(depth: f32) -> vec4<f32> {
    let squared = depth * depth;
    return vec4(depth, squared, squared * depth, squared * squared);
}
