//! Paths: a view whose eye, direction and light move from keyframe to keyframe, and parts of the
//! mesh with them.

use crate::camera::{View, is_y, y_axis};
use crate::keys::{not_later, spline};
use crate::light_kind::{Light, OwnLight};
use crate::mesh::Mesh;
use crate::motion::{Motion, moved};
use crate::movable::Movable;
use crate::vector::{SomeVector, Vector, is_default};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The most frames that a path may have: five and a half minutes at thirty per second.
const MOST_FRAMES: f64 = 10_000.0;

/// Path of a moving camera. Between keyframes, eye and direction follow Catmull-Rom splines
/// (Catmull, Rom 1974, over uneven times). Two keyframes make a straight line, two equal keyframes
/// a camera that stands still. The light and parts of the mesh may move as well.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(from = "PathText", into = "PathText")]
pub struct CameraPath {
    /// View that is changed from frame to frame: it holds the path's name and everything that stays
    /// constant. Its eye and direction are replaced by those of the keyframes.
    pub view: View,
    /// Number of frames per second of the keyframes' time, more than 0.
    pub frames_per_second: f64,
    /// Keyframes of the camera in the order of their times, at least two.
    pub keys: Vec<CameraKey>,
    /// Keyframes of the view's own light in the order of their times; empty for a light that stays
    /// in place. They have no effect if the view has no light of its own. Before the first and
    /// after the last key the light stands still.
    pub light_keys: Vec<LightKey>,
    /// Motions of parts of the mesh, at most one for each part.
    pub moves: Vec<Motion>,
}

/// A path as scene files write it.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Path")]
pub(crate) struct PathText {
    name: String,
    /// Direction up in the picture.
    #[serde(default = "y_axis", with = "Vector", skip_serializing_if = "is_y")]
    up: DVec3,
    /// Opening angle from bottom to top: more than 0, less than 180.
    fov_y_degrees: f64,
    /// Distance of the near plane, more than 0.
    near: f64,
    /// Distance of the far plane, more than `near`.
    far: f64,
    /// One sun in the place of the scene's lights.
    #[serde(default, with = "OwnLight", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<crate::DirectionalLight>"))]
    light: Option<Light>,
    #[serde(default = "thirty")]
    frames_per_second: f64,
    /// The camera's way, a smooth curve through its keys.
    keys: Vec<CameraKey>,
    /// The light's way.
    #[serde(default, skip_serializing_if = "is_default")]
    light_keys: Vec<LightKey>,
    /// Parts of the mesh that move.
    #[serde(default, skip_serializing_if = "is_default")]
    moves: Vec<Motion>,
}

fn thirty() -> f64 {
    30.0
}

impl From<CameraPath> for PathText {
    fn from(path: CameraPath) -> Self {
        let view = path.view;
        Self {
            name: view.name,
            up: view.up,
            fov_y_degrees: view.fov_y_degrees,
            near: view.near,
            far: view.far,
            light: view.light,
            frames_per_second: path.frames_per_second,
            keys: path.keys,
            light_keys: path.light_keys,
            moves: path.moves,
        }
    }
}

impl From<PathText> for CameraPath {
    fn from(mut text: PathText) -> Self {
        for motion in &mut text.moves {
            if let Motion::Sway { up, .. } = motion {
                *up = text.up;
            }
        }
        let mut view = View {
            name: text.name,
            up: text.up,
            fov_y_degrees: text.fov_y_degrees,
            near: text.near,
            far: text.far,
            light: text.light,
            ..View::default()
        };
        if let Some(first) = text.keys.first() {
            (view.eye, view.direction) = (first.eye, first.direction);
        }
        Self {
            view,
            frames_per_second: text.frames_per_second,
            keys: text.keys,
            light_keys: text.light_keys,
            moves: text.moves,
        }
    }
}

/// Keyframe of a camera: its position and direction at a time.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Key")]
pub struct CameraKey {
    /// Time in seconds, on the clock of the whole path (light and moving parts included). Frame 0
    /// is at the first keyframe.
    pub at: f64,
    /// Position of the camera, world space.
    #[serde(with = "Vector")]
    pub eye: DVec3,
    /// Direction in which the camera looks, world space, of any length above 0.
    #[serde(with = "Vector")]
    pub direction: DVec3,
}

