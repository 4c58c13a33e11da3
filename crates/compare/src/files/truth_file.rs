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
        let GroundTruthPixels {
            viewport,
            classes,
            indeterminate,
            n_dot_l,
            base_colors,
        } = &self.ground_truth.pixels;
        let area = self.ground_truth.area.as_ref();
        let mut bytes = MAGIC.to_vec();
        let samples = area.map_or(0, |area| area.samples);
        let has_colors = u32::from(!base_colors.is_empty());
        for number in [viewport[0], viewport[1], samples, has_colors] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(self.wrong_surfaces.to_le_bytes());
        bytes.extend(classes.iter().map(|class| byte_of(*class)));
        bytes.extend(indeterminate.iter().map(|flag| u8::from(*flag)));
        let mut floats = |list: &[f32]| bytes.extend(list.iter().flat_map(|it| it.to_le_bytes()));
        floats(n_dot_l);
        floats(base_colors.as_flattened());
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
        let mut left = Left(&content[MAGIC.len()..]);
        let mut read = || {
            let [width, height, samples, has_colors] = left.numbers::<4>()?;
            let pixels = usize::try_from(u64::from(width) * u64::from(height)).ok()?;
            let wrong_surfaces = u64::from_le_bytes(*left.chunk::<8>()?);
            let classes = left.take(pixels)?.iter().map(|byte| class_of(*byte));
            let classes = classes.collect::<Option<_>>()?;
            let indeterminate = left.take(pixels)?.iter().map(|byte| *byte != 0).collect();
            let n_dot_l = left.floats(pixels)?;
            let colors = left.floats(if has_colors == 0 { 0 } else { 3 * pixels })?;
            let area = if samples == 0 {
                None
            } else {
                Some(AreaVisibility {
                    samples,
                    shares: left.floats(pixels)?,
                    standard_errors: left.floats(pixels)?,
                })
            };
            let pixels = GroundTruthPixels {
                viewport: [width, height],
                classes,
                indeterminate,
                n_dot_l,
                base_colors: colors.as_chunks().0.to_vec(),
            };
            let ground_truth = GroundTruth { pixels, area };
            left.0.is_empty().then_some(Self {
                ground_truth,
                wrong_surfaces,
            })
        };
        read().ok_or_else(torn)
    }
}

/// Bytes that are not read yet.
struct Left<'a>(&'a [u8]);

impl<'a> Left<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, left) = self.0.split_at_checked(count)?;
        self.0 = left;
        Some(taken)
    }

    fn chunk<const N: usize>(&mut self) -> Option<&'a [u8; N]> {
        self.take(N)?.try_into().ok()
    }

    fn numbers<const N: usize>(&mut self) -> Option<[u32; N]> {
        let mut numbers = [0; N];
        for number in &mut numbers {
            *number = u32::from_le_bytes(*self.chunk()?);
        }
        Some(numbers)
    }

    fn floats(&mut self, count: usize) -> Option<Vec<f32>> {
        let bytes = self.take(count.checked_mul(4)?)?;
        let each = bytes.as_chunks::<4>().0.iter();
        Some(each.map(|bytes| f32::from_le_bytes(*bytes)).collect())
    }
}

fn hash(bytes: &[u8]) -> [u8; 8] {
    Fingerprint::EMPTY.with_bytes(bytes).bytes()
}

fn byte_of(class: Class) -> u8 {
    match class {
        Class::Background => 0,
        Class::FacingAway => 1,
        Class::Lit => 2,
        Class::Shadow => 3,
    }
}

fn class_of(byte: u8) -> Option<Class> {
    let classes = [
        Class::Background,
        Class::FacingAway,
        Class::Lit,
        Class::Shadow,
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
