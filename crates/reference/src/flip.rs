//! FLIP of two pictures: how large an observer finds the difference when the two alternate.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: *FLIP: A Difference Evaluator
//! for Alternating Images*, HPG 2020 (sections 4.1 to 4.3), for pictures of low dynamic range.

use crate::{error::Error, image::Image};
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Pixels per degree of the paper's observer: 0.7 m before a display that is 0.7 m and 3,840 pixels
/// wide.
const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * PI / 180.0;

/// Exponent and knee of the colour difference, section 4.1.3.
const COLOUR_EXPONENT: f64 = 0.7;
const KNEE_FROM: f64 = 0.4;
const KNEE_TO: f64 = 0.95;
/// Exponent of the feature difference, and the width of a feature in degrees, section 4.2.
const FEATURE_EXPONENT: f64 = 0.5;
const FEATURE_WIDTH: f64 = 0.082;

/// Linear sRGB to CIE XYZ, its inverse, and the white of both.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_386_563, 0.357_591_491, 0.180_450_491],
    [0.212_636_822, 0.715_182_982, 0.072_180_196],
    [0.019_330_620, 0.119_197_164, 0.950_372_587],
];
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];
const WHITE: [f64; 3] = [0.950_428_545, 1.0, 1.088_900_371];

/// Terms of a channel's contrast sensitivity, (a, b) of table 1: luminance, red-green, blue-yellow.
const SENSITIVITY: [&[(f64, f64)]; 3] = [
    &[(1.0, 0.0047)],
    &[(1.0, 0.0053)],
    &[(34.1, 0.04), (13.5, 0.025)],
];
const WIDEST: f64 = 0.04;

type Colour = [f64; 3];

/// Returns the FLIP error of the picture `test` against the picture `reference`: the mean over all
/// pixels, from 0 (alike) to 1, for an observer who sees 67 pixels per degree. 0 for pictures
/// without pixels.
///
/// # Errors
/// [`Error::PixelCount`] if the pictures differ in size.
pub fn flip(reference: &Image, test: &Image) -> Result<f64, Error> {
    let expected = u64::from(reference.size[0]) * u64::from(reference.size[1]);
    if test.size != reference.size || test.rgb.len() != reference.rgb.len() {
        return Err(Error::PixelCount {
            name: "picture",
            viewport: reference.size,
            expected,
            actual: (test.rgb.len() / 3) as u64,
        });
    }
    if reference.rgb.is_empty() {
        return Ok(0.0);
    }
    let (reference, test) = rayon::join(|| Seen::new(reference), || Seen::new(test));
    // That of green and blue.
    let greatest = colour_difference(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0]));
    let each = (0..reference.colours.len()).into_par_iter().map(|pixel| {
        let colour = colour_difference(reference.colours[pixel], test.colours[pixel]);
        let colour = beyond_knee(colour, greatest);
        let feature = |map: fn(&Seen) -> &[f64]| (map(&reference)[pixel] - map(&test)[pixel]).abs();
        let feature = feature(|seen| &seen.edges).max(feature(|seen| &seen.points));
        let feature = (FRAC_1_SQRT_2 * feature).powf(FEATURE_EXPONENT);
        colour.powf(1.0 - feature)
    });
    // Summed in order, so that the result is the same on any number of cores.
    let each: Vec<f64> = each.collect();
    Ok(each.iter().sum::<f64>() / each.len() as f64)
}

/// A picture as an observer sees it.
struct Seen {
    /// Filtered by the contrast sensitivity, L*a*b* with Hunt's adjustment.
    colours: Vec<Colour>,
    /// How strong an edge each pixel is on.
    edges: Vec<f64>,
    /// How strong a point or line it is.
    points: Vec<f64>,
}

