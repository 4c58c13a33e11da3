//! Defines cases that are hard for lists of casters per texel: many casters in few texels, and
//! casters that cover many texels.

use crate::case::HardCase;
use crate::shape::{Block, LIGHT, Shape, seen};
use glam::DVec3;
use skiagraph_scene::generate::numbers::Random;

const STEEP: DVec3 = DVec3::new(0.07, -1.0, 0.05);

type Corners = [[f32; 3]; 3];

/// Specks over one spot of a floor of 64 units, beside its middle, where four texels meet in every
/// map of even size.
fn crowded_texel() -> Shape {
    let mut random = Random::new(11);
    let specks = (0..100_000).map(|_| {
        let centre = DVec3::new(0.24, 0.2, 0.24) + random.in_ball() * DVec3::new(0.18, 0.12, 0.18);
        [(); 3].map(|()| (centre + random.in_ball() * 2e-3).as_vec3().to_array())
    });
    let specks: Vec<_> = specks.collect();
    Shape::default().graded_slab(0.5, 3, 0.5).triangles(specks)
}

/// Shelves above one another, none right above the next: casters are at all depths between the
/// receivers'.
fn shelves() -> [Block; 12] {
    std::array::from_fn(|i| {
        let (x, z) = ((i * 5 % 12) as f32, (i * 7 % 12) as f32);
        let (x, y, z) = (0.2 + 0.01 * x, 0.004 + 0.009 * i as f32, -0.06 + 0.01 * z);
        [[x, y, z], [x + 0.04, y + 0.002, z + 0.03]]
    })
}

/// Sheets that the camera sees through, because they are wound downward. The first four cut the
/// floor, at slopes of 0.5 to 0.001; two lie a hair above it and two as much below.
fn cutting() -> Vec<Corners> {
    let sheet = |[x0, z0]: [f32; 2], [x1, z1]: [f32; 2], rise: f32, y: f32| {
        let at = |x: f32, z: f32| [x, y + if x == x0 { -rise } else { rise }, z];
        let [a, b, c, d] = [at(x0, z0), at(x1, z0), at(x1, z1), at(x0, z1)];
        [[a, b, c], [a, c, d]]
    };
    [
        sheet([-1.4, -1.3], [-0.2, -0.7], 0.3, 0.0),
        sheet([0.3, -1.2], [1.3, -0.6], 0.03, 0.01),
        sheet([-1.3, -0.5], [-0.3, 0.1], 3e-3, 0.0),
        sheet([0.2, -0.4], [1.4, 0.2], 5e-4, -1e-4),
        sheet([-1.2, 0.4], [-0.7, 1.2], 0.0, 2e-5),
        sheet([-0.5, 0.5], [0.0, 1.3], 0.0, -2e-5),
        sheet([0.2, 0.4], [0.7, 1.2], 0.0, 1e-3),
        sheet([0.9, 0.5], [1.4, 1.1], 0.0, -1e-3),
    ]
    .concat()
}

/// How far from the huge triangle the small ones are.
const GAPS: [f64; 8] = [0.4, -0.4, 0.02, -0.02, 1e-3, -1e-3, 1e-4, -1e-4];

/// The huge triangle, which the camera sees through, then small ones that face up, over and under
/// it.
fn over_the_map() -> Vec<Corners> {
    let huge = [[-5.0, 0.3, -5.0], [5.0, 2.3, -5.0], [-5.0, 3.8, 5.0]];
    let [a, b, c] = huge.map(|corner| glam::Vec3::from(corner).as_dvec3());
    let (along, down) = ((b - a) / 10.0, (c - a) / 10.0);
    let small = (0..200u32).map(|i| {
        let (x, z) = (f64::from(i % 20), f64::from(i / 20));
        let gap = GAPS[(i % 20 + 3 * (i / 20)) as usize % 8];
        let first = a + along * (1.3 + 0.3 * x) + down * (1.2 + 0.3 * z) + DVec3::Y * gap;
        [first, first + down * 0.24, first + along * 0.26].map(|p| p.as_vec3().to_array())
    });
    [huge].into_iter().chain(small).collect()
}

