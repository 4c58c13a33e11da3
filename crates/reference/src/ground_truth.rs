//! The ground truth of a view: the oracle's answer at each pixel.

use crate::error::Error;
use crate::pixels::{BACKGROUND, Progress, check_pixel_count, per_pixel, place};
use crate::receiver::{self, Receiver};
use crate::status;
use rayon::prelude::*;
use skiagraph_scene::{Camera, LightKind, Mesh};
use std::borrow::Cow;

/// The oracle's answer for a pixel: tells if light reaches its receiver, the point that the pixel
/// shows. For lights with extent [`ground_truth`](crate::ground_truth()) counts shares, while
/// [`Oracle::shade`](crate::Oracle::shade) asks the light's centre alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The pixel shows no geometry.
    Background,
    /// The receiver faces away from the light, dot(interpolated normal, vector to the light) ≤ 0,
    /// whether or not a caster is in between; or it lies outside of a spot light's cone.
    FacingAway,
    /// The receiver faces the light and sees it; where shares are counted, at least half of it.
    Lit,
    /// The receiver faces the light and does not see it; where shares are counted, less than half.
    Shadow,
    /// The receiver is of a surface that receives no shadow ([`skiagraph_scene::Shadows`]): it is
    /// lit wherever it faces, and not judged.
    Unshadowed,
}

impl Class {
    /// Returns true for [`Lit`](Self::Lit) and [`Shadow`](Self::Shadow): the pixel is one of the
    /// *pixels facing the light* (PFL), of which error counts are given as shares.
    pub fn faces_light(self) -> bool {
        matches!(self, Self::Lit | Self::Shadow)
    }

    /// Returns true for [`Lit`](Self::Lit) and [`Unshadowed`](Self::Unshadowed).
    pub fn is_lit(self) -> bool {
        matches!(self, Self::Lit | Self::Unshadowed)
    }
}

/// The oracle's answers for one view. Every list has one entry per pixel, row by row from the top
/// left.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundTruthPixels {
    /// Width and height of the view in pixels.
    pub viewport: [u32; 2],
    /// Answer for each pixel.
    pub classes: Vec<Class>,
    /// True where the answer flips when the receiver (the point that the pixel shows) or the
    /// triangles that may block its light move within their f32 error bounds. An error of an f32
    /// method there is excused.
    pub indeterminate: Vec<bool>,
    /// Per pixel: dot(interpolated vertex normal, unit vector towards the light's centre); 0 in the
    /// background, at most 0 outside of a spot light's cone.
    pub n_dot_l: Vec<f32>,
    /// Linear red, green and blue of each pixel's base colour, for pictures; black in the
    /// background. Empty if the mesh has no materials.
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

    /// Returns the share of a light without extent that each pixel sees: 1 where lit, 0 elsewhere;
    /// row by row from the top left. For a light with extent see [`GroundTruth::shares`].
    pub fn shares(&self) -> Vec<f32> {
        let share = |class: &Class| f32::from(u8::from(class.is_lit()));
        self.classes.iter().map(share).collect()
    }

    /// Returns the reference's visibility of each pixel, as a shadow method would output it: 1
    /// where lit, 0 elsewhere; row by row from the top left.
    pub fn visibility(&self) -> Vec<u8> {
        let visibility = |class: &Class| u8::from(class.is_lit());
        self.classes.iter().map(visibility).collect()
    }

    /// Returns the reference's status of each pixel, a value of [`status`], as a shadow method
    /// would output it, row by row from the top left. It is never uncertain.
    pub fn status(&self) -> Vec<u8> {
        let status = |class: &Class| match class {
            Class::Background => status::BACKGROUND,
            Class::FacingAway => status::FACING_AWAY,
            Class::Lit | Class::Unshadowed => status::CERTAIN_LIGHT,
            Class::Shadow => status::CERTAIN_SHADOW,
        };
        let codes = self.classes.iter().map(status);
        codes.map(|code| code as u8).collect()
    }
}

/// Returns the base colours of the pixels of a G-buffer; nothing where the mesh has no materials.
fn base_colors(mesh: &Mesh, camera: &Camera, primitives: &[u32]) -> Vec<[f32; 3]> {
    let surfaces = &mesh.surfaces;
    if surfaces.materials.is_empty() {
        return Vec::new();
    }
    let colour = |(pixel, &primitive): (usize, &u32)| {
        if primitive == BACKGROUND {
            return [0.0; 3];
        }
        let [x, y] = place(pixel, camera.viewport);
        let direction = camera.pixel_direction(x, y);
        let weights = receiver::weights(mesh, primitive, camera.eye, direction);
        surfaces.base_color(primitive, weights)
    };
    primitives.par_iter().enumerate().map(colour).collect()
}

/// Share of an area light that each pixel sees. Lists have one entry per pixel, row by row from the
/// top left.
///
/// The shadow rays of a pixel go to two independent sets of points on the light, each set
/// stratified into parts of equal area. Half the difference of the two sets' means estimates the
/// standard error of the share.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaVisibility {
    /// Number of shadow rays for each pixel that faces the light.
    pub samples: u32,
    /// Share of the light that each pixel sees, 0 in the umbra to 1 where it sees all of the light.
    /// 0 also where it faces away from the light, and in the background; 1 where it receives no
    /// shadow.
    pub shares: Vec<f32>,
    /// Estimated standard error of each pixel's share; 0 where no ray was traced.
    pub standard_errors: Vec<f32>,
}

impl AreaVisibility {
    /// Returns `[root mean square, maximum]` of the standard errors, over the pixels that face the
    /// light by `truth`; both 0 if no pixel does.
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

/// Ground truth of one view under one light: the answer at each pixel, and the visible share of a
/// light with extent.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundTruth {
    /// Answer for each pixel.
    pub pixels: GroundTruthPixels,
    /// Share of the light that each pixel sees; `None` for a light without extent, of which a pixel
    /// sees all or nothing.
    pub area: Option<AreaVisibility>,
}

impl GroundTruth {
    /// Returns the share of the light that each pixel sees, 0 to 1, row by row from the top left.
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
            class: if !receiver.receives {
                Class::Unshadowed
            } else if faces_away || receiver.outside_cone {
                Class::FacingAway
            } else {
                Class::Lit
            },
            indeterminate: receiver.receives && !beyond_cone && (could_turn || could_leave),
            n_dot_l: if receiver.outside_cone {
                receiver.n_dot_l.min(0.0) as f32
            } else {
                receiver.n_dot_l as f32
            },
        }
    }
}
