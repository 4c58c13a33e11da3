//! Views and the cameras they make on a given viewport.

use crate::light::onto_axes;
use crate::light_kind::{Light, OwnLight};
use crate::vector::Vector;
use glam::{DMat4, DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// A named view of a scene: a perspective camera without the size of a viewport. A scene file lists
/// views.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct View {
    /// Name of the view on the command line and in results.
    pub name: String,
    /// Position of the camera, world space.
    #[serde(with = "Vector")]
    pub eye: DVec3,
    /// Direction in which the camera looks, world space, of any length above 0.
    #[serde(with = "Vector")]
    pub direction: DVec3,
    /// Direction up in the picture, world space, of any length above 0. A view straight along it,
    /// up or down, has a direction across it as its up: -z for y, y for z.
    #[serde(default = "y_axis", with = "Vector", skip_serializing_if = "is_y")]
    pub up: DVec3,
    /// Vertical field of view in degrees: more than 0, less than 180.
    pub fov_y_degrees: f64,
    /// Distance of the near plane from the eye along `direction`, in scene units, more than 0.
    pub near: f64,
    /// Distance of the far plane from the eye along `direction`, in scene units, more than `near`
    /// and at most 1e30 times `near`.
    pub far: f64,
    /// The view's own light, which replaces all lights of the scene for this view; `None` for the
    /// lights of the scene. In a scene file it is a directional light.
    #[serde(default, with = "OwnLight", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<crate::DirectionalLight>"))]
    pub light: Option<Light>,
}

impl Default for View {
    /// A camera in the origin that looks along −z, with a vertical field of view of 60 degrees.
    fn default() -> Self {
        Self {
            name: "main".to_owned(),
            eye: DVec3::ZERO,
            direction: DVec3::NEG_Z,
            up: y_axis(),
            fov_y_degrees: 60.0,
            near: 0.1,
            far: 1000.0,
            light: None,
        }
    }
}

/// Up where nothing else is said.
pub(crate) fn y_axis() -> DVec3 {
    DVec3::Y
}

pub(crate) fn is_y(up: &DVec3) -> bool {
    *up == DVec3::Y
}

/// Sine of the angle between direction and up below which their cross product would be mostly
/// rounding error, so that another up is taken.
const LEAST_SINE: f64 = 1e-9;

/// Smallest allowed ratio of a view's near plane distance to its far plane distance.
pub const LEAST_DEPTH: f64 = 1e-30;

/// Perspective camera of a view on a viewport: orthonormal axes and extents, in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Eye position, world space.
    pub eye: DVec3,
    /// Unit vector to the right of the image, world space.
    pub right: DVec3,
    /// Unit vector to the top of the image, world space.
    pub up: DVec3,
    /// Unit viewing direction, from the eye into the image, world space.
    pub forward: DVec3,
    /// Half the image width at distance 1 from the eye, in scene units: tan(fov/2) · width /
    /// height, where fov is the vertical field of view.
    pub half_width: f64,
    /// Half the image height at distance 1 from the eye, in scene units: tan(fov/2).
    pub half_height: f64,
    /// Distance of the near plane from the eye along `forward`, in scene units.
    pub near: f64,
    /// Distance of the far plane from the eye along `forward`, in scene units.
    pub far: f64,
    /// Viewport width and height in pixels.
    pub viewport: [u32; 2],
    /// Offset of each pixel's ray from the pixel's centre, in pixels, x right, y down, each within
    /// ±0.5. It is 0 unless the frame is one of several to be blended
    /// ([`jittered`](Self::jittered)).
    pub jitter: DVec2,
}

