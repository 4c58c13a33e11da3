//! Finds the surface that each pixel of a foreign picture shows: as this program rasterises it, or
//! by ids or depths that the other renderer gives.
//!
//! ```
//! use skiagraph_compare::foreign::{raster, surfaces::ids};
//! use skiagraph_compare::pictures::data::{Array, DataFormat, Values};
//!
//! let folder = tempfile::tempdir()?;
//! let file = folder.path().join("ids.npy");
//! let array = Array::of_pixels([2, 1], Values::I32(vec![7, -1]));
//! std::fs::write(&file, array.encode(DataFormat::Npy)?)?;
//! assert_eq!(ids(&raster::read(&file)?, 8)?, [7, skiagraph_reference::BACKGROUND]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::foreign::factor::flipped;
use crate::foreign::raster::Raster;
use crate::wording::{percent, thousands};
use skiagraph_reference::{BACKGROUND, Candidate};
use skiagraph_scene::Camera;

/// Relative error of a distance besides that of its file: by the arithmetic of a renderer.
const DEPTH_ERROR: f64 = 1.0 / 16_384.0;

/// Share of the pixels whose depth must be that of a surface there.
const MOST: f64 = 0.9;

/// Reads the ids of a picture: the index of a triangle of the mesh for each pixel, and -1,
/// 4294967295 or a number that is not finite for the background. `count` is the number of
/// triangles.
///
/// # Errors
/// [`CompareError::Input`]: the picture has colours, or a number that is not an id of the mesh.
pub fn ids(raster: &Raster, count: usize) -> Result<Vec<u32>> {
    let refused = |why: String| CompareError::Input(format!("{}: {why}", raster.file));
    one_channel(raster, "an id")?;
    let width = raster.size[0] as usize;
    let id = |(at, &value): (usize, &f64)| match value {
        value if !value.is_finite() || value == -1.0 || value == f64::from(BACKGROUND) => {
            Ok(BACKGROUND)
        }
        value if value.fract() == 0.0 && value >= 0.0 && value < count as f64 => Ok(value as u32),
        value => Err(refused(format!(
            "pixel ({}, {}) has the id {value}; expected the index of one of the {} triangles, in \
             the order of the scene's mesh, or -1 for the background, as `skiagraph truth` writes \
             them",
            at % width,
            at / width,
            thousands(count as u64)
        ))),
    };
    raster.values.iter().enumerate().map(id).collect()
}

fn one_channel(raster: &Raster, what: &str) -> Result<()> {
    if raster.channels == 1 {
        return Ok(());
    }
    Err(CompareError::Input(format!(
        "{}: it has colours; expected one channel with {what} for each pixel",
        raster.file
    )))
}

/// Meaning of the numbers in a picture of depths. A pixel shows the background if its number
/// stands for a distance that is negative, 0, infinite, not a number, or at the far plane or beyond
/// it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthForm {
    /// Distance along the viewing direction, in scene units.
    Linear,
    /// Distance from the eye, in scene units.
    Radial,
    /// 0 at the near plane, 1 at the far plane, as Direct3D, Vulkan and OpenGL store it.
    Forward,
    /// 1 at the near plane, 0 at the far plane.
    Reversed,
    /// 1 at the near plane, 0 infinitely far away.
    ReversedInfinite,
    /// −1 at the near plane, 1 at the far plane, as OpenGL clips it.
    Clip,
}

impl DepthForm {
    const ALL: [Self; 6] = [
        Self::Linear,
        Self::Reversed,
        Self::ReversedInfinite,
        Self::Forward,
        Self::Clip,
        Self::Radial,
    ];

