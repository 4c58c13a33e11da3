@fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 {
    let place = vec2<u32>(at.xy);
    return place.x << 8u | place.y;
}
