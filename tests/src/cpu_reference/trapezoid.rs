//! The trapezoidal shadow map of Martin and Tan, "Anti-aliasing and Continuity with Trapezoidal
//! Shadow Maps", EGSR 2004, by the eight matrices of the dissertation's equations 5 to 13.

use glam::{DMat3, DVec2, DVec3};

/// The paper's 80 % line: where the focus lies in a square from −1 to 1.
const FOCUS_LINE: f64 = -0.6;

/// The corners of the trapezoid around a frustum that is seen along the light, its near plane's
/// corners first: those that go to (−1, −1), (1, −1), (1, 1) and (−1, 1), the base line first.
/// `focus` is a share of the way from the near plane to the far plane. None where the eye looks
/// along the light, or back along it.
pub fn trapezoid(corners: [DVec2; 8], focus: f64) -> Option<[DVec2; 4]> {
    let centre = |corners: &[DVec2]| corners.iter().sum::<DVec2>() / 4.0;
    let [near, far] = [centre(&corners[..4]), centre(&corners[4..])];
    let along = (far - near).try_normalize()?;
    let across = along.perp();
    let places =
        corners.map(|corner| DVec2::new(across.dot(corner - near), along.dot(corner - near)));
    if places[4..].iter().any(|place| place.y <= 0.0) {
        return None;
    }
    let top = places
        .iter()
        .map(|place| place.y)
        .fold(f64::INFINITY, f64::min);
    let base = places
        .iter()
        .map(|place| place.y)
        .fold(f64::NEG_INFINITY, f64::max);
    let height = base - top;
    let focused = focus * (far - near).length() - top;
    let room = (1.0 - FOCUS_LINE) * height - 2.0 * focused;
    let farthest = 1e3 * height;
    let apex = if room > 0.0 {
        (height * focused * (1.0 + FOCUS_LINE) / room).min(farthest)
    } else {
        farthest
    };
    let slopes = places.map(|place| place.x / (place.y - top + apex));
    let left = slopes.into_iter().fold(f64::INFINITY, f64::min);
    let right = slopes.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let at =
        |slope: f64, beyond: f64| near + across * (slope * beyond) + along * (top - apex + beyond);
    Some([
        at(left, apex + height),
        at(right, apex + height),
        at(right, apex),
        at(left, apex),
    ])
}

/// The matrix N_T that takes such corners, which must be no parallelogram's, to those of the
/// square.
pub fn normalization(corners: [DVec2; 4]) -> DMat3 {
    let [base_left, base_right, top_right, top_left] = corners;
    // Equations 5 and 6: the middle of the top line goes to the origin, the line along x.
    let t1 = DMat3::from_translation(-(top_right + top_left) / 2.0);
    let axis = (top_right - top_left).normalize();
    let r = DMat3::from_cols(
        DVec3::new(axis.x, -axis.y, 0.0),
        DVec3::new(axis.y, axis.x, 0.0),
        DVec3::Z,
    );
    // 7: the point where the side lines meet goes to the origin.
    let (left, right) = (top_left - base_left, top_right - base_right);
    let along_left = (base_right - base_left).perp_dot(right) / left.perp_dot(right);
    let meeting = r * t1 * (base_left + left * along_left).extend(1.0);
    let t2 = DMat3::from_translation(-meeting.truncate());
    // 8: sheared, so that it is symmetrical.
    let before = t2 * r * t1;
    let middle = before * ((top_right + top_left) / 2.0).extend(1.0);
    let h = DMat3::from_cols(
        DVec3::X,
        DVec3::new(-middle.x / middle.y, 1.0, 0.0),
        DVec3::Z,
    );
    // 9: the top line at distance 1, the sides at 90 degrees.
    let before = h * before;
    let corner = before * top_right.extend(1.0);
    let s1 = DMat3::from_diagonal(DVec3::new(1.0 / corner.x, 1.0 / corner.y, 1.0));
    // 10: to a rectangle.
    let n = DMat3::from_cols(DVec3::X, DVec3::new(0.0, 1.0, 1.0), DVec3::Y);
    let before = n * s1 * before;
    let height = |point: DVec2, matrix: DMat3| {
        let place = matrix * point.extend(1.0);
        place.y / place.z
    };
    // 11 and 12: around the origin, and as high as it is wide.
    let middle = (height(base_left, before) + height(top_right, before)) / 2.0;
    let before = DMat3::from_translation(DVec2::new(0.0, -middle)) * before;
    let s2 = DMat3::from_diagonal(DVec3::new(1.0, -1.0 / height(base_left, before), 1.0));
    s2 * before
}
