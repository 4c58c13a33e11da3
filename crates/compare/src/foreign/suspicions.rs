//! Suspects a mistake in a foreign picture: it would agree much better with the truth if it were
//! read in another way, or it hardly agrees at all.

use crate::foreign::factor::{flipped, linear};
use crate::wording::percent;
use skiagraph_reference::GroundTruth;

/// Share of the error that another reading must leave at most to be named.
const MUCH_BETTER: f64 = 0.5;

/// Share of the error of a picture of one grey from which on a picture is taken for one of another
/// camera: twice that of the grey is the error of a picture that has nothing to do with the truth.
const ALIKE: f64 = 0.8;

/// Mean squared error from which another reading is looked for: a picture of 8 bits that is right
/// has a hundredth of it.
const LEAST: f64 = 0.001;

/// Pixels that face the light, below which nothing is suspected.
const FEW: usize = 16;

/// Mean factor that pixels in full shadow may show at most.
const AMBIENT: f64 = 0.05;

/// Compares the shares of a picture with the truth, over the pixels that face the light and that
/// `is_judged` names.
pub(crate) struct Suspect<'a> {
    pub(crate) size: [u32; 2],
    pub(crate) shares: &'a [f32],
    pub(crate) truth: &'a GroundTruth,
    pub(crate) is_judged: &'a [bool],
    /// True if the picture's file holds integers, which renderers encode for a screen.
    pub(crate) is_integer: bool,
}

/// Mistakes that are suspected in a picture.
#[derive(Default)]
pub(crate) struct Suspicions {
    pub(crate) texts: Vec<String>,
    /// True if the picture hardly agrees with the truth, whichever way it is read.
    pub(crate) is_another: bool,
}

impl Suspect<'_> {
    /// Returns a text for each suspicion, with the way out.
    pub(crate) fn suspicions(&self) -> Suspicions {
        let right = self.truth.shares();
        let judged: Vec<usize> = (0..right.len()).filter(|at| self.is_judged[*at]).collect();
        if judged.len() < FEW {
            return Suspicions::default();
        }
        let error = |shares: &[f32]| {
            let off = judged.iter().map(|at| square(shares[*at] - right[*at]));
            off.sum::<f64>() / judged.len() as f64
        };
        let mean = judged.iter().map(|at| f64::from(right[*at])).sum::<f64>() / judged.len() as f64;
        let even = error(&vec![mean as f32; right.len()]);
        let own = error(self.shares);
        let mut texts: Vec<String> = self.out_of_range().into_iter().collect();
        let is_better = |other: f64| own > LEAST && other < own * MUCH_BETTER;
        let mut readings: Vec<(f64, &str)> = self
            .readings()
            .into_iter()
            .map(|(shares, text)| (error(&shares), text))
            .filter(|(other, _)| is_better(*other))
            .collect();
        readings.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let is_explained = !readings.is_empty();
        texts.extend(readings.first().map(|(_, text)| (*text).to_owned()));
        let is_another = !is_explained && even > LEAST && own > even * ALIKE;
        if is_another {
            texts.push(self.another(&judged, &right));
        } else if !is_explained {
            texts.extend(self.ambient(&judged, &right));
        }
        Suspicions { texts, is_another }
    }

    /// The picture in other readings, each with what is told if it agrees much better.
    fn readings(&self) -> Vec<(Vec<f32>, &'static str)> {
        let width = self.size[0] as usize;
        let mirrored = |shares: &[f32]| -> Vec<f32> {
            let rows = shares.chunks_exact(width);
            rows.flat_map(|row| row.iter().rev().copied()).collect()
        };
        let upside_down = flipped(self.shares, self.size);
        let turned = mirrored(&upside_down);
        let inverted = self.shares.iter().map(|share| 1.0 - share).collect();
        let mut readings = vec![
            (
                upside_down,
                "upside down it agrees much better: rows run from the top to the bottom; save it \
                 so, or give --read-as flipped",
            ),
            (
                mirrored(self.shares),
                "mirrored, left for right, it agrees much better: pixels run from left to right; \
                 is the renderer's world left-handed?",
            ),
            (
                turned,
                "turned by 180 degrees it agrees much better: save it so",
            ),
            (
                inverted,
                "inverted it agrees much better: 1 is full light and 0 is shadow; save it so, or \
                 give --read-as inverted",
            ),
        ];
        if self.is_integer {
            let decoded = self.shares.iter().map(|it| linear((*it).into()) as f32);
            readings.push((
                decoded.collect(),
                "decoded from sRGB it agrees much better: a factor is linear; save it without the \
                 transfer function, or give --read-as srgb",
            ));
        }
        readings
    }

    /// That few pixels agree at all.
    fn another(&self, judged: &[usize], right: &[f32]) -> String {
        let agrees = |at: &&usize| (self.shares[**at] - right[**at]).abs() < 0.5;
        let agreeing = judged.iter().filter(agrees).count();
        let [width, height] = self.size;
        format!(
            "it hardly agrees with the truth: {} of the pixels are on the right side of one half, \
             and a picture of one grey is about as near to it. It may be of another camera \
             (--view, --eye, --look, or --fov, the vertical field of view; the aspect is that of \
             {width}x{height}), another light (--light) or another scene: `skiagraph truth` writes \
             the camera's matrices and what is right",
            percent(agreeing as u64, judged.len() as u64)
        )
    }

    /// That shadows are not dark: an ambient light is in the quotient.
    fn ambient(&self, judged: &[usize], right: &[f32]) -> Option<String> {
        let dark = judged.iter().filter(|at| right[**at] == 0.0);
        let mut dark: Vec<f64> = dark.map(|at| self.shares[*at].into()).collect();
        dark.sort_by(f64::total_cmp);
        let least = *dark.get(dark.len() / 10)?;
        (dark.len() >= FEW && least > AMBIENT).then(|| {
            format!(
                "nine tenths of the pixels in full shadow show a factor above {least:.2}: an \
                 ambient light may be in the picture, or a limit of how dark shadows get; render \
                 direct light alone"
            )
        })
    }

    /// That numbers are not shares at all, such as bytes that are held as floats.
    fn out_of_range(&self) -> Option<String> {
        let finite = self
            .shares
            .iter()
            .copied()
            .filter(|share| share.is_finite());
        let greatest = finite.fold(0.0, f32::max);
        (greatest >= 2.0).then(|| {
            format!(
                "its numbers reach {greatest}, and shares of light are 0 to 1: divide them by the \
                 number that stands for full light"
            )
        })
    }
}

/// The squared error of a share; one that is no number is wholly wrong.
fn square(off: f32) -> f64 {
    if off.is_finite() {
        f64::from(off).powi(2).min(1.0)
    } else {
        1.0
    }
}
