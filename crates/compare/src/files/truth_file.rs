//! The file in which the reference's answers for a frame are kept, so that each is traced once.
//!
//! ```
//! use skiagraph_compare::files::truth_file::Truth;
//! use skiagraph_reference::{GroundTruth, GroundTruthPixels};
//!
//! let pixels = GroundTruthPixels {
//!     viewport: [0, 0], classes: vec![], indeterminate: vec![], n_dot_l: vec![],
//!     base_colors: vec![],
//! };
//! let ground_truth = GroundTruth { pixels, area: None };
//! let truth = Truth { ground_truth, wrong_surfaces: 0 };
//! let bytes = truth.bytes();
//! assert_eq!(Truth::from_bytes(&bytes)?, truth);
//! assert!(Truth::from_bytes(&bytes[1..]).is_err());
//! # Ok::<(), String>(())
//! ```

use crate::files::fingerprint::Fingerprint;
use skiagraph_reference::{AreaVisibility, Class, GroundTruth, GroundTruthPixels};

/// Begins the file.
const MAGIC: &[u8; 16] = b"skiagraph-truth1";

/// The reference's answers for one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Answer for each pixel.
    pub ground_truth: GroundTruth,
    /// Number of pixels whose rasterised surface is hidden behind another one by more than
    /// rounding.
    pub wrong_surfaces: u64,
}

impl Truth {
    /// Returns the content of the file, the same bytes for the same answers: a fixed head, the
    /// answers of all pixels, and a hash of all before it. Numbers are little-endian.
    pub fn bytes(&self) -> Vec<u8> {
        let pixels = &self.ground_truth.pixels;
        let area = self.ground_truth.area.as_ref();
        let mut bytes = MAGIC.to_vec();
        let samples = area.map_or(0, |area| area.samples);
        let has_colors = u32::from(!pixels.base_colors.is_empty());
        let [width, height] = pixels.viewport;
        bytes.extend(bytemuck::bytes_of(&[width, height, samples, has_colors]));
        bytes.extend(bytemuck::bytes_of(&self.wrong_surfaces));
        bytes.extend(pixels.status());
        bytes.extend(bytemuck::cast_slice::<bool, u8>(&pixels.indeterminate));
        let mut floats = |list: &[f32]| bytes.extend(bytemuck::cast_slice::<f32, u8>(list));
        floats(&pixels.n_dot_l);
        floats(pixels.base_colors.as_flattened());
        if let Some(area) = area {
            floats(&area.shares);
            floats(&area.standard_errors);
        }
        let hash = hash(&bytes);
        bytes.extend(hash);
        bytes
    }

    /// Reads the content of the file.
    ///
    /// # Errors
    /// Content that is torn, or not such a file; a sentence says which.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let torn = || "it is torn, or not a file of the reference's answers".to_owned();
        let (content, end) = bytes.split_last_chunk::<8>().ok_or_else(torn)?;
        if !content.starts_with(MAGIC) || hash(content) != *end {
            return Err(torn());
        }
        let left = &mut &content[MAGIC.len()..];
        let mut read = || {
            let [width, height, samples, has_colors] = take(left, 4)?[..] else {
                return None;
            };
            let pixels = usize::try_from(u64::from(width) * u64::from(height)).ok()?;
            let wrong_surfaces = take(left, 1)?[0];
            let classes = take(left, pixels)?.into_iter().map(class_of);
            let classes = classes.collect::<Option<_>>()?;
            let indeterminate = take::<u8>(left, pixels)?;
            let indeterminate = indeterminate.iter().map(|byte| *byte != 0).collect();
            let n_dot_l = take(left, pixels)?;
            let base_colors = take(left, if has_colors == 0 { 0 } else { pixels })?;
            let area = if samples == 0 {
                None
            } else {
                Some(AreaVisibility {
                    samples,
                    shares: take(left, pixels)?,
                    standard_errors: take(left, pixels)?,
                })
            };
            let pixels = GroundTruthPixels {
                viewport: [width, height],
                classes,
                indeterminate,
                n_dot_l,
                base_colors,
            };
            let ground_truth = GroundTruth { pixels, area };
            left.is_empty().then_some(Self {
                ground_truth,
                wrong_surfaces,
            })
        };
        read().ok_or_else(torn)
    }
}

/// Takes some numbers from the bytes that are left.
fn take<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(
    left: &mut &[u8],
    count: usize,
) -> Option<Vec<T>> {
    let taken = left.split_off(..count.checked_mul(size_of::<T>())?)?;
    Some(bytemuck::pod_collect_to_vec(taken))
}

fn hash(bytes: &[u8]) -> [u8; 8] {
    Fingerprint::EMPTY.with_bytes(bytes).bytes()
}

fn class_of(byte: u8) -> Option<Class> {
    let classes = [
        Class::Background,
        Class::FacingAway,
        Class::Lit,
        Class::Shadow,
        Class::Unshadowed,
    ];
    classes.get(usize::from(byte)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth(area: bool) -> Truth {
        let pixels = GroundTruthPixels {
            viewport: [2, 2],
            classes: vec![
                Class::Background,
                Class::FacingAway,
                Class::Lit,
                Class::Shadow,
            ],
            indeterminate: vec![false, true, false, true],
            n_dot_l: vec![0.0, -0.5, 1.0, f32::MIN_POSITIVE],
            base_colors: if area {
                vec![[0.25, 0.5, 1.0]; 4]
            } else {
                Vec::new()
            },
        };
        let area = area.then(|| AreaVisibility {
            samples: 512,
            shares: vec![0.0, 0.0, 0.75, 0.125],
            standard_errors: vec![0.0, 0.0, 0.01, 0.02],
        });
        Truth {
            ground_truth: GroundTruth { pixels, area },
            wrong_surfaces: 7,
        }
    }

    #[test]
    fn answers_are_read_back_to_the_bit_and_a_torn_file_is_known() {
        for truth in [false, true].map(truth) {
            let bytes = truth.bytes();
            assert_eq!(Truth::from_bytes(&bytes), Ok(truth));
            for end in 0..bytes.len() {
                assert!(Truth::from_bytes(&bytes[..end]).is_err(), "{end} bytes");
            }
            let mut other = bytes.clone();
            other[40] ^= 1;
            assert!(Truth::from_bytes(&other).is_err());
        }
    }
}
