// Stage to mix this frame's answer with that of the frame before at the same receiver: mean, and of how many frames.
#import "shared/camera.wgsl" // bound to the frame before
#import "shared/receiver.wgsl"
#import "place_before.wgsl"

struct Params { least_weight: f32 }
var<uniform> params: Params;
var noisy: texture_2d<u32>;
var history_previous: texture_2d<f32>;
var position_previous: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec2<f32> {
    let pixel = vec2<u32>(centre.xy);
    let receiver = textureLoad(position, pixel, 0);
    if !faces_light(receiver) {
        return vec2(0.0);
    }
    let now = select(0.0, 1.0, textureLoad(noisy, pixel, 0).x == 1u);
    let was = place_before(textureLoad(primitive, pixel, 0).x, receiver.xyz);
    let relative = relative_to_eye(was);
    let clip = camera_clip(relative);
    if any(abs(clip.xy) >= vec2(clip.w)) {
        return vec2(now, 1.0);
    }
    let size = vec2<f32>(textureDimensions(position));
    let place = (clip.xy / clip.w * vec2(0.5, -0.5) + 0.5) * size - 0.5;
    let corner = floor(place);
    let share = place - corner;
    // Receivers farther off than some pixel widths are others.
    let near = 3.0 * length(relative) * camera.half_height / size.y * 2.0;
    var sum = vec2(0.0);
    var weight = 0.0;
    for (var i = 0; i < 4; i++) {
        let step = vec2(i & 1, i >> 1);
        let at = vec2<i32>(corner) + step;
        if any(at < vec2(0)) || any(at >= vec2<i32>(size)) {
            continue;
        }
        let before = textureLoad(position_previous, at, 0);
        let kept = textureLoad(history_previous, at, 0).xy;
        if before.w <= 0.0 || kept.y == 0.0 || distance(before.xyz, was) > near {
            continue;
        }
        let w = select(1.0 - share.x, share.x, step.x == 1) * select(1.0 - share.y, share.y, step.y == 1);
        sum += w * kept;
        weight += w;
    }
    if weight < 0.01 {
        return vec2(now, 1.0);
    }
    let kept = sum / weight;
    let age = kept.y + 1.0;
    return vec2(mix(kept.x, now, max(1.0 / age, params.least_weight)), min(age, 255.0));
}