    /// Returns the form as text for a user.
    pub fn text(self) -> &'static str {
        match self {
            Self::Linear => "distances along the view",
            Self::Radial => "distances from the eye",
            Self::Forward => "0 at the near plane, 1 at the far plane",
            Self::Reversed => "1 at the near plane, 0 at the far plane",
            Self::ReversedInfinite => "1 at the near plane, 0 infinitely far away",
            Self::Clip => "-1 at the near plane, 1 at the far plane",
        }
    }

    /// The least and greatest distance along the view that the depth of a pixel may stand for;
    /// infinite where nothing is.
    fn distances(self, raster: &Raster, depth: f64, camera: &Camera, at: [u32; 2]) -> [f64; 2] {
        let whole = raster.whole.unwrap_or(1.0);
        let error = raster.precision * raster.whole.map_or(depth.abs(), |_| 1.0);
        let along = |depth| self.distance(depth, camera, at);
        let [one, other] = [along(depth / whole - error), along(depth / whole + error)];
        let [least, greatest] = [one.min(other), one.max(other)];
        [least * (1.0 - DEPTH_ERROR), greatest * (1.0 + DEPTH_ERROR)]
    }

    /// The distance along the view of a depth at a pixel; infinite where nothing is.
    fn distance(self, depth: f64, camera: &Camera, [x, y]: [u32; 2]) -> f64 {
        let Camera { near, far, .. } = *camera;
        let forward = |depth: f64| near * far / (far - depth * (far - near));
        let distance = match self {
            Self::Linear => depth,
            Self::Radial => depth / camera.pixel_direction(x, y).length(),
            Self::Forward => forward(depth),
            Self::Reversed => forward(1.0 - depth),
            Self::ReversedInfinite => near / depth,
            Self::Clip => forward((depth + 1.0) * 0.5),
        };
        // Cleared depths: 0 as a distance, 1 or 0 as a depth.
        let is_before = |it: &f64| it.is_finite() && *it > 0.0 && *it < far * (1.0 - 1e-6);
        Some(distance).filter(is_before).unwrap_or(f64::INFINITY)
    }
}

/// Surface that each pixel shows, as [`by_depth`] finds it from a picture of depths.
#[derive(Debug)]
pub struct ByDepth {
    /// Form of the depths: the one in which the most pixels have the depth of a surface of the
    /// scene.
    pub form: DepthForm,
    /// Primitive id (index of a triangle of the mesh) that each pixel shows, row by row from the
    /// top left.
    pub primitives: Vec<u32>,
    /// Number of pixels whose depth fits no surface that may be seen there; these have their
    /// rasterised surface.
    pub astray: u64,
}

/// Finds the surface that each pixel shows, by the depths in `raster`. `candidates` has the
/// surfaces that each pixel may show ([`candidates`](skiagraph_reference::candidates())); of these
/// only those at the pixel's depth are kept, unless none is. `rasterised` is the primitive that
/// Skiagraph's own G-buffer has for each pixel. It is the pixel's surface if it lies at the depth,
/// or if no candidate does; otherwise the candidate nearest to the depth is.
///
/// # Errors
/// [`CompareError::Input`] if no [`DepthForm`] makes nine tenths of the depths those of surfaces.
pub fn by_depth(
    raster: &Raster,
    camera: &Camera,
    candidates: &mut [Vec<Candidate>],
    rasterised: &[u32],
) -> Result<ByDepth> {
    one_channel(raster, "a depth")?;
    let count_in = |values: &[f64], form: DepthForm| {
        let pixels = candidates.iter().enumerate();
        let fits = pixels.filter(|(at, list)| {
            let depth = form.distances(raster, values[*at], camera, place(camera, *at));
            list.iter().any(|candidate| lies_at(candidate, depth))
        });
        fits.count()
    };
    let best = |values: &[f64]| {
        let each = DepthForm::ALL.map(|form| (count_in(values, form), form));
        // The first of equals.
        let best = each.into_iter().rev().max_by_key(|(count, _)| *count);
        best.unwrap_or((0, DepthForm::Linear))
    };
    let (count, form) = best(&raster.values);
    let pixels = candidates.len();
    if (count as f64) < MOST * pixels as f64 {
        let (upside_down, _) = best(&flipped(&raster.values, raster.size));
        let hint = if upside_down as f64 >= MOST * pixels as f64 {
            "upside down they do: rows run from the top to the bottom"
        } else {
            "is it another camera, another scene, or are near and far plane others?"
        };
        return Err(CompareError::Input(format!(
            "{}: only {} of its depths are those of surfaces of the scene, read as {}, which fits \
             best; {hint}",
            raster.file,
            percent(count as u64, pixels as u64),
            form.text()
        )));
    }
    let mut primitives = Vec::with_capacity(pixels);
    for (at, list) in candidates.iter_mut().enumerate() {
        let depth = form.distances(raster, raster.values[at], camera, place(camera, at));
        let nearest_to = depth[0];
        // The rasterised one, where it lies there as well as others.
        let off = |candidate: &Candidate| {
            let middle = candidate.distances.iter().sum::<f64>() * 0.5;
            let is_other = candidate.primitive != rasterised[at];
            let off = Some((middle - nearest_to).abs()).filter(|_| middle.is_finite() && is_other);
            (u8::from(is_other), off.unwrap_or(0.0))
        };
        let order = |one: &Candidate, other: &Candidate| {
            let ((one, off_one), (other, off_other)) = (off(one), off(other));
            one.cmp(&other).then(off_one.total_cmp(&off_other))
        };
        let at_depth = list.iter().filter(|candidate| lies_at(candidate, depth));
        let nearest = at_depth.min_by(|one, other| order(one, other));
        match nearest.map(|candidate| candidate.primitive) {
            Some(primitive) => {
                primitives.push(primitive);
                list.retain(|candidate| lies_at(candidate, depth));
            }
            None => primitives.push(rasterised[at]),
        }
    }
    Ok(ByDepth {
        form,
        primitives,
        astray: (pixels - count) as u64,
    })
}

