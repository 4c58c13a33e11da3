//! Suspects a mistake in a foreign picture: it would agree much better with the truth if it were
//! read in another way, its surfaces shade themselves, or it hardly agrees at all.

use crate::foreign::factor::flipped;
use crate::records::judged_pictures::MOST_WITHOUT_ANSWER;
use crate::wording::percent;
use skiagraph_reference::{GroundTruth, flip::linear};

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

/// Least factor that pixels in full shadow may show at most.
const AMBIENT: f64 = 0.05;

/// Ratio of light that is lacking to light that is too much, from which on the errors are of one
/// kind: a picture of another camera has both.
const ONE_SIDED: f64 = 10.0;

/// Share of the light that must be lacking on lit surfaces for them to shade themselves, and of
/// those that lack it that must be scattered.
const ACNE: [f64; 2] = [0.1, 0.5];

/// Distance in pixels, along rows and columns, within which all must be lit around one on a lit
/// surface: the filter of a map's edges reaches no farther.
const AROUND: usize = 4;

/// Compares the shares of a picture with the truth, over the pixels that face the light and that
/// `is_judged` names.
pub(crate) struct Suspect<'a> {
    pub(crate) size: [u32; 2],
    pub(crate) shares: &'a [f32],
    pub(crate) truth: &'a GroundTruth,
    pub(crate) is_judged: &'a [bool],
    /// True if the picture's file holds integers, which renderers encode for a screen.
    pub(crate) is_integer: bool,
    /// True if ids or depths have told that the camera is the right one.
    pub(crate) is_camera_known: bool,
}

/// How far a picture agrees with the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Agreement {
    /// As far as pictures of this view may.
    #[default]
    Fair,
    /// Hardly, whichever way it is read.
    Hardly,
    /// It has hardly any number, so that nothing is known of it.
    NoAnswer,
}

