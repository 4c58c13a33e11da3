var image: texture_storage_2d<r8unorm, write>;

@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    textureStore(image, id.xy, vec4<f32>(1.0));
}
