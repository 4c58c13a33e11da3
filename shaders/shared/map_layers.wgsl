// The layers of a map, for receivers: each asks one. `map_layers` is 1 for a map of one layer, of
// which nothing is looked for; pssm has a layer per split of the eye's frustum (Zhang, Sun, Xu, Lun
// 2006), a point light's map one per face of a cube.

#import "shared/camera.wgsl"
#import "shared/map_fit.wgsl"

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
    while layer + 1u < map_layers && distance > map_fits[layer].fit.end {
        layer += 1u;
    }
    return layer;
}

fn fit_of(layer: u32) -> MapFit {
    // All faces lie alike.
    if map_layers == 1u || light_kind == LIGHT_POINT {
        return map_fit;
    }
    return map_fits[layer].fit;
}
