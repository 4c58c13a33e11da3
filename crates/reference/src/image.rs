//! Pictures as RGB bytes; the caller encodes them if it needs a file.

use crate::error::Error;
use crate::ground_truth::{Class, GroundTruthPixels};
use crate::pixels::check_pixel_count;
use crate::statistics::{UNANSWERED, Verdict, for_each_verdict};
use crate::status;

type Colour = [u8; 3];

const BACKGROUND: Colour = [96, 112, 128];
/// Facing away is green and uncertain is purple, as in the dissertation's figures (38, 46).
const FACING_AWAY: Colour = [0, 128, 0];
const UNCERTAIN: Colour = [160, 32, 240];
const WRONGLY_LIT: Colour = [48, 96, 255];
const WRONGLY_LIT_INDETERMINATE: Colour = [160, 190, 255];
const WRONGLY_SHADOWED: Colour = [255, 32, 32];
const WRONGLY_SHADOWED_INDETERMINATE: Colour = [255, 170, 170];
/// Grey levels under the error image: pale enough for blue and red to stand out, apart enough to
/// show shadow contours.
const DIM_LIGHT: Colour = [212, 212, 212];
const DIM_SHADOW: Colour = [144, 144, 144];
const DIM_FACING_AWAY: Colour = [116, 116, 116];
const DIM_BACKGROUND: Colour = [232, 236, 240];

/// Texels per pixel from 1/64 to 64, each stop four times the one before: hot where the map is too
/// coarse for the picture, cold where it is finer.
const TEXELS: [Colour; 7] = [
    [128, 0, 38],
    [227, 26, 28],
    [253, 141, 60],
    [255, 237, 160],
    [127, 205, 187],
    [29, 145, 192],
    [8, 29, 88],
];
/// No texel at all.
const OUTSIDE_MAP: Colour = [64, 64, 64];

const NO_NUMBER: Colour = [255, 0, 255];
/// Size of the error of a share of light (which is 0 to 1) from which on [`Image::difference`]
/// shows its colours at full strength.
pub const FULL_COLOUR: f64 = 0.25;

/// Ambient light of [`Image::shaded`], as a share of the light's own at normal incidence.
const AMBIENT: f32 = 0.2;

/// Visibility value of a pixel that can be read as a share of light: an `f32` of a method with soft
/// shadows, or a `u8` or `u32` of one with hard shadows.
pub trait Shown: Copy {
    /// Returns the share of light, 0 in shadow to 1 in light. An `f32` is clamped, and NaN is
    /// shadow. An integer is light unless it is 0 or [`UNANSWERED`].
    fn share(self) -> f32;
}

impl Shown for u8 {
    fn share(self) -> f32 {
        u32::from(self).share()
    }
}

impl Shown for u32 {
    fn share(self) -> f32 {
        f32::from(u8::from(!matches!(self, 0 | UNANSWERED)))
    }
}

impl Shown for f32 {
    fn share(self) -> f32 {
        // `max` takes the number that is one.
        if self.is_nan() {
            0.0
        } else {
            self.clamp(0.0, 1.0)
        }
    }
}

/// An RGB picture in memory, 8 bits per channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Three bytes (red, green, blue; sRGB) per pixel, row by row from the top left.
    pub rgb: Vec<u8>,
}

