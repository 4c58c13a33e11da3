// Stage to lay the shadow map over light space: over the scene, over what the eye could see, or
// over the receivers that it does see; a single thread.

#import "shared/lay_map.wgsl"

struct Params {
    map_size: u32,
    // Distance from the eye; 0 for the far plane's.
    fit_distance: f32,
    // See shared/lay_map.wgsl.
    rounding: f32,
}

var<uniform> params: Params;
// As receiver_box.wgsl has it.
var<storage, read> receiver_box: array<u32, 4>;
var<storage, read_write> map_fits: array<MapFitSlot>;

@compute @workgroup_size(1)
fn over_scene() {
    map_fits[0].fit = fit_over_scene(f32(params.map_size), params.rounding);
}

@compute @workgroup_size(1)
fn over_receivers() {
    let box = vec4(receiver_box[0], receiver_box[1], receiver_box[2], receiver_box[3]);
    map_fits[0].fit = fit_over_box(box, f32(params.map_size), params.rounding);
}

// The upright rectangle around the eye's frustum: as the dissertation fits its light.
@compute @workgroup_size(1)
fn over_camera() {
    let end = fit_end(params.fit_distance);
    if stable {
        map_fits[0].fit = fit_over_ball(camera.near, end, f32(params.map_size), params.rounding);
        return;
    }
    let axes = upright();
    let around = around_frustum(axes, camera.near, end);
    map_fits[0].fit = fit_over_rectangle(axes, around, f32(params.map_size), params.rounding);
}
