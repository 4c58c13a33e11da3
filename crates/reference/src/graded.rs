//! Errors of soft-shadow pictures, whose pixels show shares of light, against the reference.

use crate::error::Error;
use crate::flip::flip;
use crate::ground_truth::GroundTruthPixels;
use crate::image::{Image, error};
use crate::pixels::check_pixel_count;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Comparison with the reference of a soft-shadow method's picture, whose visibility at each pixel
/// is the share of the light that arrives, 0 in shadow to 1 in light.
///
/// Only pixels that face the light by the reference (PFL) are judged; no light arrives at other
/// pixels, whatever their visibility. The *error* of a pixel is its visibility minus the
/// reference's share. Values outside of 0 to 1, infinities included, are counted in `invalid`, and
/// clamped before they are judged, as a texture of 0 to 1 would hold them. NaN counts as an error
/// of size 1: too light below a share of one half, too dark from one half on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Graded {
    /// Root mean squared error over the PFL pixels (those that face the light), 0 to 1. As every
    /// mean here it is 0 over no pixels.
    pub rmse: f64,
    /// Root mean squared error over the PFL pixels (those that face the light) that are not
    /// indeterminate ([`GroundTruthPixels::indeterminate`]). At an indeterminate pixel f32 may find
    /// another answer than the reference does.
    pub rmse_outside_band: f64,
    /// Mean absolute error over the PFL pixels (those that face the light), 0 to 1.
    pub mean_absolute_error: f64,
    /// Number of PFL pixels (those that face the light) whose error exceeds each of three bounds.
    pub off: OffBy,
    /// [FLIP](crate::flip) error of the picture that [`Image::shaded`] draws with the method's
    /// visibility, against the one with the reference's, 0 to 1: the mean over all pixels.
    pub flip: f64,
    /// Number of PFL pixels (those that face the light) whose visibility is not a share: NaN,
    /// infinite, or outside of 0 to 1.
    pub invalid: Invalid,
    /// Errors in the umbra, in the penumbra and in the light of the reference.
    pub soft: SoftErrors,
}

/// Errors of a soft-shadow picture, separately for the reference's umbra, penumbra and light. Light
/// in the umbra is seen as a leak, dark in the light as a stain, and an error in the penumbra
/// hardly at all. Covers pixels that face the light (PFL) and are not indeterminate
/// ([`GroundTruthPixels::indeterminate`]). A mean over no pixels is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SoftErrors {
    /// Number of pixels in the umbra: by the reference they see less than a tenth of the light.
    pub umbra: u64,
    /// Mean over the umbra pixels of the excess of the shown share over the reference's; a share
    /// that is too small counts as 0.
    pub light_in_umbra: f64,
    /// Number of pixels in the light: by the reference they see more than nine tenths of it.
    pub light: u64,
    /// Mean over the pixels in the light of the lack of the shown share below the reference's; a
    /// share that is too large counts as 0.
    pub dark_in_light: f64,
    /// Number of pixels in the penumbra: by the reference they see a tenth to nine tenths of the
    /// light.
    pub penumbra: u64,
    /// Root mean squared error of the share of light, over the pixels in the penumbra.
    pub penumbra_rmse: f64,
    /// Mean signed error of the share of light, over the pixels in the penumbra: positive if the
    /// picture is too light.
    pub penumbra_bias: f64,
}

/// The shares between which a pixel is in the penumbra.
const PENUMBRA: RangeInclusive<f32> = 0.1..=0.9;

impl SoftErrors {
    /// The errors of one pixel, too light by `off`.
    fn of_pixel(share: f32, off: f64) -> Self {
        let mut errors = Self::default();
        if PENUMBRA.contains(&share) {
            (errors.penumbra, errors.penumbra_rmse, errors.penumbra_bias) = (1, off.abs(), off);
        } else if share < *PENUMBRA.start() {
            (errors.umbra, errors.light_in_umbra) = (1, off.max(0.0));
        } else {
            (errors.light, errors.dark_in_light) = (1, (-off).max(0.0));
        }
        errors
    }

