//! Number of shadow-map texels that a pixel covers at its receiver, the point that it shows.
//!
//! Fewer than one is *under-sampling*, which shows as steps. Zhang and others ("Parallel-Split
//! Shadow Maps", VRCIA 2006; section 3.2.1 of the dissertation that docs/methods.md names) write it
//! as dp/ds = n · (dz / z ds) · (cos φ / cos θ), pixels per texel: a *perspective* part of distance
//! and map, and a *projection* part of the surface's angles to eye and light. This is the
//! reciprocal, of areas instead of lengths.

use crate::{
    error::Error, ground_truth::GroundTruthPixels, pixels::check_pixel_count, shimmer::Seen,
};
use serde::{Deserialize, Serialize};
use skiagraph_scene::LightKind;

/// Area of a shadow map that one pixel covers, in texels, as the product of two factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Texels per pixel if the surface stood at right angles to the eye's ray and to the light's
    /// ray: the pixel's area at the receiver times the map's density there. 0 outside the map.
    pub perspective: f64,
    /// Factor of the surface's angles: cos θ / cos φ, with θ between the surface's normal and the
    /// light, and φ between its normal and the eye. It is small where light grazes the surface, and
    /// large where the eye's ray does.
    pub projection: f64,
}

impl Footprint {
    /// Returns the texels per pixel, the product of both factors.
    pub fn texels(self) -> f64 {
        self.perspective * self.projection
    }
}

/// Finds how many texels of a shadow map each pixel covers. `seen` is the mesh, camera and G-buffer
/// of the picture. `density` has an entry for each pixel: the map's texels per square scene unit at
/// right angles to the light's ray, at the point that the pixel shows; 0 outside the map. The
/// result has an entry for each pixel, row by row from the top left: `None` if the pixel does not
/// face the light by `truth` or its triangle is seen edge-on.
///
/// # Errors
/// [`Error::PixelCount`] if a list does not have one entry per pixel of `truth`.
pub fn footprints(
    seen: Seen,
    light: &LightKind,
    density: &[f32],
    truth: &GroundTruthPixels,
) -> Result<Vec<Option<Footprint>>, Error> {
    check_pixel_count("primitives", truth.viewport, seen.primitives.len())?;
    check_pixel_count("texel_density", truth.viewport, density.len())?;
    let area = seen.pixel_area();
    let footprint = |pixel: usize| {
        let surface = seen.surface(pixel)?;
        let length = surface.way.length();
        let away = seen.camera.forward.dot(surface.way);
        // A pixel's area grows with the square of the distance, and leans away from the eye's ray.
        let across_eye = area * away * away * away / length;
        let to_light = light.towards(surface.receiver).direction;
        let cos_light = surface.normal.dot(to_light).abs();
        let cos_eye = surface.normal.dot(surface.way).abs() / length;
        let density = f64::from(density[pixel]);
        let is_density = density.is_finite() && density > 0.0;
        Some(Footprint {
            perspective: if is_density {
                across_eye * density
            } else {
                0.0
            },
            projection: cos_light / cos_eye,
        })
    };
    let pixels = truth.classes.iter().enumerate();
    let footprints = pixels.map(|(pixel, class)| class.faces_light().then(|| footprint(pixel))?);
    Ok(footprints.collect())
}

/// Statistics of the shadow-map texels that a pixel covers, over the pixels that face the light and
/// lie in the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TexelsPerPixel {
    /// Number of pixels that face the light and lie in the map. The quantiles are over these.
    pub pixels: u64,
    /// Number of pixels of `pixels` that cover less than one texel: the map is too coarse there.
    pub under_one: u64,
    /// Number of pixels that face the light and lie outside the map.
    pub outside_map: u64,
    /// Quantiles of [`Footprint::texels`], the texels per pixel.
    pub texels: Quantiles,
    /// Quantiles of [`Footprint::perspective`]: the texels per pixel if all surfaces faced the eye
    /// and the light.
    pub perspective: Quantiles,
    /// Quantiles of [`Footprint::projection`], the factor of the surfaces' angles.
    pub projection: Quantiles,
}

/// Values that 5, 50 and 95 % of the pixels do not exceed; all 0 if there are no pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// 5th percentile: the value that 5 % of the pixels do not exceed.
    pub p5: f64,
    /// Median: the value that half of the pixels do not exceed.
    pub median: f64,
    /// 95th percentile: the value that 95 % of the pixels do not exceed.
    pub p95: f64,
}

impl TexelsPerPixel {
    /// Summarises the [`footprints`] of a picture. Entries that are `None` are left out.
    pub fn new(footprints: &[Option<Footprint>]) -> Self {
        let present = footprints.iter().flatten();
        let (inside, outside): (Vec<&Footprint>, Vec<_>) =
            present.partition(|pixel| pixel.perspective > 0.0);
        let quantiles =
            |part: fn(Footprint) -> f64| Quantiles::new(inside.iter().map(|pixel| part(**pixel)));
        Self {
            pixels: inside.len() as u64,
            under_one: inside.iter().filter(|pixel| pixel.texels() < 1.0).count() as u64,
            outside_map: outside.len() as u64,
            texels: quantiles(Footprint::texels),
            perspective: quantiles(|pixel| pixel.perspective),
            projection: quantiles(|pixel| pixel.projection),
        }
    }
}

