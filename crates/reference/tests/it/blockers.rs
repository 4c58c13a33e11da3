//! Blockers of certain wrong pixels: an open sheet, a closed box, nothing.

use crate::common::scenes::{add, add_rectangle, floor, from_above, light};
use glam::Vec3;
use skiagraph_reference::{
    BlockerCounts, GroundTruthPixels, Oracle, OracleMode, Progress, Statistics, blockers,
    statistics::status,
};
use skiagraph_scene::{Camera, DirectionalLight, Mesh};

const VIEWPORT: [u32; 2] = [200, 200];

/// A box, wound to be seen from outside.
fn add_box(mesh: &mut Mesh, low: [f32; 3], high: [f32; 3]) {
    let ([x0, y0, z0], [x1, y1, z1]) = (low, high);
    let centre = (Vec3::from(low) + Vec3::from(high)) / 2.0;
    for [a, b, c, d] in [
        [[x0, y0, z0], [x1, y0, z0], [x1, y0, z1], [x0, y0, z1]],
        [[x0, y1, z0], [x1, y1, z0], [x1, y1, z1], [x0, y1, z1]],
        [[x0, y0, z0], [x0, y1, z0], [x0, y1, z1], [x0, y0, z1]],
        [[x1, y0, z0], [x1, y1, z0], [x1, y1, z1], [x1, y0, z1]],
        [[x0, y0, z0], [x1, y0, z0], [x1, y1, z0], [x0, y1, z0]],
        [[x0, y0, z1], [x1, y0, z1], [x1, y1, z1], [x0, y1, z1]],
    ] {
        for [p, q, r] in [[a, b, c], [a, c, d]] {
            let [vp, vq, vr] = [p, q, r].map(Vec3::from);
            let outwards = (vq - vp).cross(vr - vp).dot(vp - centre) > 0.0;
            add(mesh, if outwards { [p, q, r] } else { [p, r, q] });
        }
    }
}

struct Judged {
    counts: Statistics,
    blockers: BlockerCounts,
}

/// A method that is certain and shows `visibility` everywhere.
fn judged(mesh: &Mesh, light: &DirectionalLight, mode: OracleMode, visibility: u8) -> Judged {
    let camera: Camera = from_above(10.0, VIEWPORT);
    let oracle = Oracle::new(mesh);
    let primitives = oracle.primary(&camera, Progress::default()).unwrap();
    let truth: GroundTruthPixels = oracle
        .shade(&camera, light, &primitives, mode, Progress::default())
        .unwrap();
    let says = match visibility {
        0 => status::CERTAIN_SHADOW,
        _ => status::CERTAIN_LIGHT,
    };
    let (visibility, says) = (
        vec![visibility; primitives.len()],
        vec![says; primitives.len()],
    );
    let counts = Statistics::judged(&visibility, &says, &truth).unwrap();
    let pixels = Statistics::certain_wrong_pixels(&visibility, &says, &truth).unwrap();
    assert_eq!(pixels.len() as u64, counts.wrong.certain);
    let blockers = blockers(&oracle, &camera, light, &primitives, mode, &pixels).unwrap();
    Judged { counts, blockers }
}

const MODES: [OracleMode; 2] = [OracleMode::Exact, OracleMode::Offset(1e-3)];

#[test]
fn a_sheet_is_open_a_box_is_not_and_lit_pixels_have_no_blocker() {
    let (mut sheet, mut solid) = (floor(), floor());
    add_rectangle(&mut sheet, [-0.9, 0.9], 2.0, [-0.91, 0.9]);
    add_box(&mut solid, [-0.9, 1.5, -0.91], [0.9, 2.0, 0.9]);
    let slanted = light(2.0, -1.0, 0.0);
    for mode in MODES {
        let lit = judged(&sheet, &slanted, mode, 1);
        assert_eq!(lit.counts.wrong.certain, 324, "{mode}");
        let open_part = 324;
        let expected = BlockerCounts {
            open_part,
            ..BlockerCounts::default()
        };
        assert_eq!(lit.blockers, expected, "{mode}");

        let lit = judged(&solid, &slanted, mode, 1);
        let closed_part = lit.counts.wrong.certain;
        assert!(closed_part > 324, "{mode}: {:?}", lit.counts);
        let expected = BlockerCounts {
            closed_part,
            ..BlockerCounts::default()
        };
        assert_eq!(lit.blockers, expected, "{mode}");

        let shadowed = judged(&sheet, &slanted, mode, 0);
        let none = shadowed.counts.wrong.certain;
        assert_eq!(
            none,
            shadowed.counts.wrong.shadow - shadowed.counts.wrong.in_band
        );
        assert!(none > 39_000, "{mode}: {:?}", shadowed.counts);
        let expected = BlockerCounts {
            none,
            ..BlockerCounts::default()
        };
        assert_eq!(shadowed.blockers, expected, "{mode}");
    }
}

/// A closed part behind the sheet casts the shadow, too: the sheet alone explains nothing.
#[test]
fn a_pixel_in_shadow_of_both_counts_as_of_the_closed_part() {
    let down = light(0.0, -1.0, 0.0);
    let mut mesh = floor();
    add_rectangle(&mut mesh, [-3.0, 3.0], 12.0, [-3.0, 3.0]);
    add_box(&mut mesh, [-1.0, 13.0, -1.0], [1.0, 14.0, 1.0]);
    for mode in MODES {
        let lit = judged(&mesh, &down, mode, 1).blockers;
        // Pixels of 0.1: the box's 20 × 20 out of the sheet's 60 × 60, less what is indeterminate.
        assert_eq!(
            (lit.open_part + lit.closed_part, lit.none),
            (3600, 0),
            "{mode}: {lit:?}"
        );
        assert_eq!(lit.closed_part, 400, "{mode}: {lit:?}");
    }
}

/// Shown lit with certainty, but facing away from the light; what stands between is not asked.
#[test]
fn what_faces_away_has_no_blocker() {
    let mut mesh = floor();
    add_rectangle(&mut mesh, [-3.0, 3.0], -1.0, [-3.0, 3.0]);
    let lit = judged(&mesh, &light(0.1, 1.0, 0.0), OracleMode::Exact, 1);
    assert_eq!(lit.counts.wrong.certain, 40_000);
    assert_eq!(lit.blockers.none, 40_000);
}
