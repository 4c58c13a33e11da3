//! Counts of a method's right and wrong pixels, as `results.json` holds them.

use crate::error::Error;
use crate::ground_truth::{Class, GroundTruthPixels};
use crate::pixels::check_pixel_count;
use serde::{Deserialize, Serialize};

pub use crate::status;

/// Value of a shadow method's output `visibility` for a pixel without an answer, because the driver
/// ended the shader before its shadow ray was traced. Pictures show the pixel in shadow;
/// [`Statistics::judged`] refuses frames with such pixels.
pub const UNANSWERED: u32 = 2;

/// Number of pixels by the reference's answer ([`Class`]). `background + facing_away +
/// facing_light` is the number of pixels of the viewport, `lit + shadow` is `facing_light`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelCounts {
    /// Pixels that show no geometry.
    pub background: u64,
    /// Pixels that face away from the light (PnFL: pixels not facing the light), and those of
    /// surfaces that receive no shadow.
    pub facing_away: u64,
    /// Pixels that face the light (PFL), lit or in shadow. All shares of error counts are relative
    /// to this number.
    pub facing_light: u64,
    /// Pixels of `facing_light` that see the light; of a light with extent, at least half.
    pub lit: u64,
    /// Pixels of `facing_light` that do not see the light; of a light with extent, less than half.
    pub shadow: u64,
}

/// Number of PFL pixels (facing the light by the reference) that the method calls certain, right or
/// wrong: those with the [status] *certain light* or *certain shadow*.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CertainCounts {
    /// PFL pixels with the status *certain light* ([`status::CERTAIN_LIGHT`]).
    pub lit: u64,
    /// PFL pixels with the status *certain shadow* ([`status::CERTAIN_SHADOW`]).
    pub shadow: u64,
}

/// Number of judged pixels whose visibility differs from the reference's; [`Statistics`] says which
/// pixels are judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WrongCounts {
    /// Pixels that the method shows lit, but the reference does not.
    pub lit: u64,
    /// Pixels that the method shows in shadow, but the reference lights.
    pub shadow: u64,
    /// `lit + shadow`, indeterminate pixels included.
    pub total: u64,
    /// Pixels of `total` that the method called certain (by its [status]), and that are not
    /// indeterminate.
    pub certain: u64,
    /// Pixels of `total` that are indeterminate: the reference's answer flips within the f32 error
    /// bounds.
    pub in_band: u64,
}

/// Number of the pixels that the reference lights, or of those in its shadow, by the method's
/// [status]. `certain_right + certain_wrong + uncertain` is their number less the pixels that the
/// method calls background or facing away. Indeterminate pixels are included. Right and wrong are
/// judged by the visibility in the picture that the method finally shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClassSplit {
    /// Pixels that the method calls certain by its [status] and gets right.
    pub certain_right: u64,
    /// Pixels that the method calls certain by its [status] and gets wrong.
    pub certain_wrong: u64,
    /// Pixels of `certain_wrong` that are not indeterminate ([`GroundTruthPixels::indeterminate`]).
    pub certain_wrong_outside_band: u64,
    /// Pixels that the method calls uncertain by its [status].
    pub uncertain: u64,
    /// Pixels of `uncertain` that are wrong in the picture that the method finally shows.
    pub uncertain_wrong: u64,
}

/// Number of PFL pixels (facing the light by the reference) by the method's status, separately for
/// the reference's lit and shadowed pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Split {
    /// Counts of the pixels that the reference lights, by the method's status.
    pub lit: ClassSplit,
    /// Counts of the pixels in the reference's shadow, by the method's status.
    pub shadow: ClassSplit,
}

impl ClassSplit {
    fn add(&mut self, pixel: &Judged) {
        let wrong = pixel.verdict != Verdict::Right;
        match (pixel.status, wrong) {
            (status::CERTAIN_LIGHT | status::CERTAIN_SHADOW, false) => self.certain_right += 1,
            (status::CERTAIN_LIGHT | status::CERTAIN_SHADOW, true) => {
                self.certain_wrong += 1;
                self.certain_wrong_outside_band += u64::from(!pixel.indeterminate);
            }
            (status::UNCERTAIN, _) => {
                self.uncertain += 1;
                self.uncertain_wrong += u64::from(wrong);
            }
            // Not taken for facing the light.
            _ => {}
        }
    }
}

