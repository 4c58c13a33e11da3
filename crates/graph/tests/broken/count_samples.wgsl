var coloured: texture_multisampled_2d<f32>;
var<storage, read_write> counts: array<u32>;

@compute @workgroup_size(1) fn main() {
    counts[0] = textureNumSamples(coloured);
}
