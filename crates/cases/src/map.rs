//! Defines cases in which casters or receivers have special places in the shadow map.

use crate::case::HardCase;
use crate::shape::{Shape, seen};
use glam::DVec3;

/// The light is fitted to 500 units and a margin of 1.002, 501 in all: a texel of a map of 64 is
/// 501 / 64, which f32 holds, and so it does every corner of texels of 64, 128 and 256. The
/// vertices *are* there; what a method's f32 makes of it is up to it.
const TEXEL: f32 = 501.0 / 64.0;

/// A coordinate, counted in texels of a map of 64.
const fn texels(count: f32) -> f32 {
    -250.5 + count * TEXEL
}

const CORNER_LIGHT: DVec3 = DVec3::new(0.5, -1.0, 0.3);

/// A fifth of a texel of a map of 128 in `receivers_on_texel_corners`. Its floor of 2500 units is
/// turned by the angle of a triangle of sides 3, 4, 5, so what is at whole texels is at whole
/// multiples of this, which f32 holds. In light space it is a sum of products, and rounding moves
/// it either way.
const FIFTH: f32 = 501.0 / 128.0;

/// World space from a place counted from the floor's centre, in units whose fifth is given.
fn turned([u, y, v]: [f32; 3], fifth: f32) -> [f32; 3] {
    [3.0 * u - 4.0 * v, 5.0 * y, 4.0 * u + 3.0 * v].map(|sum| sum * fifth)
}

/// In texels, too: corners of texels at even heights shade corners of texels of the floor.
const TILT: DVec3 = DVec3::new(-0.5, -1.0, 0.0);

/// Where the eye is over the board.
const X: f64 = (-4.0 * FIFTH) as f64;
const Z: f64 = (3.0 * FIFTH) as f64;

/// A sheet of tiles, in texels.
struct Tiling {
    /// Borders of its tiles, in either direction.
    lines: [[f32; 5]; 2],
    y: f32,
}

/// Every other square of a board, each of 4 by 4 tiles of 2 by 2 texels. Tiles meet at texels'
/// corners; the sheets end a thousandth of a texel beyond one, some as much before it, and few on
/// it. Their shadows' columns are odd, since pixels see odd columns and even rows.
fn tilings() -> impl Iterator<Item = Tiling> {
    let squares = (0..10u8).flat_map(|row| (0..10u8).map(move |column| [column, row]));
    let squares = squares.filter(|[column, row]| (column + row) % 2 == 0);
    squares.map(|[column, row]| {
        let beyond = match (3 * column + row) % 16 {
            0 => 0.0,
            6 | 12 => -0.001,
            _ => 0.001,
        };
        let y = 46.0 + 2.0 * f32::from((3 * column + 5 * row) % 7);
        let [column, row] = [column, row].map(|number| 8.0 * f32::from(number) - 40.0);
        let lines = [column + 1.0 + 0.5 * y, row].map(|first| {
            let mut lines = [0.0, 2.0, 4.0, 6.0, 8.0].map(|line| first + line);
            lines[0] -= beyond;
            lines[4] += beyond;
            lines
        });
        Tiling { lines, y }
    })
}

/// The board is above the eye, which looks straight down at a third of the map. With as many pixels
/// as the map has texels, every third column of pixels is on a line between texels, and so is every
/// third row.
fn receivers_on_texel_corners() -> Shape {
    let quad = |shape: Shape, u: &[f32], v: &[f32], y: f32, fifth: f32| {
        let corners = [[u[0], v[1]], [u[1], v[1]], [u[1], v[0]], [u[0], v[0]]];
        shape.quad(corners.map(|[u, v]| turned([u, y, v], fifth)))
    };
    let floor = quad(Shape::default(), &[-1.0, 1.0], &[-1.0, 1.0], 0.0, 250.0);
    let board = tilings().fold(Shape::default(), |shape, tiling| {
        let [columns, rows] = tiling.lines;
        rows.windows(2).fold(shape, |shape, v| {
            let tiles = columns.windows(2);
            tiles.fold(shape, |shape, u| quad(shape, u, v, tiling.y, FIFTH))
        })
    });
    floor.and(board.reversed())
}