impl Split {
    /// Returns the number of PFL pixels (facing the light by the reference) that the method calls
    /// certain and gets right.
    pub fn certain_right(&self) -> u64 {
        self.lit.certain_right + self.shadow.certain_right
    }

    /// Returns the number of PFL pixels (facing the light by the reference) that the method calls
    /// certain and gets wrong.
    pub fn certain_wrong(&self) -> u64 {
        self.lit.certain_wrong + self.shadow.certain_wrong
    }
}

/// Comparison of one method's picture with the reference.
///
/// The fields are those of `results.json`. The *band* is the set of indeterminate pixels, whose
/// answer flips within the f32 error bounds. *PFL* are the pixels that face the light by the
/// reference.
///
/// *Which pixels are judged.* Every PFL pixel, by the visibility that the method shows (0 is
/// shadow, 1 is light), even if the method calls it background or facing away (status 0 or 1): it
/// is wrong if it shows shadow where the reference is lit, or light where the reference is in
/// shadow. A pixel that the reference calls facing away but the method does not (status 2 to 4) is
/// wrong, as `lit`, if it shows light; shown in shadow it looks the same and is right. Pixels
/// facing away by both, background, and pixels of surfaces that receive no shadow, are not judged:
/// their visibility may be 0 or 1.
/// `facing_mismatch` counts the disagreements about facing, wrong or not.
///
/// `certain` and `uncertain` count PFL pixels only, so that `certain.lit + certain.shadow +
/// uncertain` is `pixels.facing_light` less the PFL pixels that the method calls background or
/// facing away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Statistics {
    /// Number of pixels by the reference's answer: background, facing away, lit or in shadow.
    pub pixels: PixelCounts,
    /// Number of PFL pixels (facing the light by the reference) that the method calls certain by
    /// its [status].
    pub certain: CertainCounts,
    /// Number of PFL pixels (facing the light by the reference) that the method calls uncertain by
    /// its [status].
    pub uncertain: u64,
    /// Number of PFL pixels (facing the light by the reference) by the reference's answer (lit or
    /// shadow) and the method's status.
    pub split: Split,
    /// Number of judged pixels whose visibility differs from the reference's.
    pub wrong: WrongCounts,
    /// Number of PFL pixels (facing the light by the reference) that are indeterminate
    /// ([`GroundTruthPixels::indeterminate`]), right or wrong.
    pub band: u64,
    /// Number of pixels that face the light by the reference but not by the method's status, or the
    /// other way round.
    pub facing_mismatch: u64,
}

impl Statistics {
    /// Judges a method's outputs against the reference. Both buffers hold one value per pixel, row
    /// by row from the top left, as u8 or u32: `visibility` is 0 in shadow and 1 in light, `status`
    /// is one of [`status`]. If a method has no status, give that of the reference,
    /// [`GroundTruthPixels::status`]: `pixels`, `band`, and `wrong` but for `wrong.certain` are
    /// then right, while the counts of certain, uncertain and facing pixels are the reference's.
    ///
    /// # Errors
    /// [`Error::PixelCount`] if a buffer does not have one value per pixel of `truth`,
    /// [`Error::Unanswered`] for pixels with the visibility [`UNANSWERED`], [`Error::Value`] for
    /// any other value that is not allowed.
    pub fn judged(
        visibility: &[impl Copy + Into<u32>],
        status: &[impl Copy + Into<u32>],
        truth: &GroundTruthPixels,
    ) -> Result<Self, Error> {
        let mut counts = Self::default();
        for_each_verdict(visibility, status, truth, |pixel| counts.add(pixel))?;
        Ok(counts)
    }