impl Quantiles {
    fn new(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let rank = (values.len() as f64 * share).ceil() as usize;
            values.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
        };
        Self {
            p5: at(0.05),
            median: at(0.5),
            p95: at(0.95),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Class;
    use glam::DVec3;
    use skiagraph_scene::{DirectionalLight, Mesh, PointLight, View};

    const SIZE: u32 = 9;
    const MIDDLE: usize = 40;

    /// The footprints on a plane through the origin, seen from (0, 10, 10) along the line to it.
    fn on_plane(up: DVec3, light: &LightKind, density: f32) -> Vec<Option<Footprint>> {
        let (u, v) = up.any_orthonormal_pair();
        let corner = |across: f64, along: f64| (u * across + v * along).as_vec3();
        let mesh = Mesh {
            positions: vec![
                corner(-900.0, -900.0),
                corner(900.0, -900.0),
                corner(0.0, 900.0),
            ],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let view = View {
            eye: DVec3::new(0.0, 10.0, 10.0),
            direction: DVec3::new(0.0, -1.0, -1.0),
            fov_y_degrees: 90.0,
            far: 1000.0,
            ..View::default()
        };
        let camera = view.camera([SIZE; 2]);
        let count = (SIZE * SIZE) as usize;
        let truth = GroundTruthPixels {
            viewport: [SIZE; 2],
            classes: vec![Class::Lit; count],
            indeterminate: vec![false; count],
            n_dot_l: vec![1.0; count],
            base_colors: Vec::new(),
        };
        let seen = Seen {
            mesh: &mesh,
            camera: &camera,
            primitives: &vec![0; count],
        };
        footprints(seen, light, &vec![density; count], &truth).unwrap()
    }

    fn near(one: f64, other: f64) -> bool {
        (one - other).abs() < 1e-6 * other.abs()
    }

    #[test]
    fn parts_are_those_worked_by_hand() {
        let light = DirectionalLight::new(DVec3::new(0.0, -1.0, 0.0)).into();
        // At the middle the plane is √200 away; a pixel is 2/9 wide at distance 1.
        let pixel = 200.0 * 4.0 / 81.0;
        // The floor: the light stands on it, and the eye sees it at 45°.
        let floor = on_plane(DVec3::Y, &light, 0.5)[MIDDLE].unwrap();
        assert!(near(floor.perspective, pixel * 0.5), "{floor:?}");
        assert!(near(floor.projection, 2f64.sqrt()), "{floor:?}");
        // A wall that leans by 1° from the light's direction: projection aliasing.
        let (sin, cos) = 1f64.to_radians().sin_cos();
        let wall = on_plane(DVec3::new(0.0, sin, cos), &light, 0.5)[MIDDLE].unwrap();
        assert!(near(wall.perspective, floor.perspective), "{wall:?}");
        let to_eye = (sin + cos) / 2f64.sqrt();
        assert!(near(wall.projection, sin / to_eye), "{wall:?}");
        assert!(near(wall.texels(), pixel * 0.5 * sin / to_eye));
    }

    /// As many texels as the area on the floor holds that a pixel's four corners enclose.
    #[test]
    fn off_the_middle_they_are_the_texels_that_the_pixel_encloses() {
        let light = PointLight {
            position: DVec3::new(3.0, 7.0, -2.0),
            radius: 0.0,
        };
        let (x, y, far) = (7u32, 6u32, 1e-4);
        let footprints = on_plane(DVec3::Y, &light.into(), 2.0);
        let footprint = footprints[(x + y * SIZE) as usize].unwrap();
        // A pixel a ten-thousandth as wide, so that distances are alike in all of it.
        let place = |dx: f64, dy: f64| {
            let ndc = [
                (f64::from(x) + 0.5 + dx) / 4.5 - 1.0,
                1.0 - (f64::from(y) + 0.5 + dy) / 4.5,
            ];
            let forward = DVec3::new(0.0, -1.0, -1.0).normalize();
            let up = DVec3::new(0.0, 1.0, -1.0).normalize();
            let way = forward + DVec3::X * ndc[0] + up * ndc[1];
            DVec3::new(0.0, 10.0, 10.0) - way * (10.0 / way.y)
        };
        let centre = place(0.0, 0.0);
        let area = (place(far, 0.0) - centre)
            .cross(place(0.0, far) - centre)
            .length()
            / (far * far);
        let to_light = light.position - centre;
        let texels = 2.0 * area * to_light.y / to_light.length();
        assert!(
            (footprint.texels() / texels - 1.0).abs() < 1e-3,
            "{footprint:?} {texels}"
        );
    }

    #[test]
    fn figures_count_what_lies_in_the_map() {
        let made = |perspective| {
            Some(Footprint {
                perspective,
                projection: 0.5,
            })
        };
        let mut footprints: Vec<_> = (1..=40)
            .map(|texels| made(f64::from(texels) * 0.5))
            .collect();
        footprints.extend([None, made(0.0)]);
        let figures = TexelsPerPixel::new(&footprints);
        // Of 0.25, 0.5 … 10 those below 1 are three.
        let counts = (figures.pixels, figures.under_one, figures.outside_map);
        assert_eq!(counts, (40, 3, 1));
        let Quantiles { p5, median, p95 } = figures.texels;
        assert_eq!([p5, median, p95], [0.5, 5.0, 9.5]);
        assert_eq!(figures.projection.median, 0.5);
        assert_eq!(TexelsPerPixel::new(&[]), TexelsPerPixel::default());
    }

    #[test]
    fn a_density_that_is_none_is_outside_the_map() {
        let light = DirectionalLight::new(DVec3::NEG_Y).into();
        for density in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let footprints = on_plane(DVec3::Y, &light, density);
            assert_eq!(footprints[MIDDLE].unwrap().texels(), 0.0, "{density}");
        }
    }
}
