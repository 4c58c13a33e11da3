//! Moves the camera and the light of a view.

use glam::{DQuat, DVec3};
use skiagraph_scene::{LightKind, View};

/// Greatest angle of the view to the horizon, degrees: straight up or down there is no right and
/// left.
const STEEPEST_DEGREES: f64 = 89.0;

/// Paces that a key flies in a second.
pub const SPEED: f64 = 0.4;

/// The frame of a view: right, up and forward, unit vectors.
fn frame(view: &View) -> [DVec3; 3] {
    let camera = view.camera([1, 1]);
    [camera.right, camera.up, camera.forward]
}

/// Turns a direction about the view's up by `yaw` and towards it by `pitch`, radians.
fn turned(direction: DVec3, view: &View, yaw: f64, pitch: f64) -> DVec3 {
    let up = view.up.normalize_or(DVec3::Y);
    let direction = DQuat::from_axis_angle(up, yaw) * direction.normalize_or(DVec3::NEG_Z);
    let [right, ..] = frame(&View {
        direction,
        ..view.clone()
    });
    let height = direction.dot(up).clamp(-1.0, 1.0).asin();
    let steepest = STEEPEST_DEGREES.to_radians();
    // A view that is steeper from the start may stay so, and not become more so.
    let most = steepest.max(height.abs());
    let pitch = (height + pitch).clamp(-most, most) - height;
    DQuat::from_axis_angle(right, pitch) * direction
}

/// Turns the camera in place: to the left by `yaw` about the view's up direction, and up by
/// `pitch`. Angles are radians.
pub fn look(view: &mut View, yaw: f64, pitch: f64) {
    view.direction = turned(view.direction, view, yaw, pitch);
}

/// Moves the camera around the point that lies `distance` (scene units) in front of the eye, and
/// turns it by `yaw` and `pitch` as [`look`] does, so that the point keeps its place in the
/// picture.
pub fn orbit(view: &mut View, yaw: f64, pitch: f64, distance: f64) {
    let [_, _, forward] = frame(view);
    let centre = view.eye + forward * distance;
    look(view, yaw, pitch);
    let [_, _, forward] = frame(view);
    view.eye = centre - forward * distance;
}

/// Returns the length that an eye moves in one unit of time, in scene units: the smallest side of
/// the scene's box between its low and high corner, but at least a twentieth of the largest, and
/// the distance of the eye to the box. That is slow in the streets of a town and fast towards it.
pub fn pace(eye: DVec3, (min, max): (DVec3, DVec3)) -> f64 {
    let size = max - min;
    let side = size.min_element().max(0.05 * size.max_element());
    (side + eye.distance(eye.clamp(min, max))).max(f64::MIN_POSITIVE)
}

/// Moves the eye by `by` along its right, up and forward directions, in multiples of its [`pace`]
/// in the scene's box.
pub fn fly(view: &mut View, by: DVec3, bounds: (DVec3, DVec3)) {
    let [right, up, forward] = frame(view);
    view.eye += (right * by.x + up * by.y + forward * by.z) * pace(view.eye, bounds);
}

