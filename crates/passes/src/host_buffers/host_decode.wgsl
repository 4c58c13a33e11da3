// Asks the host's own module, which has `decode_position` and `decode_normal`: both take the first
// word of a vertex in `vertices`. A vertex beyond the buffer is no number.

fn position_bits(vertex: u32) -> vec3<u32> {
    let word = mesh.first + vertex * mesh.stride;
    if word >= arrayLength(&vertices) {
        return vec3(NOT_A_NUMBER);
    }
    return bitcast<vec3<u32>>(decode_position(word));
}

fn normal_bits(vertex: u32) -> vec3<u32> {
    let word = mesh.first + vertex * mesh.stride;
    if word >= arrayLength(&vertices) {
        return vec3(0u);
    }
    return bitcast<vec3<u32>>(decode_normal(word));
}
