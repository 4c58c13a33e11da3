struct Out {
    @builtin(position) at: vec4f,
    @location(0) v0: f32,
    @location(1) v1: f32,
    @location(2) v2: f32,
    @location(3) v3: f32,
    @location(4) v4: f32,
    @location(5) v5: f32,
    @location(6) v6: f32,
    @location(7) v7: f32,
    @location(8) v8: f32,
    @location(9) v9: f32,
    @location(10) v10: f32,
    @location(11) v11: f32,
    @location(12) v12: f32,
    @location(13) v13: f32,
    @location(14) v14: f32,
    @location(15) v15: f32,
}
@vertex fn vertex() -> Out {
    return Out();
}
@fragment fn fragment(in: Out, @builtin(front_facing) front: bool) -> @location(0) f32 {
    return select(in.v0, in.v15, front);
}
