// A list of pixels that have a ray, 4 bytes for each: the pixel's place, row by row, and in the two
// bits above it what became of the ray. A place takes 30 bits: textures of up to 32,768 pixels
// across.

#import "shared/ids.wgsl"

const PLACE: u32 = 0x3fffffffu;
const HAS_HIT: u32 = 0x40000000u;
const HAS_NO_ANSWER: u32 = 0x80000000u;
// Both bits: the ray is traced, and changes no pixel.
const IGNORED: u32 = 0xc0000000u;

// Returns the bits that a hit adds to the entry of its ray; an ignored entry stays so.
fn outcome_bits(primitive: u32) -> u32 {
    let bits = select(HAS_HIT, 0u, primitive == NO_PRIMITIVE);
    return select(bits, HAS_NO_ANSWER, primitive == UNANSWERED);
}

fn listed_pixel(entry: u32, width: u32) -> vec2<u32> {
    return divided(entry & PLACE, width).yx;
}

// Returns the quotient, below 2^20, and the remainder of numbers below 2^31. A quotient of floats
// is off by one at most; some adapters divide integers one by one.
fn divided(a: u32, b: u32) -> vec2<u32> {
    let near = u32(f32(a) / f32(b));
    let rest = i32(a - near * b);
    let quotient = select(near + select(0u, 1u, rest >= i32(b)), near - 1u, rest < 0);
    return vec2(quotient, a - quotient * b);
}