impl Image {
    /// Draws where a method is wrong: blue = wrongly lit, red = wrongly in shadow, both paler where
    /// indeterminate ([`GroundTruthPixels::indeterminate`]), over the reference's shadows in pale
    /// colours. [`Statistics`](crate::Statistics) defines which pixels are wrong. The arguments are
    /// those of [`Statistics::judged`](crate::Statistics::judged).
    ///
    /// # Errors
    /// Those of [`Statistics::judged`](crate::Statistics::judged).
    pub fn error(
        visibility: &[impl Copy + Into<u32>],
        status: &[impl Copy + Into<u32>],
        truth: &GroundTruthPixels,
    ) -> Result<Self, Error> {
        let mut pixels = Vec::with_capacity(truth.classes.len());
        for_each_verdict(visibility, status, truth, |pixel| {
            let backdrop = |grey| tinted(grey, truth, pixel.place);
            pixels.push(match (pixel.verdict, pixel.indeterminate, pixel.class) {
                (Verdict::WronglyLit, false, _) => WRONGLY_LIT,
                (Verdict::WronglyLit, true, _) => WRONGLY_LIT_INDETERMINATE,
                (Verdict::WronglyShadowed, false, _) => WRONGLY_SHADOWED,
                (Verdict::WronglyShadowed, true, _) => WRONGLY_SHADOWED_INDETERMINATE,
                (Verdict::Right, _, Class::Background) => DIM_BACKGROUND,
                (Verdict::Right, _, Class::FacingAway) => backdrop(DIM_FACING_AWAY),
                (Verdict::Right, _, Class::Lit | Class::Unshadowed) => backdrop(DIM_LIGHT),
                (Verdict::Right, _, Class::Shadow) => backdrop(DIM_SHADOW),
            });
        })?;
        Ok(Self::painted(truth.viewport, pixels))
    }

    /// Draws where a method's shares of light (`visibility`) differ from the reference's `shares`:
    /// blue = too light, red = too dark, over the reference's shares in pale grey; magenta = NaN.
    /// Colours are stronger for larger errors, up to [`FULL_COLOUR`]. Both lists have one value per
    /// pixel, row by row from the top left. `truth` tells which pixels face the light; others show
    /// no error.
    ///
    /// # Errors
    /// [`Error::PixelCount`] if a list does not have one value per pixel of `truth`.
    pub fn difference(
        visibility: &[f32],
        shares: &[f32],
        truth: &GroundTruthPixels,
    ) -> Result<Self, Error> {
        check_pixel_count("visibility", truth.viewport, visibility.len())?;
        check_pixel_count("shares", truth.viewport, shares.len())?;
        let colour = |(index, class): (usize, &Class)| match class {
            Class::Background => DIM_BACKGROUND,
            Class::FacingAway => DIM_FACING_AWAY,
            Class::Unshadowed => DIM_LIGHT,
            _ if visibility[index].is_nan() => NO_NUMBER,
            _ => {
                let off = error(visibility[index], shares[index]);
                let full = if off > 0.0 {
                    WRONGLY_LIT
                } else {
                    WRONGLY_SHADOWED
                };
                let dim = mixed(DIM_SHADOW, DIM_LIGHT, shares[index].into());
                mixed(dim, full, (off.abs() / FULL_COLOUR).min(1.0))
            }
        };
        let pixels = truth.classes.iter().enumerate();
        Ok(Self::painted(truth.viewport, pixels.map(colour)))
    }

    /// Draws a value for each pixel on a heat scale, from dark red (1/64 and less) over pale yellow
    /// (1) to dark blue (64 and more): the number of shadow-map texels that the pixel covers, or
    /// one of the factors of its [`Footprint`](crate::Footprint). The value 0, for a pixel outside
    /// the map, is dark grey. `None`, for a pixel that does not face the light or whose triangle is
    /// seen edge-on, is pale in the background and grey elsewhere.
    ///
    /// # Errors
    /// [`Error::PixelCount`] if `texels` does not have one value per pixel of `truth`.
    pub fn texels(texels: &[Option<f64>], truth: &GroundTruthPixels) -> Result<Self, Error> {
        check_pixel_count("texels", truth.viewport, texels.len())?;
        let colour = |(texels, class): (&Option<f64>, &Class)| match (texels, class) {
            (Some(0.0), _) => OUTSIDE_MAP,
            (Some(texels), _) => heat(*texels),
            (None, Class::Background) => DIM_BACKGROUND,
            (None, _) => DIM_FACING_AWAY,
        };
        let pixels = texels.iter().zip(&truth.classes);
        Ok(Self::painted(truth.viewport, pixels.map(colour)))
    }

