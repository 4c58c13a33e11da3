//! Where things lie in the map.

use crate::{
    answer::among,
    case::HardCase,
    shape::{Block, Shape},
};
use glam::DVec3;

/// The light is fitted to 500 units and a margin of 1.002, 501 in all: a texel of a map of 64 is
/// 501 / 64, which f32 holds, and so it does every corner of texels of 64, 128 and 256. The
/// vertices *are* there; what a method's f32 makes of it is up to it.
const TEXEL: f32 = 501.0 / 64.0;

/// A coordinate, counted in texels of a map of 64.
const fn texels(count: f32) -> f32 {
    -250.5 + count * TEXEL
}

/// Corners on corners and edges of texels (of 64; of 128 and 256 they are corners, too), on their
/// centres, and on quarters.
const TEXELS: [Block; 4] = [
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
];

const CORNER_LIGHT: DVec3 = DVec3::new(0.5, -1.0, 0.3);
const CORNER: [Block; 5] = [
    [[-2.0, -0.5, -2.0], [2.0, 0.0, 2.0]],
    [[1.5, 0.0, 1.75], [1.75, 0.75, 2.0]],
    [[1.75, 0.0, 1.0], [2.0, 0.5, 1.25]],
    [[0.5, 0.0, 1.5], [0.75, 1.0, 2.0]],
    [[1.0, 0.875, 1.0], [1.5, 1.0, 2.0]],
];

pub(crate) const CASES: &[HardCase] = &[
    HardCase::closed(
        "on_texel_corners",
        "vertices exactly on corners, edges and centres of texels of maps of 64, 128 and 256",
        || {
            Shape::default().cuboids(&TEXELS).scene(
                [60.0, 52.0, 85.0],
                [8.0, 0.0, 6.0],
                DVec3::NEG_Y,
            )
        },
    )
    .with_answer(|p| among(p, DVec3::NEG_Y, &TEXELS, 1e-2)),
    HardCase::closed(
        "at_the_maps_border",
        "boxes flush with the scene's border: casters and receivers in the map's last texels",
        || {
            Shape::default()
                .cuboids(&CORNER)
                .scene([2.9, 1.7, 3.2], [1.4, 0.1, 1.5], CORNER_LIGHT)
        },
    )
    .with_answer(|p| among(p, CORNER_LIGHT, &CORNER, 1e-3)),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vertices_are_where_texels_meet() {
        let case = CASES[0].scene();
        let fit = case.light.fit(case.mesh.corner_positions());
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
}
