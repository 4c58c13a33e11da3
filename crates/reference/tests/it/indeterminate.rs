//! Pixels that are indeterminate, and pixels that are not.

use crate::common::{
    f32_shading,
    scenes::{add, add_rectangle, counts, floor, from_above, light, render},
};
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use skiagraph_reference::{Class, Oracle, OracleMode, Progress, Statistics};
use skiagraph_scene::{Bvh, Mesh, View};

/// The indeterminate pixels that face the light, by index.
fn indeterminate(truth: &skiagraph_reference::GroundTruthPixels) -> Vec<usize> {
    (0..truth.classes.len())
        .filter(|&i| truth.indeterminate[i] && truth.classes[i].faces_light())
        .collect()
}

#[test]
fn a_ray_through_a_casters_edge_is_indeterminate_and_one_a_hair_away_is_not() {
    // 101 columns: those of column 50 meet the floor at x = 0. The light comes straight down. The
    // floor's corners are 140 units away, so that f32 knows its points to about 1e-4.
    let camera = from_above(1.0, [101, 101]);
    for (edge, class, is_indeterminate) in [
        (0.0, Class::Shadow, true),
        (1e-7, Class::Lit, true),
        (-1e-7, Class::Shadow, true),
        (1e-3, Class::Lit, false),
        (-1e-3, Class::Shadow, false),
    ] {
        let mut mesh = floor();
        add_rectangle(&mut mesh, [edge, 3.0], 2.0, [-3.0, 3.0]);
        let truth = render(&mesh, &camera, light(0.0, -1.0, 0.0), OracleMode::Exact);
        let expected: Vec<usize> = if is_indeterminate {
            (0..101).map(|row| row * 101 + 50).collect()
        } else {
            vec![]
        };
        assert_eq!(indeterminate(&truth), expected, "edge at {edge}");
        assert!(
            (0..101).all(|row| truth.classes[row * 101 + 50] == class),
            "edge at {edge}"
        );
    }
}

#[test]
fn an_edge_between_two_casters_is_determinate_unless_it_is_a_crack() {
    // Two squares that meet over column 50: joined by the same vertices, or abutting along a
    // subdivided edge.
    let camera = from_above(1.0, [101, 101]);
    let joined = {
        let mut mesh = floor();
        add_rectangle(&mut mesh, [-3.0, 0.0], 2.0, [-3.0, 3.0]);
        add_rectangle(&mut mesh, [0.0, 3.0], 2.0, [-3.0, 3.0]);
        mesh
    };
    let abutting = {
        let mut mesh = floor();
        add_rectangle(&mut mesh, [-3.0, 0.0], 2.0, [-3.0, 3.0]);
        add_rectangle(&mut mesh, [0.0, 3.0], 2.0, [-4.0, 4.0]);
        mesh
    };
    let down = light(0.0, -1.0, 0.0);
    let truth = render(&joined, &camera, down, OracleMode::Exact);
    assert_eq!(counts(&truth).pixels.shadow, 101 * 101);
    assert_eq!(indeterminate(&truth), [0usize; 0]);
    let truth = render(&abutting, &camera, down, OracleMode::Exact);
    assert_eq!(counts(&truth).pixels.shadow, 101 * 101);
    assert_eq!(
        indeterminate(&truth),
        (0..101).map(|row| row * 101 + 50).collect::<Vec<_>>()
    );
}

#[test]
fn coplanar_duplicates_are_indeterminate_without_an_offset_only() {
    let mut mesh = floor();
    add(
        &mut mesh,
        [[-100.0, 0.0, -60.0], [0.0, 0.0, 100.0], [100.0, 0.0, -60.0]],
    );
    let camera = from_above(1.0, [8, 8]);
    let down = light(0.1, -1.0, 0.0);
    assert_eq!(
        indeterminate(&render(&mesh, &camera, down, OracleMode::Exact)).len(),
        64
    );
    let offset = render(&mesh, &camera, down, OracleMode::Offset(0.01));
    assert_eq!(indeterminate(&offset), [0usize; 0]);
    assert_eq!(counts(&offset).pixels.lit, 64);
}