impl View {
    /// Returns the camera of this view on a viewport of `[width, height]` pixels, neither 0. The
    /// view must pass [`check`](Self::check).
    pub fn camera(&self, viewport: [u32; 2]) -> Camera {
        let forward = self.direction.normalize();
        let up = self.up.normalize();
        let across = forward.cross(up);
        let right = if across.length() < LEAST_SINE {
            forward.cross(up.any_orthonormal_vector()).normalize()
        } else {
            across.normalize()
        };
        let up = right.cross(forward);
        let half_height = (self.fov_y_degrees.to_radians() * 0.5).tan();
        let half_width = half_height * f64::from(viewport[0]) / f64::from(viewport[1]);
        Camera {
            eye: self.eye,
            right,
            up,
            forward,
            half_width,
            half_height,
            near: self.near,
            far: self.far,
            viewport,
            jitter: DVec2::ZERO,
        }
    }

    /// Checks that a camera can be made of this view, and that its own light is valid.
    ///
    /// # Errors
    /// Sentence with the first mistake, which names the view.
    pub fn check(&self) -> Result<(), String> {
        let named = |reason| format!("view {:?}: {reason}", self.name);
        self.check_parts().map_err(named)
    }

    /// The same, without its name.
    pub(crate) fn check_parts(&self) -> Result<(), String> {
        if !self.eye.is_finite() {
            return Err(format!("the eye {} is not finite", self.eye));
        }
        if self.direction.try_normalize().is_none() || self.up.try_normalize().is_none() {
            return Err(format!(
                "direction {} and up {} must be finite and longer than 0",
                self.direction, self.up
            ));
        }
        if !(self.fov_y_degrees > 0.0 && self.fov_y_degrees < 180.0) {
            return Err(format!(
                "fov_y_degrees is {}, expected more than 0 and less than 180",
                self.fov_y_degrees
            ));
        }
        if !(self.near > 0.0 && self.near < self.far && self.far.is_finite()) {
            return Err(format!(
                "near is {} and far is {}, expected 0 < near < far",
                self.near, self.far
            ));
        }
        // Depths just before the far plane are this small, and f32 must still tell them apart.
        if self.near < LEAST_DEPTH * self.far {
            return Err(format!(
                "near is {} and far is {}, more than {:e} times as much; f32 holds \
                 no depths of both: bring them nearer to each other",
                self.near,
                self.far,
                1.0 / LEAST_DEPTH
            ));
        }
        // Shaders get it in 32 bits.
        let camera = self.camera([1, 1]).view_projection();
        if !camera.as_mat4().is_finite() {
            return Err(format!(
                "its camera overflows 32-bit numbers with eye {}, fov_y_degrees \
                 {}, near {} and far {}; \
                 bring them nearer to 1",
                self.eye, self.fov_y_degrees, self.near, self.far
            ));
        }
        self.light.as_ref().map_or(Ok(()), Light::check)
    }
}

impl Camera {
    /// Returns this camera with the [`jitter`](Self::jitter) of frame number `frame`, from 0, out
    /// of `count` frames to be blended (0 counts as 1); further frames begin again. Offsets are
    /// points of the Halton sequence of bases 2 and 3 (Halton 1964), in 256ths of a pixel, so that
    /// f32 holds them exactly.
    pub fn jittered(self, frame: u32, count: u32) -> Self {
        let point = frame % count.max(1) + 1;
        let place = |base| ((radical_inverse(point, base) - 0.5) * 256.0).round() / 256.0;
        Self {
            jitter: DVec2::new(place(2), place(3)),
            ..self
        }
    }

    /// Returns the [`jitter`](Self::jitter) in clip space: −1 to 1 across the viewport, y up.
    pub fn jitter_clip(&self) -> DVec2 {
        let [width, height] = self.viewport.map(f64::from);
        self.jitter * DVec2::new(2.0 / width, -2.0 / height)
    }

    /// Returns the direction from the eye through the centre of pixel (`x`, `y`), counted from the
    /// top left, moved by the jitter. Its component along `forward` is 1; it is not a unit vector.
    pub fn pixel_direction(&self, x: u32, y: u32) -> DVec3 {
        let across = (f64::from(x) + 0.5 + self.jitter.x) / f64::from(self.viewport[0]);
        let down = (f64::from(y) + 0.5 + self.jitter.y) / f64::from(self.viewport[1]);
        let (ndc_x, ndc_y) = (across * 2.0 - 1.0, 1.0 - down * 2.0);
        self.forward + self.right * (ndc_x * self.half_width) + self.up * (ndc_y * self.half_height)
    }

