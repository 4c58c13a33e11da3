// Stage to lay the shadow map over the trapezoid around the eye's frustum, or over the upright
// rectangle around it where the eye looks along the light; a single thread. Martin, Tan, "Anti-
// aliasing and Continuity with Trapezoidal Shadow Maps", EGSR 2004.

#import "shared/lay_map.wgsl"
#import "shared/trapezoid.wgsl"

struct Params {
    map_size: u32,
    // Distance from the eye; 0 for the far plane's.
    fit_distance: f32,
    // See shared/lay_map.wgsl.
    rounding: f32,
    // See shared/trapezoid.wgsl.
    warp: f32,
}

var<uniform> params: Params;
var<storage, read_write> map_fits: array<MapFitSlot>;

@compute @workgroup_size(1)
fn main() {
    let size = f32(params.map_size);
    let end = fit_end(params.fit_distance);
    let extent = light.extent.xy;
    var corners: array<vec2<f32>, 8>;
    for (var corner = 0u; corner < 8u; corner++) {
        corners[corner] = extent * light_clip(frustum_corner(corner, camera.near, end)).xy;
    }
    let map = trapezoid_map(corners, params.warp);
    if !map.exists {
        let axes = upright();
        let around = around_frustum(axes, camera.near, end);
        map_fits[0].fit = fit_over_rectangle(axes, around, size, params.rounding);
        return;
    }
    // From clip space, and to texels with y down.
    let scale = vec3(extent, 1.0);
    let w = map.w * scale;
    var fit = affine_fit(
        0.5 * size * (w + map.x * scale),
        0.5 * size * (w - map.y * scale),
        size,
    );
    fit.w = vec4(w, 0.0);
    map_fits[0].fit = fit;
}
