//! Masks: textures of one bit that say where a surface is opaque and where it has holes.
//!
//! Shaders and the oracle (the `f64` reference ray tracer) look up a mask by the same rule. The
//! texture coordinates at the weights of a triangle's corners are `uv_a + weight_b (uv_b - uv_a) +
//! weight_c (uv_c - uv_a)`. Each coordinate is wrapped into 0…1, multiplied by the mask's edge in
//! texels and rounded down, at most to the last texel. The surface exists where that texel of mip 0
//! is opaque. Shaders compute in f32, the oracle in f64.

use crate::texture::Wrap;
use glam::DVec2;

/// Mask of a surface: one bit per texel, set where the surface is opaque.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    /// Width and height in texels, neither 0.
    pub size: [u32; 2],
    /// Wrapping of the texture coordinates u and v outside 0…1, in this order.
    pub wrap: [Wrap; 2],
    /// Bits of all texels, 1 for opaque: row by row from the top left without gaps between rows, 32
    /// to a word, lowest bit first. Unused bits of the last word are 0.
    pub opaque: Vec<u32>,
}

/// Result of [`Mask::ask`]: the texel at the given texture coordinates, and a flag that tells if
/// their error may lead to another texel with another answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Asked {
    /// True if the texel at the texture coordinates is opaque.
    pub opaque: bool,
    /// True if a texel within the error of the texture coordinates has the opposite answer to
    /// [`opaque`](Self::opaque), or if more than 4,096 texels lie within the error.
    pub flips: bool,
}

/// The most texels that are looked at around a place; beyond them the mask counts as flipping.
const MOST_LOOKED_AT: f64 = 4096.0;

impl Mask {
    /// Creates a mask of `size` texels. `is_opaque` gets the column and row of a texel, from the
    /// top left.
    ///
    /// # Panics
    /// If the width or height is 0.
    pub fn new(size: [u32; 2], wrap: [Wrap; 2], is_opaque: impl Fn(u32, u32) -> bool) -> Self {
        assert!(size[0] > 0 && size[1] > 0, "a mask without texels");
        let texels = size[0] as usize * size[1] as usize;
        let mut opaque = vec![0; texels.div_ceil(32)];
        for y in 0..size[1] {
            for x in 0..size[0] {
                let texel = y as usize * size[0] as usize + x as usize;
                opaque[texel / 32] |= u32::from(is_opaque(x, y)) << (texel % 32);
            }
        }
        Self { size, wrap, opaque }
    }

    /// Creates a mask from a texture: opaque where `opacity` of a texel is at least `cutoff`.
    #[cfg(feature = "files")]
    pub(crate) fn from_texels(
        texels: &crate::texels::Texels,
        wrap: [Wrap; 2],
        opacity: impl Fn([u8; 4]) -> f32,
        cutoff: f32,
    ) -> Self {
        let width = texels.size[0] as usize;
        Self::new(texels.size, wrap, |x, y| {
            opacity(texels.rgba[y as usize * width + x as usize]) >= cutoff
        })
    }

    /// Returns true if all texels of the mask are opaque.
    pub fn is_solid(&self) -> bool {
        let texels = self.size[0] as usize * self.size[1] as usize;
        let opaque: u32 = self.opaque.iter().map(|word| word.count_ones()).sum();
        opaque as usize == texels
    }

    fn texel(&self, x: u32, y: u32) -> bool {
        let texel = y as usize * self.size[0] as usize + x as usize;
        self.opaque[texel / 32] >> (texel % 32) & 1 == 1
    }

    /// Returns true if the mask is a single texel, so that it needs no texture coordinates.
    pub fn is_uniform(&self) -> bool {
        self.size == [1, 1]
    }

    /// Looks up the mask at the texture coordinates `uv`. `error` is the greatest error of u and of
    /// v. In both, 1 is the mask's whole width or height.
    pub fn ask(&self, uv: DVec2, error: DVec2) -> Asked {
        let (uv, error) = (uv.to_array(), error.to_array());
        // Texels of each axis from low to high, before they are wrapped.
        let spans: [_; 2] = std::array::from_fn(|axis| {
            let size = f64::from(self.size[axis]);
            let low = ((uv[axis] - error[axis]) * size).floor();
            let high = ((uv[axis] + error[axis]) * size).floor();
            (low, high - low + 1.0)
        });
        let index = |axis: usize, texel: f64| {
            let at = (texel + 0.5) / f64::from(self.size[axis]);
            self.wrap[axis].texel(at, self.size[axis])
        };
        let own: [u32; 2] =
            std::array::from_fn(|axis| self.wrap[axis].texel(uv[axis], self.size[axis]));
        let opaque = self.texel(own[0], own[1]);
        let [(left, width), (top, height)] = spans;
        let few = width * height <= MOST_LOOKED_AT;
        let flips = !few
            || (0..height as u32).any(|row| {
                let y = index(1, top + f64::from(row));
                (0..width as u32)
                    .any(|column| self.texel(index(0, left + f64::from(column)), y) != opaque)
            });
        Asked { opaque, flips }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 × 2 texels, opaque at the top left and the bottom right.
    fn checkers(wrap: Wrap) -> Mask {
        Mask::new([2, 2], [wrap; 2], |x, y| x == y)
    }

    fn opaque(mask: &Mask, u: f64, v: f64) -> bool {
        mask.ask(DVec2::new(u, v), DVec2::ZERO).opaque
    }

    #[test]
    fn texels_are_the_nearest_ones_and_wrap() {
        let repeat = checkers(Wrap::Repeat);
        assert!(opaque(&repeat, 0.25, 0.25) && opaque(&repeat, 0.75, 0.75));
        assert!(!opaque(&repeat, 0.75, 0.25));
        // The edge belongs to the texel that it begins.
        assert!(!opaque(&repeat, 0.5, 0.25));
        assert!(opaque(&repeat, 1.25, -0.75));
        assert!(!opaque(&repeat, -0.25, 0.25));
        let mirror = checkers(Wrap::Mirror);
        assert!(opaque(&mirror, -0.25, 0.25) && !opaque(&mirror, 1.25, 0.25));
        assert!(opaque(&mirror, 1.75, 0.25) && opaque(&mirror, 2.25, 0.25));
        let clamp = checkers(Wrap::Clamp);
        assert!(opaque(&clamp, -7.0, 0.25) && opaque(&clamp, 1.0, 9.0));
        assert!(!opaque(&clamp, 9.0, 0.25));
        assert!(opaque(&repeat, f64::NAN, f64::INFINITY));
    }

    #[test]
    fn it_flips_where_another_texel_is_within_the_error() {
        let mask = checkers(Wrap::Repeat);
        let flips = |u: f64, error: f64| mask.ask(DVec2::new(u, 0.25), DVec2::splat(error)).flips;
        assert!(!flips(0.25, 0.24) && flips(0.25, 0.26));
        // Around the end as well, and over more texels than there are.
        assert!(flips(0.01, 0.02) && flips(0.25, 40.0) && flips(0.25, 1e9));
        assert!(flips(0.25, f64::INFINITY) && flips(0.25, f64::NAN));
        let solid = Mask::new([3, 5], [Wrap::Clamp; 2], |_, _| true);
        assert!(solid.is_solid() && !mask.is_solid());
        assert!(!solid.ask(DVec2::splat(0.3), DVec2::splat(0.5)).flips);
    }
}
