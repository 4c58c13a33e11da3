// Stage to draw the layer of outer_depth.wgsl, and which triangle is nearest in each texel.

#import "outer_depth.wgsl"
#import "shared/ids.wgsl"

struct TexelOfPrimitive {
    @builtin(frag_depth) depth: f32,
    @location(0) primitive: u32,
}

@fragment
fn fragment_with_primitive(vertex: Vertex) -> TexelOfPrimitive {
    return TexelOfPrimitive(nearest(vertex), vertex.primitive);
}
