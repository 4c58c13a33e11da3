//! Reads the numbers of a picture that another program wrote: PNG, OpenEXR or an array of NumPy.
//!
//! ```
//! use skiagraph_compare::foreign::raster;
//! use skiagraph_compare::pictures::data::{Array, DataFormat, Values};
//!
//! let folder = tempfile::tempdir()?;
//! let file = folder.path().join("factor.npy");
//! let array = Array::of_pixels([2, 1], Values::F32(vec![0.25, 1.0]));
//! std::fs::write(&file, array.encode(DataFormat::Npy)?)?;
//! let raster = raster::read(&file)?;
//! assert_eq!((raster.size, raster.values), ([2, 1], vec![0.25, 1.0]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
pub use crate::foreign::decoded::Raster;
use crate::foreign::decoded::{MOST_NUMBERS, checked, guarded};
use crate::foreign::{exr_file, npy_file};
use crate::wording::size;
use image::{DynamicImage, ImageFormat, ImageReader, Limits};
use skiagraph_scene::Limit;
use std::{io::Cursor, path::Path};

/// Largest file of a picture.
const PICTURE_FILE: Limit = Limit {
    of: "a picture",
    mib: 1024,
    way_out: "render it in fewer pixels, or save one channel",
};

/// Reads a file of at most 1 GiB and 16,384 pixels along an edge. Its first bytes tell the
/// format.
///
/// # Errors
/// [`CompareError::Input`] with the path: a file that cannot be read, is too large or in
/// another format, is damaged, or has other channels than grey or red, green and blue (with or
/// without alpha).
pub fn read(path: &Path) -> Result<Raster> {
    let file = path.display().to_string();
    let named = |why: String| CompareError::Input(format!("{file}: {why}"));
    let bytes = PICTURE_FILE.read(path);
    let bytes = bytes.map_err(|error| named(error.to_string()))?;
    let decoded = match &bytes[..] {
        [0x89, b'P', b'N', b'G', ..] => png(&bytes),
        [0x76, 0x2f, 0x31, 0x01, ..] => exr_file::decode(&bytes),
        [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => npy_file::decode(&bytes),
        _ => Err(unknown(&bytes)),
    };
    Ok(Raster {
        file: file.clone(),
        ..decoded.map_err(named)?.without_alpha()
    })
}

fn unknown(bytes: &[u8]) -> String {
    let expected = "expected a PNG, an OpenEXR picture (.exr) or an array of NumPy (.npy)";
    match image::guess_format(bytes) {
        Ok(ImageFormat::Jpeg) => format!(
            "it is a JPEG, which changes the numbers of pixels; {expected}: save it anew from the \
             renderer"
        ),
        Ok(format) => format!("it is a {format:?}; {expected}"),
        Err(_) if bytes.is_empty() => format!("it is empty; {expected}"),
        Err(_) => format!("its first bytes are not those of a picture; {expected}"),
    }
}

fn png(bytes: &[u8]) -> Result<Raster, String> {
    let reader = || {
        let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
        let mut limits = Limits::default();
        limits.max_alloc = Some(MOST_NUMBERS * 2);
        reader.limits(limits);
        reader
    };
    let refused = |why: image::ImageError| format!("it cannot be decoded: {why}; save it anew");
    let size = guarded("image", || reader().into_dimensions().map_err(refused))?;
    let size = <[u32; 2]>::from(size).map(u64::from);
    checked(size, 1)?;
    let picture = guarded("image", || reader().decode().map_err(refused))?;
    let colour = picture.color();
    let channels = usize::from(colour.channel_count());
    let bits = u32::from(colour.bits_per_pixel()) / channels as u32;
    Ok(Raster {
        size: checked(size, channels as u64)?,
        channels,
        has_alpha: colour.has_alpha(),
        values: samples(&picture, bits),
        whole: Some(f64::from((1u32 << bits) - 1)),
        precision: 1.0 / f64::from((1u32 << bits) - 1),
        format: format!("PNG, {bits} bits"),
        ..Raster::default()
    })
}

fn samples(picture: &DynamicImage, bits: u32) -> Vec<f64> {
    let bytes = picture.as_bytes();
    if bits == 16 {
        let pairs = bytes.as_chunks::<2>().0.iter();
        pairs.map(|pair| u16::from_ne_bytes(*pair).into()).collect()
    } else {
        bytes.iter().map(|byte| f64::from(*byte)).collect()
    }
}

/// Checks that two pictures have the same size.
///
/// # Errors
/// [`CompareError::Input`] that names both files with their sizes.
pub fn check_size((one, own): (&str, [u32; 2]), (other, its): (&str, [u32; 2])) -> Result<()> {
    if own == its {
        return Ok(());
    }
    let [own, its] = [own, its].map(size);
    Err(CompareError::Input(format!(
        "{one} has {own} pixels, and {other} has {its}: render both in one size"
    )))
}