fn place(camera: &Camera, at: usize) -> [u32; 2] {
    let (at, width) = (at as u32, camera.viewport[0]);
    [at % width, at / width]
}

/// Returns true if a surface may have a distance along the view between these; the background is
/// infinitely far away.
fn lies_at(candidate: &Candidate, [least, greatest]: [f64; 2]) -> bool {
    if candidate.primitive == BACKGROUND {
        return greatest.is_infinite();
    }
    let [from, to] = candidate.distances;
    least <= to && from <= greatest && least.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_scene::View;

    fn camera() -> Camera {
        let view = View {
            near: 0.5,
            far: 100.0,
            ..View::default()
        };
        view.camera([4, 3])
    }

    fn raster(values: Vec<f64>) -> Raster {
        Raster {
            file: "depth.exr".into(),
            size: [4, 3],
            channels: 1,
            values,
            precision: 1e-7,
            ..Raster::default()
        }
    }

    /// Two surfaces at each pixel, and the background.
    fn candidates() -> Vec<Vec<Candidate>> {
        let candidate = |primitive, distance| Candidate {
            primitive,
            distances: [distance, distance],
        };
        let pixel = |at: usize| {
            let near = 2.0 + at as f64;
            let mut list = vec![candidate(0, near), candidate(1, near * 3.0)];
            if at == 0 {
                list.push(Candidate {
                    primitive: BACKGROUND,
                    distances: [100.0, f64::INFINITY],
                });
            }
            list
        };
        (0..12).map(pixel).collect()
    }

    #[test]
    fn every_form_of_depths_is_found_out() {
        let camera = camera();
        // Of the first pixel the background, of others the second surface.
        let distance = |at: usize| {
            if at == 0 {
                f64::INFINITY
            } else {
                (2.0 + at as f64) * 3.0
            }
        };
        let forward = |d: f64| {
            if d.is_infinite() {
                1.0
            } else {
                100.0 / 99.5 * (1.0 - 0.5 / d)
            }
        };
        let stored = |form: DepthForm, at: usize| match form {
            DepthForm::Linear => distance(at),
            DepthForm::Radial => {
                distance(at)
                    * camera
                        .pixel_direction(at as u32 % 4, at as u32 / 4)
                        .length()
            }
            DepthForm::Forward => forward(distance(at)),
            DepthForm::Reversed => 1.0 - forward(distance(at)),
            DepthForm::ReversedInfinite => 0.5 / distance(at),
            DepthForm::Clip => forward(distance(at)) * 2.0 - 1.0,
        };
        for form in DepthForm::ALL {
            let mut lists = candidates();
            let depths = raster((0..12).map(|at| stored(form, at)).collect());
            let matched = by_depth(&depths, &camera, &mut lists, &[0; 12]).unwrap();
            assert_eq!((matched.form, matched.astray), (form, 0), "{}", form.text());
            assert_eq!(matched.primitives[0], BACKGROUND);
            assert_eq!(matched.primitives[1..], [1; 11], "{}", form.text());
            assert!(lists.iter().all(|list| list.len() == 1), "{}", form.text());
        }
    }

    #[test]
    fn depths_of_another_camera_or_upside_down_are_told() {
        let camera = camera();
        let message = |values: Vec<f64>| {
            let matched = by_depth(&raster(values), &camera, &mut candidates(), &[0; 12]);
            matched.unwrap_err().to_string()
        };
        let other = message((0..12).map(|at| 50.0 - f64::from(at)).collect());
        assert!(other.contains("is it another camera"), "{other}");
        let rows = |at: u32| 2.0 + f64::from((2 - at / 4) * 4 + at % 4);
        let turned = message((0..12).map(rows).collect());
        assert!(turned.contains("upside down they do"), "{turned}");
    }

    #[test]
    fn an_id_that_is_none_is_told_with_its_pixel() {
        let mut values = vec![1.0; 12];
        values[6] = 2.5;
        let message = ids(&raster(values.clone()), 8).unwrap_err().to_string();
        assert!(message.contains("pixel (2, 1) has the id 2.5"), "{message}");
        values[6] = f64::from(BACKGROUND);
        assert_eq!(ids(&raster(values), 8).unwrap()[6], BACKGROUND);
    }
}
