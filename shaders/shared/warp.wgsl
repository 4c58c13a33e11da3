// A depth, from the middle of its range on, under two exponential warps: one grows away from the
// light, one towards it. Lauritzen, McCool, "Layered Variance Shadow Maps", GI 2008.

fn warped(depth: f32, exponent: f32) -> vec2<f32> {
    let z = 2.0 * depth;
    return vec2(exp(exponent * z), -exp(-exponent * z));
}