/// Keyframe of the light of a camera path: its position and direction at a time.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LightKey {
    /// Time in seconds, on the same clock as the keyframes of the camera.
    pub at: f64,
    /// Direction in which the light travels, world space, of any length above 0; `None` for a point
    /// light.
    #[serde(default, with = "SomeVector", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Vector>"))]
    pub direction: Option<DVec3>,
    /// Position of a spot or point light, world space; `None` for a directional light.
    #[serde(default, with = "SomeVector", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Vector>"))]
    pub position: Option<DVec3>,
}

impl CameraPath {
    /// Creates a path of 30 frames per second on which only the camera moves.
    pub fn new(view: View, keys: Vec<CameraKey>) -> Self {
        Self {
            view,
            frames_per_second: thirty(),
            keys,
            light_keys: Vec::new(),
            moves: Vec::new(),
        }
    }

    /// Returns the number of frames. Frame 0 is at the first keyframe, the last frame at the last
    /// keyframe or less than a frame before it.
    pub fn frames(&self) -> u32 {
        // A time that is a whole number of frames but for its rounding has its last frame.
        (self.seconds() * self.frames_per_second + 1e-6) as u32 + 1
    }

    fn seconds(&self) -> f64 {
        match &self.keys[..] {
            [first, .., last] => last.at - first.at,
            _ => 0.0,
        }
    }

    /// When a frame is, by the time of the keys.
    fn at(&self, frame: u32) -> f64 {
        self.keys.first().map_or(0.0, |key| key.at) + f64::from(frame) / self.frames_per_second
    }

    /// Cuts a mesh into the parts that move on this path, in the order of [`moves`](Self::moves),
    /// for [`shape`](Self::shape). Returns `None` if no part moves.
    ///
    /// # Errors
    /// A sentence that names the path, if a part is not in the mesh or shares positions with other
    /// triangles.
    pub fn movable(&self, mesh: &Mesh) -> Result<Option<Movable>, String> {
        if self.moves.is_empty() {
            return Ok(None);
        }
        let parts = self.moves.iter().map(Motion::part);
        let movable = Movable::new(mesh, &parts.collect::<Vec<_>>());
        let movable =
            movable.map_err(|reason| format!("path {:?}: moves: {reason}", self.view.name))?;
        Ok(Some(movable))
    }

    /// Returns the mesh of frame number `frame`, from 0, with all parts moved. `movable` is the
    /// result of [`movable`](Self::movable). The triangles of the mesh are those at rest, because
    /// no motion mirrors a part.
    ///
    /// # Errors
    /// A sentence that names path, part and frame, if f32 cannot hold a part at its place in that
    /// frame, or if `movable` has another number of parts than the path moves.
    pub fn shape(&self, movable: &Movable, frame: u32) -> Result<Mesh, String> {
        moved(movable, &self.moves, self.at(frame))
            .map_err(|reason| format!("path {:?}: moves: frame {frame}: {reason}", self.view.name))
    }

    /// Returns the view of frame number `frame`, from 0, under the path's name. Its direction need
    /// not be a unit vector. Frames after the last show the last keyframe.
    pub fn view(&self, frame: u32) -> View {
        let at = self.at(frame);
        let times = |key: &CameraKey| key.at;
        let place = |vector: fn(&CameraKey) -> DVec3| spline(&self.keys, times, vector, at);
        View {
            eye: place(|key| key.eye),
            direction: place(|key| key.direction.normalize()),
            light: self.view.light.as_ref().map(|light| self.light(light, at)),
            ..self.view.clone()
        }
    }

    fn light(&self, light: &Light, at: f64) -> Light {
        if self.light_keys.is_empty() {
            return light.clone();
        }
        let place = |get: fn(&LightKey) -> DVec3| spline(&self.light_keys, |key| key.at, get, at);
        let direction = place(|key| key.direction.unwrap_or_default().normalize_or_zero());
        let position = place(|key| key.position.unwrap_or_default());
        let mut light = light.clone();
        let parameters = light.kind.parameters();
        for (value, now) in [
            (parameters.position, position),
            (parameters.direction, direction),
        ] {
            if let Some(value) = value {
                *value = now;
            }
        }
        light
    }

