// The status of a pixel before any map lookup or ray.

#import "shared/ids.wgsl"

var primitive: texture_2d<u32>;

fn faces_light(receiver: vec4<f32>) -> bool {
    return receiver.w > 0.0;
}

// STATUS_UNCERTAIN where the `receiver` (of `position`) faces the light and receives shadows.
fn initial_status(pixel: vec2<u32>, receiver: vec4<f32>) -> u32 {
    if textureLoad(primitive, pixel, 0).x == NO_PRIMITIVE {
        return STATUS_BACKGROUND;
    }
    let away = select(STATUS_FACING_AWAY, STATUS_LIGHT, receiver.w == UNSHADOWED);
    return select(away, STATUS_UNCERTAIN, faces_light(receiver));
}
