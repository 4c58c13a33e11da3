// Stage to draw the scene's depth as the light sees it, by vertex pulling (three vertices per
// primitive). Williams, "Casting Curved Shadows on Curved Surfaces", SIGGRAPH 1978.

#import "shared/map_fit.wgsl"
#import "shared/geometry.wgsl"

@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
    let texel = light_texel(corner_position(corner));
    return texel_clip(texel.xy, texel.z);
}