impl Seen {
    fn new(image: &Image) -> Self {
        let size = image.size.map(|edge| edge as usize);
        let pixels = image.rgb.chunks_exact(3);
        let opponent: Vec<Colour> = pixels
            .map(|rgb| {
                let linear = std::array::from_fn(|channel| linear(f64::from(rgb[channel]) / 255.0));
                let [x, y, z] = relative_xyz(linear);
                [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
            })
            .collect();
        let channel =
            |index: usize| -> Vec<f64> { opponent.iter().map(|colour| colour[index]).collect() };
        let filtered: Vec<Vec<f64>> = (0..3)
            .into_par_iter()
            .map(|index| filtered(&channel(index), size, SENSITIVITY[index]))
            .collect();
        let colours = (0..opponent.len())
            .map(|pixel| hunt(&std::array::from_fn(|index| filtered[index][pixel])))
            .collect();
        let luminance: Vec<f64> = channel(0).iter().map(|y| (y + 16.0) / 116.0).collect();
        let [edges, points] = features(&luminance, size);
        Self {
            colours,
            edges,
            points,
        }
    }
}

/// A channel, blurred as far as the eye is blind to its detail.
fn filtered(channel: &[f64], size: [usize; 2], terms: &[(f64, f64)]) -> Vec<f64> {
    let deviation = (WIDEST / (2.0 * PI * PI)).sqrt();
    let radius = (3.0 * deviation * PIXELS_PER_DEGREE).ceil() as i32;
    let mut sum = vec![0.0; channel.len()];
    let mut whole = 0.0;
    for &(a, b) in terms {
        let gauss = kernel(radius, |at| {
            let degrees = at / PIXELS_PER_DEGREE;
            (-PI * PI * degrees * degrees / b).exp()
        });
        let weight = a * (PI / b).sqrt();
        whole += weight * gauss.iter().sum::<f64>().powi(2);
        let blurred = convolved(channel, size, &gauss, &gauss);
        for (sum, blurred) in sum.iter_mut().zip(blurred) {
            *sum += weight * blurred;
        }
    }
    sum.iter_mut().for_each(|value| *value /= whole);
    sum
}

/// Strengths of edges and of points: lengths of the first and second derivatives.
fn features(luminance: &[f64], size: [usize; 2]) -> [Vec<f64>; 2] {
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let bell = |at: f64| (-at * at / (2.0 * deviation * deviation)).exp();
    let mut smooth = kernel(radius, bell);
    balance(&mut smooth);
    let first = |at: f64| -at * bell(at);
    let second = |at: f64| (at * at / (deviation * deviation) - 1.0) * bell(at);
    let strength = |derivative: &(dyn Fn(f64) -> f64 + Sync)| {
        let mut derivative = kernel(radius, derivative);
        balance(&mut derivative);
        let across = convolved(luminance, size, &derivative, &smooth);
        let down = convolved(luminance, size, &smooth, &derivative);
        across.iter().zip(down).map(|(x, y)| x.hypot(y)).collect()
    };
    let (edges, points) = rayon::join(|| strength(&first), || strength(&second));
    [edges, points]
}

fn kernel(radius: i32, value: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|at| value(f64::from(at))).collect()
}

/// Positive weights sum up to 1, negative ones to −1.
fn balance(kernel: &mut [f64]) {
    let sum = |sign: f64| {
        let weights = kernel.iter().map(|weight| (sign * weight).max(0.0));
        weights.sum::<f64>()
    };
    let (positive, negative) = (sum(1.0), sum(-1.0));
    for weight in kernel {
        *weight /= if *weight > 0.0 {
            positive
        } else {
            negative.max(f64::MIN_POSITIVE)
        };
    }
}

/// Convolved along x, then along y; beyond its border a picture goes on as it ends.
fn convolved(channel: &[f64], [width, height]: [usize; 2], x: &[f64], y: &[f64]) -> Vec<f64> {
    let across = along(channel, [width, height], [1, width], x);
    along(&across, [height, width], [width, 1], y)
}

/// Convolved along lines: `length` values each, `step` apart; `lines` of them, `next` apart.
fn along(
    values: &[f64],
    [length, lines]: [usize; 2],
    [step, next]: [usize; 2],
    kernel: &[f64],
) -> Vec<f64> {
    let radius = kernel.len() / 2;
    let mut convolved = vec![0.0; values.len()];
    for line in 0..lines {
        for at in 0..length {
            let sum = kernel.iter().enumerate().map(|(index, weight)| {
                let from = (at + index).saturating_sub(radius).min(length - 1);
                weight * values[line * next + from * step]
            });
            convolved[line * next + at * step] = sum.sum();
        }
    }
    convolved
}

/// Returns the linear share of a number that is encoded by the transfer function of sRGB (IEC
/// 61966-2-1).
pub fn linear(srgb: f64) -> f64 {
    if srgb <= 0.04045 {
        srgb / 12.92
    } else {
        ((srgb + 0.055) / 1.055).powf(2.4)
    }
}

fn product(matrix: &[[f64; 3]; 3], vector: Colour) -> Colour {
    matrix.map(|row| row.iter().zip(vector).map(|(m, v)| m * v).sum())
}

/// XYZ in units of the white's.
fn relative_xyz(linear: Colour) -> Colour {
    let xyz = product(&XYZ_FROM_RGB, linear);
    std::array::from_fn(|index| xyz[index] / WHITE[index])
}