pub(crate) const CASES: &[HardCase] = &[
    HardCase::boxes(
        "on_texel_corners",
        "vertices exactly on corners, edges and centres of texels of maps of 64, 128 and 256",
        seen([60.0, 52.0, 85.0], [8.0, 0.0, 6.0], DVec3::NEG_Y),
        // Corners on corners and edges of texels (of 64; of 128 and 256 they are corners, too), on
        // their centres, and on quarters.
        &[
            [[-250.0, -50.0, -250.0], [250.0, 0.0, 250.0]],
            [
                [texels(26.0), 60.0, texels(27.0)],
                [texels(32.0), 70.0, texels(33.0)],
            ],
            [
                [texels(33.5), 60.0, texels(34.5)],
                [texels(37.5), 70.0, texels(36.0)],
            ],
            [
                [texels(32.25), 60.0, texels(29.75)],
                [texels(35.0), 70.0, texels(32.25)],
            ],
        ],
    ),
    HardCase::open(
        "receivers_on_texel_corners",
        "receivers and casters' edges on the lines between texels: rounding picks their sides",
        seen(
            [X, 835.0, Z],
            [X, 0.0, Z],
            DVec3::new(3.0 * TILT.x, 5.0 * TILT.y, 4.0 * TILT.x),
        ),
        receivers_on_texel_corners,
    )
    .changed(|scene| {
        scene.views[0].up = DVec3::new(4.0, 0.0, -3.0);
        scene.views[0].fov_y_degrees = 90.0;
    })
    // Some of the sheets end on lines of receivers.
    .indeterminate_up_to(0.02),
    HardCase::boxes(
        "at_the_maps_border",
        "boxes flush with the scene's border: casters and receivers in the map's last texels",
        seen([2.9, 1.7, 3.2], [1.4, 0.1, 1.5], CORNER_LIGHT),
        &[
            [[-2.0, -0.5, -2.0], [2.0, 0.0, 2.0]],
            [[1.5, 0.0, 1.75], [1.75, 0.75, 2.0]],
            [[1.75, 0.0, 1.0], [2.0, 0.5, 1.25]],
            [[0.5, 0.0, 1.5], [0.75, 1.0, 2.0]],
            [[1.0, 0.875, 1.0], [1.5, 1.0, 2.0]],
        ],
    ),
];

#[cfg(test)]
pub(crate) mod answers {
    use super::*;
    use crate::tests::Answer;
    use crate::tests::answer::{in_sheet, judge};

    /// The other way, a texel being the unit.
    fn in_texels(p: DVec3) -> DVec3 {
        let turned = [3.0 * p.x + 4.0 * p.z, 5.0 * p.y, 3.0 * p.z - 4.0 * p.x];
        DVec3::from(turned) / (25.0 * f64::from(FIFTH))
    }

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[("receivers_on_texel_corners", |p| {
        let p = in_texels(p);
        let depths = tilings().map(|Tiling { lines, y }| {
            let sheet = [0, 4].map(|end| lines.map(|lines| lines[end]));
            in_sheet(p, TILT, sheet, y)
        });
        judge(depths, 3e-4)
    })];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vertices_are_where_texels_meet() {
        let case = CASES[0].scene();
        let fit = case.sun().unwrap().fit(case.mesh.corner_positions());
        assert_eq!((fit.extent.x, fit.extent.y), (250.5, 250.5));
        let [mut corners, mut centres, mut finer] = [0; 3];
        for &position in &case.mesh.positions[8..] {
            let clip = fit.view_projection.project_point3(position.as_dvec3());
            let place = (clip.truncate() + 1.0) * 32.0;
            let quarters = (place * 4.0).round();
            assert!(
                (place * 4.0 - quarters).length() < 1e-9,
                "{position}: {place}"
            );
            for quarter in quarters.to_array() {
                match quarter as i64 % 4 {
                    0 => corners += 1,
                    2 => centres += 1,
                    _ => finer += 1,
                }
            }
        }
        assert!(
            corners >= 16 && centres >= 8 && finer >= 8,
            "{corners}, {centres}, {finer}"
        );
    }

    #[test]
    fn the_receivers_are_where_texels_meet() {
        let case = CASES[1].scene();
        let fit = case.sun().unwrap().fit(case.mesh.corner_positions());
        let camera = case.views[0].camera([128; 2]);
        let pixels = (0..128).flat_map(|y| (0..128).map(move |x| (x, y)));
        let receivers = pixels.map(|(x, y)| {
            let direction = camera.pixel_direction(x, y);
            camera.eye - direction * (camera.eye.y / direction.y)
        });
        let is_corner = |point: &DVec3| {
            let clip = fit.view_projection.project_point3(*point).truncate();
            let place = (clip + 1.0) * 64.0;
            (place - place.round()).length() < 1e-9
        };
        let receivers = receivers.filter(is_corner).count();
        assert!(receivers >= 1700, "{receivers}");
        let corners = case.mesh.positions.iter().map(|p| p.as_dvec3());
        let corners = corners.filter(is_corner).count();
        assert!(corners >= 50 * 9, "{corners}");
    }
}
