//! Compares a frame of a shadow method with the ground truth.
//!
//! ```no_run
//! use skiagraph_compare::graphs::{ground_truth::Judgement, shadow_method::Outputs};
//! use skiagraph_reference::{Error, GroundTruth};
//!
//! # fn best(truth: &GroundTruth, frames: &[Outputs]) -> Result<(), Error> {
//! let mut best: Option<Judgement> = None;
//! for outputs in frames {
//!     let judged = Judgement::new(outputs, truth)?;
//!     println!("{} pixels wrong", judged.counts.wrong.total);
//!     if best.as_ref().is_none_or(|best| best.is_worse_than(&judged)) {
//!         best = Some(judged);
//!     }
//! }
//! # Ok(())
//! # }
//! ```

use crate::error::{CompareError, Result};
use crate::graphs::preset::Preset;
use crate::graphs::shadow_method::Outputs;
use skiagraph_gpu::Content;
use skiagraph_reference::{Graded, GroundTruth, Image, Statistics};
use std::collections::BTreeMap;

/// Result of comparing one frame of a method with the ground truth (the exact reference).
pub struct Judgement {
    /// Counts of right and wrong pixels of the frame. If the method answers in shares of light (0
    /// in shadow to 1 in full light), a share of 0.5 or more counts as lit.
    pub counts: Statistics,
    /// Errors of the [shares of light](crate#terms), 0 to 1, that the frame shows, against those of
    /// the [reference](crate#terms).
    pub graded: Graded,
    /// True if the method answers only 0 or 1 and the light has no extent: each pixel is then lit
    /// or in shadow, and right or wrong.
    pub is_hard: bool,
}

impl Judgement {
    /// Compares a frame's decoded outputs with the ground truth of the same view and viewport.
    ///
    /// # Errors
    /// Outputs that differ in size from the [reference](crate#terms), or hold values that are not
    /// allowed.
    pub fn new(
        outputs: &Outputs,
        ground_truth: &GroundTruth,
    ) -> Result<Self, skiagraph_reference::Error> {
        let truth = &ground_truth.pixels;
        let counts = Statistics::judged(&outputs.visibility, &outputs.status, truth)?;
        Ok(Self {
            counts,
            graded: Graded::judged(&outputs.shown(), &ground_truth.shares(), truth)?,
            is_hard: outputs.shares.is_none() && ground_truth.area.is_none(),
        })
    }

    /// Draws where the frame, of which this is the judgement, is wrong: wrong pixels of a hard
    /// answer ([`Image::error`]), errors of shares otherwise ([`Image::difference`]).
    ///
    /// # Errors
    /// Outputs that differ in size from the [reference](crate#terms).
    pub fn errors(
        &self,
        outputs: &Outputs,
        ground_truth: &GroundTruth,
    ) -> Result<Image, skiagraph_reference::Error> {
        let truth = &ground_truth.pixels;
        if self.is_hard {
            Image::error(&outputs.visibility, &outputs.status, truth)
        } else {
            Image::difference(&outputs.shown(), &ground_truth.shares(), truth)
        }
    }

    /// True if this frame is worse than another frame of the same view: by the number of all wrong
    /// pixels if [`is_hard`](Self::is_hard), otherwise by the root mean square error of the shares.
    pub fn is_worse_than(&self, other: &Self) -> bool {
        if self.is_hard {
            self.counts.wrong.total > other.counts.wrong.total
        } else {
            self.graded.rmse > other.graded.rmse
        }
    }
}

/// Compares the outputs of a preset, as they were read back, with the ground truth of the same view
/// and viewport. `layer` is the layer that is judged of outputs with one for each light.
///
/// # Errors
/// [`CompareError::InvalidOutputs`] if an output is missing, or if size, format or values are not
/// those that a shadow method must have.
pub fn judged(
    preset: &Preset,
    (contents, layer): (BTreeMap<String, Content>, usize),
    ground_truth: &GroundTruth,
) -> Result<(Outputs, Judgement)> {
    let outputs = Outputs::from_contents(contents, layer, &ground_truth.pixels);
    compared(preset, outputs, ground_truth)
}

