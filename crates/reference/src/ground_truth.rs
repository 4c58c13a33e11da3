//! The ground truth of a view: the oracle's answer at each pixel.

use crate::{
    error::Error,
    pixels::{BACKGROUND, Progress, check_pixel_count, per_pixel},
    receiver::{self, Receiver},
    status,
};
use rayon::prelude::*;
use skiagraph_scene::{Camera, LightKind, Mesh};
use std::borrow::Cow;

/// Oracle's answer for a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Shows no geometry.
    Background,
    /// dot(interpolated normal, l) ≤ 0, in its own shade, whatever stands in between; or outside of
    /// a spot light's cone.
    FacingAway,
    /// Faces the light and sees it.
    Lit,
    /// Faces the light and does not see it.
    Shadow,
}

impl Class {
    /// Returns true if the pixel is one of the *pixels facing the light* (PFL), the denominator of
    /// all shares.
    pub fn faces_light(self) -> bool {
        matches!(self, Self::Lit | Self::Shadow)
    }
}

/// The exact answer for one view. All buffers have one entry per pixel, row by row from the top
/// left.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundTruthPixels {
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// The answer.
    pub classes: Vec<Class>,
    /// True where the answer flips when receiver or casters move within their f32 error bounds: no
    /// f32 method can be blamed for it.
    pub indeterminate: Vec<bool>,
    /// dot(interpolated vertex normal, unit vector towards the light); 0 in the background.
    pub n_dot_l: Vec<f32>,
    /// Linear base colour of each pixel, for pictures; nothing where the mesh has no materials.
    pub base_colors: Vec<[f32; 3]>,
}

impl GroundTruthPixels {
    /// Answers for the receivers of a G-buffer's pixels, and what else is found of each.
    ///
    /// # Errors
    /// [`Error::PixelCount`], [`Error::UnknownPrimitive`], [`Error::Light`],
    /// [`Error::Interrupted`].
    pub(crate) fn answered<T: Default + Send>(
        (mesh, camera, light): (&Mesh, &Camera, &LightKind),
        primitives: &[u32],
        progress: Progress,
        answer: impl Fn(&Receiver, [u32; 2], &mut Vec<u32>) -> (Answer, T) + Sync,
    ) -> Result<(Self, Vec<T>), Error> {
        check_pixel_count("primitives", camera.viewport, primitives.len())?;
        light.check().map_err(Error::Light)?;
        let answers = per_pixel(camera.viewport, progress, |x, y, stack| {
            let receiver = Receiver::from_pixel(mesh, primitives, camera, [x, y], light)?;
            let background = || (Answer::BACKGROUND, T::default());
            Ok(receiver.map_or_else(background, |receiver| answer(&receiver, [x, y], stack)))
        })?;
        let (answers, more): (Vec<Answer>, _) = answers.into_iter().unzip();
        let pixels = Self {
            viewport: camera.viewport,
            base_colors: base_colors(mesh, camera, primitives),
            classes: answers.iter().map(|answer| answer.class).collect(),
            indeterminate: answers.iter().map(|answer| answer.indeterminate).collect(),
            n_dot_l: answers.iter().map(|answer| answer.n_dot_l).collect(),
        };
        Ok((pixels, more))
    }

    /// The reference's own shares of a light without extent: 1 where lit, 0 elsewhere.
    pub fn shares(&self) -> Vec<f32> {
        let share = |&class: &Class| f32::from(u8::from(class == Class::Lit));
        self.classes.iter().map(share).collect()
    }

    /// The reference's own visibility: 1 where lit, 0 elsewhere.
    pub fn visibility(&self) -> Vec<u8> {
        self.classes
            .iter()
            .map(|&class| u8::from(class == Class::Lit))
            .collect()
    }

