var a: texture_2d<f32>;
var made: texture_storage_2d<rgba16float, write>;
@compute @workgroup_size(8, 8) fn store(@builtin(global_invocation_id) at: vec3<u32>) {
    textureStore(made, at.xy, textureLoad(a, at.xy, 0) * 0.5);
}
