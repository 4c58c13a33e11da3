//! Textures of files.

use crate::{border::caught, limit::Limit, texels::Texels, text::has_extension};
use image::{ImageFormat, ImageReader, Limits};
use std::{io::Cursor, path::Path};

/// Room for 8192² texels of three bytes, not compressed.
const TEXTURE_FILE: Limit = Limit {
    of: "a texture",
    mib: 256,
    way_out: "scale it down",
};

/// Longest edge of a texture, texels.
const LONGEST_EDGE: u32 = 16384;

/// Reads the texels of a file.
pub(crate) fn read(path: &Path) -> Result<Texels, String> {
    let bytes = TEXTURE_FILE.read(path).map_err(|why| why.to_string())?;
    let is_tga = has_extension(path, "tga");
    decode(&bytes, is_tga.then_some(ImageFormat::Tga))
}

/// Checks that the first bytes of a picture are those of a kind that can be read. TGA has none.
pub(crate) fn check_format(bytes: &[u8]) -> Result<(), String> {
    match image::guess_format(bytes) {
        Ok(format) if format.reading_enabled() => Ok(()),
        Ok(format) => Err(format!("{format:?} is not read; a PNG or JPEG can be")),
        Err(why) => Err(format!("{why}; a PNG, JPEG or TGA can be read")),
    }
}

/// Decodes the content of a file; `format` is for a file whose first bytes do not tell.
pub(crate) fn decode(bytes: &[u8], format: Option<ImageFormat>) -> Result<Texels, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes));
    match format {
        Some(format) => reader.set_format(format),
        None => {
            reader = reader
                .with_guessed_format()
                .map_err(|why| why.to_string())?
        }
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(LONGEST_EDGE);
    limits.max_image_height = Some(LONGEST_EDGE);
    reader.limits(limits);
    let decoded = caught("image", || reader.decode())?
        .map_err(|why| format!("{why}; a PNG, JPEG or TGA can be read"))?;
    let has_alpha = decoded.color().has_alpha();
    let picture = decoded.into_rgba8();
    let size = [picture.width(), picture.height()];
    if size.contains(&0) {
        return Err("it has no texels".to_owned());
    }
    let rgba = picture.pixels().map(|texel| texel.0).collect();
    Ok(Texels {
        size,
        rgba,
        has_alpha,
    })
}