    /// Adds errors to sums, those of squares among them, until [`means`](Self::means).
    fn add(&mut self, errors: Self) {
        self.umbra += errors.umbra;
        self.light_in_umbra += errors.light_in_umbra * errors.umbra as f64;
        self.light += errors.light;
        self.dark_in_light += errors.dark_in_light * errors.light as f64;
        self.penumbra += errors.penumbra;
        self.penumbra_rmse += errors.penumbra_rmse.powi(2) * errors.penumbra as f64;
        self.penumbra_bias += errors.penumbra_bias * errors.penumbra as f64;
    }

    fn means(mut self) -> Self {
        let count = |pixels: u64| pixels.max(1) as f64;
        self.light_in_umbra /= count(self.umbra);
        self.dark_in_light /= count(self.light);
        self.penumbra_rmse = (self.penumbra_rmse / count(self.penumbra)).sqrt();
        self.penumbra_bias /= count(self.penumbra);
        self
    }
}

/// Number of pixels that face the light (PFL) and whose share of light differs from the reference's
/// by more than a bound. Each count includes the counts for larger bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct OffBy {
    /// Pixels with an error of size above 1/255, the smallest step that 8 bits can show.
    pub over_1_255: u64,
    /// Pixels with an error of size above 1/16.
    pub over_1_16: u64,
    /// Pixels with an error of size above 1/4.
    pub over_1_4: u64,
}

/// Number of pixels that face the light (PFL) and whose visibility in a method's picture is not a
/// share of light from 0 to 1, by kind of value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Invalid {
    /// Pixels with the visibility NaN.
    pub nan: u64,
    /// Pixels with the visibility ∞ or −∞.
    pub infinite: u64,
    /// Pixels with a finite visibility below 0 or above 1.
    pub outside: u64,
}

impl Invalid {
    /// Returns the number of all pixels that `self` counts.
    pub fn total(&self) -> u64 {
        self.nan + self.infinite + self.outside
    }

    fn add(&mut self, share: f32) {
        self.nan += u64::from(share.is_nan());
        self.infinite += u64::from(share.is_infinite());
        self.outside += u64::from(share.is_finite() && !(0.0..=1.0).contains(&share));
    }
}

/// Numbers of pixels over which the errors of one picture are averaged; [`Graded::together`]
/// weights pictures by them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JudgedPixels {
    /// Number of pixels that face the light (PFL).
    pub facing_light: u64,
    /// Number of PFL pixels (those that face the light) that are indeterminate
    /// ([`GroundTruthPixels::indeterminate`]).
    pub in_band: u64,
}

impl Graded {
    /// Judges a method's `visibility` against the reference's `shares`
    /// ([`GroundTruth::shares`](crate::GroundTruth::shares)), both one value per pixel, row by row
    /// from the top left. `truth` says which pixels face the light, and which of them are
    /// indeterminate.
    ///
    /// # Errors
    /// [`Error::PixelCount`] if a buffer does not have one value per pixel of `truth`.
    pub fn judged(
        visibility: &[f32],
        shares: &[f32],
        truth: &GroundTruthPixels,
    ) -> Result<Self, Error> {
        check_pixel_count("visibility", truth.viewport, visibility.len())?;
        check_pixel_count("shares", truth.viewport, shares.len())?;
        let mut graded = Self::default();
        let (mut facing, mut squares) = (0u64, 0.0);
        let (mut in_band, mut squares_in_band) = (0u64, 0.0);
        let classes = truth.classes.iter().zip(&truth.indeterminate);
        for ((&shown, &share), (class, &indeterminate)) in
            visibility.iter().zip(shares).zip(classes)
        {
            if !class.faces_light() {
                continue;
            }
            graded.invalid.add(shown);
            let signed = error(shown, share);
            let off = signed.abs();
            facing += 1;
            squares += off * off;
            if indeterminate {
                in_band += 1;
                squares_in_band += off * off;
            } else {
                graded.soft.add(SoftErrors::of_pixel(share, signed));
            }
            graded.mean_absolute_error += off;
            graded.off.over_1_255 += u64::from(off > 1.0 / 255.0);
            graded.off.over_1_16 += u64::from(off > 1.0 / 16.0);
            graded.off.over_1_4 += u64::from(off > 1.0 / 4.0);
        }
        let outside = (facing - in_band).max(1) as f64;
        graded.rmse_outside_band = ((squares - squares_in_band).max(0.0) / outside).sqrt();
        let facing = facing.max(1) as f64;
        graded.rmse = (squares / facing).sqrt();
        graded.mean_absolute_error /= facing;
        graded.soft = graded.soft.means();
        let right = Image::shaded(shares, truth)?;
        graded.flip = flip(&right, &Image::shaded(visibility, truth)?)?;
        Ok(graded)
    }

