//! PNG files.

use crate::error::CliError;
use crate::files::write::write_whole;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use skiagraph_reference::Image;
use std::path::Path;

/// Writes a picture, whole or not at all.
///
/// # Errors
/// The path cannot be written.
pub fn save(path: &Path, image: &Image) -> Result<(), CliError> {
    let mut png = Vec::new();
    let [width, height] = image.size;
    PngEncoder::new(&mut png)
        .write_image(&image.rgb, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| CliError::write(path, error))?;
    write_whole(path, &png)
}
