//! Reads the light factor of each pixel from another renderer's pictures: the share of the light
//! that arrives, 0 in shadow to 1 in full light.
//!
//! ```
//! use skiagraph_compare::foreign::factor::{Factor, Reading};
//! use skiagraph_compare::pictures::data::{Array, DataFormat, Values};
//!
//! let folder = tempfile::tempdir()?;
//! let file = folder.path().join("factor.npy");
//! let array = Array::of_pixels([2, 1], Values::U8(vec![0, 255]));
//! std::fs::write(&file, array.encode(DataFormat::Npy)?)?;
//! let factor = Factor::read(&file, None, Reading::default())?;
//! assert_eq!(factor.shares, [0.0, 1.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::foreign::raster::{self, Raster, check_size};
use skiagraph_reference::flip::linear;
use std::{path::Path, str::FromStr};

/// Conventions of a picture of the light factor that differ from the default: first row at the top,
/// linear numbers, 1 for full light. The [`Default`] sets none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// True if the first row of the file is the lowest row of the picture, so that rows are
    /// reversed.
    pub flipped: bool,
    /// True if numbers are encoded by the transfer function of sRGB, which [`linear`] undoes.
    pub srgb: bool,
    /// True if 1 is full shadow and 0 is full light.
    pub inverted: bool,
}

impl FromStr for Reading {
    type Err = String;

    /// Reads the words `flipped`, `srgb` and `inverted`, separated by commas.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut reading = Self::default();
        for word in text.split(',').map(str::trim) {
            match word {
                "flipped" => reading.flipped = true,
                "srgb" => reading.srgb = true,
                "inverted" => reading.inverted = true,
                _ => return Err(format!("`{word}`: expected flipped, srgb or inverted")),
            }
        }
        Ok(reading)
    }
}

/// Light factor of each pixel of a picture: the share of the light that arrives, 0 in shadow to 1
/// in full light.
#[derive(Clone, Debug)]
pub struct Factor {
    /// Path of the picture's file.
    pub file: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Share of the light that arrives at each pixel, row by row from the top left, 0 to 1. A
    /// faulty picture may have NaN or numbers outside that range.
    pub shares: Vec<f32>,
    /// Description of the file's format: `PNG, 8 bits, grey`.
    pub format: String,
    /// True if the file holds integers, of which the greatest that the format can hold stands for
    /// 1.
    pub is_integer: bool,
    /// True for each pixel that is black in the picture without shadows, so that its factor is
    /// unknown; empty without such a picture.
    pub is_black: Vec<bool>,
    /// Warnings about the file, such as an alpha channel that was left out.
    pub warnings: Vec<String>,
}

impl Factor {
    /// Reads the light factor from the picture at `path`. Without `unshadowed` the picture must be
    /// grey, and is the factor itself. `unshadowed` is the same picture rendered without shadows:
    /// the factor is then the quotient of the two pictures' sums of colour channels. A quotient
    /// above 1 is 1; where the picture without shadows is black it is 0.
    ///
    /// # Errors
    /// The errors of [`raster::read`]; a picture in colours without `unshadowed`; pictures of
    /// different sizes or without a finite number.
    pub fn read(path: &Path, unshadowed: Option<&Raster>, reading: Reading) -> Result<Self> {
        let raster = raster::read(path)?;
        let mut light = light(&raster, reading)?;
        let mut is_black = Vec::new();
        match unshadowed {
            None if raster.channels > 1 => {
                return Err(CompareError::Input(format!(
                    "{}: it has colours, and a light factor is grey, one share for each pixel: \
                     save the factor, or name the same picture without shadows with --unshadowed",
                    raster.file
                )));
            }
            None => {}
            Some(other) => {
                check_size((&raster.file, raster.size), (&other.file, other.size))?;
                let whole = self::light(other, reading)?;
                for (light, whole) in light.iter_mut().zip(&whole) {
                    *light = quotient(*light, *whole);
                }
                is_black = whole.iter().map(|whole| *whole <= 0.0).collect();
            }
        }
        if reading.inverted {
            light.iter_mut().for_each(|share| *share = 1.0 - *share);
        }
        Ok(Self {
            file: raster.file,
            size: raster.size,
            shares: light.iter().map(|share| *share as f32).collect(),
            format: raster.format,
            is_integer: raster.whole.is_some(),
            is_black,
            warnings: raster.warnings,
        })
    }
}

