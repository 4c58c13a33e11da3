//! Holds the numbers of a picture as its decoder finds them, and the bounds of their count.

use crate::wording::thousands;
use itertools::Itertools;
use skiagraph_graph::caught;

/// Longest edge of a picture in pixels.
const LONGEST_EDGE: u64 = 16_384;

/// Most numbers of a picture: pixels times channels.
pub(crate) const MOST_NUMBERS: u64 = 1 << 27;

/// Relative error of a number that is rounded to 16 bits, and of one of 32 bits.
pub(crate) const HALF: f64 = 1.0 / 2048.0;
pub(crate) const FLOAT: f64 = 1.0 / 16_777_216.0;

/// Numbers of a picture file, one or three for each pixel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Raster {
    /// Path of the file, as it was given.
    pub file: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Numbers per pixel: 1, or 3 if red, green and blue differ somewhere.
    pub channels: usize,
    /// Numbers as the file holds them, pixel after pixel, row by row from the top left. A pixel has
    /// `channels` numbers.
    pub values: Vec<f64>,
    /// Number that stands for 1 in a format of integers, such as 255; `None` for floats, in which 1
    /// stands for 1.
    pub whole: Option<f64>,
    /// Greatest error of a number by rounding: for integers one step as a share of `whole`, such as
    /// 1/255; for floats relative to the number.
    pub precision: f64,
    /// Description of the format: `PNG, 8 bits, grey`.
    pub format: String,
    /// Warnings about what was left out, such as alpha.
    pub warnings: Vec<String>,
    /// True if the last channel of the file is alpha.
    pub(crate) has_alpha: bool,
}

impl Raster {
    /// Leaves out alpha, and channels that repeat the first one.
    pub(super) fn without_alpha(mut self) -> Self {
        let (stored, has_alpha) = (self.channels, self.has_alpha);
        let colours = stored - usize::from(has_alpha);
        let opaque = self.whole.unwrap_or(1.0);
        let is_seen_through = |pixel: &&[f64]| has_alpha && pixel[stored - 1] != opaque;
        let pixels = || self.values.chunks_exact(stored);
        let seen_through = pixels().filter(is_seen_through).count();
        let is_even = |pixel: &[f64]| pixel[..colours].iter().map(|it| it.to_bits()).all_equal();
        let is_grey = pixels().all(is_even);
        let channels = if is_grey { 1 } else { colours };
        let kept = pixels().flat_map(|pixel| &pixel[..channels]);
        (self.values, self.channels) = (kept.copied().collect(), channels);
        if seen_through > 0 {
            self.warnings.push(format!(
                "alpha is not read, and {} pixels are not opaque: write what they show over \
                 nothing else, without alpha",
                thousands(seen_through as u64)
            ));
        }
        self.format += if is_grey { ", grey" } else { ", colours" };
        self
    }
}

/// Checks the size of a picture before room is made for it. `channels` includes alpha.
///
/// # Errors
/// Text with the size and the bounds, as the rest of a message that begins with the file.
pub(crate) fn checked(size: [u64; 2], channels: u64) -> Result<[u32; 2], String> {
    let [width, height] = size;
    if width == 0 || height == 0 {
        return Err(format!("it has no pixels ({width}x{height})"));
    }
    let numbers = width.saturating_mul(height).saturating_mul(channels);
    if width.max(height) > LONGEST_EDGE || numbers > MOST_NUMBERS {
        return Err(format!(
            "it says that it has {width}x{height} pixels of {channels} channels; at most \
             {LONGEST_EDGE} pixels along an edge and {} numbers in all are read: render it in \
             fewer pixels, or save one channel",
            thousands(MOST_NUMBERS)
        ));
    }
    Ok([width as u32, height as u32])
}

/// Calls a library's decoder; its panic is an error.
pub(crate) fn guarded<T>(
    library: &str,
    decode: impl FnOnce() -> Result<T, String>,
) -> Result<T, String> {
    let failed =
        |why| format!("the library `{library}` failed on it ({why}): save it in another program");
    caught(decode).map_err(failed)?
}
