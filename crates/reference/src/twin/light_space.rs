//! Light space in texels, and how far f32 may err there.

use glam::{DVec3, Vec3};
use skiagraph_scene::{DirectionalLight, LightFit, Mesh};

/// Roundings of a clip coordinate of at most 1 that add up to one another: the matrix and its product, three sums, and the way to texels, of which not
/// all align.
const ROUNDINGS: f64 = 4.0;

/// Share of a texel by which rasterisers may move a corner: they keep at least 8 bits of a coordinate's fraction, rounded.
const SNAP: f64 = 1.0 / 256.0;

/// The light space of a mesh in texels of a square map: `DirectionalLight::fit_box` over the mesh's box.
#[derive(Clone, Copy, Debug)]
pub struct LightSpace {
    fit: LightFit,
    centre: DVec3,
    size: f64,
}

impl LightSpace {
    /// Fitted to the mesh; an empty one counts as a point at the origin.
    pub fn new(mesh: &Mesh, light: &DirectionalLight, map_size: u32) -> Self {
        let (min, max) = mesh.bounds().unwrap_or((Vec3::ZERO, Vec3::ZERO));
        let centre = (min.as_dvec3() + max.as_dvec3()) * 0.5;
        Self::of_fit(light.fit_box(min, max), centre, map_size)
    }

    /// Of a given fit; `centre` is what a shader subtracts before it transforms a position.
    pub fn of_fit(fit: LightFit, centre: DVec3, map_size: u32) -> Self {
        Self {
            fit,
            centre,
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

    /// What rounding may move a transformed point by across, texels.
    pub fn across_error(&self) -> f64 {
        ROUNDINGS * crate::receiver::F32_ROUNDING * self.size
    }

    /// What rounding may move its depth by.
    pub fn depth_error(&self) -> f64 {
        2.0 * ROUNDINGS * crate::receiver::F32_ROUNDING
    }

    /// [`across_error`](Self::across_error) and what a rasteriser adds to it.
    pub fn raster_error(&self) -> f64 {
        self.across_error() + SNAP
    }

    /// What the status's own comparison takes a receiver to be off by, in shares of the map's edge and as depth: 4 ulp of all that
    /// is summed up. Twin of `rounding` in shaders/detect_uncertain.wgsl.
    pub fn allowance(&self, position: DVec3) -> (f64, f64) {
        let rows = self.fit.view_projection.transpose();
        let size = position.abs() + self.centre.abs();
        let [x, y, z] =
            [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.truncate().abs().dot(size));
        let ulps = ROUNDINGS * crate::receiver::F32_ROUNDING;
        (ulps * (x.max(y) + 1.0), ulps * (z + 1.0))
    }
}
