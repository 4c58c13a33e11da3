//! Directional lights and the orthographic light space of a shadow map.

use glam::{DMat4, DVec3, Vec3};

/// A light infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Direction in which the light travels, any length but zero. Shadow rays go the other way.
    pub direction: DVec3,
}

/// Light space: an orthographic box that maps to wgpu clip space; depth z in 0..1 grows away from the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightFit {
    /// World to clip space of the light (affine: w stays 1).
    pub view_projection: DMat4,
    /// World units per unit of light-space clip x, y and z (half the box's width, half its height, its whole depth).
    pub extent: DVec3,
}

impl DirectionalLight {
    /// Unit vector *towards* the light, l = −direction.
    pub fn towards(&self) -> DVec3 {
        -self.direction.normalize()
    }

    /// The tightest light-space box around an axis-aligned world box, in a frame whose third axis is the light's direction.
    pub fn fit_box(&self, min: Vec3, max: Vec3) -> LightFit {
        let forward = self.direction.normalize();
        let helper = if forward.y.abs() < 0.9 {
            DVec3::Y
        } else {
            DVec3::Z
        };
        let right = forward.cross(helper).normalize();
        let up = right.cross(forward);
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        let corners = (0..8).map(|i| {
            DVec3::new(
                if i & 1 == 0 { min.x } else { max.x },
                if i & 2 == 0 { min.y } else { max.y },
                if i & 4 == 0 { min.z } else { max.z },
            )
        });
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in corners {
            let p = DVec3::new(right.dot(corner), up.dot(corner), forward.dot(corner));
            low = low.min(p);
            high = high.max(p);
        }
        let centre = (low + high) * 0.5;
        // A flat scene still needs a box of some volume, and one large enough to be told from its place.
        let largest = (high - low)
            .max_element()
            .max(1e-6 * low.abs().max(high.abs()).max_element())
            .max(1e-12);
        // A hair's breadth of margin keeps the border texels' centres inside.
        let size = (high - low).max(DVec3::splat(1e-6 * largest)) * 1.002;
        let extent = DVec3::new(size.x * 0.5, size.y * 0.5, size.z);
        let nearest = centre.z - size.z * 0.5;
        let rotation = DMat4::from_cols(
            right.extend(0.0),
            up.extend(0.0),
            forward.extend(0.0),
            glam::DVec4::W,
        )
        .transpose();
        let to_clip = DMat4::from_scale(DVec3::new(1.0 / extent.x, 1.0 / extent.y, 1.0 / extent.z))
            * DMat4::from_translation(-DVec3::new(centre.x, centre.y, nearest));
        LightFit {
            view_projection: to_clip * rotation,
            extent,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIGHTS: [DVec3; 5] = [
        DVec3::NEG_Y,
        DVec3::Y,
        DVec3::X,
        DVec3::new(0.744, -0.408, 0.527),
        DVec3::new(-0.001881, -0.968051, 0.250748),
    ];

    #[test]
    fn the_whole_box_lies_in_clip_space_and_depth_grows_away_from_the_light() {
        let (min, max) = (Vec3::new(-3.0, 1.0, 20.0), Vec3::new(5.0, 1.5, 90.0));
        for direction in LIGHTS {
            let fit = DirectionalLight { direction }.fit_box(min, max);
            for i in 0..8 {
                let pick = |bit: u32, axis: usize| if i & bit == 0 { min[axis] } else { max[axis] };
                let corner = Vec3::new(pick(1, 0), pick(2, 1), pick(4, 2)).as_dvec3();
                let clip = fit.view_projection.project_point3(corner);
                assert!(
                    clip.x.abs() <= 1.0 && clip.y.abs() <= 1.0 && (0.0..=1.0).contains(&clip.z),
                    "{direction}: {clip}"
                );
                // `extent` says what a clip unit is worth.
                let further = fit
                    .view_projection
                    .project_point3(corner + direction.normalize() * fit.extent.z)
                    - clip;
                assert!(
                    (further - DVec3::Z).length() < 1e-9,
                    "{direction}: {further}"
                );
            }
        }
    }

    #[test]
    fn a_single_point_still_makes_a_finite_box() {
        for direction in LIGHTS {
            let fit = DirectionalLight { direction }.fit_box(Vec3::ONE, Vec3::ONE);
            assert!(fit.view_projection.as_mat4().is_finite() && fit.extent.min_element() > 0.0);
        }
    }
}
