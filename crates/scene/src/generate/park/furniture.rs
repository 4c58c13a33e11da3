//! The bench and the lamp.

use crate::generate::numbers::turn;
use crate::generate::solid::{Builder, Frame, GAP};
use glam::DVec3;

/// How bench and planter are turned, as a fraction of a full turn: their long sides lie across the
/// light, but 10° off, so that no side face lies along it. There n · l and the shadows of
/// neighbours would hang on the last bits.
pub(super) const ACROSS_THE_LIGHT: f64 = 0.18;

/// A bench of slats on two frames, with a leaning back.
pub(super) fn bench(builder: &mut Builder) {
    builder.group("bench");
    let bench = Frame::upright(DVec3::new(4.0, 0.0, 15.0), ACROSS_THE_LIGHT);
    let part = |builder: &mut Builder, centre: [f64; 3], half: [f64; 3]| {
        let frame = bench.moved_to(bench.at(centre[0], centre[1], centre[2]));
        builder.cuboid(frame, DVec3::from(half));
    };
    const SEAT: f64 = 5.5;
    /// Where the posts stand on either side of the middle.
    const POST: f64 = 5.5;
    for x in [-POST, POST] {
        for z in [-2.2, 2.2] {
            part(builder, [x, GAP + 2.45, z], [0.4, 2.45, 0.4]);
        }
        part(builder, [x, 4.9 + 2.0 * GAP + 0.25, 0.0], [0.4, 0.25, 2.7]);
    }
    for slat in 0..5 {
        let z = -2.4 + 1.2 * f64::from(slat);
        part(builder, [0.0, SEAT + 3.0 * GAP, z], [POST + 2.0, 0.08, 0.5]);
    }
    // The back leans away from the seat, its posts begin behind the last slat.
    let lean = Frame::along(
        bench.at(0.0, SEAT, -3.2),
        (bench.y - bench.z * 0.25).normalize(),
        bench.x,
    );
    for x in [-POST, POST] {
        let frame = lean.moved_to(lean.at(x, 2.75, 0.0));
        builder.cuboid(frame, DVec3::new(0.4, 2.75, 0.15));
    }
    for slat in 0..3 {
        let y = 1.7 + 1.6 * f64::from(slat);
        let frame = lean.moved_to(lean.at(0.0, y, 0.15 + GAP + 0.15));
        builder.cuboid(frame, DVec3::new(POST + 2.0, 0.6, 0.15));
    }
}

/// A park lamp: a turned foot and pole, a globe and a cap.
pub(super) fn lamp(builder: &mut Builder) {
    builder.group("lamp");
    const SIDES: u32 = 24;
    let foot = Frame::upright(DVec3::new(11.0, 0.0, -7.5), 0.0);
    let turned = |builder: &mut Builder, profile: &[(f64, f64)]| {
        let ring = |&(y, radius): &(f64, f64)| foot.ring(y, radius, radius, SIDES);
        let rings: Vec<_> = profile.iter().map(ring).collect();
        let (first, last) = (profile[0].0, profile[profile.len() - 1].0);
        builder.loft(foot.at(0.0, first, 0.0), &rings, foot.at(0.0, last, 0.0));
    };
    turned(
        builder,
        &[
            (GAP, 1.2),
            (0.6, 1.2),
            (0.9, 0.9),
            (1.6, 0.8),
            (2.0, 0.45),
            (3.0, 0.4),
            (3.2, 0.55),
            (3.4, 0.4),
            (15.0, 0.3),
        ],
    );
    turned(builder, &[(15.0 + GAP, 0.8), (15.2, 0.9), (15.4, 0.8)]);
    let globe: Vec<(f64, f64)> = (1..12)
        .map(|step| {
            let (cos, sin) = turn(f64::from(step) / 24.0);
            (16.9 - 1.45 * cos, 1.45 * sin)
        })
        .collect();
    turned(builder, &globe);
    turned(
        builder,
        &[(18.4, 1.7), (18.5, 1.75), (19.2, 0.7), (19.6, 0.2)],
    );
}
