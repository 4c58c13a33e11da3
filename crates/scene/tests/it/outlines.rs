//! The light's box around parts is that around all their points, of which few are looked at.

use glam::{DAffine3, DMat3, DVec3, Vec3};
use skiagraph_scene::{
    DirectionalLight, LightFit, Outline,
    outline::{Border, outer},
};

/// Clouds of points in rows, some of which are nothing.
fn clouds(count: usize) -> Vec<Vec<Vec3>> {
    let mut state = 7u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    let mut point = |at: Vec3| at + Vec3::new(next(), next(), next());
    let cloud = |index: usize| {
        let at = Vec3::new(
            (index % 9) as f32,
            0.2 * (index % 5) as f32,
            (index / 9) as f32,
        );
        (0..index % 40).map(|_| point(3.0 * at)).collect()
    };
    (0..count).map(cloud).collect()
}

fn loose(light: &DirectionalLight, points: &[Vec3]) -> Outline {
    let [low, high] = [Vec3::min, Vec3::max].map(|op| points.iter().copied().reduce(op));
    let ends = low.zip(high).map(|(low, high)| [low, high]);
    let corners = ends.into_iter().flat_map(|ends| {
        (0..8).map(move |corner: usize| {
            Vec3::from_array([0, 1, 2].map(|axis| ends[corner >> axis & 1][axis]))
        })
    });
    light.outline(corners)
}

#[test]
fn the_box_of_parts_is_that_of_their_points() {
    for direction in [DVec3::NEG_Y, DVec3::new(0.4, -1.0, -0.3), DVec3::X] {
        let light = DirectionalLight::new(direction);
        for count in [0, 1, 3, 60, 120] {
            let clouds = clouds(count);
            let mut outlines = vec![None; count];
            let mut asked = 0;
            let mut joined = |outlines: &mut [Option<Outline>], clouds: &[Vec<Vec3>]| {
                let rough = clouds.iter().map(|cloud| Some(loose(&light, cloud)));
                let rough: Vec<Option<Outline>> = rough.collect();
                let outline = Outline::joined(outlines, &rough, |part| {
                    asked += 1;
                    light.outline(clouds[part].iter().copied())
                });
                light.fit_outline(&outline)
            };
            let fit =
                |clouds: &[Vec<Vec3>]| -> LightFit { light.fit(clouds.iter().flatten().copied()) };
            assert_eq!(joined(&mut outlines, &clouds), fit(&clouds), "{count}");
            // Those inside are not asked for; nor is one twice, but for those that move.
            let mut moved = clouds.clone();
            for part in [0, 2, 31, 77].into_iter().filter(|part| *part < count) {
                moved[part]
                    .iter_mut()
                    .for_each(|point| *point += Vec3::splat(0.4));
                outlines[part] = None;
            }
            assert_eq!(joined(&mut outlines, &moved), fit(&moved), "{count}");
            assert!(count < 100 || asked < 3 * count / 4, "{asked} of {count}");
        }
    }
}

/// The outer points, and the border, give the outlines of all points, and of most meshes they are
/// few.
#[test]
fn outlines_of_the_border_are_those_of_all_points() {
    let mut clouds: Vec<Vec<Vec3>> = clouds(60);
    let whole: Vec<Vec3> = clouds.iter().flatten().copied().collect();
    let far: Vec<Vec3> = whole.iter().map(|p| *p + Vec3::splat(4e5)).collect();
    let flat: Vec<Vec3> = whole.iter().map(|p| p.with_y(2.0)).collect();
    let thin: Vec<Vec3> = whole.iter().map(|p| p.with_y(1e-5 * p.y)).collect();
    let on_a_grid: Vec<Vec3> = whole.iter().map(|p| (4.0 * *p).round()).collect();
    // So many that the box within them is chosen by some, in an order that those follow.
    let many: Vec<Vec3> = (0..70_000)
        .map(|at| whole[at % whole.len()] * (1.0 + (at / whole.len()) as f32))
        .collect();
    let outside = |points: &[Vec3]| outer(points.len(), |at| points[at]);
    let border = |points: &[Vec3]| Border::new(points.len(), |at| points[at]);
    for points in [&whole, &far, &many] {
        assert!(outside(points).len() < points.len());
        assert!(4 * border(points).points.len() < points.len());
    }
    clouds.extend([whole, far, flat, thin, on_a_grid, many]);
    for points in &clouds {
        let outer = outside(points);
        for op in [Vec3::min, Vec3::max] {
            let end = |points: &[Vec3]| points.iter().copied().reduce(op);
            assert_eq!(end(&outer), end(points));
        }
        let border = border(points).points;
        for turn in 0..200 {
            let angle = 0.37 * f64::from(turn);
            let direction = match turn {
                0 => DVec3::X,
                1 => DVec3::NEG_Y,
                2 => DVec3::Z,
                3 => DVec3::ONE,
                _ => DVec3::new(angle.cos(), -(0.1 + 0.01 * angle), angle.sin()),
            };
            let light = DirectionalLight::new(direction);
            let outline = |points: &[Vec3]| light.outline(points.iter().copied());
            for some in [&outer, &border] {
                let count = [some.len(), points.len()];
                assert_eq!(outline(some), outline(points), "{direction}, {count:?}");
            }
        }
    }
}

/// Wherever a map takes points, and f32 rounds them, the border has their box and outline, or tells
/// that it may not.
#[test]
fn a_border_moved_is_that_of_the_points_moved() {
    let whole: Vec<Vec3> = clouds(60).into_iter().flatten().collect();
    let thin: Vec<Vec3> = whole.iter().map(|p| p.with_y(1e-3 * p.y)).collect();
    let ball = whole
        .iter()
        .map(|p| (*p - Vec3::splat(4.0)).normalize_or_zero());
    let ball: Vec<Vec3> = ball.collect();
    let (mut sure, mut unsure) = (0, 0);
    for points in [&whole, &thin, &ball] {
        let border = Border::new(points.len(), |at| points[at]);
        for turn in 0..300 {
            let size = f64::from(turn % 7).exp2() * 0.1;
            let angle = 0.37 * f64::from(turn);
            let skew = DMat3::from_cols(DVec3::X, DVec3::new(0.3, 1.0, 0.0), DVec3::Z);
            let matrix = DMat3::from_rotation_y(angle) * skew * DMat3::from_rotation_x(angle);
            let far = 10f64.powi(turn % 9 - 2);
            let translation = far * DVec3::new(angle.sin(), angle.cos(), 1.0);
            let map = DAffine3::from_mat3_translation(size * matrix, translation);
            let place = |point: &Vec3| map.transform_point3(point.as_dvec3()).as_vec3();
            let all_moved: Vec<Vec3> = points.iter().map(place).collect();
            let Some(moved) = border.moved(&map) else {
                unsure += 1;
                continue;
            };
            sure += 1;
            for op in [Vec3::min, Vec3::max] {
                let end = |points: &[Vec3]| points.iter().copied().reduce(op);
                assert_eq!(end(&moved), end(&all_moved), "{map}");
            }
            for direction in [DVec3::NEG_Y, DVec3::new(0.4, -1.0, -0.3), -translation] {
                let light = DirectionalLight::new(direction);
                let outline = |points: &[Vec3]| light.outline(points.iter().copied());
                assert_eq!(outline(&moved), outline(&all_moved), "{map}");
            }
        }
    }
    assert!(sure > 300 && unsure > 30, "{sure}, {unsure}");
}
