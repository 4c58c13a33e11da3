// Chebyshev's inequality: no more than this share of what has these first two moments is as great
// as `at`. Donnelly, Lauritzen, "Variance Shadow Maps", I3D 2006, equations 3 to 5.

fn chebyshev(moments: vec2<f32>, at: f32, least_variance: f32) -> f32 {
    let behind = at - moments.x;
    if behind <= 0.0 {
        return 1.0;
    }
    let variance = max(moments.y - moments.x * moments.x, least_variance);
    return variance / (variance + behind * behind);
}
