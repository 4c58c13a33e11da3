// Decodes the formats of layout.rs in integers: to the f32 nearest to what a component stands for.

// Formats of an attribute, as in layout.rs.
const FLOAT32 = 0u;
const FLOAT16 = 1u;
const SNORM16 = 2u;
const UNORM16 = 3u;
const SINT16 = 4u;
const UINT16 = 5u;
const SNORM8 = 6u;
const UNORM8 = 7u;
const SINT8 = 8u;
const UINT8 = 9u;

fn position_bits(vertex: u32) -> vec3<u32> {
    return component_bits(vertex, mesh.position_at, mesh.position_format);
}

fn normal_bits(vertex: u32) -> vec3<u32> {
    return component_bits(vertex, mesh.normal_at, mesh.normal_format);
}

// Three components of an attribute, decoded, as bits of f32.
fn component_bits(vertex: u32, at: u32, format: u32) -> vec3<u32> {
    let word = mesh.first + vertex * mesh.stride + at;
    if format == FLOAT32 {
        return vec3(vertices[word], vertices[word + 1u], vertices[word + 2u]);
    }
    if format >= SNORM8 {
        let bytes = vertices[word];
        return vec3(
            byte(bytes & 0xffu, format),
            byte((bytes >> 8u) & 0xffu, format),
            byte((bytes >> 16u) & 0xffu, format),
        );
    }
    let half = vec3(vertices[word], vertices[word] >> 16u, vertices[word + 1u]) & vec3(0xffffu);
    return vec3(
        half_word(half.x, format),
        half_word(half.y, format),
        half_word(half.z, format),
    );
}

fn byte(bits: u32, format: u32) -> u32 {
    let signed = bitcast<i32>(bits << 24u) >> 24u;
    switch format {
        case SNORM8: { return share(signed, 127u); }
        case UNORM8: { return share(bitcast<i32>(bits), 255u); }
        case SINT8: { return bitcast<u32>(f32(signed)); }
        default: { return bitcast<u32>(f32(bits)); }
    }
}

fn half_word(bits: u32, format: u32) -> u32 {
    let signed = bitcast<i32>(bits << 16u) >> 16u;
    switch format {
        case FLOAT16: { return from_half(bits); }
        case SNORM16: { return share(signed, 32767u); }
        case UNORM16: { return share(bitcast<i32>(bits), 65535u); }
        case SINT16: { return bitcast<u32>(f32(signed)); }
        default: { return bitcast<u32>(f32(bits)); }
    }
}

fn from_half(bits: u32) -> u32 {
    let sign = (bits & 0x8000u) << 16u;
    let exponent = (bits >> 10u) & 31u;
    let mantissa = bits & 0x3ffu;
    if exponent == 31u {
        return sign | INFINITE | (mantissa << 13u);
    }
    if exponent > 0u {
        return sign | ((exponent + 112u) << 23u) | (mantissa << 13u);
    }
    if mantissa == 0u {
        return sign;
    }
    let top = firstLeadingBit(mantissa);
    return sign | ((top + 103u) << 23u) | ((mantissa << (23u - top)) & 0x7fffffu);
}

// n / most, rounded to the nearest; at least -1.
fn share(n: i32, most: u32) -> u32 {
    let sign = select(0u, 0x80000000u, n < 0);
    let size = min(u32(abs(n)), most);
    if size == 0u {
        return 0u;
    }
    var shift = countLeadingZeros(size) - countLeadingZeros(most);
    if (size << shift) < most {
        shift += 1u;
    }
    var rest = size << shift;
    var mantissa = 0u;
    for (var i = 0u; i < 24u; i++) {
        mantissa <<= 1u;
        if rest >= most {
            rest -= most;
            mantissa |= 1u;
        }
        rest <<= 1u;
    }
    // `most` is odd, so no rest is a half.
    mantissa += select(0u, 1u, rest > most);
    return sign | (((126u - shift) << 23u) + mantissa);
}
