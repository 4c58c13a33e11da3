#import "shadow_lookup.wgsl"
@fragment fn mask(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    let status = compare(vec2<u32>(centre.xy));
    return select(select(0.5, 0.0, status == STATUS_SHADOW), 1.0, status == STATUS_LIGHT);
}