    fn add(&mut self, pixel: &Judged) {
        let (status, indeterminate) = (pixel.status, pixel.indeterminate);
        let faces_light = pixel.class.faces_light();
        match pixel.class {
            Class::Background => self.pixels.background += 1,
            Class::FacingAway | Class::Unshadowed => self.pixels.facing_away += 1,
            Class::Lit => {
                self.pixels.lit += 1;
                self.split.lit.add(pixel);
            }
            Class::Shadow => {
                self.pixels.shadow += 1;
                self.split.shadow.add(pixel);
            }
        }
        if faces_light {
            self.pixels.facing_light += 1;
            self.band += u64::from(indeterminate);
            match status {
                status::CERTAIN_LIGHT => self.certain.lit += 1,
                status::CERTAIN_SHADOW => self.certain.shadow += 1,
                status::UNCERTAIN => self.uncertain += 1,
                _ => {}
            }
        }
        let is_mismatch = faces_light != (status >= status::CERTAIN_LIGHT);
        let is_judged = pixel.class != Class::Unshadowed;
        self.facing_mismatch += u64::from(is_mismatch && is_judged);
        match pixel.verdict {
            Verdict::Right => return,
            Verdict::WronglyLit => self.wrong.lit += 1,
            Verdict::WronglyShadowed => self.wrong.shadow += 1,
        }
        self.wrong.total += 1;
        self.wrong.in_band += u64::from(indeterminate);
        self.wrong.certain += u64::from(pixel.is_certain_wrong());
    }

    /// Counts the wrong pixels that are not indeterminate. The arguments are those of
    /// [`judged`](Self::judged).
    ///
    /// # Errors
    /// Those of [`judged`](Self::judged).
    pub fn wrong_outside_band(
        visibility: &[impl Copy + Into<u32>],
        status: &[impl Copy + Into<u32>],
        truth: &GroundTruthPixels,
    ) -> Result<WrongCounts, Error> {
        let mut counts = Self::default();
        for_each_verdict(visibility, status, truth, |pixel| {
            if !pixel.indeterminate {
                counts.add(pixel);
            }
        })?;
        Ok(counts.wrong)
    }

    /// Finds the pixels that [`WrongCounts::certain`] counts, as ascending indices into
    /// `visibility` and `status`. The arguments are those of [`judged`](Self::judged).
    ///
    /// # Errors
    /// Those of [`judged`](Self::judged).
    pub fn certain_wrong_pixels(
        visibility: &[impl Copy + Into<u32>],
        status: &[impl Copy + Into<u32>],
        truth: &GroundTruthPixels,
    ) -> Result<Vec<usize>, Error> {
        let mut pixels = Vec::new();
        for_each_verdict(visibility, status, truth, |pixel| {
            if pixel.is_certain_wrong() {
                pixels.push(pixel.place);
            }
        })?;
        Ok(pixels)
    }

    /// Returns a count of pixels divided by the number of pixels that face the light (PFL); 0 if no
    /// pixel does.
    pub fn share(&self, count: u64) -> f64 {
        if self.pixels.facing_light == 0 {
            0.0
        } else {
            count as f64 / self.pixels.facing_light as f64
        }
    }

    /// Returns the number of wrong pixels as a share of PFL, the pixels that face the light.
    pub fn wrong_share(&self) -> f64 {
        self.share(self.wrong.total)
    }

    /// Returns the number of pixels that the method calls uncertain as a share of PFL, the pixels
    /// that face the light.
    pub fn uncertain_share(&self) -> f64 {
        self.share(self.uncertain)
    }

    /// Returns the number of indeterminate pixels ([`GroundTruthPixels::indeterminate`]) as a share
    /// of PFL, the pixels that face the light.
    pub fn indeterminate_share(&self) -> f64 {
        self.share(self.band)
    }
}

/// How one pixel of a method stands against the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Right,
    WronglyLit,
    WronglyShadowed,
}

/// A pixel of a method beside the reference's.
pub(crate) struct Judged {
    /// In the buffers.
    pub place: usize,
    pub class: Class,
    pub status: u32,
    pub indeterminate: bool,
    pub verdict: Verdict,
}

impl Judged {
    /// Returns true if the method called it certain and is wrong of it outside the band.
    fn is_certain_wrong(&self) -> bool {
        let certain = matches!(self.status, status::CERTAIN_LIGHT | status::CERTAIN_SHADOW);
        certain && !self.indeterminate && self.verdict != Verdict::Right
    }
}

