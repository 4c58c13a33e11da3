//! The oracle, the reference's ray tracer: primary and shadow rays in f64 for every pixel, on all
//! cores.

use crate::contact::{Contact, FuzzyRay};
use crate::error::Error;
use crate::error_bound::Uncertainty;
use crate::ground_truth::{Answer, Class, GroundTruthPixels};
use crate::pixels::{BACKGROUND, Progress, per_pixel};
use crate::ray::Ray;
use crate::receiver::Receiver;
use crate::tree::Tree;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use skiagraph_scene::{Camera, LIGHT_GAP, LightKind, Mesh, Parts, Towards};
use std::{fmt, ops::ControlFlow, str::FromStr, sync::OnceLock};

/// Rule by which a shadow ray leaves its receiver (the point that a pixel shows) without hitting
/// the receiver's own surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum OracleMode {
    /// The ray begins at the receiver itself; the pixel's own primitive cannot block it.
    #[default]
    Exact,
    /// The ray begins at the receiver moved by this length, in scene units, towards the light;
    /// every primitive can block it. 0.03 on Sponza gives the counts of the dissertation
    /// (docs/dissertation.md).
    Offset(f64),
}

impl OracleMode {
    /// Where the receiver's shadow ray begins, the way from there to its end, and the primitive
    /// that it passes. A light at a place is not quite reached: see [`LIGHT_GAP`].
    pub(crate) fn ray(self, receiver: &Receiver) -> (DVec3, Towards, u32) {
        let towards = receiver.towards;
        let distance = towards.distance * (1.0 - LIGHT_GAP);
        let (offset, passed) = match self {
            Self::Exact => (0.0, receiver.primitive),
            Self::Offset(length) => (length, BACKGROUND),
        };
        let way = Towards {
            distance: distance - offset,
            ..towards
        };
        (receiver.position + towards.direction * offset, way, passed)
    }
}

impl FromStr for OracleMode {
    type Err = Error;

    /// Reads `exact` or `offset:LENGTH`.
    fn from_str(text: &str) -> Result<Self, Error> {
        if text == "exact" {
            return Ok(Self::Exact);
        }
        let length = text.strip_prefix("offset:");
        let length = length.and_then(|length| length.parse().ok());
        match length {
            Some(length) if f64::is_finite(length) && length >= 0.0 => Ok(Self::Offset(length)),
            _ => Err(Error::Mode(text.to_owned())),
        }
    }
}

impl fmt::Display for OracleMode {
    /// Writes the form that [`FromStr`] reads.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => f.write_str("exact"),
            Self::Offset(length) => write!(f, "offset:{length}"),
        }
    }
}

/// The longest offset in extents of the mesh: far beyond it rays miss by rounding alone.
const MOST_EXTENTS: f64 = 1e6;

/// Ray tracer in f64 with error bounds over one mesh. It finds the ground truth against which
/// shadow methods are judged. Shadow rays pass through triangles that cast no shadow
/// ([`skiagraph_scene::Shadows`]). Masked triangles have holes, through which all rays pass, those
/// from the eye too ([`skiagraph_scene::mask`]).
pub struct Oracle<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) tree: Tree<'a>,
    /// Parts of the mesh, found at the first request for blockers.
    pub(crate) parts: OnceLock<Parts>,
}

/// The oracle's answer for a ray: the result of [`Oracle::occlusion`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occlusion {
    /// True if a triangle stands in the ray's way, at any distance.
    pub blocked: bool,
    /// True if `blocked` changes when the triangles, and the edges of their masks, move by the f32
    /// rounding of their corners, seen from the ray's origin.
    pub indeterminate: bool,
}

impl<'a> Oracle<'a> {
    /// Creates an oracle: builds a bounding-volume hierarchy over the mesh, on all cores.
    ///
    /// # Panics
    /// If a triangle's index is out of range, which [`Mesh`] forbids.
    pub fn new(mesh: &'a Mesh) -> Self {
        let (tree, parts) = (Tree::new(mesh), OnceLock::new());
        Self { mesh, tree, parts }
    }

