//! The schema of `judge.json`, version 1: pictures of other renderers, judged. Scripts rely on it:
//! extend it, rename nothing.
//!
//! ```
//! use skiagraph_compare::records::judged_pictures::JudgedPicture;
//!
//! let picture = JudgedPicture { wrong_unattributable: 3, ..JudgedPicture::default() };
//! assert_eq!(picture.wrong_attributable(), 0);
//! ```

use crate::records::results::{Answer, AreaReference, Images, Scene};
use serde::{Deserialize, Serialize};
use skiagraph_reference::{BlockerCounts, EdgeDistances, Graded, PixelCounts, WrongCounts};

/// Greatest share of the pixels facing the light that may be
/// [unattributable](JudgedPictures::unattributable): with more of them pictures get no rank.
pub const MOST_UNATTRIBUTABLE: f64 = 0.01;

/// Greatest share of the pixels facing the light that may have no finite number in a picture
/// ([`JudgedPicture::without_answer`]): one with more of them gets no rank.
pub const MOST_WITHOUT_ANSWER: f64 = 0.01;

/// Content of `judge.json`: pictures of one view of a scene, with the [truth](crate#terms) that
/// they were held against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JudgedPictures {
    /// Version of this schema: 1.
    pub schema: u32,
    /// The program that judged, `skiagraph 0.1.0`.
    pub program: String,
    /// Name and triangles of the scene that the pictures show.
    pub scene: Scene,
    /// Name of the view.
    pub view: String,
    /// Name of the view's own light, if [`under_lights`] made the view, one for each light of a
    /// scene; absent elsewhere.
    ///
    /// [`under_lights`]: crate::measuring::view_or_path::under_lights
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub light: Option<String>,
    /// Width and height of the pictures in pixels.
    pub viewport: [u32; 2],
    /// Mode of the [reference](crate#terms)'s shadow rays: `exact`, or `offset:LENGTH` in scene
    /// units.
    pub oracle: String,
    /// Numbers of pixels by the [reference](crate#terms)'s answer.
    pub pixels: PixelCounts,
    /// Number of pixels in the [band](crate#terms): those facing the light whose right answer flips
    /// when the receiver (the point that the pixel shows) or the casters move within their f32
    /// rounding error.
    pub band: u64,
    /// Number of pixels whose surface, as [`surfaces`](Self::surfaces) says, is hidden behind
    /// another one by more than rounding explains.
    pub wrong_surface: u64,
    /// Number of samples and estimated error of the [reference](crate#terms) under a light [with an
    /// extent](crate#terms); absent for other lights.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area: Option<AreaReference>,
    /// Source of the surface that each pixel shows: `rasterised` by this program, `ids` or `depth`
    /// of the other renderer.
    pub surfaces: String,
    /// Number of *unattributable* pixels: they face the light and are not in the
    /// [band](crate#terms), but the picture may show one of several surfaces there, whose right
    /// answers differ. A picture's rank does not count them.
    pub unattributable: u64,
    /// The pictures, in the order of those of the [`Judging`](crate::foreign::judging::Judging).
    pub pictures: Vec<JudgedPicture>,
}

/// A picture of another renderer, judged.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JudgedPicture {
    /// Path of the file, as it was given.
    pub file: String,
    /// Format of the file: `PNG, 8 bits, grey`.
    pub format: String,
    /// Kind of the answers: `hard` if all are 0 and 1.
    pub answer: Answer,
    /// Rank among the pictures, 1 for the best: by wrong pixels, under a light [with an
    /// extent](crate#terms) by `rmse_outside_band`. Null if more than 1 % of the pixels facing the
    /// light are unattributable or have no finite number in it, or the picture hardly agrees with
    /// the [truth](crate#terms) and no ids or depths tell that its camera is right.
    pub rank: Option<u32>,
    /// Numbers of pixels on which picture and reference disagree; of shares, one half or more
    /// counts as lit. Unattributable ones are included.
    pub wrong: WrongCounts,
    /// Number of the pixels of `wrong.total` that are
    /// [unattributable](JudgedPictures::unattributable); none of them is in the
    /// [band](crate#terms).
    pub wrong_unattributable: u64,
    /// Number of pixels facing the light at which the picture has no finite number, the
    /// [unattributable](JudgedPictures::unattributable) ones and those in the [band](crate#terms)
    /// left out; absent if there are none. They count as in shadow in `wrong`, and nowhere else.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub without_answer: u64,
    /// Number of the pixels of `wrong.total` among them.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub wrong_without_answer: u64,
    /// Errors of the [shares of light](crate#terms), over all pixels facing the light. The fields
    /// `rmse_outside_band` and `soft` leave out pixels in the band,
    /// [unattributable](JudgedPictures::unattributable) ones and those without an answer.
    pub graded: Graded,
    /// Distances of the wrong pixels, outside the [band](crate#terms) and attributable, from the
    /// edges of the [reference](crate#terms)'s shadows.
    pub edges: EdgeDistances,
    /// Numbers of the wrong pixels that are outside the [band](crate#terms) and attributable, by
    /// the kind of caster that blocks their light; absent if there are no such pixels, or if
    /// answers are [shares of light](crate#terms).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrong_blockers: Option<BlockerCounts>,
    /// Warnings: what was left out of the file, and mistakes that are suspected.
    pub warnings: Vec<String>,
    /// File names of the pictures that were drawn of it; absent if none were drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub images: Option<Images>,
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

impl JudgedPictures {
    /// True if so few pixels are unattributable that pictures have ranks.
    pub fn is_attributable(&self) -> bool {
        let facing = self.pixels.facing_light as f64;
        self.unattributable as f64 <= MOST_UNATTRIBUTABLE * facing
    }
}

impl JudgedPicture {
    /// Returns the number of wrong pixels outside the [band](crate#terms) that are not
    /// [unattributable](JudgedPictures::unattributable) and have an answer.
    pub fn wrong_attributable(&self) -> u64 {
        let apart = self.wrong.in_band + self.wrong_unattributable + self.wrong_without_answer;
        self.wrong.total.saturating_sub(apart)
    }
}
