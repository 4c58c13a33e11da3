//! The camera of a host, as the matrices that it draws with.

use crate::error::Error;
use crate::uniforms::{CameraUniform, UnprojectionUniform};
use glam::{DMat4, DVec2, DVec3};
use skiagraph_scene::{Camera, LEAST_DEPTH};

/// Convention of a depth buffer: the end of the range 0 to 1 that belongs to the near plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// Depth 0 is near, depth 1 is far.
    Standard,
    /// Depth 1 is near, depth 0 is far.
    Reversed,
}

/// How many times as far off as the near plane the far plane is taken to be where it is infinite.
const FARTHEST: f64 = 65536.0;

/// Camera of a host program, given by its matrices: perspective or orthographic, symmetric or not,
/// jittered or not, with a far plane or without.
///
/// Positions that the document `shared/from_depth.ron` reconstructs from a depth buffer are right
/// for any such camera. Shadow maps fitted to the camera's frustum (`fit: camera`, preset `pssm`)
/// use a symmetric frustum that holds the camera's own. That frustum ends at 65,536 times the
/// distance of its near plane if the camera has no far plane. `shared/gbuffer.ron` draws the
/// symmetric frustum, too, in reversed depth whatever the host's depth is. So the pixels of a
/// preset that draws its own G-buffer are the host's only if its projection is perspective,
/// symmetric and without jitter; for any other, orthographic ones included, `shared/from_depth.ron`
/// takes the place of `shared/gbuffer.ron`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Eye {
    pub(crate) camera: CameraUniform,
    pub(crate) unprojection: UnprojectionUniform,
}

