//! Lights at a place: spreading shadows, cones, and where a shadow ray ends.

use crate::common::{
    f32_shading,
    scenes::{add, add_rectangle, floor, from_above, light, render},
};
use glam::DVec3;
use proptest::prelude::*;
use skiagraph_reference::{Class, GroundTruthPixels, Oracle, OracleMode, Progress, Statistics};
use skiagraph_scene::{Bvh, Camera, LightKind, Mesh, PointLight, SpotLight};

fn point(position: [f64; 3]) -> LightKind {
    PointLight {
        position: position.into(),
        radius: 0.0,
    }
    .into()
}

fn spot(position: DVec3, direction: DVec3, cone_degrees: f64) -> LightKind {
    SpotLight {
        position,
        direction,
        cone_degrees,
        radius: 0.0,
    }
    .into()
}

/// Where the pixel's ray meets the floor.
fn on_floor(camera: &Camera, pixel: usize) -> DVec3 {
    let width = camera.viewport[0] as usize;
    let direction = camera.pixel_direction((pixel % width) as u32, (pixel / width) as u32);
    camera.eye - direction * (camera.eye.y / direction.y)
}

/// All pixels are of the class that their place on the floor should have, and only those within
/// `near` of its change are indeterminate.
fn expect(truth: &GroundTruthPixels, camera: &Camera, class: impl Fn(DVec3) -> (Class, f64)) {
    for (pixel, answer) in truth.classes.iter().enumerate() {
        let (expected, away) = class(on_floor(camera, pixel));
        assert_eq!(*answer, expected, "pixel {pixel}");
        assert!(away < 1e-3 || !truth.indeterminate[pixel], "pixel {pixel}");
    }
}

#[test]
fn a_shadow_spreads_away_from_a_point_light() {
    let mut mesh = floor();
    add_rectangle(&mut mesh, [-0.5, 0.5], 2.0, [-0.5, 0.5]);
    // Beyond the light, and no caster.
    add_rectangle(&mut mesh, [-9.0, 9.0], 4.5, [-9.0, 9.0]);
    let camera = from_above(1.5, [100, 100]);
    let truth = render(&mesh, &camera, point([0.0, 4.0, 0.0]), OracleMode::Exact);
    expect(&truth, &camera, |at| {
        let inside = 1.0 - at.x.abs().max(at.z.abs());
        let class = if inside > 0.0 {
            Class::Shadow
        } else {
            Class::Lit
        };
        (class, inside.abs())
    });
}

#[test]
fn a_spot_light_ends_at_its_cone() {
    let camera = from_above(1.5, [100, 100]);
    let light = spot(DVec3::Y, DVec3::NEG_Y, 90.0);
    let truth = render(&floor(), &camera, light, OracleMode::Exact);
    expect(&truth, &camera, |at| {
        let inside = 1.0 - at.x.hypot(at.z);
        let class = if inside >= 0.0 {
            Class::Lit
        } else {
            Class::FacingAway
        };
        (class, inside.abs())
    });
}

#[test]
fn a_surface_that_the_light_lies_on_shades_nobody() {
    let camera = from_above(1.0, [50, 50]);
    for (ceiling, class) in [(2.0, Class::Lit), (1.99, Class::Shadow)] {
        // A floor whose corners are not so far off that rounding is more than the light's gap.
        let mut mesh = Mesh::default();
        add(
            &mut mesh,
            [[-10.0, 0.0, -6.0], [0.0, 0.0, 10.0], [10.0, 0.0, -6.0]],
        );
        add_rectangle(&mut mesh, [-3.0, 3.0], ceiling, [-3.0, 3.0]);
        let truth = render(&mesh, &camera, point([0.1, 2.0, 0.2]), OracleMode::Exact);
        expect(&truth, &camera, |_| (class, 1.0));
    }
}

