// Stage to count bright texels.
var image: texture_2d<f32>;
var<storage, read_write> total: atomic<u32>;

@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if textureLoad(image, id.xy, 0).x > 0.5 {
        atomicAdd(&total, 1u);
    }
}
