// Stage to bound the light that arrives at each pixel by four moments of the depths around it; one
// thread per pixel. Peters, Klein, "Moment Shadow Mapping", I3D 2015, algorithm 3 (Hamburger 4MSM).

#import "shared/filtered_lookup.wgsl"

struct Params {
    radius: u32,
    moment_bias: f32,
    bleed_reduction: f32,
}

var<uniform> params: Params;

fn share_of_light(stored: vec4<f32>, depth: f32) -> f32 {
    // Rounded moments may be those of no depths: a share of valid ones makes them so.
    let b = mix(stored, vec4(0.5), params.moment_bias);
    // Cholesky's factors of the Hankel matrix of 1, b, solved for the polynomial whose roots are
    // the two other depths that would darken the receiver most.
    let d22 = b.y - b.x * b.x;
    let l32 = (b.z - b.x * b.y) / d22;
    let d33 = b.w - b.y * b.y - l32 * l32 * d22;
    var c = vec3(1.0, depth - b.x, depth * depth - b.y);
    c.z = (c.z - l32 * c.y) / d33;
    c.y = c.y / d22 - l32 * c.z;
    c.x -= dot(c.yz, b.xy);
    let middle = -0.5 * c.y / c.z;
    let apart = sqrt(max(middle * middle - c.x / c.z, 0.0));
    let low = middle - apart;
    let high = middle + apart;
    if depth <= low {
        return 1.0;
    }
    if depth <= high {
        return 1.0 - weight(low, vec2(depth, high), b.xy);
    }
    return weight(depth, vec2(low, high), b.xy);
}

// The share of depths that lie at `depth`, if all others lie at these two.
fn weight(depth: f32, others: vec2<f32>, mean: vec2<f32>) -> f32 {
    let at_others = others.x * others.y - mean.x * (others.x + others.y) + mean.y;
    return at_others / ((depth - others.x) * (depth - others.y));
}
