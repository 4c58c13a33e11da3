//! Shimmer: a shadow that is stuck to the screen changes where the right one does not.

use crate::common::scenes::{add_rectangle, floor, from_above, light};
use glam::DVec3;
use skiagraph_reference::{
    BACKGROUND, GroundTruth, Oracle, OracleMode, Progress, Shimmer,
    shimmer::{Seen, same_receivers, shimmer},
};
use skiagraph_scene::{Camera, Mesh};

const VIEWPORT: [u32; 2] = [100, 100];

struct Frame {
    camera: Camera,
    primitives: Vec<u32>,
    ground_truth: GroundTruth,
}

/// A sheet over the floor, seen from above by an eye moved by `pixels` to the right.
fn frame(mesh: &Mesh, pixels: f64) -> Frame {
    let mut camera = from_above(10.0, VIEWPORT);
    // The floor's 20 units fill 100 pixels.
    camera.eye += DVec3::X * (0.2 * pixels);
    let oracle = Oracle::new(mesh);
    let primitives = oracle.primary(&camera, Progress::default()).unwrap();
    let sun = light(0.8, -1.0, 0.0);
    let shaded = oracle.shade(
        &camera,
        sun,
        &primitives,
        OracleMode::Exact,
        Progress::default(),
    );
    Frame {
        camera,
        primitives,
        ground_truth: GroundTruth {
            pixels: shaded.unwrap(),
            area: None,
        },
    }
}

fn compared(mesh: &Mesh, [before, now]: [&Frame; 2], answers: [&[f32]; 2]) -> Shimmer {
    let seen = |frame: &'_ Frame| (frame.camera, frame.primitives.clone());
    let [(camera_before, ids_before), (camera, ids)] = [seen(before), seen(now)];
    let before_seen = Seen {
        mesh,
        camera: &camera_before,
        primitives: &ids_before,
    };
    let now_seen = Seen {
        mesh,
        camera: &camera,
        primitives: &ids,
    };
    let same = same_receivers(before_seen, now_seen, Progress::default()).unwrap();
    shimmer(&same, answers, [&before.ground_truth, &now.ground_truth]).unwrap()
}

#[test]
fn an_exact_method_does_not_shimmer_and_a_picture_that_sticks_to_the_screen_does() {
    let mut mesh = floor();
    add_rectangle(&mut mesh, [-1.01, 1.03], 5.0, [-1.02, 1.04]);
    let (before, now) = (frame(&mesh, 0.0), frame(&mesh, 3.0));
    let right = [before.ground_truth.shares(), now.ground_truth.shares()];
    let exact = compared(&mesh, [&before, &now], [&right[0], &right[1]]);
    assert_eq!(exact.changed, 0);
    // All of the floor that both see but the shadow's and the sheet's borders.
    assert!(exact.compared > 9_000, "{exact:?}");

    let stuck = compared(&mesh, [&before, &now], [&right[0], &right[0]]);
    assert_eq!(stuck.compared, exact.compared);
    assert!(stuck.changed > 20 && stuck.changed < 200, "{stuck:?}");
}

#[test]
fn receivers_that_were_not_seen_before_are_not_compared() {
    let mesh = floor();
    let (before, now) = (frame(&mesh, 0.0), frame(&mesh, 10.0));
    let seen = [&before, &now].map(|frame| Seen {
        mesh: &mesh,
        camera: &frame.camera,
        primitives: &frame.primitives,
    });
    let same = same_receivers(seen[0], seen[1], Progress::default()).unwrap();
    for (pixel, &earlier) in same.iter().enumerate() {
        let expected = match pixel % 100 {
            x if x < 90 => pixel as u32 + 10,
            _ => BACKGROUND,
        };
        assert_eq!(earlier, expected, "pixel {pixel}");
    }
    assert!(
        same_receivers(
            seen[0],
            Seen {
                primitives: &[],
                ..seen[1]
            },
            Progress::default()
        )
        .is_err()
    );
    let unknown = vec![7; 10_000];
    let unknown = Seen {
        primitives: &unknown,
        ..seen[1]
    };
    assert!(same_receivers(seen[0], unknown, Progress::default()).is_err());
}
