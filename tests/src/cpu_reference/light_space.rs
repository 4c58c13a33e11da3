//! Light space in texels, and how far f32 may err there.

use glam::{DVec3, DVec4, Vec3};
use skiagraph_reference::error_bound::F32_ROUNDING;
use skiagraph_scene::{DirectionalLight, LightFit, Mesh};
use std::f64::consts::SQRT_2;

/// Roundings of a sum of four products that add up to one another: each product (2) and the sums
/// (3), of which not all align.
const ROUNDINGS: f64 = 4.0;

/// Bound on the displacement of a corner by a rasteriser, texels: it keeps eight bits of each
/// coordinate's fraction, rounded to the nearest.
const SNAP: f64 = SQRT_2 / 512.0;

/// The light space of a mesh in texels of a square map.
#[derive(Clone, Copy, Debug)]
pub struct LightSpace {
    fit: LightFit,
    centre: DVec3,
    /// Half the extents of the mesh's box.
    half: DVec3,
    size: f64,
}

impl LightSpace {
    /// Fitted to the corners of the mesh, as the presets do; without any, to a point at the origin.
    pub fn new(mesh: &Mesh, light: &DirectionalLight, map_size: u32) -> Self {
        Self::from_fit(light.fit(mesh.corner_positions()), mesh, map_size)
    }

    /// Creates the space of a given fit.
    pub fn from_fit(fit: LightFit, mesh: &Mesh, map_size: u32) -> Self {
        let (min, max) = mesh.bounds().unwrap_or((Vec3::ZERO, Vec3::ZERO));
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        Self {
            fit,
            centre: (min + max) * 0.5,
            half: (max - min) * 0.5,
            size: f64::from(map_size),
        }
    }

    /// Edge of the map in texels.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// A point in texels and depth.
    pub fn texel(&self, position: DVec3) -> DVec3 {
        let clip = self.fit.view_projection.project_point3(position);
        DVec3::new(
            (clip.x * 0.5 + 0.5) * self.size,
            (-clip.y * 0.5 + 0.5) * self.size,
            clip.z,
        )
    }

    /// A displacement in texels and depth.
    pub fn texel_vector(&self, displacement: DVec3) -> DVec3 {
        let clip = self.fit.view_projection.transform_vector3(displacement);
        DVec3::new(clip.x * 0.5 * self.size, -clip.y * 0.5 * self.size, clip.z)
    }

    /// The image of a ball of radius 1: half its extents in texels and depth.
    pub fn texel_ball(&self) -> DVec3 {
        let rows = self.fit.view_projection.transpose();
        let [x, y, z] = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.truncate().length());
        DVec3::new(x * 0.5 * self.size, y * 0.5 * self.size, z)
    }

    /// The absolute values of the matrix times a vector of none but positive ones: all that is
    /// summed up for clip x, y, z.
    fn summands(&self, size: DVec3) -> DVec3 {
        let rows = self.fit.view_projection.transpose();
        let sum = |row: DVec4| row.truncate().abs().dot(size);
        DVec3::new(sum(rows.x_axis), sum(rows.y_axis), sum(rows.z_axis))
    }

    /// Bounds the rounding of a transformed point across, texels: in clip space, and on the way to
    /// texels.
    pub fn across_error(&self) -> f64 {
        let clip = self.summands(self.half).truncate().max_element();
        ROUNDINGS * F32_ROUNDING * (clip + 1.0) * 0.5 * self.size
    }

    /// Bounds the rounding of its depth.
    pub fn depth_error(&self) -> f64 {
        ROUNDINGS * F32_ROUNDING * (self.summands(self.half).z + 1.0)
    }

    /// [`across_error`](Self::across_error) and what a rasteriser adds to it.
    pub fn raster_error(&self) -> f64 {
        self.across_error() + SNAP
    }

    /// Returns the status's own bound on a receiver and its casters' corners together, in texels
    /// and as depth. CPU reference of the function of this name in shaders/shared/light.wgsl.
    pub fn light_space_error_bound(&self, position: DVec3) -> (f64, f64) {
        let clip = self.summands(position.abs() + self.centre.abs());
        let across = ROUNDINGS * F32_ROUNDING * (clip.truncate().max_element() + 1.0);
        let along = ROUNDINGS * F32_ROUNDING * (clip.z + 1.0);
        (
            across * 0.5 * self.size + self.across_error(),
            along + self.depth_error(),
        )
    }
}
