var<immediate> factor: array<vec4f, 100>;
@fragment fn fragment() -> @location(0) f32 {
    return factor[0].x;
}
