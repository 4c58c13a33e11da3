//! The bench and the lamp.

use super::{Builder, Frame, GAP};
use glam::DVec3;

/// A bench of slats on two frames, with a leaning back.
pub(super) fn bench(builder: &mut Builder) {
    builder.group("bench");
    let bench = Frame::upright(DVec3::new(6.0, 0.0, 15.0), 0.31);
    let part = |builder: &mut Builder, centre: [f64; 3], half: [f64; 3]| {
        let frame = Frame {
            origin: bench.at(centre[0], centre[1], centre[2]),
            ..bench
        };
        builder.cuboid(frame, DVec3::from(half));
    };
    const SEAT: f64 = 4.5;
    for x in [-6.5, 6.5] {
        for z in [-1.7, 1.7] {
            part(builder, [x, GAP + 2.0, z], [0.3, 2.0, 0.3]);
        }
        part(builder, [x, 4.0 + 2.0 * GAP + 0.2, 0.0], [0.3, 0.2, 2.2]);
    }
    for slat in 0..5 {
        let z = -2.0 + f64::from(slat);
        part(builder, [0.0, SEAT + 3.0 * GAP, z], [8.0, 0.12, 0.4]);
    }
    // The back leans away from the seat, its posts begin behind the last slat.
    let lean = Frame::along(
        bench.at(0.0, SEAT, -2.75),
        (bench.y - bench.z * 0.25).normalize(),
        bench.x,
    );
    for x in [-6.5, 6.5] {
        let frame = Frame {
            origin: lean.at(x, 2.2, 0.0),
            ..lean
        };
        builder.cuboid(frame, DVec3::new(0.3, 2.2, 0.15));
    }
    for slat in 0..3 {
        let frame = Frame {
            origin: lean.at(0.0, 1.4 + 1.3 * f64::from(slat), 0.15 + GAP + 0.12),
            ..lean
        };
        builder.cuboid(frame, DVec3::new(8.0, 0.5, 0.12));
    }
}

/// A park lamp: a turned foot and pole, a globe and a cap.
pub(super) fn lamp(builder: &mut Builder) {
    builder.group("lamp");
    const SIDES: u32 = 24;
    let foot = Frame::upright(DVec3::new(8.0, 0.0, -5.0), 0.0);
    let turned = |builder: &mut Builder, profile: &[(f64, f64)]| {
        let rings: Vec<_> = profile
            .iter()
            .map(|&(y, radius)| foot.ring(y, radius, radius, SIDES))
            .collect();
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
            let (cos, sin) = super::super::numbers::turn(f64::from(step) / 24.0);
            (16.9 - 1.45 * cos, 1.45 * sin)
        })
        .collect();
    turned(builder, &globe);
    turned(
        builder,
        &[(18.4, 1.7), (18.5, 1.75), (19.2, 0.7), (19.6, 0.2)],
    );
}
