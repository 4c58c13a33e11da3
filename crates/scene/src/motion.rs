//! Motions of parts of a mesh on a camera path: rigid, from pose to pose, or swaying.

use crate::camera::y_axis;
use crate::keys::{not_later, spline};
use crate::mesh::Mesh;
use crate::movable::{Movable, MoveError};
use crate::vector::{Turn, Vector};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Motion of a part of a mesh (an OBJ group or object, a glTF node, or a group of a generated mesh)
/// over the time of a [`CameraPath`](crate::CameraPath), in seconds.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "moves")]
#[cfg_attr(feature = "schema", schemars(rename = "Motion"))]
pub enum Motion {
    /// The part is turned about an axis, then shifted. Between keys both follow Catmull-Rom
    /// splines, like the camera.
    Rigid {
        /// Name of the part.
        part: String,
        /// Point on the axis, which stays where it is while the part turns; world space.
        #[serde(default, with = "Vector")]
        pivot: DVec3,
        /// Axis about which the part turns, world space, of any length but zero.
        #[serde(default = "y_axis", with = "Vector")]
        axis: DVec3,
        /// Keys in the order of their times, at least one. Before the first and after the last key
        /// the part stands still.
        keys: Vec<RigidKey>,
    },
    /// The part is turned and shifted from pose to pose, along straight lines and by the shortest
    /// turns.
    Posed {
        /// Name of the part.
        part: String,
        /// Keys in the order of their times, at least one. Before the first and after the last key
        /// the part stands still.
        keys: Vec<PoseKey>,
    },
    /// The part is bent as by wind: a point at height h above the foot (the lowest point along
    /// `up`) of a part of height H is shifted by `H (h / H)² tan(a)` along `axis`. The angle a is
    /// `degrees · sin(2π t / seconds)` at the time t on the clock of the path's keyframes. The foot
    /// stands still.
    Sway {
        /// Name of the part.
        part: String,
        /// Direction in which the part leans while a is positive, world space, of any length but
        /// zero and not along `up`.
        #[serde(with = "Vector")]
        axis: DVec3,
        /// Direction in which the part grows, world space, of any length but zero: that of the `up`
        /// of the path that the motion belongs to, and no field of its own in scene files.
        #[serde(skip, default = "y_axis")]
        up: DVec3,
        /// Greatest angle of the swing in degrees, more than −90 and less than 90.
        degrees: f64,
        /// Period of the swing in seconds, more than 0.
        seconds: f64,
    },
}

/// Keyframe of a `Rigid` motion: turn and shift of a part at a time.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RigidKey {
    /// Time in seconds, on the clock of the path's keyframes.
    pub at: f64,
    /// Shift of the part from its place at rest, in scene units, after the turn.
    #[serde(default, with = "Vector")]
    pub translation: DVec3,
    /// Angle in degrees by which the part is turned about the motion's axis, counter-clockwise seen
    /// from the axis's tip.
    #[serde(default)]
    pub degrees: f64,
}

/// Keyframe of a `Posed` motion: the part is turned about the world's origin, then shifted.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PoseKey {
    /// Time in seconds, on the clock of the path's keyframes.
    pub at: f64,
    /// Shift of the part after the turn, in scene units.
    #[serde(default, with = "Vector")]
    pub translation: DVec3,
    /// Unit quaternion (x, y, z, w) that turns the part from its pose at rest.
    #[serde(default, with = "Turn")]
    pub rotation: DQuat,
}

/// The map of poses at a time.
fn posed(keys: &[PoseKey], at: f64) -> DAffine3 {
    let passed = keys.partition_point(|key| key.at <= at);
    let (from, to) = (passed.saturating_sub(1), passed.min(keys.len().max(1) - 1));
    let (Some(from), Some(to)) = (keys.get(from), keys.get(to)) else {
        return DAffine3::IDENTITY;
    };
    // At a key it is the key, to the last bit.
    if at <= from.at || to.at <= from.at {
        return DAffine3::from_rotation_translation(from.rotation, from.translation);
    }
    let share = ((at - from.at) / (to.at - from.at)).min(1.0);
    DAffine3::from_rotation_translation(
        from.rotation.slerp(to.rotation, share),
        from.translation.lerp(to.translation, share),
    )
}

/// Finds the mistake in keys: there are none, their times do not grow, or they are not valid
/// otherwise.
fn wrong_keys<K>(
    keys: &[K],
    time: fn(&K) -> f64,
    are_valid: bool,
    otherwise: &str,
) -> Option<String> {
    if keys.is_empty() {
        return Some("it has none of the keys, of which it needs one at least".to_owned());
    }
    not_later(keys, time).or_else(|| (!are_valid).then(|| otherwise.to_owned()))
}

impl Motion {
    /// Returns the name of the part that moves.
    pub fn part(&self) -> &str {
        match self {
            Self::Rigid { part, .. } | Self::Posed { part, .. } | Self::Sway { part, .. } => part,
        }
    }