/// Turns the direction of a directional or spot light, or moves a point light around `centre`: by
/// `yaw` about the view's up direction, and towards it by `pitch`. Angles are radians.
pub fn turn_light(light: &mut LightKind, view: &View, yaw: f64, pitch: f64, centre: DVec3) {
    let turn = |direction| turned(direction, view, yaw, pitch);
    let light = light.parameters();
    if let Some(direction) = light.direction {
        *direction = turn(*direction);
    } else if let Some(position) = light.position
        && *position != centre
    {
        let arm = *position - centre;
        *position = centre + turn(arm) * arm.length();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_scene::{DirectionalLight, PointLight};

    fn view() -> View {
        View {
            eye: DVec3::new(0.0, 2.0, 8.0),
            far: 100.0,
            ..View::default()
        }
    }

    #[test]
    fn who_orbits_keeps_distance_and_subject() {
        let mut view = view();
        let centre = view.eye + view.direction * 8.0;
        for _ in 0..40 {
            orbit(&mut view, 0.2, 0.1, 8.0);
            view.check().unwrap();
            assert!((view.eye.distance(centre) - 8.0).abs() < 1e-9);
            let towards = (centre - view.eye).normalize();
            assert!(towards.dot(view.direction.normalize()) > 1.0 - 1e-9);
        }
        assert!(view.eye.y < -5.9, "the pitch has led below: {}", view.eye);
    }

    #[test]
    fn nobody_looks_straight_up() {
        let mut view = view();
        look(&mut view, 0.0, 10.0);
        view.check().unwrap();
        let height = view.direction.normalize().y.asin().to_degrees();
        assert!((height - STEEPEST_DEGREES).abs() < 1e-6, "{height}");
        view.direction = DVec3::new(1e-4, 1.0, 0.0);
        look(&mut view, 0.0, 1.0);
        view.check().unwrap();
    }

    #[test]
    fn a_view_straight_down_is_turned_up_again() {
        let mut view = view();
        view.direction = DVec3::NEG_Y;
        look(&mut view, 0.0, 0.4);
        // Towards what was the top of the picture.
        let expected = DVec3::new(0.0, -0.4f64.cos(), -0.4f64.sin());
        assert!(view.direction.distance(expected) < 1e-9, "{view:?}");
        let mut sun = LightKind::from(DirectionalLight::new(DVec3::NEG_Y));
        turn_light(&mut sun, &view, 0.5, 0.1, DVec3::ZERO);
        sun.check().unwrap();
    }

    #[test]
    fn flying_goes_where_the_eye_looks() {
        let mut view = view();
        look(&mut view, std::f64::consts::FRAC_PI_2, 0.0);
        let bounds = (DVec3::splat(-9.0), DVec3::splat(9.0));
        fly(&mut view, DVec3::new(0.0, 0.0, 0.5), bounds);
        let there = DVec3::new(-9.0, 2.0, 8.0);
        assert!(view.eye.distance(there) < 1e-9, "{}", view.eye);
    }

    /// Seconds in which an eye that flies ahead, as W has it, gets out of a box.
    fn seconds_inside(view: &View, bounds: (DVec3, DVec3)) -> f64 {
        let (mut view, mut frames) = (view.clone(), 0);
        while view.eye.clamp(bounds.0, bounds.1) == view.eye && frames < 6000 {
            fly(&mut view, DVec3::Z * SPEED / 60.0, bounds);
            frames += 1;
        }
        f64::from(frames) / 60.0
    }

    #[test]
    fn flights_are_scaled_to_the_scene() {
        // From the middle of a town in several units, of a room, and of a tower.
        for (size, least, most) in [
            ([300.0, 25.0, 300.0], 10.0, 30.0),
            ([3e4, 2500.0, 3e4], 10.0, 30.0),
            ([3e6, 0.0, 3e6], 10.0, 30.0),
            ([8.0, 3.0, 6.0], 2.0, 6.0),
            ([20.0, 90.0, 20.0], 1.0, 6.0),
        ] {
            let size = DVec3::from(size);
            let eye = DVec3::new(0.0, 0.07 * size.y, 0.0);
            let low = DVec3::new(-0.5 * size.x, 0.0, -0.5 * size.z);
            let seconds = seconds_inside(&View { eye, ..view() }, (low, low + size));
            assert!((least..most).contains(&seconds), "{size}: {seconds}");
        }
        // From outside, a town is reached in seconds.
        let bounds = (DVec3::ZERO, DVec3::new(300.0, 25.0, 300.0));
        let mut far = View {
            eye: DVec3::new(150.0, 10.0, 3000.0),
            ..view()
        };
        let mut frames = 0;
        while far.eye.z > 300.0 && frames < 6000 {
            fly(&mut far, DVec3::Z * SPEED / 60.0, bounds);
            frames += 1;
        }
        assert!((180..900).contains(&frames), "{frames}");
    }

    #[test]
    fn a_light_turns_and_stays_as_long_or_as_far_away() {
        let view = view();
        let mut sun = LightKind::from(DirectionalLight::new(DVec3::new(1.0, -1.0, 0.0)));
        turn_light(&mut sun, &view, 0.5, 0.1, DVec3::ZERO);
        sun.check().unwrap();
        let mut bulb = LightKind::Point(PointLight {
            position: DVec3::new(3.0, 4.0, 0.0),
            radius: 0.0,
        });
        turn_light(&mut bulb, &view, 0.5, 0.0, DVec3::ZERO);
        let position = bulb.position().unwrap();
        assert!((position.length() - 5.0).abs() < 1e-9, "{position}");
        assert!((position.y - 4.0).abs() < 1e-9, "{position}");
    }
}
