#import "shared/light.wgsl"
#import "shared/receiver.wgsl"
struct Params { map_size: u32 }
var<uniform> params: Params;
var<storage, read> map: array<u32>;
struct Answer { @location(0) visibility: u32, @location(1) status: u32 }
@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    let pixel = vec2<u32>(centre.xy);
    let receiver = textureLoad(position, pixel, 0);
    var status = initial_status(pixel, receiver);
    if status == STATUS_UNCERTAIN {
        let clip = light_clip(receiver.xyz);
        let t = vec2<u32>((vec2(clip.x, -clip.y) * 0.5 + 0.5) * f32(params.map_size));
        let z = map[min(t.y, params.map_size - 1u) * params.map_size + min(t.x, params.map_size - 1u)];
        status = select(STATUS_SHADOW, STATUS_LIGHT, clip.z - 0.004 <= f32(4294967040u - z) / 4294967040.0);
    }
    return Answer(initial_visibility(status), status);
}