    /// Checks that the motion is valid: keys in the order of their times, finite numbers within
    /// their ranges, and a sway that does not turn its part inside out.
    ///
    /// # Errors
    /// Sentence with the first mistake, which names the part.
    pub fn check(&self) -> Result<(), String> {
        let is_axis = |axis: DVec3| axis.is_finite() && axis.length_squared() > 0.0;
        let wrong = match self {
            Self::Rigid { axis, .. } if !is_axis(*axis) => {
                Some(format!("axis {axis} must be finite and longer than 0"))
            }
            Self::Rigid { pivot, keys, .. } => {
                let is_finite = |key: &RigidKey| {
                    key.at.is_finite() && key.translation.is_finite() && key.degrees.is_finite()
                };
                let are_finite = pivot.is_finite() && keys.iter().all(is_finite);
                wrong_keys(
                    keys,
                    |key| key.at,
                    are_finite,
                    "pivot and keys must be finite",
                )
            }
            Self::Posed { keys, .. } => {
                let is_pose = |key: &PoseKey| {
                    key.at.is_finite()
                        && key.translation.is_finite()
                        && key.rotation.is_normalized()
                };
                let otherwise = "keys must be finite, and each rotation a unit quaternion";
                wrong_keys(keys, |key| key.at, keys.iter().all(is_pose), otherwise)
            }
            Self::Sway { axis, up, .. }
                if !is_axis(*axis) || axis.cross(*up).length_squared() == 0.0 =>
            {
                Some(format!(
                    "axis {axis} must be finite, longer than 0 and not along {up}, which is up"
                ))
            }
            Self::Sway { degrees, .. } if degrees.is_nan() || degrees.abs() >= 90.0 => {
                Some(format!("degrees are {degrees}, expected less than 90"))
            }
            Self::Sway {
                axis, up, degrees, ..
            } if folds(*axis, *up, *degrees) => Some(format!(
                "leaning by {degrees} degrees along {axis}, which is partly up or down, it is \
                 turned inside out: lean less, or across {up}"
            )),
            Self::Sway { seconds, .. } if !(seconds.is_finite() && *seconds > 0.0) => {
                Some(format!("seconds are {seconds}, expected more than 0"))
            }
            Self::Sway { .. } => None,
        };
        let named = |what| Err(format!("moves: {:?}: {what}", self.part()));
        wrong.map_or(Ok(()), named)
    }

    /// The map of its part, which lies between two heights, at a time: of a place at rest, the
    /// place now and the map's derivative there.
    fn map(&self, [low, high]: [f64; 2], at: f64) -> Box<dyn Fn(DVec3) -> (DVec3, DMat3)> {
        match self {
            Self::Rigid {
                pivot, axis, keys, ..
            } => {
                let degrees = spline(keys, |key| key.at, |key| DVec3::X * key.degrees, at).x;
                let shift = spline(keys, |key| key.at, |key| key.translation, at);
                let turn = DQuat::from_axis_angle(axis.normalize(), degrees.to_radians());
                let map = DAffine3::from_translation(*pivot + shift)
                    * DAffine3::from_quat(turn)
                    * DAffine3::from_translation(-*pivot);
                // A part at rest is where it was to the last bit.
                let map = if degrees == 0.0 {
                    DAffine3::from_translation(shift)
                } else {
                    map
                };
                Box::new(move |place| (map.transform_point3(place), map.matrix3))
            }
            Self::Posed { keys, .. } => {
                let map = posed(keys, at);
                Box::new(move |place| (map.transform_point3(place), map.matrix3))
            }
            Self::Sway {
                axis,
                up,
                degrees,
                seconds,
                ..
            } => {
                let (axis, up) = (axis.normalize(), up.normalize());
                let lean = (degrees.to_radians() * (TAU * at / seconds).sin()).tan();
                let height = (high - low).max(f64::MIN_POSITIVE);
                Box::new(move |place| {
                    let share = (place.dot(up) - low) / height;
                    let slope = axis * (2.0 * share * lean);
                    let bent = DMat3::from_cols(slope * up.x, slope * up.y, slope * up.z);
                    (
                        place + axis * (height * share * share * lean),
                        DMat3::IDENTITY + bent,
                    )
                })
            }
        }
    }

    fn up(&self) -> DVec3 {
        match self {
            Self::Rigid { .. } | Self::Posed { .. } => DVec3::ZERO,
            Self::Sway { up, .. } => up.normalize(),
        }
    }
}

/// Returns true if a sway turns the top of its part inside out: the determinant of its derivative,
/// 1 + 2 (h / H) tan(a) (axis · up), is not above 0 everywhere.
fn folds(axis: DVec3, up: DVec3, degrees: f64) -> bool {
    let along = axis.normalize().dot(up.normalize()).abs();
    2.0 * degrees.abs().to_radians().tan() * along >= 1.0
}

