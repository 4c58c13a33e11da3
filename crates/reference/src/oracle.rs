//! The oracle: primary and shadow rays in f64 for every pixel, on all cores.

use crate::{
    Error,
    band::{Contact, FuzzyRay, Uncertainty},
    ray::Ray,
    receiver::Receiver,
    tree::Tree,
};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use skiagraph_scene::{Bvh, Camera, DirectionalLight, Mesh};
use std::{
    borrow::Cow,
    fmt,
    ops::ControlFlow,
    str::FromStr,
    sync::atomic::{AtomicBool, AtomicU64, Ordering},
};

/// Primitive id of a pixel that shows no geometry.
pub const BACKGROUND: u32 = u32::MAX;

/// How a shadow ray leaves its receiver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum OracleMode {
    /// From the receiver itself; the pixel's own primitive is no caster.
    #[default]
    Exact,
    /// From the receiver moved by this length, in scene units, towards the light; every primitive is a caster. 0.03 on Sponza is the
    /// dissertation's convention.
    Offset(f64),
}

impl FromStr for OracleMode {
    type Err = Error;

    /// Reads `exact` or `offset:LENGTH`.
    fn from_str(text: &str) -> Result<Self, Error> {
        if text == "exact" {
            return Ok(Self::Exact);
        }
        let length = text
            .strip_prefix("offset:")
            .and_then(|length| length.parse().ok());
        match length {
            Some(length) if f64::is_finite(length) && length >= 0.0 => Ok(Self::Offset(length)),
            _ => Err(Error::Mode(text.to_owned())),
        }
    }
}

impl fmt::Display for OracleMode {
    /// What [`FromStr`] reads.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => f.write_str("exact"),
            Self::Offset(length) => write!(f, "offset:{length}"),
        }
    }
}

/// How a run reports its progress and is stopped.
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    /// Called from any thread whenever a row of pixels is done, with the number of rows done so far, of `viewport[1]`.
    pub rows_done: &'a (dyn Fn(u64) + Sync),
    /// Raised by the caller to stop; the run then ends within a row's time with [`Error::Interrupted`].
    pub interrupted: &'a AtomicBool,
}

/// The longest offset in extents of the mesh: far beyond it rays miss by rounding alone.
const MOST_EXTENTS: f64 = 1e6;

static NEVER: AtomicBool = AtomicBool::new(false);

impl Default for Progress<'_> {
    /// Silent, and never interrupted.
    fn default() -> Self {
        Self {
            rows_done: &|_| (),
            interrupted: &NEVER,
        }
    }
}

/// What the oracle says of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Shows no geometry.
    Background,
    /// dot(interpolated normal, l) ≤ 0: in its own shade, whatever stands in between.
    FacingAway,
    /// Faces the light and sees it.
    Lit,
    /// Faces the light and does not see it.
    Shadow,
}

impl Class {
    /// Whether the pixel is one of the *pixels facing the light* (PFL), the denominator of all shares.
    pub fn faces_light(self) -> bool {
        matches!(self, Self::Lit | Self::Shadow)
    }
}

/// The exact answer for one view. All buffers have one entry per pixel, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// The answer.
    pub classes: Vec<Class>,
    /// Whether the answer flips when receiver or casters move by their own f32 rounding error: no f32 method can be blamed for it.
    pub in_band: Vec<bool>,
    /// dot(interpolated vertex normal, unit vector towards the light); 0 in the background.
    pub n_dot_l: Vec<f32>,
}

/// The f64 ray tracer over one mesh.
pub struct Oracle<'a> {
    mesh: &'a Mesh,
    tree: Tree<'a>,
}

/// What the oracle says of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occlusion {
    /// Whether a triangle stands in its way.
    pub blocked: bool,
    /// Whether that changes when the triangles move by what f32 makes of their corners, seen from the ray's origin.
    pub in_band: bool,
}

#[derive(Clone, Copy)]
struct Answer {
    class: Class,
    in_band: bool,
    n_dot_l: f32,
}

impl<'a> Oracle<'a> {
    /// Builds a hierarchy over the mesh, with all cores.
    ///
    /// # Panics
    /// If a triangle's index is out of range, which [`Mesh`] forbids.
    pub fn new(mesh: &'a Mesh) -> Self {
        let tree = Tree::new(mesh, Cow::Owned(Bvh::build(mesh)))
            .expect("the hierarchy was built over this very mesh");
        Self { mesh, tree }
    }

    /// Uses a hierarchy that was built over `mesh` before.
    ///
    /// # Errors
    /// [`Error::Hierarchy`] if it cannot have been.
    pub fn with_bvh(mesh: &'a Mesh, bvh: &'a Bvh) -> Result<Self, Error> {
        Ok(Self {
            mesh,
            tree: Tree::new(mesh, Cow::Borrowed(bvh))?,
        })
    }