    /// Checks that the keys of the light are of the kind that the view's own light is.
    fn check_light(&self) -> Result<(), String> {
        if let Some(late) = not_later(&self.light_keys, |key| key.at) {
            return Err(format!("light_keys: {late}"));
        }
        let (Some(light), Some(_)) = (&self.view.light, self.light_keys.first()) else {
            return Ok(());
        };
        let (position, direction) = (light.kind.position(), light.kind.direction());
        let has = (position.is_some(), direction.is_some());
        let needs = match has {
            (true, true) => "`position` and `direction`",
            (true, false) => "`position` alone",
            (false, _) => "`direction` alone",
        };
        let fits = |key: &LightKey| (key.position.is_some(), key.direction.is_some()) == has;
        match self.light_keys.iter().find(|key| !fits(key)) {
            None => Ok(()),
            Some(key) => Err(format!(
                "the key of a {} light at {} s needs {needs}",
                light.kind.word(),
                key.at
            )),
        }
    }

    fn check_moves(&self) -> Result<(), String> {
        for (index, it) in self.moves.iter().enumerate() {
            let part = it.part();
            if self.moves[..index].iter().any(|other| other.part() == part) {
                return Err(format!("moves: {part:?} is there twice"));
            }
            it.check()?;
        }
        Ok(())
    }

