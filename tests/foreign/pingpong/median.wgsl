#import "shared/ids.wgsl"
var source: texture_2d<u32>;
struct Answer { @location(0) visibility: u32, @location(1) status: u32 }

fn lit(place: vec2<i32>) -> f32 {
    let last = vec2<i32>(textureDimensions(source)) - 1;
    let status = textureLoad(source, clamp(place, vec2(0), last), 0).x;
    return select(select(0.5, 0.0, status == STATUS_SHADOW), 1.0, status == STATUS_LIGHT);
}

@fragment fn fragment(@builtin(position) p: vec4<f32>) -> Answer {
    let h = vec2<i32>(p.xy);
    var status = textureLoad(source, h, 0).x;
    if lit(h) != 0.5 {
        let sum = lit(h) + lit(h + vec2(1, 0)) + lit(h - vec2(1, 0)) + lit(h + vec2(0, 1)) + lit(h - vec2(0, 1));
        status = select(STATUS_SHADOW, STATUS_LIGHT, sum > 2.5);
    }
    return Answer(initial_visibility(status), status);
}
