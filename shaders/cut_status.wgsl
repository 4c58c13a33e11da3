// Stage to call half the light and more light, and less than that shadow; a full-screen triangle.

#import "shared/receiver.wgsl"

var visibility: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) u32 {
    let pixel = vec2<u32>(centre.xy);
    let status = initial_status(pixel, textureLoad(position, pixel, 0));
    let is_lit = textureLoad(visibility, pixel, 0).x >= 0.5;
    return select(status, select(STATUS_SHADOW, STATUS_LIGHT, is_lit), status == STATUS_UNCERTAIN);
}