pub(crate) const CASES: &[HardCase] = &[
    HardCase::open(
        "crowded_texel",
        "a hundred thousand specks in one texel, receivers among them",
        seen([0.33, 0.62, 0.55], [0.24, 0.1, 0.24], STEEP),
        crowded_texel,
    ),
    HardCase::closed(
        "shelves_in_two_texels",
        "every pixel in the same two texels, with casters at all depths between the receivers'",
        seen([0.25, 0.23, 0.08], [0.29, 0.03, 0.02], LIGHT),
        || {
            Shape::default()
                .graded_slab(0.5, 4, 0.5)
                .cuboids(&shelves())
        },
    ),
    HardCase::open(
        "sheets_cut_the_floor",
        "casters through the receivers' own depth, and a hair above and below it",
        seen([1.1, 2.9, 1.9], [0.3, 0.0, 0.1], LIGHT),
        || Shape::default().floor(2.0, 0.0).triangles(cutting()),
    ),
    HardCase::open(
        "one_triangle_over_the_map",
        "a slanted triangle over the whole map and all depths, small ones close over and under \
             it",
        seen([-4.0, 7.5, -6.5], [-0.9, 1.6, -1.3], LIGHT),
        || Shape::default().floor(4.0, 0.0).triangles(over_the_map()),
    ),
];

#[cfg(test)]
pub(crate) mod answers {
    use super::*;
    use crate::tests::Answer;
    use crate::tests::answer::{among, in_triangle, judge};

    fn lit_among(p: DVec3, casters: Vec<Corners>) -> Option<bool> {
        let depths = casters.into_iter();
        judge(depths.map(|corners| in_triangle(p, LIGHT, corners)), 1e-3)
    }

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[
        ("shelves_in_two_texels", |p| {
            among(p, LIGHT, &shelves(), 1e-5)
        }),
        ("sheets_cut_the_floor", |p| lit_among(p, cutting())),
        ("one_triangle_over_the_map", |p| {
            lit_among(p, over_the_map())
        }),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_scene::LightFit;
    use std::collections::BTreeSet;

    /// The texels of a map of 128 in which some points are.
    fn texels(fit: &LightFit, points: impl Iterator<Item = DVec3>) -> BTreeSet<[i64; 2]> {
        let clip = points.map(|point| fit.view_projection.project_point3(point));
        clip.map(|clip| [clip.x, clip.y].map(|at| ((at + 1.0) * 64.0).floor() as i64))
            .collect()
    }

    #[test]
    fn the_crowd_is_over_one_texel() {
        let scene = CASES[0].scene();
        let mesh = &scene.mesh;
        let fit = scene.sun().unwrap().fit(mesh.corner_positions());
        let small = |&i: &u32| (mesh.corners(i)[0] - mesh.corners(i)[1]).length() < 0.01;
        let specks: Vec<u32> = (0..mesh.triangles.len() as u32).filter(small).collect();
        assert!(specks.len() >= 99_000, "{}", specks.len());
        let corners = specks.iter().flat_map(|&i| mesh.corners(i));
        assert_eq!(texels(&fit, corners).len(), 1);
    }

    #[test]
    fn every_pixel_is_over_one_of_two_texels() {
        let case = CASES[1].scene();
        let fit = case.sun().unwrap().fit(case.mesh.corner_positions());
        let camera = case.views[0].camera([128; 2]);
        let pixels = (0..128).flat_map(|y| (0..128).map(move |x| (x, y)));
        let floor = pixels.map(|(x, y)| {
            let direction = camera.pixel_direction(x, y);
            camera.eye - direction * (camera.eye.y / direction.y)
        });
        let corners = shelves().concat().into_iter();
        let corners = corners.map(|corner| glam::Vec3::from(corner).as_dvec3());
        let covered = texels(&fit, floor.chain(corners));
        assert_eq!(covered.len(), 2, "{covered:?}");
    }
}
