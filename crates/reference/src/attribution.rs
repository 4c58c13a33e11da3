//! Finds the pixels of a foreign picture that cannot be held against the truth, as it is unknown
//! which of several surfaces they show.

use crate::area::{answered, strata};
use crate::error::Error;
use crate::ground_truth::{Class, GroundTruth};
use crate::oracle::{Oracle, OracleMode};
use crate::pixels::{BACKGROUND, Progress, check_pixel_count, existing, per_pixel};
use crate::receiver::Receiver;
use crate::visible::Candidate;
use skiagraph_scene::{Camera, LightKind};

/// Greatest difference of two shares of light that 8 bits cannot show.
const SAME: f64 = 1.0 / 255.0;

/// Marks the pixels whose truth is not unique: true for a pixel that faces the light and is not
/// indeterminate by `ground_truth`, if one of its `candidates` has another answer, an indeterminate
/// one, or a share of an area light that differs by more than 1/255.
///
/// `ground_truth` is of this camera and light, found with `mode` and `samples`, which is ignored
/// for a light without extent; `candidates` are those of [`candidates`](crate::candidates), one
/// list for each pixel. The result has an entry for each pixel, row by row from the top left.
///
/// # Errors
/// [`Error::PixelCount`], [`Error::UnknownPrimitive`], [`Error::Interrupted`].
pub fn unattributable(
    oracle: &Oracle<'_>,
    (camera, light): (&Camera, &LightKind),
    candidates: &[Vec<Candidate>],
    ground_truth: &GroundTruth,
    (mode, samples): (OracleMode, u32),
    progress: Progress,
) -> Result<Vec<bool>, Error> {
    check_pixel_count("candidates", camera.viewport, candidates.len())?;
    let (truth, width) = (&ground_truth.pixels, camera.viewport[0] as usize);
    check_pixel_count("classes", camera.viewport, truth.classes.len())?;
    let shares = ground_truth.shares();
    let strata = ground_truth.area.is_some().then(|| strata(samples));
    let count = oracle.mesh.triangles.len() as u64;
    per_pixel(camera.viewport, progress, |x, y, stack| {
        let place = y as usize * width + x as usize;
        let (class, share) = (truth.classes[place], f64::from(shares[place]));
        if !class.faces_light() || truth.indeterminate[place] || candidates[place].len() < 2 {
            return Ok(false);
        }
        for candidate in &candidates[place] {
            if candidate.primitive == BACKGROUND {
                return Ok(true);
            }
            let primitive = existing(candidate.primitive, [x, y], count)?;
            let receiver = Receiver::new(oracle.mesh, primitive, camera, [x, y], light);
            let (answer, other) = match &strata {
                Some(strata) => {
                    let place = (&receiver, [x, y]);
                    let (answer, [share, _]) = answered(oracle, light, strata, place, mode, stack);
                    (answer, share)
                }
                None => {
                    let answer = oracle.answer(&receiver, mode, stack);
                    (answer, f64::from(u8::from(answer.class == Class::Lit)))
                }
            };
            let faces_light = answer.class.faces_light();
            if !faces_light || answer.indeterminate || (other - share).abs() > SAME {
                return Ok(true);
            }
        }
        Ok(false)
    })
}
