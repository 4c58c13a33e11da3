// As primitive.wgsl, where triangles are masked or double-sided: drawn without culling, a fragment
// is left out where its mask is not opaque, or where a single-sided primitive is seen from behind.

#import "shared/masks.wgsl"
#import "shared/pixel_weights.wgsl"
#import "primitive.wgsl"

struct Params {
    viewport: vec2<u32>,
}

var<uniform> params: Params;

@fragment
fn fragment_masked(vertex: Vertex) -> @location(0) u32 {
    let first = 3u * vertex.primitive;
    let at = pixel_weights(
        pixel_direction(vec2<u32>(vertex.clip.xy), params.viewport),
        relative_to_eye(corner_position(first)),
        relative_to_eye(corner_position(first + 1u)),
        relative_to_eye(corner_position(first + 2u)),
    );
    if at.from_behind && !is_double_sided(vertex.primitive) {
        discard;
    }
    if !is_opaque(vertex.primitive, at.weights.y, at.weights.z) {
        discard;
    }
    return vertex.primitive;
}
