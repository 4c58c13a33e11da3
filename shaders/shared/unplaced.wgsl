// Depths in 0..1 as numbers that grow towards the light, 1 at the far end: atomics know the largest
// integer, and a cleared one is no depth.

const FAR_END: u32 = 0x3f800001u; // a bit more than those of 1.0

fn nearness(depth: f32) -> u32 {
    return FAR_END - bitcast<u32>(depth);
}

fn depth_of_nearness(nearness: u32) -> f32 {
    return bitcast<f32>(FAR_END - nearness);
}
