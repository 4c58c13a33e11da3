#import "shared/receiver.wgsl"
var count: texture_2d<u32>;
struct Answer { @location(0) visibility: u32, @location(1) status: u32 }
@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    let pixel = vec2<u32>(centre.xy);
    var status = initial_status(pixel, textureLoad(position, pixel, 0));
    if status == STATUS_UNCERTAIN {
        status = select(STATUS_LIGHT, STATUS_SHADOW, textureLoad(count, pixel, 0).x != 0u);
    }
    return Answer(initial_visibility(status), status);
}