/// Calls `pixel` with every pixel.
pub(crate) fn for_each_verdict(
    visibility: &[impl Copy + Into<u32>],
    status: &[impl Copy + Into<u32>],
    truth: &GroundTruthPixels,
    mut pixel: impl FnMut(&Judged),
) -> Result<(), Error> {
    check_pixel_count("visibility", truth.viewport, visibility.len())?;
    check_pixel_count("status", truth.viewport, status.len())?;
    check_answers(visibility, truth.viewport)?;
    for (place, (&class, &indeterminate)) in
        truth.classes.iter().zip(&truth.indeterminate).enumerate()
    {
        let (visibility, status) = (visibility[place].into(), status[place].into());
        let value = |name, value, expected| {
            let width = truth.viewport[0] as usize;
            Error::Value {
                name,
                x: (place % width) as u32,
                y: (place / width) as u32,
                value,
                expected,
            }
        };
        if visibility > 1 {
            let expected = "expected 0 in shadow, 1 in light";
            return Err(value("visibility", visibility, expected));
        }
        if status > status::UNCERTAIN {
            let expected = "expected 0 background, 1 facing away, 2 certain light, 3 certain \
                shadow or 4 uncertain";
            return Err(value("status", status, expected));
        }
        let verdict = match (class, visibility) {
            (Class::Shadow, 1) => Verdict::WronglyLit,
            (Class::FacingAway, 1) if status >= status::CERTAIN_LIGHT => Verdict::WronglyLit,
            (Class::Lit, 0) => Verdict::WronglyShadowed,
            _ => Verdict::Right,
        };
        pixel(&Judged {
            place,
            class,
            status,
            indeterminate,
            verdict,
        });
    }
    Ok(())
}