    /// Returns the mesh that the oracle traces.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// Finds the primitive that each pixel's centre shows: one primitive id (index of a triangle of
    /// the mesh) per pixel, row by row from the top left; [`BACKGROUND`] where a pixel shows none.
    /// It is the nearest front face (counter-clockwise) or double-sided face that the ray through
    /// the centre meets between the near and the far plane. Of equally near faces it is the one
    /// with the lowest id, as a depth test with *less* keeps the first one drawn.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if the caller stops the run.
    pub fn primary(&self, camera: &Camera, progress: Progress) -> Result<Vec<u32>, Error> {
        let max_distance = self.tree.max_distance(camera.eye);
        per_pixel(camera.viewport, progress, |x, y, stack| {
            let ray = Ray::new(camera.eye, camera.pixel_direction(x, y), max_distance, 0.0);
            Ok(self.nearest(camera, &ray, stack))
        })
    }

    /// The nearest front face that a ray from the eye meets between the planes; of equally near
    /// ones the lowest id, as a depth test keeps the first one drawn.
    pub(crate) fn nearest(&self, camera: &Camera, ray: &Ray, stack: &mut Vec<u32>) -> u32 {
        let mut nearest = (camera.far, BACKGROUND);
        self.tree.walk(ray, stack, |caster, t_max| {
            if let Some(hit) = caster.hit(ray)
                && (hit.front || caster.double_sided)
                && hit.t >= camera.near
                && (hit.t, caster.primitive) < nearest
            {
                nearest = (hit.t, caster.primitive);
                // Boxes err by rounding, and an equally near triangle of lower id still counts: a
                // hair further.
                *t_max = hit.t * (1.0 + 1e-12);
            }
            ControlFlow::Continue(())
        });
        nearest.1
    }

    /// Classifies every pixel of a G-buffer as lit, in shadow, facing away or background, with one
    /// ray to the light's centre; for the share that a pixel sees of a light with extent call
    /// [`ground_truth`](crate::ground_truth()). `primitives` holds the primitive id (index of a
    /// triangle of the mesh) that each pixel shows, row by row from the top left; [`BACKGROUND`]
    /// for a pixel without geometry. The receiver is the point where the ray through the pixel's
    /// centre (moved by [`Camera::jitter`]) meets that primitive. At a triangle's edge a
    /// rasteriser, which snaps corners, may name a primitive that the centre lies slightly outside
    /// of; the receiver is within the primitive's edges all the same ([`Receiver::new`]). Casters
    /// are two-sided and count if they lie in front of the ray's origin (t > 0) by more than f64
    /// rounding; rays to a spot or point light end before it, by the share [`LIGHT_GAP`] of their
    /// length.
    ///
    /// # Errors
    /// [`Error::PixelCount`], [`Error::UnknownPrimitive`], [`Error::Light`], [`Error::Offset`],
    /// [`Error::OffsetTooLong`], [`Error::Interrupted`].
    pub fn shade(
        &self,
        camera: &Camera,
        light: impl Into<LightKind>,
        primitives: &[u32],
        mode: OracleMode,
        progress: Progress,
    ) -> Result<GroundTruthPixels, Error> {
        self.check_offset(mode)?;
        let scene = (self.mesh, camera, &light.into());
        let answer = |receiver: &Receiver, _, stack: &mut Vec<u32>| {
            let answer = self.answer(receiver, mode, stack);
            (answer, ())
        };
        let (pixels, _) = GroundTruthPixels::answered(scene, primitives, progress, answer)?;
        Ok(pixels)
    }

    /// Checks that a mode's offset can be traced.
    pub(crate) fn check_offset(&self, mode: OracleMode) -> Result<(), Error> {
        if let OracleMode::Offset(length) = mode {
            if !(length.is_finite() && length >= 0.0) {
                return Err(Error::Offset(length));
            }
            let most = self.tree.extent().map_or(length, |it| it * MOST_EXTENTS);
            if length > most {
                return Err(Error::OffsetTooLong { length, most });
            }
        }
        Ok(())
    }