    /// The primitive that each pixel's centre shows, row by row from the top left, [`BACKGROUND`] for none: the nearest
    /// front face (counter-clockwise) between the near and the far plane; of equally near ones the lowest id, as a depth test
    /// with *less* keeps the first one drawn.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub fn primary(&self, camera: &Camera, progress: Progress) -> Result<Vec<u32>, Error> {
        let reach = self.tree.reach(camera.eye);
        per_pixel(camera.viewport, progress, |x, y, stack| {
            let ray = Ray::new(camera.eye, camera.pixel_direction(x, y), reach, 0.0);
            let mut nearest = (camera.far, BACKGROUND);
            self.tree.walk(&ray, stack, |caster, t_max| {
                if let Some(hit) = ray.hit(&caster.corners)
                    && hit.front
                    && hit.t >= camera.near
                    && (hit.t, caster.primitive) < nearest
                {
                    nearest = (hit.t, caster.primitive);
                    // Boxes err by rounding, and an equally near triangle of lower id still counts: a hair further.
                    *t_max = hit.t * (1.0 + 1e-12);
                }
                ControlFlow::Continue(())
            });
            Ok(nearest.1)
        })
    }

    /// Classifies every pixel of a G-buffer. `primitives` holds the primitive id that each pixel shows, row by row from the
    /// top left, [`BACKGROUND`] for none. The receiver is where the ray through the pixel's centre meets the *plane* of that primitive: at a triangle's
    /// edge a rasteriser, which snaps vertices, may name a primitive that the centre lies slightly outside of, and the
    /// point outside is then the receiver. Casters are two-sided and count at t > 0 by more than f64 rounding.
    ///
    /// # Errors
    /// [`Error::PixelCount`], [`Error::UnknownPrimitive`], [`Error::Light`], [`Error::Offset`],
    /// [`Error::OffsetTooLong`], [`Error::Interrupted`].
    pub fn shade(
        &self,
        camera: &Camera,
        light: &DirectionalLight,
        primitives: &[u32],
        mode: OracleMode,
        progress: Progress,
    ) -> Result<Reference, Error> {
        let viewport = camera.viewport;
        check_pixel_count("primitives", viewport, primitives.len())?;
        let towards = light.towards();
        if !towards.is_finite() {
            let [x, y, z] = light.direction.to_array();
            return Err(Error::Light { x, y, z });
        }
        if let OracleMode::Offset(length) = mode
            && !(length.is_finite() && length >= 0.0)
        {
            return Err(Error::Offset(length));
        }
        if let OracleMode::Offset(length) = mode
            && let Some(most) = self.tree.extent().map(|extent| extent * MOST_EXTENTS)
            && length > most
        {
            return Err(Error::OffsetTooLong { length, most });
        }
        let answers = per_pixel(viewport, progress, |x, y, stack| {
            let primitive = primitives[x as usize + y as usize * viewport[0] as usize];
            if primitive == BACKGROUND {
                return Ok(Answer {
                    class: Class::Background,
                    in_band: false,
                    n_dot_l: 0.0,
                });
            }
            let count = self.mesh.triangles.len() as u64;
            if u64::from(primitive) >= count {
                return Err(Error::UnknownPrimitive {
                    x,
                    y,
                    primitive,
                    count,
                });
            }
            let receiver = Receiver::new(
                self.mesh,
                primitive,
                camera.eye,
                camera.pixel_direction(x, y),
                towards,
            );
            Ok(self.answer(&receiver, primitive, towards, mode, stack))
        })?;
        Ok(Reference {
            viewport,
            classes: answers.iter().map(|answer| answer.class).collect(),
            in_band: answers.iter().map(|answer| answer.in_band).collect(),
            n_dot_l: answers.iter().map(|answer| answer.n_dot_l).collect(),
        })
    }

    /// Traces rays given by origin and direction (any length but zero), for tracers of f32 to be held against: both count as exact, t > 0,
    /// and triangles are two-sided.
    pub fn occlusion(&self, rays: &[(Vec3, Vec3)]) -> Vec<Occlusion> {
        let exact = Uncertainty {
            segments: [DVec3::ZERO; 3],
            radius: 0.0,
        };
        rays.par_iter()
            .map_init(Vec::new, |stack, (origin, direction)| {
                let towards = direction.as_dvec3().normalize();
                let (blocked, in_band) =
                    self.visibility(origin.as_dvec3(), towards, &exact, BACKGROUND, stack);
                Occlusion { blocked, in_band }
            })
            .collect()
    }

    fn answer(
        &self,
        receiver: &Receiver,
        own: u32,
        towards: DVec3,
        mode: OracleMode,
        stack: &mut Vec<u32>,
    ) -> Answer {
        let facing_in_band = receiver.n_dot_l.abs() <= receiver.n_dot_l_error;
        let n_dot_l = receiver.n_dot_l as f32;
        if receiver.n_dot_l <= 0.0 {
            return Answer {
                class: Class::FacingAway,
                in_band: facing_in_band,
                n_dot_l,
            };
        }
        let (origin, excluded) = match mode {
            OracleMode::Exact => (receiver.position, own),
            OracleMode::Offset(length) => (receiver.position + towards * length, BACKGROUND),
        };
        let (shadow, in_band) = match &receiver.uncertainty {
            Some(uncertainty) => self.visibility(origin, towards, uncertainty, excluded, stack),
            None => (self.occluded(origin, towards, excluded, stack), true),
        };
        // A rasteriser's snapping puts it beyond its primitive, where a neighbour may lie on top of it.
        let snapped = |border: DVec3| {
            let origin = border + (origin - receiver.position);
            self.occluded(origin, towards, excluded, stack) != shadow
        };
        let in_band = in_band || facing_in_band || receiver.on_border.is_some_and(snapped);
        let class = if shadow { Class::Shadow } else { Class::Lit };
        Answer {
            class,
            in_band,
            n_dot_l,
        }
    }

    /// Whether the receiver is in shadow, and whether that is in band.
    fn visibility(
        &self,
        origin: DVec3,
        towards: DVec3,
        uncertainty: &Uncertainty,
        excluded: u32,
        stack: &mut Vec<u32>,
    ) -> (bool, bool) {
        let reach = self.tree.reach(origin);
        let ray = Ray::new(origin, towards, reach, uncertainty.extent(reach));
        let fuzzy = FuzzyRay::new(&ray, origin, towards, uncertainty);
        let (mut touched, mut robust) = (false, false);
        let mut blocked: Option<(f64, bool)> = None;
        self.tree.walk(&ray, stack, |caster, _| {
            if caster.primitive == excluded {
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
                Contact::Robust => {
                    robust = true;
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        });
        match blocked {
            _ if robust => (true, false),
            None => (false, touched),
            Some((_, true)) => (true, true),
            Some((error, false)) => {
                let displaced = uncertainty.displacements(towards, error);
                (
                    true,
                    !displaced
                        .iter()
                        .all(|&by| self.occluded(origin + by, towards, excluded, stack)),
                )
            }
        }
    }

    /// Whether any triangle but `excluded` stands between `origin` and the light.
    fn occluded(&self, origin: DVec3, towards: DVec3, excluded: u32, stack: &mut Vec<u32>) -> bool {
        let ray = Ray::new(origin, towards, self.tree.reach(origin), 0.0);
        let mut occluded = false;
        self.tree.walk(&ray, stack, |caster, _| {
            if caster.primitive != excluded
                && ray
                    .hit(&caster.corners)
                    .is_some_and(|hit| hit.t > ray.nearest)
            {
                occluded = true;
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        occluded
    }
}

/// One value per pixel, rows in parallel. The first error, in no particular order, ends the run.
pub(crate) fn per_pixel<T: Send>(
    viewport: [u32; 2],
    progress: Progress,
    pixel: impl Fn(u32, u32, &mut Vec<u32>) -> Result<T, Error> + Sync,
) -> Result<Vec<T>, Error> {
    let [width, height] = viewport;
    let done = AtomicU64::new(0);
    let rows: Vec<Vec<T>> = (0..height)
        .into_par_iter()
        .map_init(Vec::new, |stack, y| {
            if progress.interrupted.load(Ordering::Relaxed) {
                return Err(Error::Interrupted);
            }
            let row = (0..width)
                .map(|x| pixel(x, y, stack))
                .collect::<Result<Vec<T>, Error>>()?;
            (progress.rows_done)(done.fetch_add(1, Ordering::Relaxed) + 1);
            Ok(row)
        })
        .collect::<Result<_, Error>>()?;
    Ok(rows.into_iter().flatten().collect())
}

pub(crate) fn check_pixel_count(
    name: &'static str,
    viewport: [u32; 2],
    actual: usize,
) -> Result<(), Error> {
    let expected = u64::from(viewport[0]) * u64::from(viewport[1]);
    if actual as u64 == expected {
        Ok(())
    } else {
        Err(Error::PixelCount {
            name,
            viewport,
            expected,
            actual: actual as u64,
        })
    }
}
