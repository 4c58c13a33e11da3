// Stages of the pass kind `Equalize`, one thread per texel: `count` puts every texel of `source` into a bin by its brightness,
// `spread` writes to `result` which share of all texels is at most as bright (histogram equalisation).

override BINS: u32;

var source: texture_2d<f32>;
var result: texture_storage_2d<r32float, write>;
var<storage, read_write> histogram: array<atomic<u32>>;

fn bin(texel: vec2<u32>) -> u32 {
    let brightness = saturate(textureLoad(source, texel, 0).x);
    return min(u32(brightness * f32(BINS)), BINS - 1u);
}

@compute @workgroup_size(8, 8) fn count(@builtin(global_invocation_id) texel: vec3<u32>) {
    if any(texel.xy >= textureDimensions(source)) { return; }
    atomicAdd(&histogram[bin(texel.xy)], 1u);
}

@compute @workgroup_size(8, 8) fn spread(@builtin(global_invocation_id) texel: vec3<u32>) {
    let size = textureDimensions(source);
    if any(texel.xy >= size) { return; }
    var darker = 0u;
    for (var other = 0u; other <= bin(texel.xy); other++) {
        darker += atomicLoad(&histogram[other]);
    }
    textureStore(result, texel.xy, vec4(f32(darker) / f32(size.x * size.y), 0.0, 0.0, 0.0));
}
