// Kernels that bring a host's vertices into the scene's buffers. Positions are computed in integers,
// so that each is, on any device, the f32 that the CPU has for it: the vertex decoded to f32, moved
// by the f64 map, and rounded once (`Movable::moved_part`). `y` of a workgroup counts the parts of
// one mesh. `position_bits` and `normal_bits`, the bits of a vertex decoded to f32, are those of
// decode.wgsl, or of host_decode.wgsl and the host's own module.

struct Mesh {
    // In words of four bytes.
    first: u32,
    stride: u32,
    position_at: u32,
    position_format: u32,
    normal_at: u32,
    normal_format: u32,
    positions: u32,
    normals: u32,
}

struct Part {
    // Columns and translation, in f64: low word, high word.
    map: array<vec2<u32>, 12>,
    // Takes normals along, up to their length.
    across: mat3x3<f32>,
    // Bounds of the vertices before they are moved.
    low: vec3<f32>,
    first_position: u32,
    high: vec3<f32>,
    first_normal: u32,
    first_triangle: u32,
    first_node: u32,
    // Number among all parts that are written.
    number: u32,
    padding: u32,
}

struct Node {
    low: vec3<f32>,
    first: u32,
    high: vec3<f32>,
    count: u32,
}

@group(0) @binding(0) var<uniform> mesh: Mesh;
@group(0) @binding(1) var<storage, read> parts: array<Part>;
@group(0) @binding(2) var<storage, read> vertices: array<u32>;
// The vertex of each position; `NONE` for one that no triangle uses.
@group(0) @binding(3) var<storage, read> sources: array<u32>;
// The vertex of each normal, and the first corner of a triangle that has it.
@group(0) @binding(4) var<storage, read> normal_sources: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read_write> placed: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read_write> turned: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read> indices: array<u32>;
@group(0) @binding(9) var<storage, read> primitives: array<u32>;
// The number of levels, where each begins and the last one ends, and the nodes of each.
@group(0) @binding(10) var<storage, read> levels: array<u32>;
@group(0) @binding(11) var<storage, read_write> nodes: array<Node>;
// The first vertex of each part that lies beyond its bounds.
@group(0) @binding(12) var<storage, read_write> beyond: array<atomic<u32>>;

// The position and normal of each vertex, as bits.
@group(0) @binding(13) var<storage, read_write> at_rest: array<array<u32, 6>>;

// Positions of the scene's own parts before they are moved, as bits, and the number of the part.
@group(0) @binding(14) var<storage, read> own: array<vec4<u32>>;

const NONE = 0xffffffffu;
const NOT_A_NUMBER = 0x7fc00000u;
const INFINITE = 0x7f800000u;
const WIDTH = 256u;

@compute @workgroup_size(WIDTH)
fn place_positions(
    @builtin(global_invocation_id) thread: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    for (var i = thread.x; i < mesh.positions; i += WIDTH * groups.x) {
        if sources[i] != NONE {
            let at = moved(thread.y, position_bits(sources[i]));
            placed[parts[thread.y].first_position + i] = vec4(at, bitcast<u32>(1.0));
        }
    }
}

@compute @workgroup_size(WIDTH)
fn place_normals(
    @builtin(global_invocation_id) thread: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    for (var i = thread.x; i < mesh.normals; i += WIDTH * groups.x) {
        let source = normal_sources[i];
        var normal = vec3(0.0);
        if source.x != NONE {
            let own = normal_bits(source.x);
            normal = unit(parts[thread.y].across * bitcast<vec3<f32>>(own));
        }
        if all(normal == vec3(0.0)) {
            let corner = 3u * parts[thread.y].first_triangle + source.y;
            let a = positions[indices[corner]].xyz;
            let b = positions[indices[corner + 1u]].xyz - a;
            let c = positions[indices[corner + 2u]].xyz - a;
            normal = unit(cross(shortened(b), shortened(c)));
        }
        if all(normal == vec3(0.0)) {
            normal = vec3(0.0, 1.0, 0.0);
        }
        turned[parts[thread.y].first_normal + i] = vec4(normal, 0.0);
    }
}

@compute @workgroup_size(WIDTH)
fn fit_nodes(
    @builtin(local_invocation_id) thread: vec3<u32>,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    for (var level = 0u; level < levels[0]; level++) {
        for (var i = levels[1u + level] + thread.x; i < levels[2u + level]; i += WIDTH) {
            fit_node(parts[group.y].first_node + levels[i] - 1u);
        }
        storageBarrier();
    }
}

@compute @workgroup_size(WIDTH)
fn find_beyond(
    @builtin(global_invocation_id) thread: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let low = parts[thread.y].low;
    let high = parts[thread.y].high;
    for (var i = thread.x; i < mesh.positions; i += WIDTH * groups.x) {
        if sources[i] != NONE && !is_within(position_bits(sources[i]), low, high) {
            atomicMin(&beyond[parts[thread.y].number], sources[i]);
        }
    }
}