/// Reason why the matrices given to [`Eye::new`] do not form a camera.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EyeError {
    /// A matrix has entries that are infinite or NaN. Holds the name of the matrix: `view` or
    /// `projection`.
    #[error("the {0} matrix has entries that are not finite")]
    NotFinite(&'static str),
    /// A matrix cannot be inverted. Holds the name of the matrix: `view` or `projection`.
    #[error("the {0} matrix is singular")]
    Singular(&'static str),
    /// The frustum of the projection is empty, or its numbers do not fit f32. An orthographic
    /// camera is represented by a pyramid that holds its box.
    #[error("the frustum of the projection is none that f32 can hold: near {near}, far {far}")]
    Frustum {
        /// Distance of the near plane, in scene units: from the eye, or for an orthographic camera
        /// from the apex of the pyramid.
        near: f64,
        /// Distance of the far plane, in scene units, from the same point as `near`.
        far: f64,
    },
    /// The plane that this [`Depth`] takes for the near one is not the nearer one, or is not before
    /// the eye. Only perspective cameras are checked: the planes of an orthographic camera may lie
    /// behind the eye, so that a wrong `Depth` gives a camera that looks in the opposite direction,
    /// without an error.
    #[error("the depth of the projection is not {0:?}: its near plane is not before the eye")]
    Depth(Depth),
}

impl Eye {
    /// Creates an eye from a camera's matrices, which multiply column vectors, as in glam and WGSL:
    /// `view` maps world space to eye space, `projection` (with its jitter) maps eye space to
    /// wgpu's clip space (y up, depth 0 to 1). Eye space may be right-handed or left-handed, and
    /// look along −z or +z: only the two matrices together matter. `depth` tells which end of the
    /// depth range is near.
    ///
    /// # Errors
    /// [`EyeError`] for matrices that do not form a camera.
    pub fn new(view: DMat4, projection: DMat4, depth: Depth) -> Result<Self, EyeError> {
        for (name, matrix) in [("view", view), ("projection", projection)] {
            if !matrix.is_finite() {
                return Err(EyeError::NotFinite(name));
            }
            if !matrix.inverse().is_finite() {
                return Err(EyeError::Singular(name));
            }
        }
        // Relative to the eye, so that far from the origin nothing is lost.
        let origin = view.inverse().project_point3(DVec3::ZERO);
        let view = view * DMat4::from_translation(origin);
        let relative_from_clip = (projection * view).inverse();
        let mut camera = frustum(&relative_from_clip, depth)?;
        camera.eye += origin;
        let rounded = origin.as_vec3();
        let unprojection = UnprojectionUniform {
            relative_from_clip: relative_from_clip.as_mat4(),
            origin: rounded,
            is_reversed: u32::from(depth == Depth::Reversed),
            origin_low: (origin - rounded.as_dvec3()).as_vec3(),
            padding: 0.0,
        };
        Ok(Self {
            camera: CameraUniform::from(&camera),
            unprojection,
        })
    }

    /// Creates the eye of a picture that is drawn into a part of a larger target: the view of one
    /// of several players, or a picture whose resolution changes within textures that stay.
    /// `viewport` is the part, in pixels of the target: left and upper edge, width and height. The
    /// graph is planned for the target's size, and takes its depth (`shared/from_depth.ron`), which
    /// is that of the far plane outside of the viewport. Maps with `fit: camera` are fitted to all
    /// of the target.
    ///
    /// # Errors
    /// Those of [`new`](Self::new). A viewport or target without area makes the projection singular
    /// or not finite.
    pub fn in_viewport(
        view: DMat4,
        projection: DMat4,
        depth: Depth,
        [x, y, width, height]: [f64; 4],
        target: [u32; 2],
    ) -> Result<Self, EyeError> {
        let target = DVec2::from(target.map(f64::from));
        let scale = DVec2::new(width, height) / target;
        let corner = 2.0 * DVec2::new(x, y) / target;
        let shift = DVec3::new(corner.x + scale.x - 1.0, 1.0 - corner.y - scale.y, 0.0);
        let within = DMat4::from_translation(shift) * DMat4::from_scale(scale.extend(1.0));
        Self::new(view, within * projection, depth)
    }

    /// Itself, unless its camera was none.
    pub(crate) fn finite(&self) -> Result<&Self, Error> {
        let numbers: &[f32] = bytemuck::cast_slice(std::slice::from_ref(&self.camera));
        let is_finite = numbers.iter().all(|number| number.is_finite());
        is_finite.then_some(self).ok_or(Error::Camera(self.camera))
    }
}

impl From<&Camera> for Eye {
    fn from(camera: &Camera) -> Self {
        let uniform = CameraUniform::from(camera);
        let at_origin = Camera {
            eye: DVec3::ZERO,
            ..*camera
        };
        let matrix = at_origin.view_projection().inverse();
        Self {
            camera: uniform,
            unprojection: UnprojectionUniform {
                relative_from_clip: matrix.as_mat4(),
                origin: uniform.eye,
                is_reversed: 1,
                origin_low: uniform.eye_low,
                padding: 0.0,
            },
        }
    }
}

/// The camera of a projection, relative to the eye.
fn frustum(relative_from_clip: &DMat4, depth: Depth) -> Result<Camera, EyeError> {
    let near_depth = f64::from(u8::from(depth == Depth::Reversed));
    let at = |x: f64, y: f64, depth: f64| relative_from_clip * DVec3::new(x, y, depth).extend(1.0);
    let point = |x, y, depth| {
        let at = at(x, y, depth);
        at.truncate() / at.w
    };
    let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    let near_corners = corners.map(|(x, y)| point(x, y, near_depth));
    let [low, right, up, _] = near_corners;
    let (right, up) = ((right - low).normalize_or_zero(), up - low);
    let up = up.reject_from_normalized(right).normalize_or_zero();
    let middle = point(0.0, 0.0, 0.5);
    let centre = point(0.0, 0.0, near_depth);
    let across = right.cross(up);
    let forward = across * across.dot(middle - centre).signum();
    let end = at(0.0, 0.0, 1.0 - near_depth);
    let along = |point: DVec3| forward.dot(point);
    let (mut near, mut far) = (along(centre), f64::INFINITY);
    if end.w.abs() > 1e-12 * end.truncate().length() {
        far = along(end.truncate() / end.w);
    }
    let begin = at(0.0, 0.0, near_depth).w;
    let is_parallel = (begin - end.w).abs() <= 1e-9 * begin.abs();
    let mut apex = DVec3::ZERO;
    if is_parallel {
        // A pyramid that has the box in it: its apex is as far before the box as that is deep.
        let length = far - near;
        apex = forward * (near - length);
        (near, far) = (length, 2.0 * length);
    } else if far.is_infinite() {
        far = FARTHEST * near;
    }
    // `near` is NaN if an infinite far plane is taken for the near one.
    if !is_parallel && (near <= 0.0 || near.is_nan() || far < near) {
        return Err(EyeError::Depth(depth));
    }
    let half = [right, up].map(|axis| {
        let reach = near_corners.map(|corner| axis.dot(corner - apex).abs());
        reach.into_iter().fold(0.0, f64::max) / near
    });
    let numbers = [near, far, half[0], half[1], 1.0 / near];
    let is_finite = |it: &f64| *it > 0.0 && (*it as f32).is_finite();
    let is_held = numbers.iter().all(is_finite) && near >= LEAST_DEPTH * far;
    if !(near < far && is_held && forward.is_finite()) {
        return Err(EyeError::Frustum { near, far });
    }
    Ok(Camera {
        eye: apex,
        right,
        up,
        forward,
        half_width: half[0],
        half_height: half[1],
        near,
        far,
        viewport: [1, 1],
        jitter: DVec2::ZERO,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dcamera::rh::{proj::directx as proj, view::look_to_mat4};

    fn view() -> DMat4 {
        look_to_mat4(
            DVec3::new(5.0, 6.0, 7.0),
            DVec3::new(1.0, -2.0, 3.0).normalize(),
            DVec3::Y,
        )
    }

    /// An eye, its matrix, and points of its frustum, corners and middle.
    fn seen(projection: DMat4, depth: Depth) -> (Eye, DMat4) {
        let eye = Eye::new(view(), projection, depth).unwrap();
        (eye, projection * view())
    }

    #[test]
    fn a_point_comes_back_from_its_depth() {
        let jitter = DMat4::from_translation(DVec3::new(0.003, -0.002, 0.0));
        let infinite = proj::perspective_infinite_reverse(1.0, 1.5, 0.1);
        for (projection, depth) in [
            (proj::perspective(1.0, 1.5, 0.1, 90.0), Depth::Standard),
            (infinite, Depth::Reversed),
            (jitter * infinite, Depth::Reversed),
            (
                proj::orthographic(-9.0, 9.0, -6.0, 6.0, -20.0, 60.0),
                Depth::Standard,
            ),
            (
                proj::orthographic(-9.0, 9.0, -6.0, 6.0, 60.0, -20.0),
                Depth::Reversed,
            ),
        ] {
            let (eye, matrix) = seen(projection, depth);
            let point = DVec3::new(6.0, 3.0, 12.0);
            let clip = matrix.project_point3(point);
            let back = eye
                .unprojection
                .relative_from_clip
                .as_dmat4()
                .project_point3(clip);
            let origin =
                eye.unprojection.origin.as_dvec3() + eye.unprojection.origin_low.as_dvec3();
            assert!((origin + back).distance(point) < 1e-4, "{projection}");

            // The frustum of the camera has what is seen in it.
            let camera = eye.camera;
            let from = (point.as_vec3() - camera.eye) - camera.eye_low;
            let distance = from.dot(camera.forward);
            assert!(
                camera.near <= distance && distance <= camera.far,
                "{projection}"
            );
            let ndc = [
                from.dot(camera.right) / (distance * camera.half_width),
                from.dot(camera.up) / (distance * camera.half_height),
            ];
            assert!(ndc.iter().all(|x| x.abs() <= 1.0), "{ndc:?}");
        }
    }

    #[test]
    fn a_cameras_eye_is_that_of_its_matrices() {
        let view_of = skiagraph_scene::View {
            name: String::new(),
            eye: DVec3::new(5.0, 6.0, 7.0),
            direction: DVec3::new(1.0, -2.0, 3.0),
            fov_y_degrees: 50.0,
            near: 0.5,
            far: 80.0,
            ..skiagraph_scene::View::default()
        };
        let own = Eye::from(&view_of.camera([30, 20]));
        // Planes that change places reverse the depth.
        let projection = proj::perspective(50_f64.to_radians(), 1.5, 80.0, 0.5);
        let (given, _) = seen(projection, Depth::Reversed);
        let is_near = |a: f32, b: f32| (a - b).abs() <= 1e-5 * (1.0 + b.abs());
        let numbers = |eye: &Eye| -> Vec<f32> {
            [
                bytemuck::bytes_of(&eye.camera),
                bytemuck::bytes_of(&eye.unprojection),
            ]
            .concat()
            .as_chunks()
            .0
            .iter()
            .map(|&bytes| f32::from_ne_bytes(bytes))
            .collect()
        };
        let pairs = numbers(&own).into_iter().zip(numbers(&given));
        assert!(
            pairs.into_iter().all(|(a, b)| is_near(a, b)),
            "{own:?} {given:?}"
        );
    }

    #[test]
    fn matrices_that_are_no_cameras_are_refused() {
        let projection = proj::perspective(1.0, 1.5, 0.1, 90.0);
        let error = |view, projection, depth| Eye::new(view, projection, depth).unwrap_err();
        assert_eq!(
            error(DMat4::ZERO, projection, Depth::Standard),
            EyeError::Singular("view")
        );
        assert_eq!(
            error(view(), DMat4::ZERO, Depth::Standard),
            EyeError::Singular("projection")
        );
        assert_eq!(
            error(view() * f64::NAN, projection, Depth::Standard),
            EyeError::NotFinite("view")
        );
        assert_eq!(
            error(view(), projection, Depth::Reversed),
            EyeError::Depth(Depth::Reversed)
        );
        let infinite = proj::perspective_infinite_reverse(1.0, 1.5, 0.1);
        assert_eq!(
            error(view(), infinite, Depth::Standard),
            EyeError::Depth(Depth::Standard)
        );
        let flat = proj::orthographic(-1e300, 1e300, -1.0, 1.0, 0.0, 1.0);
        assert!(matches!(
            error(view(), flat, Depth::Standard),
            EyeError::Frustum { .. } | EyeError::Singular(_)
        ));
    }
}
