// Stage to ask for as many workgroups as `image` is bright.
var image: texture_2d<f32>;
var<storage, read_write> groups: array<u32>;

@compute @workgroup_size(3) fn main(@builtin(local_invocation_index) index: u32) {
    groups[index] = u32(textureLoad(image, vec2<u32>(0u), 0).x);
}