    /// Iterates over the views of all frames, in order.
    pub fn views(&self) -> impl Iterator<Item = View> + '_ {
        (0..self.frames()).map(|frame| self.view(frame))
    }

    /// Checks that the keyframes and motions are valid, that the path has at most 10,000 frames,
    /// and that the view of each frame is valid.
    ///
    /// # Errors
    /// Sentence with the first mistake, which names the path.
    pub fn check(&self) -> Result<(), String> {
        let name = &self.view.name;
        if self.keys.len() < 2 {
            return Err(format!(
                "path {name:?} has {} of the two keys that it needs at least",
                self.keys.len()
            ));
        }
        let named = |reason| format!("path {name:?}: {reason}");
        self.check_parts().map_err(named)
    }

    /// Checks all but the number of keys, and leaves out its name.
    fn check_parts(&self) -> Result<(), String> {
        let rate = self.frames_per_second;
        if !(rate > 0.0 && rate.is_finite()) {
            return Err(format!("frames_per_second is {rate}, expected more than 0"));
        }
        if let Some(late) = not_later(&self.keys, |key| key.at) {
            return Err(late);
        }
        self.check_light()?;
        self.check_moves()?;
        let frames = self.seconds() * rate;
        if frames.is_nan() || frames >= MOST_FRAMES {
            return Err(format!(
                "{} s of {rate} frames are more than {MOST_FRAMES} frames",
                self.seconds()
            ));
        }
        for (frame, view) in self.views().enumerate() {
            view.check_parts()
                .map_err(|reason| format!("{reason} (frame {frame})"))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::DirectionalLight;

    fn path(keys: &[(f64, DVec3, DVec3)]) -> CameraPath {
        let keys = keys
            .iter()
            .map(|&(at, eye, direction)| CameraKey { at, eye, direction });
        let view = View {
            name: "walk".into(),
            direction: DVec3::X,
            near: 1.0,
            far: 100.0,
            ..View::default()
        };
        CameraPath {
            frames_per_second: 10.0,
            ..CameraPath::new(view, keys.collect())
        }
    }

    #[test]
    fn a_light_moves_past_a_camera_that_stands() {
        let eye = DVec3::new(0.1, 0.7, 0.3);
        let mut walk = path(&[(0.0, eye, DVec3::ONE), (0.5, eye, DVec3::ONE)]);
        let key = |at, direction| LightKey {
            at,
            direction: Some(direction),
            position: None,
        };
        walk.light_keys = vec![key(0.0, DVec3::X * 2.0), key(0.4, DVec3::NEG_Y)];
        walk.check().unwrap();
        walk.view.light = Some(DirectionalLight::new(DVec3::Z).into());
        walk.check().unwrap();
        let direction = |frame| {
            let light = walk.view(frame).light.unwrap();
            light.kind.directional().unwrap().direction
        };
        assert_eq!(direction(0), DVec3::X);
        assert!((direction(2) - DVec3::new(0.5, -0.5, 0.0)).length() < 1e-12);
        assert_eq!([direction(4), direction(5)], [DVec3::NEG_Y; 2]);
        let first = walk.view(0);
        for view in walk.views() {
            assert_eq!((view.eye, view.direction), (first.eye, first.direction));
        }
        walk.light_keys[1].position = Some(DVec3::ONE);
        assert_eq!(
            walk.check().unwrap_err(),
            "path \"walk\": the key of a directional light at 0.4 s needs `direction` alone"
        );
        walk.light_keys[1].at = 0.0;
        let late = walk.check().unwrap_err();
        assert!(late.contains("light_keys: a key at 0 s follows"), "{late}");
    }

    #[test]
    fn two_keys_are_a_line_and_the_ends_are_the_keys() {
        let walk = path(&[
            (1.0, DVec3::ZERO, DVec3::X),
            (1.3, DVec3::X * 3.0, DVec3::X * 9.0),
        ]);
        walk.check().unwrap();
        assert_eq!(walk.frames(), 4);
        for (frame, view) in walk.views().enumerate() {
            assert!(
                (view.eye - DVec3::X * frame as f64).length() < 1e-12,
                "{view:?}"
            );
            assert!((view.direction - DVec3::X).length() < 1e-12, "{view:?}");
            assert_eq!(view.name, "walk");
        }
    }

    #[test]
    fn it_passes_through_its_keys_without_a_corner() {
        let keys = [
            (0.0, DVec3::ZERO, DVec3::X),
            (0.5, DVec3::new(1.0, 2.0, 0.0), DVec3::Z),
            (0.7, DVec3::new(4.0, 2.0, 1.0), DVec3::Z),
            (1.6, DVec3::new(4.0, 0.0, 1.0), DVec3::X),
        ];
        let mut walk = path(&keys);
        walk.frames_per_second = 1000.0;
        walk.check().unwrap();
        for (at, eye, _) in keys {
            let frame = (at * 1000.0).round() as u32;
            assert!((walk.view(frame).eye - eye).length() < 1e-9);
        }
        let speed = |frame: u32| (walk.view(frame + 1).eye - walk.view(frame).eye) * 1000.0;
        for frame in [500, 700] {
            assert!(
                (speed(frame) - speed(frame - 1)).length() < 0.2,
                "frame {frame}"
            );
        }
    }

    #[test]
    fn what_makes_no_path_is_named() {
        let says = |change: fn(&mut CameraPath), expected: &str| {
            let mut walk = path(&[(0.0, DVec3::ZERO, DVec3::X), (1.0, DVec3::X, DVec3::X)]);
            change(&mut walk);
            assert_eq!(
                walk.check().unwrap_err(),
                format!("path \"walk\"{expected}")
            );
        };
        says(
            |walk| walk.keys.truncate(1),
            " has 1 of the two keys that it needs at least",
        );
        says(
            |walk| walk.frames_per_second = 0.0,
            ": frames_per_second is 0, expected more than 0",
        );
        says(
            |walk| walk.frames_per_second = 1e9,
            ": 1 s of 1000000000 frames are more than 10000 frames",
        );
        says(
            |walk| walk.keys[1].at = 0.0,
            ": a key at 0 s follows one at 0 s, expected a later time",
        );
        says(
            |walk| walk.keys[1].at = f64::NAN,
            ": a key at NaN s follows one at 0 s, expected a later time",
        );
        says(
            |walk| walk.keys[1].direction = -DVec3::X,
            ": direction [0, 0, 0] and up [0, 1, 0] must be finite and longer than 0 (frame 5)",
        );
    }

    #[test]
    fn a_path_may_look_straight_down_and_up() {
        let keys = [DVec3::NEG_Y, DVec3::Z, DVec3::Y, DVec3::Y];
        let keys = [0.0, 1.0, 2.0, 3.0].iter().zip(keys);
        let keys: Vec<_> = keys.map(|(&at, way)| (at, DVec3::ZERO, way)).collect();
        let walk = path(&keys);
        walk.check().unwrap();
        for view in walk.views() {
            let camera = view.camera([2, 1]);
            assert!(camera.right.dot(DVec3::Y).abs() < 1e-6, "{camera:?}");
        }
    }
}
