//! Directional lights and the orthographic light space of a shadow map.

use crate::outline::Outline;
use crate::vector::{Vector, is_default};
use glam::{DMat4, DVec2, DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// A light infinitely far away, such as the sun.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Light")]
pub struct DirectionalLight {
    /// Direction in which the light travels, world space, of any length above 0.
    #[serde(with = "Vector")]
    pub direction: DVec3,
    /// Angular diameter in degrees as seen from the scene: at least 0, less than 90. A light of 0
    /// degrees has no extent, and its shadows are hard. The sun has 0.53 degrees.
    #[serde(default, skip_serializing_if = "is_default")]
    pub angle_degrees: f64,
}

/// Points are spread evenly over a flat disk. At the rim of one of 90 degrees each stands for 0.35
/// of the sky that it stands for at the centre, and of a wider one for hardly any.
const WIDEST_DEGREES: f64 = 90.0;

/// Light space of a directional light (the space of its shadow map): an orthographic box that maps
/// to wgpu clip space. Depth z in 0..1 grows away from the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightFit {
    /// Matrix from world space to the light's clip space: x and y from −1 to 1, z from 0 at the
    /// side of the box towards the light to 1 at its far side. It is affine: w stays 1.
    pub view_projection: DMat4,
    /// Scene units per unit of light-space clip x, y and z: half the box's width, half its height,
    /// its whole depth.
    pub extent: DVec3,
}

impl DirectionalLight {
    /// Creates a light without extent, whose shadows are hard. `direction` is the direction in
    /// which it travels, world space, of any length above 0.
    pub const fn new(direction: DVec3) -> Self {
        Self {
            direction,
            angle_degrees: 0.0,
        }
    }

    /// Returns the unit vector, world space, from any point to the light: the reverse of
    /// `direction`.
    pub fn to_light(&self) -> DVec3 {
        -self.direction.normalize()
    }

    /// Checks that the light's direction is finite and not zero, and that its angle is at least 0
    /// and less than 90 degrees.
    ///
    /// # Errors
    /// Sentence with the first mistake.
    pub fn check(&self) -> Result<(), String> {
        if self.direction.try_normalize().is_none() {
            return Err(format!(
                "the light's direction {} must be finite and longer than 0",
                self.direction
            ));
        }
        if !(0.0..WIDEST_DEGREES).contains(&self.angle_degrees) {
            return Err(format!(
                "the light's angle_degrees is {}; expected at least 0 and less than \
                 {WIDEST_DEGREES}, the angle that it takes up in the sky; several lights stand \
                 for a wider one",
                self.angle_degrees
            ));
        }
        Ok(())
    }

    /// Returns the smallest [`LightFit`] box around points in world space, enlarged by 0.2 %, with
    /// the light's direction as its third axis. One side of the rectangle of least area around a
    /// convex polygon lies on an edge of it (Freeman and Shapira, CACM 18(7), 1975). An empty list
    /// counts as one point at the origin. No side of the box is 0: each is at least a millionth of
    /// the longest, which counts as no shorter than a millionth of the largest coordinate and than
    /// 10⁻¹² scene units.
    pub fn fit(&self, points: impl IntoIterator<Item = Vec3>) -> LightFit {
        self.fit_outline(&self.outline(points))
    }

    /// Returns the outline of points in world space as the light sees them, for
    /// [`fit_outline`](Self::fit_outline).
    pub fn outline(&self, points: impl IntoIterator<Item = Vec3>) -> Outline {
        let forward = self.direction.normalize();
        let (right, up) = across(forward);
        let (mut places, mut nearest, mut farthest) =
            (Vec::new(), f64::INFINITY, f64::NEG_INFINITY);
        for point in points {
            let point = point.as_dvec3();
            let depth = forward.dot(point);
            (nearest, farthest) = (nearest.min(depth), farthest.max(depth));
            places.push(DVec2::new(right.dot(point), up.dot(point)));
        }
        Outline::new(places, [nearest, farthest])
    }

    /// Returns the box that [`fit`](Self::fit) would return for the points of `outline`, which must
    /// come from [`outline`](Self::outline) of a light with this direction.
    pub fn fit_outline(&self, outline: &Outline) -> LightFit {
        let forward = self.direction.normalize();
        let (right, up) = across(forward);
        let point = Outline::of_the_origin();
        let is_empty = outline.hull.is_empty();
        let outline = if is_empty { &point } else { outline };
        let (turn, low, high) = least_rectangle(&outline.hull);
        let (right, up) = (right * turn.x + up * turn.y, up * turn.x - right * turn.y);
        let (low, high) = (low.extend(outline.nearest), high.extend(outline.farthest));
        let centre = (low + high) * 0.5;
        // A flat scene still needs a box of some volume, and one large enough to be told from its
        // place.
        let largest = (high - low)
            .max_element()
            .max(1e-6 * low.abs().max(high.abs()).max_element())
            .max(1e-12);
        // A hair's breadth of margin keeps the border texels' centres inside.
        let size = (high - low).max(DVec3::splat(1e-6 * largest)) * 1.002;
        let extent = DVec3::new(size.x * 0.5, size.y * 0.5, size.z);
        let nearest = centre.z - size.z * 0.5;
        let rotation = onto_axes([right, up, forward]);
        let to_clip = DMat4::from_scale(DVec3::new(1.0 / extent.x, 1.0 / extent.y, 1.0 / extent.z))
            * DMat4::from_translation(-DVec3::new(centre.x, centre.y, nearest));
        LightFit {
            view_projection: to_clip * rotation,
            extent,
        }
    }
}