fn compared(
    preset: &Preset,
    outputs: Result<Outputs, String>,
    ground_truth: &GroundTruth,
) -> Result<(Outputs, Judgement)> {
    let broken = |reason: String| {
        let name = &preset.name;
        CompareError::InvalidOutputs(format!("`{name}` breaks the contract of outputs: {reason}"))
    };
    let outputs = outputs.map_err(broken)?;
    let judgement = Judgement::new(&outputs, ground_truth).map_err(|error| match error {
        // A bound on a frame's work, not a wrong answer.
        skiagraph_reference::Error::Unanswered { .. } => {
            let cause = if outputs.rays.is_some_and(|rays| rays > 0) {
                "the driver ended loops of the shader that traces their rays, which pass too many \
                 triangles; another adapter may answer"
            } else {
                "their texels have no complete lists, and to test all casters for them is more \
                 work than a frame may take; give a larger `map_size` or `max_entries`, or \
                 `unlisted=rays`"
            };
            CompareError::InvalidOutputs(format!("`{}`: {error}: {cause}", preset.name))
        }
        error => broken(error.to_string()),
    })?;
    Ok((outputs, judgement))
}

/// Returns how wrong the outputs of a preset are, in pixels; the arguments are those of [`judged`].
/// Under a light [without an
/// extent](crate#terms) it is the number of wrong pixels, without those whose right answer rounding
/// to f32 may flip; under a light with an extent it is the sum of the squared errors of the pixels'
/// [shares of light](crate#terms).
///
/// # Errors
/// Those of [`judged`].
pub fn error(
    preset: &Preset,
    (contents, layer): (BTreeMap<String, Content>, usize),
    ground_truth: &GroundTruth,
) -> Result<f64> {
    let outputs = Outputs::from_contents(contents, layer, &ground_truth.pixels);
    if let (Ok(decoded), None) = (&outputs, &ground_truth.area) {
        // The errors of shares, FLIP among them, would take the most of the time.
        let counts = Statistics::judged(&decoded.visibility, &decoded.status, &ground_truth.pixels);
        if let Ok(Statistics { wrong, .. }) = counts {
            return Ok(wrong.total.saturating_sub(wrong.in_band) as f64);
        }
    }
    let (_, judgement) = compared(preset, outputs, ground_truth)?;
    let facing_light = judgement.counts.pixels.facing_light;
    Ok(judgement.graded.rmse.powi(2) * facing_light as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphs::preset;
    use crate::graphs::shadow_method::tests::truth;
    use skiagraph_reference::AreaVisibility;

    #[test]
    fn a_graded_answer_or_light_is_judged_as_graded() {
        let presets = preset::load_all(&["nsm".into()], &skiagraph_passes::EmbeddedSources);
        let presets = presets.unwrap();
        let pixels = truth();
        let error = |shares: Option<Vec<f32>>, area: Option<AreaVisibility>| {
            let outputs = Outputs {
                visibility: vec![0, 1, 0, 0],
                shares,
                status: vec![3, 2, 1, 0],
                rays: None,
            };
            let pixels = pixels.clone();
            let ground_truth = GroundTruth { pixels, area };
            let (_, judgement) = compared(&presets[0], Ok(outputs), &ground_truth).unwrap();
            (judgement.is_hard, judgement.graded.mean_absolute_error)
        };
        let area = AreaVisibility {
            samples: 4,
            shares: vec![0.5, 1.0, 0.0, 0.0],
            standard_errors: vec![0.0; 4],
        };
        assert_eq!(error(None, None), (true, 0.0));
        assert_eq!(error(Some(vec![0.0, 1.0, 0.1, 0.1]), None), (false, 0.0));
        assert_eq!(error(None, Some(area)), (false, 0.25));
    }
}
