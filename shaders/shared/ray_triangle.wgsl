// A ray against a primitive of the scene.

#import "shared/geometry.wgsl"
#import "shared/ray_corners.wgsl"

// Tests a primitive as `intersect_corners` does; shortens `hit` to it.
fn intersect(ray: Sheared, primitive: u32, t_min: f32, hit: ptr<function, Hit>) -> bool {
    let a = corner_position(3u * primitive);
    let b = corner_position(3u * primitive + 1u);
    let c = corner_position(3u * primitive + 2u);
    return intersect_corners(ray, Corners(a, b, c, primitive), t_min, hit);
}