#[test]
fn a_spot_light_far_away_is_directional() {
    let mut mesh = floor();
    for step in 0u8..8 {
        let at = f32::from(step) * 0.25 - 1.0;
        add_rectangle(&mut mesh, [at, at + 0.1], 2.0 + at, [at - 0.3, 0.4 - at]);
    }
    let camera = from_above(1.0, [120, 120]);
    let direction = DVec3::new(0.3, -1.0, 0.2);
    let sun = render(&mesh, &camera, light(0.3, -1.0, 0.2), OracleMode::Exact);
    let differing = |distance: f64| {
        let light = spot(-direction * distance, direction, 2.0);
        let lamp = render(&mesh, &camera, light, OracleMode::Exact);
        let other = |i: &usize| lamp.classes[*i] != sun.classes[*i];
        let differ: Vec<usize> = (0..lamp.classes.len()).filter(other).collect();
        let outside = |i: &&usize| !(lamp.indeterminate[**i] || sun.indeterminate[**i]);
        [differ.len(), differ.iter().filter(outside).count()]
    };
    let counts = [1e2, 1e3, 1e4, 1e6, 1e8].map(differing);
    let totals = counts.map(|[total, _]| total);
    assert!(
        totals[0] > 100 && totals.is_sorted_by(|a, b| a >= b),
        "{counts:?}"
    );
    // Pixels that still differ hang on rounding.
    assert!(
        counts[2..].iter().all(|[_, outside]| *outside == 0),
        "{counts:?}"
    );
}

/// Casters above a floor, some through the light's place.
fn scene(rectangles: &[[f32; 5]]) -> Mesh {
    let mut mesh = floor();
    for &[x, z, width, depth, y] in rectangles {
        add_rectangle(&mut mesh, [x, x + width], y, [z, z + depth]);
    }
    mesh
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn f32_errs_within_the_band_alone(
        rectangles in prop::collection::vec(
            (-1.0f32..1.0, -1.0f32..1.0, 0.1f32..0.9, 0.1f32..0.9, 0.1f32..2.5)
                .prop_map(|(x, z, width, depth, y)| [x, z, width, depth, y]),
            1..12,
        ),
        at in prop::array::uniform3(-2.0f64..2.0),
        height in prop_oneof![Just(0), Just(1), Just(2)],
        is_spot: bool,
    ) {
        let mesh = scene(&rectangles);
        let y = match height {
            0 => at[1].abs() + 0.01,
            // On a caster, and just above the floor.
            1 => f64::from(rectangles[0][4]),
            _ => 1e-3,
        };
        let position = DVec3::new(at[0], y, at[2]);
        let light = if is_spot {
            spot(position, DVec3::new(-at[0], -1.0, 0.3), 80.0)
        } else {
            point(position.into())
        };
        let camera = from_above(1.7, [48, 48]);
        let oracle = Oracle::new(&mesh);
        let primitives = oracle.primary(&camera, Progress::default()).expect("it is not stopped");
        let mode = OracleMode::Exact;
        let truth = oracle.shade(&camera, light, &primitives, mode, Progress::default());
        let truth = truth.expect("its own primitives");
        let bvh = Bvh::build(&mesh);
        let (visibility, status) =
            f32_shading::shade(&mesh, &bvh, &camera, light, &primitives, mode);
        for pixel in 0..primitives.len() {
            if truth.indeterminate[pixel] {
                continue;
            }
            let answer = match (status[pixel], visibility[pixel]) {
                (0, _) => Class::Background,
                (1, _) => Class::FacingAway,
                (_, 0) => Class::Shadow,
                _ => Class::Lit,
            };
            prop_assert_eq!(answer, truth.classes[pixel], "pixel {}", pixel);
        }
        let counts = Statistics::judged(&visibility, &status, &truth).expect("valid values");
        // Among the few pixels that a cone near the floor lights, two may lie at its edge.
        let most = 0.2 * counts.pixels.facing_light as f64 + 2.0;
        // A light on a caster: whether that shades the floor hangs on the floor's own rounding.
        prop_assert!(height == 1 || counts.band as f64 <= most, "{counts:?}");
    }
}
