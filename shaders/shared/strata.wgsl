// Points spread over a disk, one in each of some parts of equal area.
// crates/reference/src/strata.rs has the same parts, and other points in them.

// A point in part `index` of `count` of the unit square: columns as wide as they have rows.
fn stratum_point(index: u32, count: u32, jitter: vec2<f32>) -> vec2<f32> {
    let columns = u32(round(sqrt(f32(count))));
    // The column that begins at or before the part: part c * count / columns is its first.
    let column = quotient((index + 1u) * columns + count - 1u, count) - 1u;
    let first = quotient(column * count, columns);
    let rows = quotient((column + 1u) * count, columns) - first;
    return vec2(
        (f32(first) + jitter.x * f32(rows)) / f32(count),
        (f32(index - first) + jitter.y) / f32(rows),
    );
}

// a / b of numbers below 2^20, to the bit: with the half it is farther from any whole number than a
// division errs. Some adapters divide integers one by one.
fn quotient(a: u32, b: u32) -> u32 {
    return u32((f32(a) + 0.5) / f32(b));
}

// The point of the unit disk that a pixel's sample goes to, one of `count`.
fn sample_point(pixel: u32, sample: u32, count: u32) -> vec2<f32> {
    return disk_point(stratum_point(sample, count, random_pair(pixel, sample)));
}

// From the unit square to the unit disk; parts of equal area stay so. Shirley, Chiu, "A Low
// Distortion Map Between Disk and Square", JGT 2(3), 1997.
fn disk_point(square: vec2<f32>) -> vec2<f32> {
    const QUARTER: f32 = 0.78539816;
    let at = 2.0 * square - 1.0;
    let is_wide = abs(at.x) > abs(at.y);
    let radius = select(at.y, at.x, is_wide);
    let across = select(at.x, at.y, is_wide);
    let angle = QUARTER * (across / select(radius, 1.0, radius == 0.0));
    let point = radius * cosine_and_sine(angle);
    return select(point.yx, point, is_wide);
}

// The cosine and the sine of an angle up to a quarter of pi, by Taylor's series, which leave out
// less than half an ulp of 1. WGSL's own may be off by 2^-11, and take longer.
fn cosine_and_sine(angle: f32) -> vec2<f32> {
    let s = angle * angle;
    let cosine = 1.0 + s * (-1.0 / 2.0 + s * (1.0 / 24.0 + s * (-1.0 / 720.0 + s / 40320.0)));
    let sine = 1.0 + s * (-1.0 / 6.0 + s * (1.0 / 120.0 + s * (-1.0 / 5040.0 + s / 362880.0)));
    return vec2(cosine, angle * sine);
}

// Two numbers in 0..1, others for every pixel and sample: pcg3d of Jarzynski, Olano, "Hash
// Functions for GPU Rendering", JCGT 9(3), 2020.
fn random_pair(pixel: u32, sample: u32) -> vec2<f32> {
    var v = vec3(pixel, sample, 0u) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    // 24 bits: all that a float below 1 can tell.
    return vec2<f32>(v.xy >> vec2(8u)) / 16777216.0;
}
