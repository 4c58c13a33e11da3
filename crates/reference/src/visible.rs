//! Finds the primitives that each pixel may show, and checks those of a G-buffer.

use crate::error::Error;
use crate::error_bound::F32_ROUNDING;
use crate::oracle::Oracle;
use crate::pixels::{BACKGROUND, Progress, check_pixel_count, per_pixel, shown};
use crate::ray::{Corners, Ray};
use crate::tree::Caster;
use glam::{DVec3, Vec3};
use skiagraph_scene::{Camera, mask::Asked};
use std::ops::ControlFlow;

/// How far from a pixel's centre its sample may count as lying, in pixels: a step of the grid to
/// which a rasteriser moves corners. Vulkan asks of it 4 bits, WebGPU nothing.
const SNAPPING: f64 = 1.0 / 16.0;

/// Roundings of a corner's distance along the view, in units of its distance to the eye: relative
/// to the eye (2), products and sums (5), the depth made of it (1).
const CORNER_ROUNDINGS: f64 = 8.0;

/// Roundings of a depth that is interpolated from a triangle's corners, in units of the greatest
/// depth that it has in the picture.
const DEPTH_ROUNDINGS: f64 = 8.0;

/// How much farther than what hides them surfaces are looked for: far more than rounding.
const ROOM: f64 = 1.001;

/// Counts the pixels of a G-buffer that show a wrong primitive: one behind another surface or
/// beside the pixel, or the background although there is a surface. `primitives` holds one
/// primitive id (index of a triangle) per pixel, as for [`Oracle::shade`].
///
/// Allows for the rounding of a rasteriser: corners may move by a sixteenth of a pixel, depths by a
/// few ulps of the triangle's nearest depth. A pixel in which two surfaces meet may show either.
///
/// # Errors
/// [`Error::PixelCount`], [`Error::UnknownPrimitive`], [`Error::Interrupted`].
pub fn wrong_surfaces(
    oracle: &Oracle<'_>,
    camera: &Camera,
    primitives: &[u32],
    progress: Progress,
) -> Result<u64, Error> {
    check_pixel_count("primitives", camera.viewport, primitives.len())?;
    let count = oracle.mesh.triangles.len() as u64;
    let max_distance = oracle.tree.max_distance(camera.eye);
    let wrong = per_pixel(camera.viewport, progress, |x, y, stack| {
        let shown = shown(primitives, camera.viewport, [x, y], count)?.unwrap_or(BACKGROUND);
        let direction = camera.pixel_direction(x, y);
        let ray = Ray::new(camera.eye, direction, max_distance, 0.0);
        if oracle.nearest(camera, &ray, stack) == shown {
            return Ok(false);
        }
        let sample = Sample::new(camera, direction, max_distance);
        Ok(is_wrong(oracle, &sample, shown, stack))
    })?;
    Ok(wrong.into_iter().filter(|&is_wrong| is_wrong).count() as u64)
}

/// A surface that a renderer may show at a pixel, as [`candidates`] finds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Primitive id (index of a triangle of the mesh), or [`BACKGROUND`].
    pub primitive: u32,
    /// Least and greatest distance along the camera's viewing direction, in scene units, at which
    /// the pixel may show the surface; from minus to plus infinity for a surface that is seen
    /// edge-on, and from the far plane's distance to infinity for the background.
    pub distances: [f64; 2],
}

/// Finds, for each pixel, the surfaces that a renderer may show there, if its sample lies anywhere
/// in the square of an eighth of a pixel around the pixel's centre, and its depths are rounded as
/// those of a rasteriser. Such a surface touches the square, and at a corner or the centre of the
/// square no other surface surely hides it. The result has a list for each pixel, row by row from
/// the top left. No list is empty; the order within a list is arbitrary.
///
/// # Errors
/// [`Error::Interrupted`] if the caller stops the run.
pub fn candidates(
    oracle: &Oracle<'_>,
    camera: &Camera,
    progress: Progress,
) -> Result<Vec<Vec<Candidate>>, Error> {
    let max_distance = oracle.tree.max_distance(camera.eye);
    per_pixel(camera.viewport, progress, |x, y, stack| {
        let direction = camera.pixel_direction(x, y);
        let sample = Sample::new(camera, direction, max_distance);
        let (mut candidates, mut nearest) = (Vec::new(), [f64::INFINITY; 5]);
        let reach = sample.reach(max_distance);
        let ray = Ray::new(camera.eye, direction, max_distance, reach);
        oracle.tree.walk(&ray, stack, |caster, t_max| {
            candidates.extend(sample.candidate(caster));
            for (nearest, end) in nearest.iter_mut().zip(sample.hides_from(caster)) {
                *nearest = nearest.min(end);
            }
            let end = nearest.iter().copied().fold(0.0, f64::max);
            *t_max = t_max.min(end * ROOM);
            ControlFlow::Continue(())
        });
        let end = nearest.into_iter().fold(0.0, f64::max);
        candidates.retain(|candidate| candidate.distances[0] <= end);
        if end > camera.far * (1.0 - 16.0 * F32_ROUNDING) {
            candidates.push(Candidate {
                primitive: BACKGROUND,
                distances: [camera.far, f64::INFINITY],
            });
        }
        Ok(candidates)
    })
}

