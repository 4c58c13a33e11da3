//! The flower box: a planter and some fifty flowers of very small triangles.

use super::furniture::ACROSS_THE_LIGHT;
use crate::generate::numbers::{Random, turn};
use crate::generate::solid::{Builder, Frame, GAP};
use glam::DVec3;

/// Half length and half width of the planter's inside.
const INSIDE: (f64, f64) = (11.4, 3.5);
/// Height of the soil.
const SOIL: f64 = 2.2;
/// Distance between neighbouring stems. A flower keeps inside a cylinder of half this radius around
/// its stem's foot.
const PITCH: f64 = 1.7;

pub(super) fn flower_box(builder: &mut Builder) {
    // Its long side lies across the light, so that the shadows of all rows fall on the lawn behind.
    let planter = Frame::upright(DVec3::new(-17.0, 0.0, 4.0), ACROSS_THE_LIGHT);
    builder.group("planter");
    let wall = 0.4;
    let rings = [
        planter.rectangle(GAP, INSIDE.0, INSIDE.1),
        planter.rectangle(2.6, INSIDE.0 + wall, INSIDE.1 + wall),
        planter.rectangle(2.6, INSIDE.0, INSIDE.1),
        planter.rectangle(SOIL, INSIDE.0 - 0.1, INSIDE.1 - 0.1),
    ];
    let [low, high] = [GAP, SOIL].map(|y| planter.at(0.0, y, 0.0));
    builder.loft(low, &rings, high);
    builder.group("flowers");
    let mut random = Random::new(2014);
    for row in 0..4 {
        let shift = if row % 2 == 0 { 0.0 } else { PITCH * 0.5 };
        for column in 0..13 {
            let x = (f64::from(column) - 6.25) * PITCH + shift;
            let z = (f64::from(row) - 1.5) * PITCH;
            let foot = Frame::upright(planter.at(x, SOIL + GAP, z), random.range(0.0, 1.0));
            flower(builder, foot, &mut random);
        }
    }
}

fn flower(builder: &mut Builder, foot: Frame, random: &mut Random) {
    let height = random.range(4.8, 8.4);
    let radius = 0.06;
    let bend = random.range(0.0, 0.08);
    let axis = |y: f64| {
        let t = y / height;
        foot.at(bend * t * t, y, 0.0)
    };
    let stem: Vec<(DVec3, f64)> = (0..=6)
        .map(|i| (axis(height * f64::from(i) / 6.0), radius))
        .collect();
    builder.tube(&stem, 6);
    leaves(builder, foot, height, radius + bend + GAP, random);
    head(builder, foot, height + GAP, random);
}

/// Leaves in a spiral, none above another nearer than the rise from one to the next.
fn leaves(builder: &mut Builder, foot: Frame, height: f64, inner: f64, random: &mut Random) {
    let count = 10;
    for index in 0..count {
        let y = 0.4 + (height - 1.6) * f64::from(index) / f64::from(count);
        let (cos, sin) = turn(0.382 * f64::from(index));
        let out = foot.x * cos + foot.z * sin;
        let rise = random.range(0.1, 0.5);
        let along = (out + foot.y * rise).normalize();
        let origin = foot.at(0.0, y, 0.0) + out * inner;
        let frame = Frame::along(origin, along.cross(foot.y.cross(out)).normalize(), along);
        builder.leaf(frame, PITCH * 0.5 - inner - 0.05, 0.3, 0.02, 10);
    }
}

/// A dome with two wreaths of petals around it.
fn head(builder: &mut Builder, foot: Frame, y: f64, random: &mut Random) {
    let tilt = DVec3::new(random.range(-0.2, 0.2), 1.0, random.range(-0.2, 0.2)).normalize();
    let centre = Frame::along(foot.at(0.04, y, 0.0), tilt, foot.x);
    const DOME: f64 = 0.22;
    let rings: Vec<_> = (1..6)
        .map(|step| {
            let (cos, sin) = turn(f64::from(step) / 12.0);
            centre.ring(0.2 - 0.12 * cos, DOME * sin, DOME * sin, 10)
        })
        .collect();
    builder.loft(centre.at(0.0, 0.08, 0.0), &rings, centre.at(0.0, 0.32, 0.0));
    for (wreath, (count, lift, rise)) in [(9, 0.16, 0.05), (9, 0.26, 0.45)].into_iter().enumerate()
    {
        for petal in 0..count {
            let (cos, sin) = turn((f64::from(petal) + 0.5 * wreath as f64) / f64::from(count));
            let out = centre.x * cos + centre.z * sin;
            let along = (out + centre.y * rise).normalize();
            let origin = centre.at(0.0, lift, 0.0) + out * (DOME + 0.03);
            let frame = Frame::along(origin, along.cross(centre.y.cross(out)).normalize(), along);
            builder.leaf(frame, 0.5, 0.13, 0.012, 12);
        }
    }
}
