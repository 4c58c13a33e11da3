// Stage to write `image` from compute.
var image: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    textureStore(image, id.xy, vec4<f32>(1.0));
}
