// Stage to bound the light that arrives at each pixel by four moments of the depths around it; one
// thread per pixel. Peters, Klein, "Moment Shadow Mapping", I3D 2015, algorithm 3 (Hamburger 4MSM).

#import "shared/filtered_lookup.wgsl"

struct Params {
    radius: u32,
    moment_bias: f32,
    slope_bias: f32,
    bleed_reduction: f32,
}

var<uniform> params: Params;

fn share_of_light(stored: vec4<f32>, look: Look) -> f32 {
    let depth = look.depth - params.slope_bias * look.rise;
    // Rounded moments may be those of no depths; a share of depths of which 0.628 lie at the ends
    // of the range, the others in its middle, makes them valid.
    let b = mix(stored, vec4(0.0, 0.157, 0.0, 0.03925), params.moment_bias);
    // Cholesky's factors of the Hankel matrix of 1, b, solved for the polynomial whose roots are
    // the two other depths that would darken the receiver least. The least values are what rounding
    // may take from a flat surface; there any two depths will do.
    let d22 = max(b.y - b.x * b.x, 1e-9);
    let l32 = (b.z - b.x * b.y) / d22;
    let d33 = max(b.w - b.y * b.y - l32 * l32 * d22, 1e-10);
    var c = vec3(1.0, depth - b.x, depth * depth - b.y);
    c.z = (c.z - l32 * c.y) / d33;
    c.y = c.y / d22 - l32 * c.z;
    c.x -= dot(c.yz, b.xy);
    let divisor = select(c.z, 1e-6, abs(c.z) < 1e-6);
    let middle = -0.5 * c.y / divisor;
    let others = middle + vec2(-1.0, 1.0) * sqrt(max(middle * middle - c.x / divisor, 0.0));
    if depth <= others.x {
        return 1.0;
    }
    if depth <= others.y {
        return 1.0 - weight(others.x, vec2(depth, others.y), b.xy);
    }
    return weight(depth, others, b.xy);
}

// The share of depths that lie at `depth`, if all others lie at these two.
fn weight(depth: f32, others: vec2<f32>, mean: vec2<f32>) -> f32 {
    let at_others = others.x * others.y - mean.x * (others.x + others.y) + mean.y;
    return at_others / ((depth - others.x) * (depth - others.y));
}
