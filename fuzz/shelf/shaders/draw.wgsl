#import "shared/scene.wgsl"
@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return camera * corner(index);
}