/// Returns true if no rasteriser may show this primitive at the sample.
fn is_wrong(oracle: &Oracle<'_>, sample: &Sample, shown: u32, stack: &mut Vec<u32>) -> bool {
    let end = match shown {
        BACKGROUND => sample.camera.far * (1.0 - 16.0 * F32_ROUNDING),
        _ => {
            let corners = oracle.mesh.corners(shown);
            let corners = corners.map(|corner| corner.as_vec3().into());
            if !sample.may_touch(&corners) {
                return true;
            }
            sample.distances(&corners)[0]
        }
    };
    oracle.tree.walk(&sample.rays[0], stack, |caster, t_max| {
        *t_max = t_max.min(end);
        if caster.primitive != shown && sample.surely_shows(caster, end) {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    })
}

/// A pixel's centre, and the corners of the square that its sample may be anywhere in.
struct Sample<'a> {
    camera: &'a Camera,
    directions: [DVec3; 5],
    rays: [Ray; 5],
}

impl<'a> Sample<'a> {
    /// `direction` is the centre's.
    fn new(camera: &'a Camera, direction: DVec3, max_distance: f64) -> Self {
        let [width, height] = camera.viewport.map(f64::from);
        let right = camera.right * (2.0 * SNAPPING * camera.half_width / width);
        let up = camera.up * (2.0 * SNAPPING * camera.half_height / height);
        let moved = [DVec3::ZERO, right + up, right - up, up - right, -right - up];
        let directions = moved.map(|by| direction + by);
        let ray = |direction| Ray::new(camera.eye, direction, max_distance, 0.0);
        Self {
            camera,
            directions,
            rays: directions.map(ray),
        }
    }

    /// Returns true if a triangle may cover some of the square: false only where all of it is
    /// beyond one edge, whichever side is seen.
    fn may_touch(&self, corners: &Corners) -> bool {
        let edges = self.edges(corners);
        [1.0, -1.0]
            .iter()
            .any(|side| (0..3).all(|edge| edges.iter().any(|edges| side * edges[edge] >= 0.0)))
    }

    /// Greatest distance from the centre's ray of a place so far away that the square shows.
    fn reach(&self, distance: f64) -> f64 {
        let [axis, corners @ ..] = self.directions.map(DVec3::normalize);
        let sines = corners.map(|corner| axis.cross(corner).length());
        sines.into_iter().fold(0.0, f64::max) * distance
    }

    /// The triangle as a candidate, if it may be seen in the square while nothing hides it.
    fn candidate(&self, caster: &Caster<'_>) -> Option<Candidate> {
        let edges = self.edges(&caster.corners);
        let is_seen = caster.double_sided || edges.iter().any(|ray| ray.iter().sum::<f64>() > 0.0);
        if !is_seen || self.is_beside(&caster.corners) || !self.may_touch(&caster.corners) {
            return None;
        }
        if self.is_cut_out(caster) {
            return None;
        }
        let distances = self.distances(&caster.corners);
        let is_between = distances[1] >= self.camera.near && distances[0] <= self.camera.far;
        is_between.then_some(Candidate {
            primitive: caster.primitive,
            distances,
        })
    }

    /// Returns true if a triangle lies behind the eye, or its box in the picture beside the square.
    fn is_beside(&self, corners: &Corners) -> bool {
        let camera = self.camera;
        let relative = self.relative(corners);
        let depths = relative.map(|corner| camera.forward.dot(corner));
        if depths.iter().any(|depth| *depth <= 0.0) {
            return depths.iter().all(|depth| *depth <= 0.0);
        }
        [camera.right, camera.up].into_iter().any(|axis| {
            let none = [f64::INFINITY, f64::NEG_INFINITY];
            let with = |[low, high]: [f64; 2], value: &f64| [low.min(*value), high.max(*value)];
            let bounds = |values: &[f64]| values.iter().fold(none, with);
            let square = bounds(&self.directions.map(|direction| axis.dot(direction)));
            let places: [f64; 3] = std::array::from_fn(|at| axis.dot(relative[at]) / depths[at]);
            let [least, greatest] = bounds(&places);
            let room = F32_ROUNDING * (least.abs() + greatest.abs());
            least - room > square[1] || greatest + room < square[0]
        })
    }

    /// The least and the greatest distance along the view at which a rasteriser may put a
    /// triangle's plane; infinite for one that is all but edge-on.
    fn distances(&self, corners: &Corners) -> [f64; 2] {
        let [a, b, c] = self.relative(corners);
        let normal = (b - a).cross(c - a);
        let [mut least, mut greatest] = [f64::INFINITY, 0.0f64];
        for direction in self.directions {
            let distance = normal.dot(a) / normal.dot(direction);
            if distance.is_nan() || distance <= 0.0 {
                return [f64::NEG_INFINITY, f64::INFINITY];
            }
            [least, greatest] = [least.min(distance), greatest.max(distance)];
        }
        [
            least - self.distance_error(corners, least),
            greatest + self.distance_error(corners, greatest),
        ]
    }