/// Returns two unit vectors at right angles to the unit vector `forward` and to each other: right
/// and up. Up is as near to +y as it can be, or to +z if |y| of `forward` is 0.9 or more.
pub fn across(forward: DVec3) -> (DVec3, DVec3) {
    let is_level = forward.y.abs() < 0.9;
    let helper = if is_level { DVec3::Y } else { DVec3::Z };
    let right = forward.cross(helper).normalize();
    (right, right.cross(forward))
}

/// Takes places to their coordinates along three axes.
pub(crate) fn onto_axes(axes: [DVec3; 3]) -> DMat4 {
    let [x, y, z] = axes.map(|axis| axis.extend(0.0));
    DMat4::from_cols(x, y, z, glam::DVec4::W).transpose()
}

/// The rectangle of least area around a convex polygon: its unit x axis, and its lower and upper
/// corner in its own axes. An upright one that is as small to a thousandth is preferred.
fn least_rectangle(hull: &[DVec2]) -> (DVec2, DVec2, DVec2) {
    let around = |axis: DVec2| {
        let turn = |p: &DVec2| DVec2::new(axis.dot(*p), axis.perp_dot(*p));
        let turned = hull.iter().map(turn);
        let empty = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = turned.fold(empty, |(low, high), p| (low.min(p), high.max(p)));
        (axis, low, high)
    };
    let area = |(_, low, high): (DVec2, DVec2, DVec2)| (high - low).element_product();
    let mut best = around(DVec2::X);
    let sides = hull.iter().zip(hull.iter().cycle().skip(1));
    for axis in sides.filter_map(|(a, b)| (*b - *a).try_normalize()) {
        let turned = around(axis);
        if area(turned) < area(best) * 0.999 {
            best = turned;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outline::convex_hull;

    const LIGHTS: [DVec3; 5] = [
        DVec3::NEG_Y,
        DVec3::Y,
        DVec3::X,
        DVec3::new(0.744, -0.408, 0.527),
        DVec3::new(-0.001881, -0.968051, 0.250748),
    ];

    #[test]
    fn all_points_lie_in_clip_space_and_depth_grows_away_from_the_light() {
        let (min, max) = (Vec3::new(-3.0, 1.0, 20.0), Vec3::new(5.0, 1.5, 90.0));
        let pick = |i: u32, bit: u32, axis: usize| if i & bit == 0 { min[axis] } else { max[axis] };
        let corners = (0..8).map(|i| Vec3::new(pick(i, 1, 0), pick(i, 2, 1), pick(i, 4, 2)));
        for direction in LIGHTS {
            let fit = DirectionalLight::new(direction).fit(corners.clone());
            for corner in corners.clone() {
                let corner = corner.as_dvec3();
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
    fn the_map_turns_with_the_scene() {
        // A rectangle of 8 by 2, turned by 30 degrees, seen from above.
        let (sin, cos) = 30f32.to_radians().sin_cos();
        let corners = [
            [-4.0, -1.0],
            [4.0, -1.0],
            [4.0, 1.0],
            [-4.0, 1.0],
            [0.0, 0.5],
        ];
        let points =
            corners.map(|[x, z]: [f32; 2]| Vec3::new(x * cos - z * sin, 0.0, x * sin + z * cos));
        let fit = DirectionalLight::new(DVec3::NEG_Y).fit(points);
        let sides = [
            fit.extent.x.max(fit.extent.y),
            fit.extent.x.min(fit.extent.y),
        ];
        assert!(
            (sides[0] - 4.0 * 1.002).abs() < 1e-5 && (sides[1] - 1.002).abs() < 1e-5,
            "{sides:?}"
        );
        // Points on a line, and a hull that is its own least rectangle.
        assert_eq!(
            convex_hull(vec![DVec2::X, DVec2::ZERO, DVec2::X * 0.5]).len(),
            2
        );
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        assert_eq!(
            least_rectangle(&square),
            (DVec2::X, DVec2::ZERO, DVec2::ONE)
        );
    }

    #[test]
    fn one_point_or_none_still_makes_a_finite_box() {
        for direction in LIGHTS {
            for points in [&[][..], &[Vec3::ONE], &[Vec3::ONE, Vec3::ONE]] {
                let fit = DirectionalLight::new(direction).fit(points.iter().copied());
                assert!(
                    fit.view_projection.as_mat4().is_finite() && fit.extent.min_element() > 0.0
                );
            }
        }
    }
}