/// Returns the mesh of `movable` with its parts moved to their places at the time `at`, in seconds
/// on the clock of the keyframes of the [`CameraPath`](crate::CameraPath). Part number n of
/// `movable` follows `motions[n]`; the name in that motion ([`Motion::part`]) is ignored.
///
/// # Errors
/// [`MoveError::Count`] if there is not one motion for each part; other errors for a part that its
/// motion cannot move at that time.
pub fn moved(movable: &Movable, motions: &[Motion], at: f64) -> Result<Mesh, MoveError> {
    movable.check_count(motions.len())?;
    let parts = motions.iter().enumerate();
    let maps = parts.map(|(part, motion)| motion.map(movable.span(part, motion.up()), at));
    let maps: Vec<_> = maps.collect();
    movable.bent(|part, place| maps[part](place))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sway(axis: DVec3, degrees: f64) -> Motion {
        Motion::Sway {
            part: "tree".into(),
            axis,
            up: DVec3::Y,
            degrees,
            seconds: 2.0,
        }
    }

    #[test]
    fn a_foot_stands_and_the_derivative_is_that_of_the_bend() {
        let map = sway(DVec3::X, 45.0).map([1.0, 5.0], 0.5);
        let foot = DVec3::new(2.0, 1.0, 3.0);
        assert_eq!(map(foot).0, foot);
        let tip = map(foot + DVec3::Y * 4.0).0;
        assert!((tip - DVec3::new(6.0, 5.0, 3.0)).length() < 1e-12, "{tip}");
        let (place, step) = (DVec3::new(0.5, 2.5, -1.0), 1e-6);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let slope = (map(place + axis * step).0 - map(place).0) / step;
            assert!((slope - map(place).1 * axis).length() < 1e-5, "{slope}");
        }
        // At the period's begin nothing is bent.
        assert_eq!(sway(DVec3::X, 45.0).map([1.0, 5.0], 0.0)(place).0, place);
    }

    #[test]
    fn a_turn_keeps_its_pivot() {
        let key = |at, degrees| RigidKey {
            at,
            translation: DVec3::ZERO,
            degrees,
        };
        let turn = Motion::Rigid {
            part: "lamp".into(),
            pivot: DVec3::X,
            axis: DVec3::Y * 3.0,
            keys: vec![key(0.0, 0.0), key(1.0, 90.0)],
        };
        turn.check().unwrap();
        let map = turn.map([0.0; 2], 2.0);
        assert!((map(DVec3::X).0 - DVec3::X).length() < 1e-12);
        let turned = map(DVec3::X * 2.0).0;
        assert!((turned - DVec3::new(1.0, 0.0, -1.0)).length() < 1e-12);
    }

    #[test]
    fn poses_are_met_and_between_them_the_way_is_straight() {
        let key = |at, translation, degrees: f64| PoseKey {
            at,
            translation,
            rotation: DQuat::from_rotation_z(degrees.to_radians()),
        };
        let keys = vec![
            key(1.0, DVec3::ZERO, 0.0),
            key(2.0, DVec3::X * 2.0, 90.0),
            key(4.0, DVec3::X * 2.0, 90.0),
        ];
        let part = "door".to_owned();
        let motion = Motion::Posed {
            part: part.clone(),
            keys: keys.clone(),
        };
        motion.check().unwrap();
        let place = |at| motion.map([0.0; 2], at)(DVec3::Y).0;
        assert_eq!([place(0.0), place(1.0)], [DVec3::Y; 2]);
        let half = DVec3::new(1.0 - 0.5f64.sqrt(), 0.5f64.sqrt(), 0.0);
        assert!((place(1.5) - half).length() < 1e-12, "{}", place(1.5));
        for at in [2.0, 3.0, 4.0, 9.0] {
            assert!((place(at) - DVec3::X).length() < 1e-12, "{}", place(at));
        }
        let refusal = |change: fn(&mut Vec<PoseKey>)| {
            let mut keys = keys.clone();
            change(&mut keys);
            let part = part.clone();
            Motion::Posed { part, keys }.check().unwrap_err()
        };
        let none = refusal(Vec::clear);
        assert!(none.contains("none of the keys"), "{none}");
        let late = refusal(|keys| keys[1].at = 0.5);
        assert!(late.contains("expected a later time"), "{late}");
        let no_turn = refusal(|keys| keys[1].rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        assert!(no_turn.contains("unit quaternion"), "{no_turn}");
    }

    #[test]
    fn what_is_no_motion_is_named() {
        let upright = sway(DVec3::Y, 5.0).check().unwrap_err();
        assert!(
            upright.contains("moves: \"tree\": axis [0, 1, 0]"),
            "{upright}"
        );
        let inside_out = sway(DVec3::new(1.0, 1.0, 0.0), 40.0).check().unwrap_err();
        assert!(inside_out.contains("turned inside out"), "{inside_out}");
        sway(DVec3::new(1.0, 1.0, 0.0), 30.0).check().unwrap();
        let flat = sway(DVec3::X, 90.0).check().unwrap_err();
        assert!(flat.contains("degrees are 90"), "{flat}");
    }
}