impl Suspect<'_> {
    /// Returns a text for each suspicion, with the way out, and whether the picture agrees.
    pub(crate) fn suspicions(&self) -> (Vec<String>, Agreement) {
        let right = self.truth.shares();
        let facing = self.is_judged.iter().filter(|it| **it).count();
        let has_answer = |at: &usize| self.is_judged[*at] && self.shares[*at].is_finite();
        let judged: Vec<usize> = (0..right.len()).filter(has_answer).collect();
        if ((facing - judged.len()) as f64) > MOST_WITHOUT_ANSWER * facing as f64 {
            let text = no_answer(judged.len() as u64, facing as u64);
            return (vec![text], Agreement::NoAnswer);
        }
        if judged.len() < FEW {
            return Default::default();
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
        let readings = self.readings().into_iter();
        let readings = readings.map(|(shares, text)| (error(&shares), text));
        let better = readings.filter(|(other, _)| is_better(*other));
        let better = better.min_by(|(one, _), (other, _)| one.total_cmp(other));
        let is_explained = better.is_some();
        texts.extend(better.map(|(_, text)| text.to_owned()));
        let acne = self.acne(&judged, &right);
        let acne = acne.filter(|_| !is_explained && own > LEAST);
        let is_hardly = even > LEAST && own > even * ALIKE && !self.is_one_sided(&judged, &right);
        let is_hardly = is_hardly && !is_explained && acne.is_none();
        texts.extend(match acne {
            None if is_hardly => Some(self.hardly(&judged, &right)),
            None => self.ambient(&judged, &right).filter(|_| !is_explained),
            acne => acne,
        });
        let agreement = is_hardly.then_some(Agreement::Hardly);
        (texts, agreement.unwrap_or_default())
    }

    /// True if nearly all errors are lacking light, or nearly all light that is too much.
    fn is_one_sided(&self, judged: &[usize], right: &[f32]) -> bool {
        let off = judged.iter();
        let off = off.map(|at| f64::from(self.shares[*at] - right[*at]));
        let [lacking, too_much] = off.fold([0.0; 2], |[lacking, too_much], off| {
            [lacking + f64::max(-off, 0.0), too_much + f64::max(off, 0.0)]
        });
        lacking.max(too_much) > ONE_SIDED * lacking.min(too_much)
    }

    /// Indices of the pixels around one, itself among them.
    fn around(&self, at: usize) -> impl Iterator<Item = usize> + use<> {
        let [width, height] = self.size.map(|side| side as usize);
        let beside = |at: usize, end: usize| at.saturating_sub(AROUND)..(at + AROUND + 1).min(end);
        let columns = beside(at % width, width);
        let rows = beside(at / width, height);
        rows.flat_map(move |y| columns.clone().map(move |x| y * width + x))
    }

    /// Tells that surfaces which are lit all around lack light, in stripes or specks or through a
    /// filter over these, while shadows are dark.
    fn acne(&self, judged: &[usize], right: &[f32]) -> Option<String> {
        let classes = &self.truth.pixels.classes;
        let is_lit = |at: usize| right[at] == 1.0;
        let is_open = |at: &usize| {
            let mut around = self.around(*at);
            is_lit(*at) && around.all(|other| is_lit(other) || !classes[other].faces_light())
        };
        let open: Vec<usize> = judged.iter().copied().filter(is_open).collect();
        let lacks = |at: usize| f64::from(1.0 - self.shares[at]).clamp(0.0, 1.0);
        let lacking: f64 = open.iter().map(|at| lacks(*at)).sum();
        let is_dim = |at: &usize| lacks(*at) > 0.05;
        let dim: Vec<usize> = open.iter().copied().filter(is_dim).collect();
        let is_scattered = |at: &&usize| {
            let mut around = self.around(**at).filter(|other| self.is_judged[*other]);
            let lack = lacks(**at);
            lack < 0.95 || around.any(|other| is_lit(other) && lack - lacks(other) > 0.5)
        };
        let scattered = dim.iter().filter(is_scattered).count();
        let dark = judged.iter().filter(|at| right[**at] == 0.0);
        let light = |at: &usize| f64::from(self.shares[*at]).clamp(0.0, 1.0);
        let too_much: f64 = dark.map(light).sum();
        let [least, most_solid] = ACNE;
        let is_acne = open.len() >= FEW
            && lacking > least * open.len() as f64
            && lacking > 3.0 * too_much
            && dim.len() * 100 < open.len() * 99
            && scattered as f64 > most_solid * dim.len() as f64;
        is_acne.then(|| {
            format!(
                "surfaces that are lit all around lack light at {} of their pixels, scattered, \
                 where shadows are as dark as they should be: acne, surfaces that shade \
                 themselves (raise the depth or the normal bias, or cast by back faces), or a \
                 filter that is too wide",
                percent(dim.len() as u64, open.len() as u64)
            )
        })
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

    /// Tells that few pixels agree at all.
    fn hardly(&self, judged: &[usize], right: &[f32]) -> String {
        let agrees = |at: &&usize| (self.shares[**at] - right[**at]).abs() < 0.5;
        let agreeing = judged.iter().filter(agrees).count();
        let [width, height] = self.size;
        let causes = if self.is_camera_known {
            "Its surfaces are those of this camera, so it may be of another light (--light), or \
             its shadows are that far off"
                .to_owned()
        } else {
            format!(
                "It may be of another camera (--view, --eye, --look, or --fov, the vertical field \
                 of view; the aspect is that of {width}x{height}), another light (--light) or \
                 another scene: `skiagraph truth` writes the camera's matrices and what is right; \
                 --ids or --depth tell that the camera is right"
            )
        };
        format!(
            "it hardly agrees with the truth: {} of the pixels are on the right side of one half, \
             and a picture of one grey is about as near to it. {causes}",
            percent(agreeing as u64, judged.len() as u64)
        )
    }

    /// Tells that no shadow is dark: an ambient light is in the quotient. A filter that blurs
    /// leaves the inside of shadows dark.
    fn ambient(&self, judged: &[usize], right: &[f32]) -> Option<String> {
        let dark = judged.iter().filter(|at| right[**at] == 0.0);
        let mut dark: Vec<f64> = dark.map(|at| self.shares[*at].into()).collect();
        dark.sort_by(f64::total_cmp);
        let least = *dark.get(dark.len() / 100)?;
        (dark.len() >= FEW && least > AMBIENT).then(|| {
            format!(
                "no shadow is darker than {least:.2}, but for a hundredth of the pixels in full \
                 shadow: an ambient light may be in the picture, or a limit of how dark shadows \
                 get; render direct light alone"
            )
        })
    }

    /// Tells that numbers are not shares at all, such as bytes that are held as floats.
    fn out_of_range(&self) -> Option<String> {
        let finite = self.shares.iter().filter(|it| it.is_finite());
        let greatest = finite.copied().fold(0.0, f32::max);
        (greatest >= 2.0).then(|| {
            format!(
                "its numbers reach {greatest}, and shares of light are 0 to 1: divide them by the \
                 number that stands for full light"
            )
        })
    }
}

/// Tells that a picture has no answer at so many pixels that it cannot be judged.
fn no_answer(answered: u64, facing: u64) -> String {
    let has = match answered {
        0 => "the picture holds no answer: it has no finite number at any".to_owned(),
        _ => format!(
            "it has a finite number at only {}",
            percent(answered, facing)
        ),
    };
    format!("{has} of the pixels that face the light, so it gets no rank")
}

/// The squared error of a share; one that is no number is wholly wrong.
pub(crate) fn square(off: f32) -> f64 {
    if off.is_finite() {
        f64::from(off).powi(2).min(1.0)
    } else {
        1.0
    }
}