    /// Finds the pixel `[x, y]`, counted from the top left, into which a world position falls.
    /// Returns `None` for a position outside the image or not in front of the eye.
    pub fn pixel_of(&self, point: DVec3) -> Option<[u32; 2]> {
        let relative = point - self.eye;
        let distance = self.forward.dot(relative);
        let across = self.right.dot(relative) / (distance * self.half_width);
        let up = self.up.dot(relative) / (distance * self.half_height);
        let [width, height] = self.viewport;
        let x = ((across + 1.0) * 0.5 * f64::from(width) - self.jitter.x).floor();
        let y = ((1.0 - up) * 0.5 * f64::from(height) - self.jitter.y).floor();
        let inside = distance > 0.0
            && (0.0..f64::from(width)).contains(&x)
            && (0.0..f64::from(height)).contains(&y);
        inside.then_some([x as u32, y as u32])
    }

    /// Returns the matrix from world space to wgpu clip space, jitter included: x right, y up, z
    /// from 1 at the near plane to 0 at the far plane. Depth is reversed so that f32 tells far
    /// surfaces apart however near the near plane is.
    pub fn view_projection(&self) -> DMat4 {
        let rotation = onto_axes([self.right, self.up, -self.forward]);
        let range = self.near / (self.far - self.near);
        let projection = DMat4::from_cols_array_2d(&[
            [1.0 / self.half_width, 0.0, 0.0, 0.0],
            [0.0, 1.0 / self.half_height, 0.0, 0.0],
            [0.0, 0.0, range, -1.0],
            [0.0, 0.0, self.far * range, 0.0],
        ]);
        let camera = projection * rotation * DMat4::from_translation(-self.eye);
        if self.jitter == DVec2::ZERO {
            camera
        } else {
            DMat4::from_translation(-self.jitter_clip().extend(0.0)) * camera
        }
    }
}

