#import "shared/receiver.wgsl"
var ping: texture_2d<f32>;
struct Answer { @location(0) visibility: u32, @location(1) status: u32 }
@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    let pixel = vec2<u32>(centre.xy);
    var s = initial_status(pixel, textureLoad(position, pixel, 0));
    if s == STATUS_UNCERTAIN { s = select(STATUS_SHADOW, STATUS_LIGHT, textureLoad(ping, pixel, 0).x > 0.5); }
    return Answer(initial_visibility(s), s);
}