    /// The reference's own status: never uncertain.
    pub fn status(&self) -> Vec<u8> {
        let status = |class: &Class| match class {
            Class::Background => status::BACKGROUND,
            Class::FacingAway => status::FACING_AWAY,
            Class::Lit => status::CERTAIN_LIGHT,
            Class::Shadow => status::CERTAIN_SHADOW,
        };
        self.classes
            .iter()
            .map(|class| status(class) as u8)
            .collect()
    }
}

/// Returns the base colours of the pixels of a G-buffer; nothing where the mesh has no materials.
fn base_colors(mesh: &Mesh, camera: &Camera, primitives: &[u32]) -> Vec<[f32; 3]> {
    let surfaces = &mesh.surfaces;
    if surfaces.materials.is_empty() {
        return Vec::new();
    }
    let width = camera.viewport[0];
    let colour = |(pixel, &primitive): (usize, &u32)| {
        if primitive == BACKGROUND {
            return [0.0; 3];
        }
        let pixel = pixel as u32;
        let direction = camera.pixel_direction(pixel % width, pixel / width);
        let weights = receiver::weights(mesh, primitive, camera.eye, direction);
        surfaces.base_color(primitive, weights)
    };
    primitives.par_iter().enumerate().map(colour).collect()
}

/// The share of an area light that each pixel sees, row by row from the top left.
///
/// The samples are two independent sets of as many strata of equal area, so that half the
/// difference of their means estimates the standard error of the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaVisibility {
    /// Shadow rays per pixel that faces the light.
    pub samples: u32,
    /// 0 in the umbra, 1 where all of the light is seen; 0 where the pixel does not face the light.
    pub shares: Vec<f32>,
    /// The estimated standard error of each share.
    pub standard_errors: Vec<f32>,
}

impl AreaVisibility {
    /// The standard errors' root mean square and greatest over the pixels that face the light.
    pub fn standard_error(&self, truth: &GroundTruthPixels) -> [f64; 2] {
        let classes = truth.classes.iter().zip(&self.standard_errors);
        let facing = classes.filter(|(class, _)| class.faces_light());
        let errors: Vec<f64> = facing.map(|(_, &error)| f64::from(error)).collect();
        let squares: f64 = errors.iter().map(|error| error * error).sum();
        [
            (squares / (errors.len().max(1)) as f64).sqrt(),
            errors.iter().copied().fold(0.0, f64::max),
        ]
    }
}

/// Ground truth of one view: the lit pixels of a light without extent, and the visible share of a
/// light with one.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundTruth {
    /// Answer at each pixel.
    pub pixels: GroundTruthPixels,
    /// The shares, of a light with extent.
    pub area: Option<AreaVisibility>,
}

impl GroundTruth {
    /// Returns the share of the light that each pixel sees.
    pub fn shares(&self) -> Cow<'_, [f32]> {
        match &self.area {
            Some(area) => Cow::Borrowed(&area.shares),
            None => Cow::Owned(self.pixels.shares()),
        }
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Answer {
    pub(crate) class: Class,
    pub(crate) indeterminate: bool,
    pub(crate) n_dot_l: f32,
}

impl Answer {
    pub(crate) const BACKGROUND: Self = Self {
        class: Class::Background,
        indeterminate: false,
        n_dot_l: 0.0,
    };

    /// Returns the answer before blockers are looked for: facing away, or lit.
    pub(crate) fn facing(receiver: &Receiver) -> Self {
        let faces_away = receiver.n_dot_l <= 0.0;
        let could_turn = receiver.n_dot_l.abs() <= receiver.n_dot_l_error;
        // A receiver that faces away does so within the cone and outside of it.
        let could_leave = receiver.on_cone_edge && (!faces_away || could_turn);
        let beyond_cone = receiver.outside_cone && !receiver.on_cone_edge;
        Self {
            class: if faces_away || receiver.outside_cone {
                Class::FacingAway
            } else {
                Class::Lit
            },
            indeterminate: !beyond_cone && (could_turn || could_leave),
            n_dot_l: if receiver.outside_cone {
                receiver.n_dot_l.min(0.0) as f32
            } else {
                receiver.n_dot_l as f32
            },
        }
    }
}
