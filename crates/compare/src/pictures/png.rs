//! Encodes and writes PNG files.

use crate::error::{CompareError, Result};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use skiagraph_reference::Image;
use std::path::Path;

/// Returns a picture as the bytes of a PNG file; `path` names the file in errors.
///
/// # Errors
/// The picture cannot be encoded.
pub fn encode(path: &Path, image: &Image) -> Result<Vec<u8>> {
    let mut png = Vec::new();
    let [width, height] = image.size;
    // Flat areas: the fast setting would make them five times as large.
    PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
        .write_image(&image.rgb, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| CompareError::write(path, error))?;
    Ok(png)
}
