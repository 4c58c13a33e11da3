//! Holds the numbers of a picture as its decoder finds them, and the bounds of their count.

use crate::wording::thousands;
use skiagraph_graph::caught;

/// Longest edge of a picture in pixels.
const LONGEST_EDGE: u64 = 16_384;

/// Most numbers of a picture: pixels times channels.
pub(crate) const MOST_NUMBERS: u64 = 1 << 27;

/// Relative error of a number that is rounded to 16 bits, and of one of 32 bits.
pub(crate) const HALF: f64 = 1.0 / 2048.0;
pub(crate) const FLOAT: f64 = 1.0 / 16_777_216.0;

/// Numbers of a picture as its decoder finds them, with all colour channels.
pub(crate) struct Decoded {
    pub(crate) size: [u32; 2],
    /// Numbers of each pixel, alpha included.
    pub(crate) channels: usize,
    /// True if the last channel is alpha.
    pub(crate) has_alpha: bool,
    pub(crate) values: Vec<f64>,
    pub(crate) whole: Option<f64>,
    /// Greatest relative error of a number by rounding.
    pub(crate) precision: f64,
    /// The format and its type of numbers: `PNG, 8 bits`.
    pub(crate) format: String,
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