    /// Traces rays, each given by its origin and direction (world space, any length but zero), and
    /// returns an answer for each, in their order. A ray has no end. Tracers in f32 are tested
    /// against the result. Origin and direction count as exact, hits count at t > 0 by more than
    /// f64 rounding, triangles are two-sided, and rays pass through the holes of their masks.
    pub fn occlusion(&self, rays: &[(Vec3, Vec3)]) -> Vec<Occlusion> {
        let exact = Uncertainty {
            segments: [DVec3::ZERO; 3],
            radius: 0.0,
        };
        rays.par_iter()
            .map_init(Vec::new, |stack, (origin, direction)| {
                let way = Towards {
                    direction: direction.as_dvec3().normalize(),
                    distance: f64::INFINITY,
                };
                let (blocked, indeterminate) =
                    self.visibility(origin.as_dvec3(), way, &exact, BACKGROUND, stack);
                Occlusion {
                    blocked,
                    indeterminate,
                }
            })
            .collect()
    }

    pub(crate) fn answer(
        &self,
        receiver: &Receiver,
        mode: OracleMode,
        stack: &mut Vec<u32>,
    ) -> Answer {
        let facing = Answer::facing(receiver);
        if !facing.class.faces_light() {
            return facing;
        }
        let (origin, way, excluded) = mode.ray(receiver);
        let (shadow, indeterminate) = match &receiver.uncertainty {
            Some(uncertainty) => self.visibility(origin, way, uncertainty, excluded, stack),
            None => (self.occluded(origin, way, excluded, stack), true),
        };
        let class = if shadow { Class::Shadow } else { Class::Lit };
        Answer {
            class,
            indeterminate: indeterminate || facing.indeterminate,
            ..facing
        }
    }

    /// Returns two answers: if the receiver is in shadow, and if that is indeterminate.
    fn visibility(
        &self,
        origin: DVec3,
        way: Towards,
        uncertainty: &Uncertainty,
        excluded: u32,
        stack: &mut Vec<u32>,
    ) -> (bool, bool) {
        let extent = uncertainty.extent(self.tree.max_distance(origin), &way);
        let ray = self.tree.ray(origin, &way, extent);
        let fuzzy = FuzzyRay::new(&ray, origin, way, uncertainty);
        let mut touched = false;
        let mut blocked: Option<(f64, bool)> = None;
        let robust = self.tree.walk(&ray, stack, |caster, _| {
            if !caster.may_shade(excluded) {
                return ControlFlow::Continue(());
            }
            match fuzzy.contact(caster) {
                Contact::Miss => {}
                Contact::Touched => touched = true,
                Contact::Hit {
                    error,
                    near_open_edge,
                } => {
                    let (largest, all_near_open_edges) = blocked.unwrap_or((0.0, true));
                    blocked = Some((largest.max(error), all_near_open_edges && near_open_edge));
                }
                Contact::Robust => return ControlFlow::Break(()),
            }
            ControlFlow::Continue(())
        });
        match blocked {
            _ if robust => (true, false),
            None => (false, touched),
            Some((_, true)) => (true, true),
            Some((error, false)) => {
                let displaced = uncertainty.displacements(way.direction, error);
                let is_blocked = |by| self.occluded(origin + by, way, excluded, stack);
                (true, !displaced.into_iter().all(is_blocked))
            }
        }
    }

    /// Returns true if any triangle but `excluded` stands between `origin` and the light.
    pub(crate) fn occluded(
        &self,
        origin: DVec3,
        way: Towards,
        excluded: u32,
        stack: &mut Vec<u32>,
    ) -> bool {
        let ray = self.tree.ray(origin, &way, 0.0);
        self.tree.walk(&ray, stack, |caster, _| {
            if caster.may_shade(excluded) && caster.blocks(&ray) {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })
    }
}

/// Classifies each pixel of a G-buffer as if nothing cast shadows: every receiver (point that a
/// pixel shows) that faces the light is lit. It is fast, because it traces no rays and builds no
/// hierarchy. `primitives` is as for [`Oracle::shade`].
///
/// # Errors
/// [`Error::PixelCount`], [`Error::UnknownPrimitive`], [`Error::Light`], [`Error::Interrupted`].
pub fn unshadowed(
    mesh: &Mesh,
    camera: &Camera,
    light: &LightKind,
    primitives: &[u32],
    progress: Progress,
) -> Result<GroundTruthPixels, Error> {
    let scene = (mesh, camera, light);
    let answer = |receiver: &Receiver, _, _: &mut Vec<u32>| (Answer::facing(receiver), ());
    let (pixels, _) = GroundTruthPixels::answered(scene, primitives, progress, answer)?;
    Ok(pixels)
}