    /// The distances behind which this triangle hides what is at the centre and at each corner.
    fn hides_from(&self, caster: &Caster<'_>) -> [f64; 5] {
        let hits = self.rays.each_ref().map(|ray| caster.hit(ray));
        if hits.iter().all(Option::is_none) || self.mask_may_flip(caster) {
            return [f64::INFINITY; 5];
        }
        hits.map(|hit| match hit {
            Some(hit) if hit.front || caster.double_sided => {
                let error = self.distance_error(&caster.corners, hit.t);
                if hit.t - error > self.camera.near {
                    hit.t + error
                } else {
                    f64::INFINITY
                }
            }
            _ => f64::INFINITY,
        })
    }

    /// Returns true if a rasteriser shows this triangle, or something before it, at a sample
    /// anywhere in the square: it covers all of the square, between the near plane and `end`.
    fn surely_shows(&self, caster: &Caster<'_>, end: f64) -> bool {
        let mut span = [f64::INFINITY, 0.0f64];
        for ray in &self.rays {
            let Some(hit) = caster.hit(ray) else {
                return false;
            };
            if !(hit.front || caster.double_sided) {
                return false;
            }
            span = [span[0].min(hit.t), span[1].max(hit.t)];
        }
        if self.mask_may_flip(caster) {
            return false;
        }
        let error = self.distance_error(&caster.corners, span[1]);
        span[0] - error > self.camera.near && span[1] + error < end
    }

    /// Returns true if a triangle's mask says different things within the square.
    fn mask_may_flip(&self, caster: &Caster<'_>) -> bool {
        self.masked(caster).is_some_and(|asked| asked.flips)
    }

    /// Returns true if a triangle's mask leaves nothing of it within the square.
    fn is_cut_out(&self, caster: &Caster<'_>) -> bool {
        self.masked(caster)
            .is_some_and(|asked| !asked.flips && !asked.opaque)
    }

    /// Asks a triangle's mask, if it has one, over the whole square.
    fn masked(&self, caster: &Caster<'_>) -> Option<Asked> {
        let masked = caster.masked.as_ref()?;
        let [centre, corners @ ..] = self.edges(&caster.corners);
        let spread = |edge: usize| {
            let off = corners.iter().map(|ray| (ray[edge] - centre[edge]).abs());
            off.fold(0.0, f64::max)
        };
        Some(masked.ask(centre, [0, 1, 2].map(spread)))
    }

    /// The edge functions of each ray.
    fn edges(&self, corners: &Corners) -> [[f64; 3]; 5] {
        let edges = |ray: &Ray| Ray::edges(corners.map(|corner| ray.sheared(corner)));
        self.rays.each_ref().map(edges)
    }

    /// Length by which rounding may move a surface along the view, at that distance.
    fn distance_error(&self, corners: &Corners, distance: f64) -> f64 {
        let relative = self.relative(corners);
        let farthest = relative.iter().map(|corner| corner.length());
        let farthest = farthest.fold(0.0, f64::max);
        // Depth is about near / distance: off by so many ulps of near / nearest, it is off by so
        // many of distance² / nearest along the view.
        let nearest = self.nearest_in_picture(&relative).min(distance);
        F32_ROUNDING
            * (CORNER_ROUNDINGS * farthest + DEPTH_ROUNDINGS * distance * distance / nearest)
    }

    /// The least distance along the view of what the picture has of a triangle: of its part in the
    /// frustum, cut as Sutherland and Hodgman do it, *Reentrant Polygon Clipping*, 1974.
    fn nearest_in_picture(&self, relative: &[DVec3; 3]) -> f64 {
        let camera = self.camera;
        let seen = |corner: DVec3| {
            DVec3::new(
                camera.right.dot(corner) / camera.half_width,
                camera.up.dot(corner) / camera.half_height,
                camera.forward.dot(corner),
            )
        };
        let mut part = relative.map(seen).to_vec();
        let planes: [&dyn Fn(DVec3) -> f64; 5] = [
            &|at| at.z - camera.near,
            &|at| at.z - at.x,
            &|at| at.z + at.x,
            &|at| at.z - at.y,
            &|at| at.z + at.y,
        ];
        for inside in planes {
            let cut = |(&from, &to): (&DVec3, &DVec3)| {
                let (begin, end) = (inside(from), inside(to));
                let crosses = (begin < 0.0) != (end < 0.0);
                let border = crosses.then(|| from.lerp(to, begin / (begin - end)));
                (begin >= 0.0).then_some(from).into_iter().chain(border)
            };
            let next = part.iter().cycle().skip(1);
            part = part.iter().zip(next).flat_map(cut).collect();
        }
        part.iter().map(|at| at.z).fold(f64::INFINITY, f64::min)
    }

    fn relative(&self, corners: &Corners) -> [DVec3; 3] {
        corners.map(|corner| Vec3::from(corner).as_dvec3() - self.camera.eye)
    }
}
