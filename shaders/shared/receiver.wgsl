// What each pixel shows of the scene, as shared/gbuffer.ron makes it, and its status before a map or a ray is asked.

#import "shared/ids.wgsl"

var primitive: texture_2d<u32>;
// The receiver of the pixel, where `scene_positions` are; w: dot(n, l).
var position: texture_2d<f32>;

// STATUS_UNCERTAIN where the light has to be asked: at a `receiver` (of `position`) that faces it.
fn status_unasked(pixel: vec2<u32>, receiver: vec4<f32>) -> u32 {
    if textureLoad(primitive, pixel, 0).x == NO_PRIMITIVE {
        return STATUS_BACKGROUND;
    }
    return select(STATUS_FACING_AWAY, STATUS_UNCERTAIN, receiver.w > 0.0);
}
