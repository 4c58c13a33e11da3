// The layers of a map, for receivers: each asks one. `map_layers` is 1 for a map of one layer, of
// which nothing is looked for; pssm has a layer per split of the eye's frustum (Zhang, Sun, Xu, Lun
// 2006), a point light's map one per face of a cube.

#import "shared/camera.wgsl"
#import "shared/map_fit.wgsl"
#import "shared/strata.wgsl"

override map_layers: u32 = 1u;

var<storage, read> map_fits: array<MapFitSlot>;

// The layer that a receiver asks: of the first split that reaches so far from the eye. Any layer
// would be right where it has the receiver in it; this one has the smallest texels.
fn layer_of(receiver: vec3<f32>) -> u32 {
    if map_layers == 1u {
        return 0u;
    }
    if light_kind == LIGHT_POINT {
        return light_face(receiver);
    }
    let distance = dot(camera.forward, relative_to_eye(receiver));
    var layer = 0u;
    while layer + 1u < map_layers && distance > end_of(layer, receiver) {
        layer += 1u;
    }
    return layer;
}

// How far from the eye a receiver asks this layer: to the end of its split, or by chance less far.
// Cells of light space have one chance each, so that it stays while the eye moves. Their width, a
// 512th of the end's distance, goes in powers of two, since the splits of `sdsm` move.
fn end_of(layer: u32, receiver: vec3<f32>) -> f32 {
    let end = map_fits[layer].fit.end;
    if split_blend == 0.0 {
        return end;
    }
    let across = light_clip(receiver).xy * light.extent.xy;
    let width = exp2(floor(log2(end))) / 512.0;
    let cell = bitcast<vec2<u32>>(vec2<i32>(floor(across / width)));
    return end * (1.0 - split_blend * random_pair(cell.x, cell.y).x);
}

fn fit_of(layer: u32) -> MapFit {
    // All faces lie alike.
    if map_layers == 1u || light_kind == LIGHT_POINT {
        return map_fit;
    }
    return map_fits[layer].fit;
}
