//! Penumbrae that can be worked out by hand.

use crate::common;
use crate::common::scenes::{add_rectangle, floor, from_above};
use glam::DVec3;
use skiagraph_reference::{
    AreaVisibility, Class, GroundTruthPixels, Oracle, OracleMode, Progress, ground_truth,
};
use skiagraph_scene::{DirectionalLight, Mesh};

const FROM_ABOVE: DVec3 = DVec3::NEG_Y;

fn area(
    mesh: &Mesh,
    (direction, angle_degrees): (DVec3, f64),
    samples: u32,
    mode: OracleMode,
) -> (GroundTruthPixels, AreaVisibility) {
    let light = DirectionalLight {
        direction,
        angle_degrees,
    };
    let camera = from_above(4.0, [80, 80]);
    let oracle = Oracle::new(mesh);
    let primitives = oracle.primary(&camera, Progress::default()).unwrap();
    let progress = Progress::default();
    let answer = ground_truth(
        &oracle,
        &camera,
        light,
        &primitives,
        (mode, samples),
        progress,
    );
    let answer = answer.unwrap();
    (answer.pixels, answer.area.unwrap())
}

/// A half plane over the floor, at height 1, whose edge runs along z at x = 0.
fn half_plane() -> Mesh {
    let mut mesh = floor();
    add_rectangle(&mut mesh, [0.0, 50.0], 1.0, [-30.0, 30.0]);
    mesh
}

/// The share of a unit disk that lies left of x.
fn left_of(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / std::f64::consts::PI
}

#[test]
fn a_straight_edge_throws_the_penumbra_of_a_disk() {
    // Seen from the floor at x < 0, the edge lies at −x to the right of the light's centre at
    // distance 1; the light's rim at tan 20°.
    let radius = 20f64.to_radians().tan();
    for mode in [OracleMode::Exact, OracleMode::Offset(1e-9)] {
        let (truth, area) = area(&half_plane(), (FROM_ABOVE, 40.0), 400, mode);
        assert_eq!(area.samples, 400);
        let (mut worst, mut penumbra, mut squares, mut pixels) = (0.0f64, 0, 0.0, 0);
        for (index, &share) in area.shares.iter().enumerate() {
            // Pixels are 0.1 wide; right of x = 0 the camera sees the plane itself.
            let x = ((index % 80) as f64 + 0.5) * 0.1 - 4.0;
            if x > 0.0 {
                assert_eq!(share, 1.0);
                continue;
            }
            let expected = left_of(-x / radius);
            let error = f64::from(share) - expected;
            worst = worst.max(error.abs());
            (squares, pixels) = (squares + error * error, pixels + 1);
            penumbra += u32::from(share > 0.0 && share < 1.0);
            assert_eq!(truth.classes[index], Class::Lit);
        }
        // Four columns of 80 pixels, a share of 1 elsewhere.
        assert!((240..=320).contains(&penumbra), "{penumbra}");
        assert!(worst < 0.03, "{worst}");
        // The standard error that it states is the one that it has, on the half of PFL where there
        // is one.
        let [stated, greatest] = area.standard_error(&truth);
        let real = (squares / f64::from(pixels) * 0.5).sqrt();
        assert!((0.7..1.4).contains(&(stated / real)), "{stated} {real}");
        assert!(greatest < 0.05, "{greatest}");
    }
}

#[test]
fn more_samples_converge_and_the_same_ones_repeat() {
    let error = |samples| {
        let (truth, area) = area(
            &half_plane(),
            (FROM_ABOVE, 40.0),
            samples,
            OracleMode::Exact,
        );
        area.standard_error(&truth)[0]
    };
    let errors = [16, 64, 256, 1024].map(error);
    // Strata beat the square root: a quarter of the error of four times as many would be 1/N, half
    // of it random samples'.
    for pair in errors.windows(2) {
        assert!(pair[1] < 0.45 * pair[0], "{errors:?}");
    }
    assert_eq!(errors[0], error(16));
}

#[test]
fn a_light_of_hardly_any_width_is_the_hard_one() {
    let mut mesh = half_plane();
    add_rectangle(&mut mesh, [-2.0, -1.0], 0.5, [-1.03, 1.03]);
    let direction = DVec3::new(0.31, -1.0, 0.23);
    let (soft, area) = area(&mesh, (direction, 1e-7), 4, OracleMode::Exact);
    let light = DirectionalLight::new(direction);
    let hard = common::scenes::render(&mesh, &from_above(4.0, [80, 80]), light, OracleMode::Exact);
    assert_eq!(soft.classes, hard.classes);
    assert_eq!(area.shares, hard.shares());
    assert!(hard.classes.contains(&Class::Shadow));
    assert_eq!(area.standard_error(&soft), [0.0; 2]);
}

#[test]
fn many_casters_are_searched_by_the_hierarchy_with_the_same_answer() {
    // The half plane cut into 200 strips, which a wide light's cone meets by the dozen.
    let mut strips = floor();
    for strip in 0..200 {
        let at = |index: i32| 0.02 * index as f32;
        let end = if strip == 199 { 50.0 } else { at(strip + 1) };
        add_rectangle(&mut strips, [at(strip), end], 1.0, [-30.0, 30.0]);
    }
    let visibility = |mesh: &Mesh| area(mesh, (FROM_ABOVE, 85.0), 64, OracleMode::Exact).1;
    let (strips, whole) = (visibility(&strips), visibility(&half_plane()));
    let left = |area: &AreaVisibility| -> Vec<f32> {
        area.shares
            .chunks(80)
            .flat_map(|row| row[..40].to_vec())
            .collect()
    };
    assert_eq!(left(&strips), left(&whole));
    assert!(left(&whole).iter().any(|share| *share < 0.9));
}

/// A bulb so large that the floor is within its ball.
#[test]
fn a_receiver_within_the_lights_ball_asks_the_hierarchy() {
    let mesh = half_plane();
    let bulb = skiagraph_scene::PointLight {
        position: DVec3::new(0.0, 2.0, 0.0),
        radius: 3.0,
    };
    let camera = from_above(4.0, [40, 40]);
    let oracle = Oracle::new(&mesh);
    let primitives = oracle.primary(&camera, Progress::default()).unwrap();
    let how = (OracleMode::Exact, 64);
    let light = skiagraph_scene::LightKind::Point(bulb);
    let answer = ground_truth(
        &oracle,
        &camera,
        light,
        &primitives,
        how,
        Progress::default(),
    );
    let answer = answer.unwrap();
    let (truth, area) = (answer.pixels, answer.area.unwrap());
    // From (-0.7, 0) the disk across (0.7, 2) is hidden from a fifth of its radius on.
    let near = 20 * 40 + 16;
    assert_eq!(truth.classes[near], Class::Lit);
    assert!(
        (left_of(0.2) - f64::from(area.shares[near])).abs() < 0.05,
        "{}",
        area.shares[near]
    );
}

#[test]
fn what_faces_away_from_the_lights_centre_sees_none_of_it() {
    let (truth, area) = area(&half_plane(), (DVec3::Y, 85.0), 16, OracleMode::Exact);
    assert!(
        truth
            .classes
            .iter()
            .all(|class| *class == Class::FacingAway)
    );
    assert!(area.shares.iter().all(|share| *share == 0.0));
    assert_eq!(area.standard_error(&truth), [0.0; 2]);
}
