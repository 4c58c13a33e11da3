fn inner(p: ptr<function, i32>) -> i32 {
    return *p + 1;
}
fn pick(v: ptr<function, array<array<array<i32, 4>, 4>, 4>>, i: u32, j: u32) -> i32 {
    let row = i % 4u;
    return inner(&(*v)[row][0][j]);
}
@fragment fn fragment(@builtin(position) at: vec4f) -> @location(0) f32 {
    var a: array<array<array<i32, 4>, 4>, 4>;
    return f32(pick(&a, 1u, 2u));
}
