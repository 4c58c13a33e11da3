//! Generated masks for meshes whose textures are not available.

use crate::{mask::Mask, texture::Wrap};
use serde::{Deserialize, Serialize};

/// Pattern of a generated mask of 128 × 128 texels, which repeats without a seam. It replaces a
/// texture that is not available.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Pattern {
    /// Leaves on twigs; about half of the texels are holes.
    Leaves,
    /// A vertical chain of ring-shaped links.
    Links,
}

/// Texels along an edge.
const SIZE: u32 = 128;

impl Pattern {
    /// Creates the mask with this pattern.
    pub fn mask(self) -> Mask {
        Mask::new([SIZE; 2], [Wrap::Repeat; 2], |x, y| {
            let at = |texel: u32| (f64::from(texel) + 0.5) / f64::from(SIZE);
            match self {
                Self::Leaves => is_leaf(at(x), at(y)),
                Self::Links => is_link(at(x), at(y)),
            }
        })
    }
}

/// The nearer way from one place to another where 1 is 0 again.
fn around(from: f64, to: f64) -> f64 {
    let way = to - from;
    way - way.round()
}

fn is_leaf(u: f64, v: f64) -> bool {
    // Four rows of leaves that point up to the left and up to the right in turn.
    const ROWS: u32 = 4;
    let twig = around(0.5, u).abs() < 0.02;
    let leaf = |row: u32, column: u32| {
        let across = around((f64::from(column) + 0.5) / f64::from(ROWS), u);
        let shift = if column.is_multiple_of(2) { 0.0 } else { 0.5 };
        let along = around((f64::from(row) + shift) / f64::from(ROWS), v);
        let is_even = (row + column).is_multiple_of(2);
        let side = if is_even { 1.0 } else { -1.0 };
        // Turned by the angle of the Pythagorean triangle 3, 4, 5.
        let p = 0.8 * across + side * 0.6 * along;
        let q = 0.8 * along - side * 0.6 * across;
        (p / 0.15).powi(2) + (q / 0.07).powi(2) < 1.0
    };
    twig || (0..ROWS).any(|row| (0..ROWS).any(|column| leaf(row, column)))
}

fn is_link(u: f64, v: f64) -> bool {
    const LINKS: u32 = 4;
    (0..LINKS).any(|link| {
        let across = around(0.5, u) / 0.35;
        let along = around((f64::from(link) + 0.5) / f64::from(LINKS), v) / 0.17;
        (0.35..1.0).contains(&(across * across + along * along))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn about_half_of_a_pattern_is_there() {
        for pattern in [Pattern::Leaves, Pattern::Links] {
            let opaque: u32 = pattern
                .mask()
                .opaque
                .iter()
                .map(|word| word.count_ones())
                .sum();
            let share = f64::from(opaque) / f64::from(SIZE * SIZE);
            assert!((0.3..0.75).contains(&share), "{pattern:?} {share}");
        }
    }
}
