// Stage to find how densely the shadow map's texels lie where each pixel looks, and which layer it
// asks; a full-screen triangle. For `skiagraph compare`, which turns density into texels per pixel.

#import "shared/map_layers.wgsl"
#import "shared/receiver.wgsl"

struct Lookup {
    // Texels on a unit of area across the light's rays; 0 outside the map.
    @location(0) density: f32,
    @location(1) layer: u32,
}

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> Lookup {
    let receiver = textureLoad(position, vec2<u32>(centre.xy), 0).xyz;
    let layer = layer_of(receiver);
    let fit = fit_of(layer);
    let place = texel_of(fit, receiver).xy;
    return Lookup(select(density(fit, receiver, place), 0.0, is_outside_of(fit, place)), layer);
}

fn density(fit: MapFit, receiver: vec3<f32>, place: vec2<f32>) -> f32 {
    var x = fit.x.xy;
    var y = fit.y.xy;
    if map_is_projective {
        // The derivatives of the quotients.
        let w = dot(fit.w.xyz, vec3(light_clip(receiver).xy, 1.0));
        x = (x - place.x * fit.w.xy) / w;
        y = (y - place.y * fit.w.xy) / w;
    }
    let across = abs(x.x * y.y - x.y * y.x) / (light.extent.x * light.extent.y);
    if light_kind == LIGHT_DIRECTIONAL {
        return across;
    }
    // `extent` holds at `range`, in a plane that the axis stands on; rays lean by the angle whose
    // cosine is the distance along the axis to that along the ray.
    let along_axis = light_homogeneous(receiver, light_face(receiver)).z;
    let along_ray = length(light_way(receiver)) / light.range;
    return across * along_ray / (along_axis * along_axis * along_axis);
}
