// Stage to draw the scene's depth as the light sees it into a map that may be projective: depths
// are those of light space all the same, as each fragment has them, because a plane's are not
// linear across such a map. Three vertices per primitive, pulled. Martin, Tan 2004, section 4.

#import "shared/map_fit.wgsl"
#import "shared/geometry.wgsl"

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) depth: f32,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> Vertex {
    let clip = light_clip(corner_position(corner));
    let across = vec3(clip.xy, 1.0);
    let w = dot(map_fit.w.xyz, across);
    let texel = vec2(dot(map_fit.x.xyz, across), dot(map_fit.y.xyz, across));
    let place = texel / map_fit.size * 2.0 - w;
    // Clipped where w is 0, not by depth.
    return Vertex(vec4(place.x, -place.y, 0.5 * w, w), clip.z);
}

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    return saturate(vertex.depth);
}