#[test]
fn more_is_indeterminate_farther_from_the_origin() {
    // The same scene, 10⁶ units away: f32 corners there are 0.06 apart, and pixels that near a
    // contour are undecided.
    let width = |shift: f32| {
        let mut mesh = floor();
        add_rectangle(&mut mesh, [-0.5, 0.5], 2.0, [-0.5, 0.5]);
        for position in &mut mesh.positions {
            *position += Vec3::new(shift, 0.0, 0.0);
        }
        let mut camera = from_above(1.0, [100, 100]);
        camera.eye.x += f64::from(shift);
        let truth = render(&mesh, &camera, light(0.0, -1.0, 0.0), OracleMode::Exact);
        assert_eq!(counts(&truth).pixels.facing_light, 10_000);
        indeterminate(&truth).len()
    };
    assert_eq!(width(0.0), 0);
    let far = width(1_048_576.0);
    assert!(far > 200, "{far} indeterminate pixels at 10⁶");
}

/// A tangle of triangles in ±1 over a floor, or of strips with T-junctions, moved and scaled.
fn tangle(corners: &[[[f32; 3]; 3]], scale: f32, shift: f32) -> Mesh {
    let place = |corner: [f32; 3]| ((Vec3::from(corner) + shift) * scale).to_array();
    let mut mesh = Mesh::default();
    add(
        &mut mesh,
        [[-4.0, -1.1, -4.0], [-4.0, -1.1, 4.0], [4.0, -1.1, 4.0]].map(place),
    );
    add(
        &mut mesh,
        [[-4.0, -1.1, -4.0], [4.0, -1.1, 4.0], [4.0, -1.1, -4.0]].map(place),
    );
    for &[a, b, c] in corners {
        let (pa, pb) = (Vec3::from(a), Vec3::from(b));
        let middle = pa.midpoint(pb).to_array();
        let opposite = (pa + pb - Vec3::from(c)).to_array();
        add(&mut mesh, [a, b, c].map(place));
        add(&mut mesh, [b, middle, opposite].map(place));
        add(&mut mesh, [middle, a, opposite].map(place));
    }
    mesh
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 96,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Whatever the scene, its scale and its place, a correct f32 method errs in indeterminate
    /// pixels only. (That these are few, where light does not graze coplanar triangles, is for the
    /// standard views to show.)
    #[test]
    fn an_f32_ray_tracer_errs_in_indeterminate_pixels_only(
        corners in prop::collection::vec(
            prop::array::uniform3(prop::array::uniform3(-1.0f32..1.0)),
            1..24,
        ),
        scale in prop::sample::select(vec![1e-4f32, 1.0, 1e4]),
        shift in prop::sample::select(vec![0.0f32, 10.0, 1e3]),
        eye in prop::array::uniform3(-2.0f64..2.0),
        direction in (-1.0f64..1.0, -1.0f64..-0.05, -1.0f64..1.0),
    ) {
        let mesh = tangle(&corners, scale, shift);
        let place = |point: DVec3| (point + f64::from(shift)) * f64::from(scale);
        let eye = DVec3::from(eye) + DVec3::new(0.0, 2.0, 0.0);
        let view = View {
            name: String::new(),
            eye: place(eye),
            direction: DVec3::new(0.01, -0.5, 0.02) - eye,
            near: 1e-3 * f64::from(scale),
            far: 1e3 * f64::from(scale),
            ..View::default()
        };
        let camera = view.camera([40, 30]);
        let light = light(direction.0, direction.1, direction.2);
        let bvh = Bvh::build(&mesh);
        let oracle = Oracle::new(&mesh);
        let primitives = oracle
            .primary(&camera, Progress::default())
            .expect("it is not stopped");
        for mode in [
            OracleMode::Exact,
            OracleMode::Offset(1e-3 * f64::from(scale)),
        ] {
            let truth = oracle
                .shade(&camera, light, &primitives, mode, Progress::default())
                .expect("valid ids");
            let (visibility, status) =
                f32_shading::shade(&mesh, &bvh, &camera, light, &primitives, mode);
            let counts =
                Statistics::judged(&visibility, &status, &truth).expect("valid values");
            prop_assert_eq!(counts.wrong.total, counts.wrong.in_band, "{:?}", counts);
        }
    }
}