// Moves the scene's own parts, of which those that stay where they are have no number.
@compute @workgroup_size(WIDTH)
fn move_parts(
    @builtin(global_invocation_id) thread: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    for (var i = thread.x; i < arrayLength(&own); i += WIDTH * groups.x) {
        let at = own[i];
        if at.w != NONE && parts[at.w].number != NONE {
            placed[i] = vec4(moved(at.w, at.xyz), bitcast<u32>(1.0));
        }
    }
}

// Decodes the vertices at rest, of which `mesh.positions` is the number.
@compute @workgroup_size(WIDTH)
fn decode_rest(
    @builtin(global_invocation_id) thread: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    for (var i = thread.x; i < mesh.positions; i += WIDTH * groups.x) {
        let at = position_bits(i);
        let normal = normal_bits(i);
        at_rest[i] = array(at.x, at.y, at.z, normal.x, normal.y, normal.z);
    }
}

fn fit_node(index: u32) {
    let node = nodes[index];
    var low: vec3<f32>;
    var high: vec3<f32>;
    if node.count == 0u {
        low = min(nodes[node.first].low, nodes[node.first + 1u].low);
        high = max(nodes[node.first].high, nodes[node.first + 1u].high);
    } else {
        low = positions[indices[3u * primitives[node.first]]].xyz;
        high = low;
        for (var i = 0u; i < 3u * node.count; i++) {
            let corner = 3u * primitives[node.first + i / 3u] + i % 3u;
            low = min(low, positions[indices[corner]].xyz);
            high = max(high, positions[indices[corner]].xyz);
        }
    }
    nodes[index].low = low;
    nodes[index].high = high;
}

// By bits, since a shader may take it that no number is none.
fn is_within(at: vec3<u32>, low: vec3<f32>, high: vec3<f32>) -> bool {
    let own = bitcast<vec3<f32>>(at);
    return all((at & vec3(INFINITE)) != vec3(INFINITE)) && all(own >= low) && all(own <= high);
}

// The vector of length 1, or 0 if that has no direction.
fn unit(v: vec3<f32>) -> vec3<f32> {
    let short = shortened(v);
    let squared = dot(short, short);
    return select(vec3(0.0), short * inverseSqrt(squared), squared > 0.0);
}

// The vector with a largest coordinate of 1, so that no product leaves f32.
fn shortened(v: vec3<f32>) -> vec3<f32> {
    let largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    return select(vec3(0.0), v / largest, largest > 0.0);
}

// Where the map of a part takes a position, as bits of f32.
fn moved(part: u32, at: vec3<u32>) -> vec3<u32> {
    if any((at & vec3(INFINITE)) == vec3(INFINITE)) {
        return vec3(NOT_A_NUMBER);
    }
    return vec3(moved_along(part, 0u, at), moved_along(part, 1u, at), moved_along(part, 2u, at));
}

fn moved_along(part: u32, axis: u32, at: vec3<u32>) -> u32 {
    let x = times(double(parts[part].map[axis]), at.x);
    let y = times(double(parts[part].map[3u + axis]), at.y);
    let z = times(double(parts[part].map[6u + axis]), at.z);
    return single(plus(plus(plus(x, y), z), double(parts[part].map[9u + axis])));
}

// (high, low) · 2^exponent, where the two words are 0 or a number of 53 bits.
struct Double {
    is_negative: bool,
    exponent: i32,
    high: u32,
    low: u32,
}

// Of the bits of an f64. Those below 2^-1022 are 0: nothing of them is left in an f32.
fn double(bits: vec2<u32>) -> Double {
    let exponent = (bits.y >> 20u) & 0x7ffu;
    let is_negative = (bits.y >> 31u) == 1u;
    if exponent == 0u {
        return Double(is_negative, 0, 0u, 0u);
    }
    let high = (bits.y & 0xfffffu) | 0x100000u;
    return Double(is_negative, i32(exponent) - 1075, high, bits.x);
}

fn is_zero(a: Double) -> bool {
    return (a.high | a.low) == 0u;
}

// Rounded up by one unit of the 53 bits, or not.
fn rounded(a: Double, is_up: bool) -> Double {
    if !is_up {
        return a;
    }
    let low = a.low + 1u;
    let high = a.high + select(0u, 1u, low == 0u);
    if high == 0x200000u {
        return Double(a.is_negative, a.exponent + 1, 0x100000u, 0u);
    }
    return Double(a.is_negative, a.exponent, high, low);
}

fn product(a: u32, b: u32) -> vec2<u32> {
    let a0 = a & 0xffffu;
    let a1 = a >> 16u;
    let b0 = b & 0xffffu;
    let b1 = b >> 16u;
    let low = a0 * b0;
    let middle = a1 * b0 + (low >> 16u);
    let other = a0 * b1 + (middle & 0xffffu);
    return vec2((low & 0xffffu) | (other << 16u), a1 * b1 + (middle >> 16u) + (other >> 16u));
}

