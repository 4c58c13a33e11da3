// Bias that is added to a stored depth before a receiver is compared with it, and the edge of a
// texel at the receiver.

#import "shared/map_fit.wgsl"

// The plane of the receiver rises by tan(angle to the light) per unit across; `slope_bias` counts
// in texels of that rise.
fn bias_at(
    fit: MapFit,
    receiver: vec3<f32>,
    place: vec3<f32>,
    n_dot_l: f32,
    bias: f32,
    slope_bias: f32,
) -> f32 {
    let texel = texel_edge_at(fit, receiver, place);
    let slope = sqrt(max(1.0 - n_dot_l * n_dot_l, 0.0)) / n_dot_l;
    return bias + slope_bias * slope * texel / light.extent.z;
}

// The longer edge, in units of the scene.
fn texel_edge_at(fit: MapFit, receiver: vec3<f32>, place: vec3<f32>) -> f32 {
    // Growth of the map's x and y per unit of clip x and y.
    var x = fit.x.xy;
    var y = fit.y.xy;
    if map_is_projective {
        // Texels differ in size: by the derivative of the quotients here.
        let w = dot(fit.w.xyz, vec3(light_clip(receiver).xy, 1.0));
        x = (x - place.x * fit.w.xy) / w;
        y = (y - place.y * fit.w.xy) / w;
    }
    if light_kind != LIGHT_DIRECTIONAL {
        // The nearer the light, the smaller.
        x /= max(place.z, 1e-6);
        y /= max(place.z, 1e-6);
    }
    let extent = light.extent.xy;
    let texel = 1.0 / vec2(length(x / extent), length(y / extent));
    return max(texel.x, texel.y);
}
