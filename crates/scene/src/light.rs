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
        // A flat scene still needs a box of some volume; a hair's breadth of margin keeps the border texels' centres inside.
        let size = (high - low).max(DVec3::splat(1e-6 * (high - low).max_element().max(1e-30)));
        let (low, high) = (low - size * 1e-3, high + size * 1e-3);
        let extent = DVec3::new(
            (high.x - low.x) * 0.5,
            (high.y - low.y) * 0.5,
            high.z - low.z,
        );
        let centre = (low + high) * 0.5;
        let rotation = DMat4::from_cols(
            right.extend(0.0),
            up.extend(0.0),
            forward.extend(0.0),
            glam::DVec4::W,
        )
        .transpose();
        let to_clip = DMat4::from_scale(DVec3::new(1.0 / extent.x, 1.0 / extent.y, 1.0 / extent.z))
            * DMat4::from_translation(-DVec3::new(centre.x, centre.y, low.z));
        LightFit {
            view_projection: to_clip * rotation,
            extent,
        }
    }
}
