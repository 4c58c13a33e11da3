enable f16;
const HALF: f16 = f16(65530i);
const BIG: i32 = i32(HALF);
@fragment fn fragment(@builtin(position) at: vec4f) -> @location(0) f32 {
    let q = BIG;
    return f32(q) / 70000.0;
}
