//! Changes the camera of a view: eye, direction, field of view and clip planes of one's own.
//!
//! ```
//! use glam::DVec3;
//! use skiagraph_compare::own_camera::OwnCamera;
//! use skiagraph_scene::SceneLibrary;
//!
//! let (scene, _) = SceneLibrary::default().load("park")?;
//! let camera = OwnCamera { eye: Some(DVec3::new(0.0, 90.0, 0.0)), ..OwnCamera::default() };
//! let view = camera.of_view(&scene.views[0], &scene.mesh, true);
//! assert!(view.eye.y == 90.0 && view.far > 90.0);
//! assert_eq!(view.direction, scene.views[0].direction);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use glam::DVec3;
use skiagraph_scene::{Mesh, View};

/// A depth buffer of 32-bit floats tells depths apart well over this range.
const NEAR_TO_FAR: f64 = 1e4;

/// Parts of a camera that replace the same parts of a view's camera. `None` keeps the view's part.
/// Lengths are in the scene's units, positions and directions in world space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OwnCamera {
    /// Position of the eye, world space.
    pub eye: Option<DVec3>,
    /// Direction in which the eye looks, world space, of any length above 0.
    pub direction: Option<DVec3>,
    /// Direction up in the picture, world space, of any length above 0.
    pub up: Option<DVec3>,
    /// Vertical field of view in degrees, between 0 and 180.
    pub fov_y_degrees: Option<f64>,
    /// Distance of the near plane from the eye, in scene units.
    pub near: Option<f64>,
    /// Distance of the far plane from the eye, in scene units.
    pub far: Option<f64>,
}

impl OwnCamera {
    /// True if all parts are `None`, so that a view's camera is kept.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns a copy of `view` whose camera has these parts instead of its own. If `fits` is true,
    /// a clip plane that is `None` here is fitted to the mesh: far just behind the mesh, near at a
    /// ten-thousandth of far. The copy is not checked: [`View::check`] does that.
    pub fn of_view(&self, view: &View, mesh: &Mesh, fits: bool) -> View {
        let mut own = View {
            eye: self.eye.unwrap_or(view.eye),
            direction: self.direction.unwrap_or(view.direction),
            up: self.up.unwrap_or(view.up),
            fov_y_degrees: self.fov_y_degrees.unwrap_or(view.fov_y_degrees),
            near: self.near.unwrap_or(view.near),
            far: self.far.unwrap_or(view.far),
            ..view.clone()
        };
        if fits {
            let farthest = mesh.bounds().map_or(1.0, |(min, max)| {
                let (min, max) = (min.as_dvec3(), max.as_dvec3());
                (max - own.eye).abs().max((own.eye - min).abs()).length()
            });
            let least = (self.near.unwrap_or(0.0) * 2.0).max(f64::MIN_POSITIVE);
            own.far = self.far.unwrap_or((farthest * 1.01).max(least));
            own.near = self.near.unwrap_or(own.far / NEAR_TO_FAR);
        }
        own
    }
}
