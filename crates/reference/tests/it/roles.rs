//! Parts that cast no shadow or receive none: rays pass the first, the others are not judged.

use crate::common::scenes::{add_rectangle, floor, from_above};
use glam::DVec3;
use skiagraph_reference::{
    Class, Oracle, OracleMode, Progress, Statistics, ground_truth, nearest_blockers,
};
use skiagraph_scene::{DirectionalLight, Shadows};

/// Answers for a square roof over the floor, 2 by 2 at height 1, and for the floor, of these roles;
/// the light comes from the right.
fn classes(roof: Shadows, ground: Shadows, angle_degrees: f64) -> (Vec<Class>, Vec<f32>, usize) {
    let mut mesh = floor();
    add_rectangle(&mut mesh, [0.0, 2.0], 1.0, [-1.0, 1.0]);
    mesh.surfaces.set_shadows([1, 2], 3, roof);
    mesh.surfaces.set_shadows([0], 3, ground);
    let light = DirectionalLight {
        direction: DVec3::new(-2.0, -1.0, 0.0),
        angle_degrees,
    };
    let (oracle, progress) = (Oracle::new(&mesh), Progress::default());
    let camera = from_above(4.0, [80, 80]);
    let primitives = oracle.primary(&camera, progress).unwrap();
    assert!(
        primitives.contains(&1),
        "whatever its role, the roof is seen"
    );
    let exact = OracleMode::Exact;
    let truth = ground_truth(&oracle, &camera, light, &primitives, (exact, 64), progress).unwrap();
    let nearest = nearest_blockers(&oracle, &camera, light, &primitives, exact, progress);
    let blocked = nearest
        .unwrap()
        .into_iter()
        .filter(|id| [1, 2].contains(id));
    let pixels = &truth.pixels;
    let counts = Statistics::judged(&pixels.visibility(), &pixels.status(), pixels).unwrap();
    let unshadowed = pixels.classes.iter().filter(|it| **it == Class::Unshadowed);
    assert_eq!(counts.pixels.facing_away, unshadowed.count() as u64);
    assert_eq!((counts.wrong.total, counts.facing_mismatch), (0, 0));
    let shares = truth.shares().into_owned();
    (truth.pixels.classes, shares, blocked.count())
}

#[test]
fn shadow_rays_pass_what_casts_nothing() {
    let count = |classes: &[Class], class| classes.iter().filter(|it| **it == class).count();
    for angle in [0.0, 4.0] {
        let (with, _, blocked) = classes(Shadows::Both, Shadows::Both, angle);
        assert!(count(&with, Class::Shadow) > 300 && blocked > 300);
        let (alone, _, blocked) = classes(Shadows::Casts, Shadows::Both, angle);
        assert_eq!(count(&alone, Class::Shadow), count(&with, Class::Shadow));
        assert!(count(&alone, Class::Unshadowed) > 300 && blocked > 300);
        let (without, shares, blocked) = classes(Shadows::Receives, Shadows::Both, angle);
        assert_eq!((count(&without, Class::Shadow), blocked), (0, 0));
        assert!(shares.iter().all(|share| *share == 1.0));
    }
}

#[test]
fn what_receives_nothing_is_lit_and_not_judged() {
    for angle in [0.0, 4.0] {
        let (classes, shares, blocked) = classes(Shadows::Both, Shadows::Casts, angle);
        let ground = classes.iter().filter(|it| **it == Class::Unshadowed);
        assert!(ground.count() > 3000 && !classes.contains(&Class::Shadow));
        assert_eq!(blocked, 0);
        assert!(shares.iter().all(|share| *share == 1.0));
    }
}