    /// Draws a method's output alone: white = lit, black = shadow, grey for shares in between,
    /// green = facing away, grey-blue = background. `status` holds values of [`status`], which tell
    /// where a pixel faces away or shows the background. Both lists have one value per pixel, row
    /// by row from the top left.
    ///
    /// # Errors
    /// [`Error::PixelCount`] if a list does not have one value per pixel of `viewport`.
    pub fn visibility(
        viewport: [u32; 2],
        visibility: &[impl Shown],
        status: &[impl Copy + Into<u32>],
    ) -> Result<Self, Error> {
        check_pixel_count("visibility", viewport, visibility.len())?;
        check_pixel_count("status", viewport, status.len())?;
        let colour = |share: f32, status: u32| match status {
            status::BACKGROUND => BACKGROUND,
            status::FACING_AWAY => FACING_AWAY,
            _ => [srgb(share); 3],
        };
        let pixels = visibility.iter().zip(status);
        let pixels = pixels.map(|(visibility, &status)| colour(visibility.share(), status.into()));
        Ok(Self::painted(viewport, pixels))
    }

    /// Draws the shaded scene, as [`shaded`](Self::shaded) does, with the pixels that the method
    /// calls uncertain ([`status::UNCERTAIN`]) in purple. Both lists have one value per pixel, row
    /// by row from the top left.
    ///
    /// # Errors
    /// [`Error::PixelCount`] if a list does not have one value per pixel of `truth`.
    pub fn uncertain(
        visibility: &[impl Shown],
        status: &[impl Copy + Into<u32>],
        truth: &GroundTruthPixels,
    ) -> Result<Self, Error> {
        check_pixel_count("status", truth.viewport, status.len())?;
        let mut image = Self::shaded(visibility, truth)?;
        for (pixel, &status) in image.rgb.chunks_exact_mut(3).zip(status) {
            if status.into() == status::UNCERTAIN {
                pixel.copy_from_slice(&UNCERTAIN);
            }
        }
        Ok(image)
    }

    /// Draws the scene in its base colours, or in grey without materials, under Lambert's law: 0.8
    /// max(n · l, 0) × visibility + ambient light of 0.1 to 0.2, the more the greater n · l is.
    /// `truth` has n · l and the base colours. `visibility` has one value per pixel, row by row
    /// from the top left.
    ///
    /// # Errors
    /// [`Error::PixelCount`] if `visibility` does not have one value per pixel of `truth`.
    pub fn shaded(visibility: &[impl Shown], truth: &GroundTruthPixels) -> Result<Self, Error> {
        check_pixel_count("visibility", truth.viewport, visibility.len())?;
        let colour = |(index, &class): (usize, &Class)| {
            if class == Class::Background {
                return BACKGROUND;
            }
            let direct = visibility[index].share() * truth.n_dot_l[index].max(0.0);
            // A little of n · l in the ambient term keeps form readable where no light arrives.
            let ambient = AMBIENT * (0.75 + 0.25 * truth.n_dot_l[index].clamp(-1.0, 1.0));
            let light = ambient + (1.0 - AMBIENT) * direct;
            match truth.base_colors.get(index) {
                Some(color) => color.map(|channel| srgb(channel * light)),
                None => [srgb(light); 3],
            }
        };
        let pixels = truth.classes.iter().enumerate();
        Ok(Self::painted(truth.viewport, pixels.map(colour)))
    }

    fn painted(size: [u32; 2], pixels: impl IntoIterator<Item = Colour>) -> Self {
        Self {
            size,
            rgb: pixels.into_iter().flatten().collect(),
        }
    }
}

/// The error of one pixel: positive where the method shows too much light. NaN is a whole light
/// off, to the side on which there is room.
pub(crate) fn error(shown: f32, share: f32) -> f64 {
    let share = f64::from(share);
    match f64::from(shown) {
        shown if shown.is_nan() && share < 0.5 => 1.0,
        shown if shown.is_nan() => -1.0,
        shown => shown.clamp(0.0, 1.0) - share,
    }
}

