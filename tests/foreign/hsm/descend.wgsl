#import "shared/light.wgsl"
#import "shared/receiver.wgsl"
var pyramid: texture_2d<f32>;
struct Answer { @location(0) visibility: u32, @location(1) status: u32, @location(2) steps: u32 }

@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    let pixel = vec2<u32>(centre.xy);
    let receiver = textureLoad(position, pixel, 0);
    var status = initial_status(pixel, receiver);
    var steps = 0u;
    if status == STATUS_UNCERTAIN {
        let clip = light_clip(receiver.xyz);
        let uv = vec2(clip.x, -clip.y) * 0.5 + 0.5;
        status = STATUS_LIGHT;
        for (var level = textureNumLevels(pyramid); level > 0u; level--) {
            steps++;
            let size = vec2<f32>(textureDimensions(pyramid, level - 1u));
            let m = textureLoad(pyramid, vec2<u32>(uv * size), level - 1u).xy;
            if clip.z <= m.x { break; }
            if clip.z > m.y { status = STATUS_SHADOW; break; }
        }
    }
    return Answer(initial_visibility(status), status, steps);
}