/// The digits of a number mirrored at the point: the first of them counts most.
fn radical_inverse(mut number: u32, base: u32) -> f64 {
    let (mut inverse, mut digit) = (0.0, 1.0);
    while number > 0 {
        digit /= f64::from(base);
        inverse += f64::from(number % base) * digit;
        number /= base;
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        camera_view().camera([40, 20])
    }

    fn camera_view() -> View {
        View {
            eye: DVec3::new(-83.7, 222.0, -2.9),
            direction: DVec3::new(0.81, -0.27, 0.52) * 3.0,
            up: DVec3::Y * 2.0,
            near: 1.0,
            far: 2800.0,
            ..View::default()
        }
    }

    #[test]
    fn a_point_falls_into_the_pixel_that_sees_it() {
        let camera = camera();
        for (x, y) in [(0, 0), (39, 19), (0, 19), (13, 7)] {
            let point = camera.eye + camera.pixel_direction(x, y) * 50.0;
            assert_eq!(camera.pixel_of(point), Some([x, y]));
            let behind = camera.eye - camera.pixel_direction(x, y) * 50.0;
            assert_eq!(camera.pixel_of(behind), None);
        }
        let beside = camera.eye + camera.forward + camera.right * (camera.half_width * 1.01);
        assert_eq!(camera.pixel_of(beside), None);
        assert_eq!(camera.pixel_of(camera.eye), None);
    }

    #[test]
    fn jitter_moves_all_rays_alike_and_stays_within_the_pixel() {
        let frames: Vec<Camera> = (0..9).map(|frame| camera().jittered(frame, 8)).collect();
        let jitters: Vec<DVec2> = frames.iter().map(|camera| camera.jitter).collect();
        let third = (256.0f64 / 3.0 - 128.0).round() / 256.0;
        assert_eq!(jitters[0], DVec2::new(0.0, third));
        assert_eq!(jitters[1].x, -0.25);
        assert_eq!(jitters[8], jitters[0]);
        for (index, camera) in frames[..8].iter().enumerate() {
            assert!(!jitters[..index].contains(&camera.jitter));
            assert!(camera.jitter.abs().max_element() <= 0.5);
            for (x, y) in [(0, 0), (39, 19), (13, 7)] {
                let point = camera.eye + camera.pixel_direction(x, y) * 50.0;
                assert_eq!(camera.pixel_of(point), Some([x, y]));
                let clip = camera.view_projection().project_point3(point);
                let centre = DVec2::new((clip.x + 1.0) * 20.0, (1.0 - clip.y) * 10.0);
                let pixel = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
                assert!((centre - pixel).abs().max_element() < 1e-9, "{centre}");
            }
        }
    }

    #[test]
    fn a_pixels_direction_projects_to_its_centre() {
        let camera = camera();
        for (x, y) in [(0, 0), (39, 19), (0, 19), (13, 7)] {
            for distance in [camera.near, 50.0, camera.far] {
                let clip = camera
                    .view_projection()
                    .project_point3(camera.eye + camera.pixel_direction(x, y) * distance);
                let pixel = ((clip.x + 1.0) * 20.0, (1.0 - clip.y) * 10.0);
                assert!(
                    (pixel.0 - f64::from(x) - 0.5).abs() < 1e-9
                        && (pixel.1 - f64::from(y) - 0.5).abs() < 1e-9
                );
                let depth =
                    camera.near / (camera.far - camera.near) * (camera.far / distance - 1.0);
                assert!(
                    (clip.z - depth).abs() < 1e-12,
                    "{} instead of {depth}",
                    clip.z
                );
            }
        }
    }

    #[test]
    fn planes_whose_depths_f32_cannot_hold_are_refused() {
        let view = |near, far| View {
            near,
            far,
            ..View::default()
        };
        assert_eq!(view(1e-10, 1e10).check(), Ok(()));
        let refused = view(1e-20, 1e11).check().unwrap_err();
        assert!(
            refused.contains("bring them nearer to each other"),
            "{refused}"
        );
    }

    #[test]
    fn a_view_straight_along_its_up_has_another_up_across() {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.3, -0.7, 0.6)];
        let ways = axes.iter().flat_map(|&axis| [axis, -axis]);
        let nearly = [0.0, 1e-300, 1e-13, 1e-10, 1e-8, 1e-3];
        for (up, tilt) in ways.flat_map(|way| nearly.map(|tilt| (way, tilt))) {
            let aside = up.normalize().any_orthonormal_vector() * tilt;
            for direction in [5.0 * (up + aside), -(up + aside)] {
                let view = View {
                    direction,
                    up,
                    ..camera_view()
                };
                assert_eq!(view.check(), Ok(()), "{direction} {up}");
                let Camera {
                    right, up, forward, ..
                } = view.camera([4, 3]);
                let axes = glam::DMat3::from_cols(right, up, -forward);
                assert!((axes.determinant() - 1.0).abs() < 1e-6, "{axes} {tilt}");
                assert!((forward - direction.normalize()).length() < 1e-15);
                assert!(right.dot(view.up).abs() < 1e-6, "{right}");
            }
        }
        let down = View {
            direction: DVec3::NEG_Y,
            up: DVec3::Y,
            ..camera_view()
        };
        assert_eq!(down.camera([1, 1]).up, DVec3::NEG_Z);
        assert_eq!(down.camera([1, 1]).right, DVec3::X);
    }

    #[test]
    fn the_field_of_view_is_vertical_and_the_frame_is_right_handed() {
        let camera = camera();
        let top = camera.forward + camera.up * camera.half_height;
        assert!((top.angle_between(camera.forward).to_degrees() - 30.0).abs() < 1e-9);
        assert!((camera.half_width - 2.0 * camera.half_height).abs() < 1e-15);
        assert!((camera.right.cross(camera.up) + camera.forward).length() < 1e-12);
        assert!(camera.up.y > 0.0);
    }
}
