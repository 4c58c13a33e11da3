#import "map_lookup.wgsl"

struct Params { radius: u32, moment_bias: f32, bias: f32, bleed: f32 }
var<uniform> params: Params;

// Hamburger's bound of four moments: algorithm 3 of the paper.
fn light_share(stored: vec4<f32>, depth: f32) -> f32 {
    let b = mix(stored, vec4(0.5), params.moment_bias);
    let z0 = depth - params.bias;
    let l32_d22 = b.z - b.x * b.y;
    let d22 = b.y - b.x * b.x;
    let squared_variance = b.w - b.y * b.y;
    let d33_d22 = squared_variance * d22 - l32_d22 * l32_d22;
    let l32 = l32_d22 / d22;
    var c = vec3(1.0, z0, z0 * z0);
    c.y -= b.x;
    c.z -= b.y + l32 * c.y;
    c.y /= d22;
    c.z *= d22 / d33_d22;
    c.y -= l32 * c.z;
    c.x -= dot(c.yz, b.xy);
    let p = c.y / c.z;
    let q = c.x / c.z;
    let r = sqrt(max(0.25 * p * p - q, 0.0));
    let z1 = -0.5 * p - r;
    let z2 = -0.5 * p + r;
    var choice = vec4(0.0);
    if z2 < z0 {
        choice = vec4(z1, z0, 1.0, 1.0);
    } else if z1 < z0 {
        choice = vec4(z0, z1, 0.0, 1.0);
    }
    let quotient = (choice.x * z2 - b.x * (choice.x + z2) + b.y) / ((z2 - choice.y) * (z0 - z1));
    let shadow = clamp(choice.z + choice.w * quotient, 0.0, 1.0);
    return (1.0 - shadow - params.bleed) / (1.0 - params.bleed);
}