    /// Returns the errors of several pictures together, each given with the numbers of its pixels:
    /// counts are added, means are taken over all their pixels. FLIP is the mean over the pictures.
    pub fn together(pictures: impl IntoIterator<Item = (Self, JudgedPixels)>) -> Self {
        let mut total = Self::default();
        let (mut count, mut facing, mut outside) = (0.0, 0.0, 0.0);
        for (graded, pixels) in pictures {
            // Field by field: one that is left out does not compile.
            let Self {
                rmse,
                rmse_outside_band,
                mean_absolute_error,
                off,
                flip,
                invalid,
                soft,
            } = graded;
            total.soft.add(soft);
            let of_facing = pixels.facing_light as f64;
            let of_outside = pixels.facing_light.saturating_sub(pixels.in_band) as f64;
            count += 1.0;
            facing += of_facing;
            outside += of_outside;
            // Sums of squares until all are there.
            total.rmse += rmse * rmse * of_facing;
            total.rmse_outside_band += rmse_outside_band * rmse_outside_band * of_outside;
            total.mean_absolute_error += mean_absolute_error * of_facing;
            total.off += off;
            total.flip += flip;
            total.invalid += invalid;
        }
        total.rmse = (total.rmse / f64::max(facing, 1.0)).sqrt();
        total.rmse_outside_band = (total.rmse_outside_band / f64::max(outside, 1.0)).sqrt();
        total.mean_absolute_error /= f64::max(facing, 1.0);
        total.flip /= f64::max(count, 1.0);
        total.soft = total.soft.means();
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Class;
    use proptest::prelude::*;

    /// The last pixel is indeterminate.
    fn truth(classes: &[Class]) -> GroundTruthPixels {
        let last = classes.len() - 1;
        GroundTruthPixels {
            viewport: [classes.len() as u32, 1],
            classes: classes.to_vec(),
            indeterminate: (0..=last).map(|pixel| pixel == last).collect(),
            n_dot_l: vec![0.5; classes.len()],
            base_colors: Vec::new(),
        }
    }

    #[test]
    fn errors_are_means_over_the_pixels_that_face_the_light() {
        use Class::{Background, FacingAway, Lit, Shadow};
        let truth = truth(&[Shadow, Lit, Lit, FacingAway, Background, Lit]);
        let shares = [0.0, 0.75, 0.5, 0.0, 0.0, 1.0];
        let shown = [0.5, 0.75, 0.4, 1.0, 1.0, 1.0];
        let graded = Graded::judged(&shown, &shares, &truth).unwrap();
        // Errors 0.5, 0, −0.1, and 0 in the band.
        assert!((graded.rmse_outside_band - (0.26f64 / 3.0).sqrt()).abs() < 1e-7);
        assert!(
            (graded.rmse - (0.26f64 / 4.0).sqrt()).abs() < 1e-7,
            "{graded:?}"
        );
        assert!((graded.mean_absolute_error - 0.15).abs() < 1e-7);
        let off = OffBy {
            over_1_255: 2,
            over_1_16: 2,
            over_1_4: 1,
        };
        assert_eq!((graded.off, graded.invalid.total()), (off, 0));
        assert!(graded.flip > 0.0);
        // By hand: in the umbra 0.5 too light; in the penumbra 0 and −0.1; in the light nothing is
        // left, its pixel is in the band.
        let soft = graded.soft;
        assert_eq!([soft.umbra, soft.penumbra, soft.light], [1, 2, 0]);
        assert!((soft.light_in_umbra - 0.5).abs() < 1e-7, "{soft:?}");
        assert!((soft.penumbra_rmse - 0.005f64.sqrt()).abs() < 1e-7);
        assert!((soft.penumbra_bias + 0.05).abs() < 1e-7);
        assert_eq!(soft.dark_in_light, 0.0);
        let right = Graded::judged(&shares, &shares, &truth).unwrap();
        let soft = SoftErrors {
            umbra: 1,
            penumbra: 2,
            ..SoftErrors::default()
        };
        assert_eq!(
            right,
            Graded {
                soft,
                ..Graded::default()
            }
        );
        assert!(Graded::judged(&shares[1..], &shares, &truth).is_err());
    }

    #[test]
    fn pictures_together_are_as_one_of_all_their_pixels() {
        // The last pixel of each picture is in the band; that of the whole one is put there.
        let judged = |shown: &[f32], in_band: &[usize]| {
            let mut truth = truth(&vec![Class::Lit; shown.len()]);
            for &pixel in in_band {
                truth.indeterminate[pixel] = true;
            }
            let in_band = truth.indeterminate.iter().filter(|it| **it).count();
            let right = vec![1.0; shown.len()];
            let graded = Graded::judged(shown, &right, &truth).unwrap();
            let pixels = JudgedPixels {
                facing_light: shown.len() as u64,
                in_band: in_band as u64,
            };
            (graded, pixels)
        };
        let parts = [judged(&[0.5, 1.0, 0.9], &[]), judged(&[0.25, 0.0], &[])];
        let whole = judged(&[0.5, 1.0, 0.9, 0.25, 0.0], &[2]).0;
        let together = Graded::together(parts);
        assert!((together.rmse - whole.rmse).abs() < 1e-9);
        assert!(whole.rmse_outside_band > 0.4 && whole.rmse_outside_band != whole.rmse);
        assert!((together.rmse_outside_band - whole.rmse_outside_band).abs() < 1e-9);
        assert!((together.mean_absolute_error - whole.mean_absolute_error).abs() < 1e-9);
        assert_eq!((together.off, together.invalid), (whole.off, whole.invalid));
        let (dark, light) = (together.soft.dark_in_light, together.soft.light);
        assert!((dark - whole.soft.dark_in_light).abs() < 1e-9 && dark > 0.3);
        assert_eq!(light, whole.soft.light);
        // One picture is itself.
        let one = Graded::together([parts[0]]);
        assert!((one.rmse_outside_band - parts[0].0.rmse_outside_band).abs() < 1e-12);
        assert_eq!(Graded::together([]), Graded::default());
    }

    proptest! {
        /// Figures of a path agree with those of its frames, however these are grouped.
        #[test]
        fn soft_errors_together_are_those_of_all_pixels(
            pixels in prop::collection::vec((0.0f32..=1.0, -1.0..=1.0), 0..60),
            cut in 0usize..60,
        ) {
            let sum = |pixels: &[(f32, f64)]| {
                let mut sum = SoftErrors::default();
                for &(share, off) in pixels {
                    sum.add(SoftErrors::of_pixel(share, off));
                }
                sum.means()
            };
            let (one, other) = pixels.split_at(cut.min(pixels.len()));
            let (mut together, whole) = (SoftErrors::default(), sum(&pixels));
            together.add(sum(one));
            together.add(sum(other));
            let together = together.means();
            let counts = |sums: SoftErrors| [sums.umbra, sums.light, sums.penumbra];
            prop_assert_eq!(counts(together), counts(whole));
            let figures = |sums: SoftErrors| {
                [sums.light_in_umbra, sums.dark_in_light, sums.penumbra_rmse, sums.penumbra_bias]
            };
            for (one, other) in figures(together).into_iter().zip(figures(whole)) {
                prop_assert!((one - other).abs() < 1e-9, "{together:?} {whole:?}");
            }
        }
    }

    #[test]
    fn what_is_no_share_is_counted_and_clamped() {
        let truth = truth(&[Class::Lit; 6]);
        let shown = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.5, -0.5, 1.0];
        let graded = Graded::judged(&shown, &[1.0; 6], &truth).unwrap();
        let invalid = Invalid {
            nan: 1,
            infinite: 2,
            outside: 2,
        };
        assert_eq!(graded.invalid, invalid);
        // NaN, −∞ and −0.5 are a whole light off.
        assert!((graded.rmse - 0.5f64.sqrt()).abs() < 1e-12);
        assert_eq!(graded.off.over_1_4, 3);
        assert_eq!([error(f32::NAN, 0.2), error(f32::NAN, 0.8)], [1.0, -1.0]);
    }
}