/// From filtered opponent colours to L*a*b* whose hues fade where it is dark.
fn hunt([y, cx, cz]: &Colour) -> Colour {
    let y = (y + 16.0) / 116.0;
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    let xyz = std::array::from_fn(|index| relative[index] * WHITE[index]);
    let linear = product(&RGB_FROM_XYZ, xyz).map(|value| value.clamp(0.0, 1.0));
    hunt_lab(linear)
}

fn hunt_lab(linear: Colour) -> Colour {
    let [x, y, z] = relative_xyz(linear).map(|value| {
        let delta: f64 = 6.0 / 29.0;
        if value > delta.powi(3) {
            value.cbrt()
        } else {
            value / (3.0 * delta * delta) + 4.0 / 29.0
        }
    });
    let lightness = 116.0 * y - 16.0;
    let fade = 0.01 * lightness;
    [lightness, fade * 500.0 * (x - y), fade * 200.0 * (y - z)]
}

/// The distance HyAB (Abasi, Tehran, Fairchild 2020) to the power that FLIP takes of it.
fn colour_difference(one: Colour, other: Colour) -> f64 {
    let [lightness, a, b]: Colour = std::array::from_fn(|index| one[index] - other[index]);
    (lightness.abs() + a.hypot(b)).powf(COLOUR_EXPONENT)
}

/// Most of the range for the differences that are frequent.
fn beyond_knee(difference: f64, greatest: f64) -> f64 {
    let knee = KNEE_FROM * greatest;
    let scaled = if difference < knee {
        KNEE_TO * difference / knee
    } else {
        KNEE_TO + (difference - knee) / (greatest - knee) * (1.0 - KNEE_TO)
    };
    // Rounding may leave the greatest one a hair above.
    scaled.min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uniform(colour: [u8; 3]) -> Image {
        let size = [24, 16];
        let rgb = colour.repeat(24 * 16);
        Image { size, rgb }
    }

    /// A picture of noise, the same everywhere: a linear congruential generator.
    fn noise(seed: u32) -> Image {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let rgb = (0..64 * 48 * 3).map(|_| next()).collect();
        Image {
            size: [64, 48],
            rgb,
        }
    }

    /// A grey ramp with a black square, as the reference; with the square moved and blurred bars.
    fn squares() -> [Image; 2] {
        let picture = |left: u32, bar: u32| {
            let mut rgb = Vec::new();
            for y in 0..48u32 {
                for x in 0..64u32 {
                    let inside = (left..left + 16).contains(&x) && (16..32).contains(&y);
                    let level = if inside {
                        0
                    } else {
                        64 + 2 * x + bar * (y % 2)
                    };
                    rgb.extend([level as u8; 3]);
                }
            }
            Image {
                size: [64, 48],
                rgb,
            }
        };
        [picture(20, 0), picture(23, 9)]
    }

    #[test]
    fn uniform_pictures_differ_by_their_colour_alone() {
        let difference = |one, other| flip(&uniform(one), &uniform(other)).unwrap();
        assert_eq!(difference([90, 20, 200], [90, 20, 200]), 0.0);
        // The two colours that are farthest apart.
        assert!((difference([0, 255, 0], [0, 0, 255]) - 1.0).abs() < 1e-9);
        // Black and white: L* is 0 and 100, so HyAB is 100, whose power 0.7 is 25.119. Green has
        // L* 87.735, a* −86.183, b* 83.180; blue 32.299, 79.191, −107.865; both with Hunt's
        // adjustment: HyAB 205.3 or so, whose power is 41.5. 25.119 lies beyond the knee at 16.6:
        // 0.95 + 0.05 · (25.119 − 16.6) / (41.5 − 16.6) = 0.967.
        assert!((difference([0; 3], [255; 3]) - 0.967).abs() < 2e-3);
    }

    #[test]
    fn figures_are_those_of_the_authors_program() {
        // flip-evaluator 1.7 of NVIDIA, `evaluate(reference, test, "LDR")`, on these pictures.
        let [reference, test] = squares();
        assert!((flip(&reference, &test).unwrap() - 0.130_109).abs() < 2e-5);
        assert!((flip(&noise(1), &noise(2)).unwrap() - 0.431_583).abs() < 2e-5);
    }

    #[test]
    fn pictures_of_two_sizes_are_an_error_and_an_empty_one_is_none() {
        let empty = Image {
            size: [0, 4],
            rgb: Vec::new(),
        };
        assert_eq!(flip(&empty, &empty), Ok(0.0));
        assert!(flip(&empty, &uniform([0; 3])).is_err());
    }
}