/// Light divided by that of the picture without shadows; NaN stays NaN.
fn quotient(light: f64, whole: f64) -> f64 {
    match light / whole {
        _ if whole <= 0.0 => 0.0,
        share if share > 1.0 => 1.0,
        share => share,
    }
}

/// Sum of the colour channels of each pixel, in linear light.
fn light(raster: &Raster, reading: Reading) -> Result<Vec<f64>> {
    if !raster.values.iter().any(|value| value.is_finite()) {
        return Err(CompareError::Input(format!(
            "{}: it has no finite number: all are NaN or infinite",
            raster.file
        )));
    }
    let whole = raster.whole.unwrap_or(1.0);
    let linear = |value: &f64| match value / whole {
        share if reading.srgb => linear(share),
        share => share,
    };
    let sums = raster.values.chunks_exact(raster.channels);
    let mut sums: Vec<f64> = sums.map(|pixel| pixel.iter().map(linear).sum()).collect();
    if reading.flipped {
        sums = flipped(&sums, raster.size);
    }
    Ok(sums)
}

/// Returns the values of pixels, row by row, with the rows in reverse order: the last row first.
pub fn flipped<T: Copy>(values: &[T], [width, _]: [u32; 2]) -> Vec<T> {
    let rows = values.chunks_exact(width as usize).rev();
    rows.flatten().copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pictures::data::{Array, DataFormat, Values};
    use tempfile::TempDir;

    fn raster(folder: &TempDir, name: &str, values: Values, size: [u32; 2]) -> std::path::PathBuf {
        let file = folder.path().join(name);
        let bytes = Array::of_pixels(size, values).encode(DataFormat::Npy);
        std::fs::write(&file, bytes.unwrap()).unwrap();
        file
    }

    #[test]
    fn a_quotient_is_the_factor_where_there_is_light() {
        let folder = tempfile::tempdir().unwrap();
        let shadowed = Values::F32(vec![0.0, 0.25, 0.5, 0.0, 0.7, f32::NAN]);
        let shadowed = raster(&folder, "a.npy", shadowed, [3, 2]);
        let whole = Values::F32(vec![0.5, 0.5, 0.5, 0.0, 0.6, 0.5]);
        let whole = raster::read(&raster(&folder, "b.npy", whole, [3, 2])).unwrap();
        let factor = Factor::read(&shadowed, Some(&whole), Reading::default()).unwrap();
        assert_eq!(factor.shares[..5], [0.0, 0.5, 1.0, 0.0, 1.0]);
        assert!(factor.shares[5].is_nan());
        assert_eq!(factor.is_black, [false, false, false, true, false, false]);
        let small = raster(&folder, "c.npy", Values::F32(vec![0.5]), [1, 1]);
        let error = Factor::read(&small, Some(&whole), Reading::default()).unwrap_err();
        assert!(error.to_string().contains("has 1x1 pixels, and"), "{error}");
    }

    #[test]
    fn words_of_reading_change_what_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = raster(
            &folder,
            "a.npy",
            Values::F32(vec![0.0, 0.5, 1.0, 0.5]),
            [1, 4],
        );
        let read = |words: &str| {
            let shares = Factor::read(&file, None, words.parse().unwrap())
                .unwrap()
                .shares;
            shares
                .iter()
                .map(|share| (share * 1000.0).round())
                .collect::<Vec<_>>()
        };
        assert_eq!(read("flipped"), [500.0, 1000.0, 500.0, 0.0]);
        assert_eq!(read("srgb"), [0.0, 214.0, 1000.0, 214.0]);
        assert_eq!(read("inverted,flipped"), [500.0, 0.0, 500.0, 1000.0]);
        let message = "sideways".parse::<Reading>().unwrap_err();
        assert!(
            message.contains("`sideways`: expected flipped, srgb or inverted"),
            "{message}"
        );
    }

    #[test]
    fn a_picture_without_numbers_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let file = raster(&folder, "a.npy", Values::F32(vec![f32::NAN; 4]), [2, 2]);
        let error = Factor::read(&file, None, Reading::default()).unwrap_err();
        assert!(
            error.to_string().contains("a.npy: it has no finite number"),
            "{error}"
        );
    }
}