/// Returns the colour at a place, from 0 to the number of the last one, among several colours.
pub fn between(colours: &[[u8; 3]], place: f64) -> [u8; 3] {
    let stop = (place as usize).min(colours.len() - 2);
    mixed(colours[stop], colours[stop + 1], place - stop as f64)
}

fn mixed(from: Colour, to: Colour, share: f64) -> Colour {
    std::array::from_fn(|channel| {
        let [from, to] = [from, to].map(|colour| f64::from(colour[channel]));
        (from + (to - from) * share).round() as u8
    })
}

/// The colour of so many texels.
fn heat(texels: f64) -> Colour {
    let place = texels.log2() / 2.0 + 3.0;
    between(&TEXELS, place.clamp(0.0, (TEXELS.len() - 1) as f64))
}

/// Linear light 0..1 as a channel of sRGB (gamma 2.2 is near enough for a picture).
fn srgb(linear: f32) -> u8 {
    (linear.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0).round() as u8
}

/// A grey of the backdrop in the colour of what the pixel shows, where that is known.
fn tinted(grey: Colour, truth: &GroundTruthPixels, pixel: usize) -> Colour {
    match truth.base_colors.get(pixel) {
        Some(color) => {
            let tint = color.map(|channel| f32::from(srgb(channel)) / 255.0);
            std::array::from_fn(|at| (f32::from(grey[at]) * tint[at]).round() as u8)
        }
        None => grey,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One pixel of each class, then a shadowed one that is indeterminate.
    fn truth() -> GroundTruthPixels {
        GroundTruthPixels {
            viewport: [5, 1],
            classes: vec![
                Class::Background,
                Class::FacingAway,
                Class::Lit,
                Class::Shadow,
                Class::Shadow,
            ],
            indeterminate: vec![false, false, false, false, true],
            n_dot_l: vec![0.0, -0.5, 1.0, 1.0, 0.5],
            base_colors: Vec::new(),
        }
    }

    #[test]
    fn base_colours_tint_what_is_shown() {
        let mut truth = truth();
        let grey = colours(Image::shaded(&[0u8, 0, 1, 0, 0], &truth).unwrap());
        truth.base_colors = vec![[1.0, 0.0, 1.0]; 5];
        let tinted = colours(Image::shaded(&[0u8, 0, 1, 0, 0], &truth).unwrap());
        assert_eq!(tinted[0], grey[0], "the background");
        for (tinted, grey) in tinted.iter().zip(&grey).skip(1) {
            assert_eq!(*tinted, [grey[0], 0, grey[2]]);
        }
        let error = colours(Image::error(&[0u8, 0, 1, 0, 0], &[0u8, 1, 2, 3, 3], &truth).unwrap());
        assert_eq!(error[2], [DIM_LIGHT[0], 0, DIM_LIGHT[2]]);
    }

    fn colours(image: Image) -> Vec<Colour> {
        assert_eq!(
            image.rgb.len(),
            (3 * image.size[0] * image.size[1]) as usize
        );
        image
            .rgb
            .chunks_exact(3)
            .map(|pixel| [pixel[0], pixel[1], pixel[2]])
            .collect()
    }

    #[test]
    fn errors_are_blue_and_red() {
        let truth = truth();
        let right =
            colours(Image::error(&truth.visibility(), &truth.status(), &truth).expect("its own"));
        assert_eq!(
            right,
            [
                DIM_BACKGROUND,
                DIM_FACING_AWAY,
                DIM_LIGHT,
                DIM_SHADOW,
                DIM_SHADOW
            ]
        );
        let wrong =
            colours(Image::error(&[0u8, 0, 0, 1, 1], &truth.status(), &truth).expect("valid"));
        assert_eq!(
            wrong[2..],
            [WRONGLY_SHADOWED, WRONGLY_LIT, WRONGLY_LIT_INDETERMINATE]
        );
        assert!(Image::error(&[0u8; 4], &[0u8; 5], &truth).is_err());
    }

    #[test]
    fn visibility_and_uncertainty_follow_the_method() {
        let (visibility, status) = ([1u8, 1, 1, 0, 1], [0u8, 1, 2, 3, 4]);
        let shown = colours(Image::visibility([5, 1], &visibility, &status).expect("same sizes"));
        assert_eq!(shown, [BACKGROUND, FACING_AWAY, [255; 3], [0; 3], [255; 3]]);
        let truth = truth();
        let shaded = colours(Image::shaded(&visibility, &truth).expect("same size"));
        let shown = colours(Image::uncertain(&visibility, &status, &truth).expect("same sizes"));
        assert_eq!((&shown[..4], shown[4]), (&shaded[..4], UNCERTAIN));
        assert!(Image::uncertain(&visibility, &status[1..], &truth).is_err());
        assert!(Image::visibility([5, 2], &visibility, &status).is_err());
    }

    #[test]
    fn as_many_pixels_are_coloured_as_are_wrong() {
        let [width, height] = [512usize, 64];
        let mut truth = GroundTruthPixels {
            viewport: [512, 64],
            classes: vec![Class::Lit; width * height],
            indeterminate: vec![false; width * height],
            n_dot_l: vec![1.0; width * height],
            base_colors: Vec::new(),
        };
        let (lone, in_band) = (32 * width + 100, 32 * width + 108);
        truth.indeterminate[in_band] = true;
        let mut visibility = vec![1u8; width * height];
        for pixel in [0, lone, in_band] {
            visibility[pixel] = 0;
        }
        let status = vec![status::CERTAIN_LIGHT as u8; width * height];
        let shown = colours(Image::error(&visibility, &status, &truth).unwrap());
        let count = |wanted: Colour| shown.iter().filter(|colour| **colour == wanted).count();
        assert_eq!(count(WRONGLY_SHADOWED), 2);
        assert_eq!(shown[in_band], WRONGLY_SHADOWED_INDETERMINATE);
        assert_eq!(count(DIM_LIGHT), width * height - 3);
    }

    #[test]
    fn differences_of_shares_have_a_side_and_a_strength() {
        let truth = truth();
        let shares = [0.0, 0.0, 1.0, 0.5, 0.5];
        let shown = [1.0, 1.0, 0.75, 0.625, f32::NAN];
        let shown = colours(Image::difference(&shown, &shares, &truth).expect("same sizes"));
        let middle = mixed(DIM_SHADOW, DIM_LIGHT, 0.5);
        let half = mixed(middle, WRONGLY_LIT, 0.5);
        let expected = [
            DIM_BACKGROUND,
            DIM_FACING_AWAY,
            WRONGLY_SHADOWED,
            half,
            NO_NUMBER,
        ];
        assert_eq!(shown, expected);
        assert!(Image::difference(&shares[1..], &shares, &truth).is_err());
    }

    #[test]
    fn texels_are_hot_where_they_are_few() {
        let texels = [None, None, Some(1.0), Some(0.125), Some(0.0)];
        let shown = colours(Image::texels(&texels, &truth()).expect("same size"));
        // An eighth lies halfway between the stops of a quarter and a sixteenth.
        let eighth = mixed(TEXELS[1], TEXELS[2], 0.5);
        let expected = [
            DIM_BACKGROUND,
            DIM_FACING_AWAY,
            TEXELS[3],
            eighth,
            OUTSIDE_MAP,
        ];
        assert_eq!(shown, expected);
        assert_eq!([1e-9, 1e9].map(heat), [TEXELS[0], TEXELS[6]]);
        assert!(Image::texels(&texels[1..], &truth()).is_err());
    }

    #[test]
    fn shading_follows_the_cosine_and_the_visibility() {
        let shaded = colours(Image::shaded(&[1u8, 1, 1, 0, 1], &truth()).expect("same size"));
        assert_eq!(shaded[0], BACKGROUND);
        assert_eq!(shaded[2], [255; 3]);
        let level = |pixel: usize| shaded[pixel][0];
        assert!(level(2) > level(4) && level(4) > level(3) && level(3) > level(1) && level(1) > 0);
        assert!(Image::shaded(&[1u8; 6], &truth()).is_err());
    }
}