/// Refuses pixels without an answer.
fn check_answers(visibility: &[impl Copy + Into<u32>], viewport: [u32; 2]) -> Result<(), Error> {
    let shown = (0u32..).zip(visibility);
    let mut unanswered = shown.filter(|(_, shown)| (**shown).into() == UNANSWERED);
    let Some((first, _)) = unanswered.next() else {
        return Ok(());
    };
    Err(Error::Unanswered {
        pixels: 1 + unanswered.count(),
        x: first % viewport[0],
        y: first / viewport[0],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One row of pixels: class, whether indeterminate.
    fn truth(pixels: &[(Class, bool)]) -> GroundTruthPixels {
        GroundTruthPixels {
            viewport: [pixels.len() as u32, 1],
            classes: pixels.iter().map(|pixel| pixel.0).collect(),
            indeterminate: pixels.iter().map(|pixel| pixel.1).collect(),
            n_dot_l: vec![0.5; pixels.len()],
            base_colors: Vec::new(),
        }
    }

    #[test]
    fn every_combination_is_counted_once() {
        use Class::{Background, FacingAway, Lit, Shadow};
        // Class, indeterminate, visibility, status.
        let pixels: [(Class, bool, u8, u8); 15] = [
            (Background, false, 1, 0),
            (FacingAway, false, 1, 1), // not judged
            (FacingAway, false, 0, 3), // looks the same
            (FacingAway, false, 1, 2), // wrongly lit, certain
            (FacingAway, true, 1, 4),  // wrongly lit, indeterminate
            (Lit, false, 1, 2),
            (Lit, true, 1, 4),
            (Lit, false, 0, 3), // wrongly in shadow, certain
            (Lit, false, 0, 4), // wrongly in shadow, uncertain
            (Lit, false, 0, 1), // taken for facing away: wrongly in shadow
            (Shadow, false, 0, 3),
            (Shadow, false, 0, 1), // taken for facing away, looks the same
            (Shadow, true, 1, 2),  // wrongly lit, indeterminate
            (Shadow, false, 1, 2), // wrongly lit, certain
            (Shadow, false, 1, 0), // taken for background, shown lit
        ];
        let truth = truth(&pixels.map(|pixel| (pixel.0, pixel.1)));
        let visibility = pixels.map(|pixel| pixel.2);
        let status = pixels.map(|pixel| pixel.3);
        let expected = Statistics {
            pixels: PixelCounts {
                background: 1,
                facing_away: 4,
                facing_light: 10,
                lit: 5,
                shadow: 5,
            },
            certain: CertainCounts { lit: 3, shadow: 2 },
            uncertain: 2,
            split: Split {
                lit: ClassSplit {
                    certain_right: 1,
                    certain_wrong: 1,
                    certain_wrong_outside_band: 1,
                    uncertain: 2,
                    uncertain_wrong: 1,
                },
                shadow: ClassSplit {
                    certain_right: 1,
                    certain_wrong: 2,
                    certain_wrong_outside_band: 1,
                    uncertain: 0,
                    uncertain_wrong: 0,
                },
            },
            wrong: WrongCounts {
                lit: 5,
                shadow: 3,
                total: 8,
                certain: 3,
                in_band: 2,
            },
            band: 2,
            facing_mismatch: 6,
        };
        assert_eq!(
            Statistics::judged(&visibility, &status, &truth),
            Ok(expected)
        );
        assert_eq!(
            Statistics::certain_wrong_pixels(&visibility, &status, &truth),
            Ok(vec![3, 7, 13])
        );
        let outside = Statistics::wrong_outside_band(&visibility, &status, &truth).unwrap();
        assert_eq!([outside.lit, outside.shadow, outside.certain], [3; 3]);
        // The same values as u32.
        let (visibility, status) = (visibility.map(u32::from), status.map(u32::from));
        assert_eq!(
            Statistics::judged(&visibility, &status, &truth),
            Ok(expected)
        );
        assert_eq!(expected.wrong_share(), 0.8);
        assert_eq!(expected.uncertain_share(), 0.2);
        assert_eq!(expected.indeterminate_share(), 0.2);
    }

    #[test]
    fn the_names_in_json_are_the_contracts() {
        let json = serde_json::to_value(Statistics::default()).expect("plain numbers");
        let keys = |value: &serde_json::Value| {
            let mut keys: Vec<String> = value
                .as_object()
                .expect("a struct")
                .keys()
                .cloned()
                .collect();
            keys.sort_unstable();
            keys
        };
        assert_eq!(
            keys(&json),
            [
                "band",
                "certain",
                "facing_mismatch",
                "pixels",
                "split",
                "uncertain",
                "wrong"
            ]
        );
        assert_eq!(keys(&json["split"]), ["lit", "shadow"]);
        let class = [
            "certain_right",
            "certain_wrong",
            "certain_wrong_outside_band",
            "uncertain",
            "uncertain_wrong",
        ];
        assert_eq!(keys(&json["split"]["lit"]), class);
        assert_eq!(
            keys(&json["pixels"]),
            ["background", "facing_away", "facing_light", "lit", "shadow"]
        );
        assert_eq!(keys(&json["certain"]), ["lit", "shadow"]);
        assert_eq!(
            keys(&json["wrong"]),
            ["certain", "in_band", "lit", "shadow", "total"]
        );
        assert_eq!(
            serde_json::from_value::<Statistics>(json).expect("what was written"),
            Statistics::default()
        );
    }

    #[test]
    fn foreign_values_and_sizes_are_errors() {
        let truth = truth(&[(Class::Lit, false), (Class::Shadow, false)]);
        let viewport = [2, 1];
        let size = |name, actual| {
            Err(Error::PixelCount {
                name,
                viewport,
                expected: 2,
                actual,
            })
        };
        assert_eq!(
            Statistics::judged(&[1u8], &[2u8, 3], &truth),
            size("visibility", 1)
        );
        assert_eq!(
            Statistics::judged(&[1u8, 0], &[2u8, 3, 3], &truth),
            size("status", 3)
        );
        let named = |visibility: [u8; 2], status: [u8; 2]| match Statistics::judged(
            &visibility,
            &status,
            &truth,
        ) {
            Err(Error::Value {
                name, x, y, value, ..
            }) => Some((name, x, y, value)),
            _ => None,
        };
        assert_eq!(named([1, 255], [2, 3]), Some(("visibility", 1, 0, 255)));
        assert_eq!(named([1, 0], [5, 3]), Some(("status", 0, 0, 5)));
        assert_eq!(named([1, 0], [2, 3]), None);
        assert_eq!(
            Statistics::judged(&[0u8, 2], &[2u8, 4], &truth),
            Err(Error::Unanswered {
                pixels: 1,
                x: 1,
                y: 0
            })
        );
    }
}
