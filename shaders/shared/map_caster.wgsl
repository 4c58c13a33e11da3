// Fragments that cast in a map of depths, where triangles are masked or double-sided: a draw that
// culls nothing leaves out here what a draw without sheets culls.

#import "shared/light_triangle.wgsl"
#import "shared/solid.wgsl"

// `weights`: of the primitive's second and third corner.
fn is_cast(primitive: u32, weights: vec2<f32>, is_front: bool, cull: u32) -> bool {
    let is_culled = cull == select(CULL_BACK, CULL_FRONT, is_front) && !is_sheet(primitive);
    return !is_culled && is_opaque(primitive, weights.x, weights.y);
}
