// A triangle over the whole target, for full-screen passes that an indirect draw may leave out.

@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
    let x = select(-1.0, 3.0, corner == 1u);
    let y = select(-1.0, 3.0, corner == 2u);
    return vec4(x, y, 0.0, 1.0);
}