// Times an f32, as f64 has it.
fn times(a: Double, bits: u32) -> Double {
    let is_negative = a.is_negative != ((bits >> 31u) == 1u);
    var mantissa = bits & 0x7fffffu;
    var exponent = i32((bits >> 23u) & 0xffu) - 150;
    if exponent == -150 {
        let shift = countLeadingZeros(mantissa) - 8u;
        exponent = -149 - i32(shift);
        mantissa <<= shift & 31u;
    } else {
        mantissa |= 0x800000u;
    }
    if mantissa == 0u || is_zero(a) {
        return Double(is_negative, 0, 0u, 0u);
    }
    let below = product(a.low, mantissa);
    let above = product(a.high, mantissa);
    let middle = below.y + above.x;
    let top = above.y + select(0u, 1u, middle < below.y);
    // 76 or 77 bits.
    let shift = 23u + ((top >> 12u) & 1u);
    let rest = below.x & ((1u << shift) - 1u);
    let low = (below.x >> shift) | (middle << (32u - shift));
    let high = (middle >> shift) | (top << (32u - shift));
    let half = 1u << (shift - 1u);
    let is_up = rest > half || (rest == half && (low & 1u) == 1u);
    return rounded(Double(is_negative, a.exponent + exponent + i32(shift), high, low), is_up);
}

// The sum as f64 has it.
fn plus(a: Double, b: Double) -> Double {
    if is_zero(a) {
        return b;
    }
    if is_zero(b) {
        return a;
    }
    let is_less = a.exponent < b.exponent
        || (a.exponent == b.exponent
        && (a.high < b.high || (a.high == b.high && a.low < b.low)));
    if is_less {
        return sum(b, a);
    }
    return sum(a, b);
}

// Of the larger number and the smaller one.
fn sum(a: Double, b: Double) -> Double {
    // Ten bits more.
    let a_high = (a.high << 10u) | (a.low >> 22u);
    let a_low = a.low << 10u;
    let b_high = (b.high << 10u) | (b.low >> 22u);
    let small = lowered(b_high, b.low << 10u, u32(a.exponent - b.exponent));
    var high: u32;
    var low: u32;
    var exponent = a.exponent;
    if a.is_negative == b.is_negative {
        low = a_low + small.y;
        high = a_high + small.x + select(0u, 1u, low < a_low);
        if (high >> 31u) == 1u {
            low = (low >> 1u) | (high << 31u) | (low & 1u);
            high >>= 1u;
            exponent += 1;
        }
    } else {
        low = a_low - small.y;
        high = a_high - small.x - select(0u, 1u, a_low < small.y);
        if (high | low) == 0u {
            return Double(false, 0, 0u, 0u);
        }
        if high == 0u {
            high = low;
            low = 0u;
            exponent -= 32;
        }
        let shift = countLeadingZeros(high);
        if shift == 0u {
            low = (low >> 1u) | (high << 31u) | (low & 1u);
            high >>= 1u;
            exponent += 1;
        } else if shift > 1u {
            high = (high << (shift - 1u)) | (low >> (33u - shift));
            low <<= shift - 1u;
            exponent -= i32(shift) - 1;
        }
    }
    let rest = low & 1023u;
    let is_up = rest > 512u || (rest == 512u && (low & 1024u) != 0u);
    let short = Double(a.is_negative, exponent, high >> 10u, (low >> 10u) | (high << 22u));
    return rounded(short, is_up);
}

// A number of two words divided by a power of two; its last bit is 1 where others are lost.
fn lowered(high: u32, low: u32, by: u32) -> vec2<u32> {
    if by == 0u {
        return vec2(high, low);
    }
    if by < 32u {
        let lost = select(0u, 1u, (low << (32u - by)) != 0u);
        return vec2(high >> by, (low >> by) | (high << (32u - by)) | lost);
    }
    if by == 32u {
        return vec2(0u, high | select(0u, 1u, low != 0u));
    }
    if by < 64u {
        let lost = select(0u, 1u, (low | (high << (64u - by))) != 0u);
        return vec2(0u, (high >> (by - 32u)) | lost);
    }
    return vec2(0u, 1u);
}

// Rounded to f32, as bits.
fn single(a: Double) -> u32 {
    let sign = select(0u, 0x80000000u, a.is_negative);
    if is_zero(a) {
        return 0u;
    }
    let exponent = a.exponent + 179;
    let shift = u32(29 + max(0, 1 - exponent));
    if shift > 54u {
        return sign;
    }
    var whole: u32;
    var is_up: bool;
    if shift < 32u {
        let rest = a.low & ((1u << shift) - 1u);
        let half = 1u << (shift - 1u);
        whole = (a.low >> shift) | (a.high << (32u - shift));
        is_up = rest > half || (rest == half && (whole & 1u) == 1u);
    } else if shift == 32u {
        whole = a.high;
        is_up = a.low > 0x80000000u || (a.low == 0x80000000u && (whole & 1u) == 1u);
    } else {
        let rest = a.high & ((1u << (shift - 32u)) - 1u);
        let half = 1u << (shift - 33u);
        whole = a.high >> (shift - 32u);
        is_up = rest > half || (rest == half && (a.low != 0u || (whole & 1u) == 1u));
    }
    whole += select(0u, 1u, is_up);
    if exponent >= 255 {
        return sign | INFINITE;
    }
    return sign | (whole + select(0u, u32(exponent - 1) << 23u, exponent > 0));
}
