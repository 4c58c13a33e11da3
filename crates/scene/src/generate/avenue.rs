//! An avenue 2,000 units long between fences, trees and lamps: what is near the eye and what is at
//! the horizon want texels of very different sizes, which is what warped and split maps are for.
//!
//! Every part is a closed surface and touches no other.

use super::numbers::Random;
use super::solid::{Builder, Frame, GAP};
use crate::mesh::Mesh;
use glam::DVec3;

/// Half the length and half the width of the ground.
const HALF: [f64; 2] = [1000.0, 60.0];
/// Bays along the avenue; each is fenced, with a tree and a lamp on either side.
const BAYS: u32 = 100;
/// How far from the middle fences stand.
const FENCE: f64 = 8.0;
/// Posts of a bay's fence on one side.
const POSTS: u32 = 5;

/// Builds the avenue, along z.
pub(super) fn build() -> Mesh {
    let mut random = Random::new(2004);
    let mut builder = Builder::default();
    builder.group("ground");
    let corner = DVec3::new(HALF[1], 0.0, HALF[0]);
    builder.slab(-corner - DVec3::Y * 2.0, corner, 40);
    builder.group("bays");
    let bay = 2.0 * HALF[0] / f64::from(BAYS);
    for number in 0..BAYS {
        let begin = -HALF[0] + f64::from(number) * bay;
        for side in [-1.0, 1.0] {
            fence(&mut builder, side * FENCE, begin, bay);
            let along = begin + bay * random.range(0.3, 0.7);
            let aside = side * random.range(FENCE + 5.0, FENCE + 16.0);
            let foot = DVec3::new(aside, GAP, along);
            tree(&mut builder, foot, random.range(2.0, 4.0));
            let foot = DVec3::new(side * (FENCE - 2.0), GAP, begin + 0.5 * bay);
            lamp(&mut builder, foot);
        }
    }
    builder.finish()
}

/// Posts, and a rail above them.
fn fence(builder: &mut Builder, x: f64, begin: f64, length: f64) {
    let place = |y: f64, z: f64| Frame::upright(DVec3::new(x, y, z), 0.0);
    for post in 0..POSTS {
        let z = begin + length * (f64::from(post) + 0.5) / f64::from(POSTS);
        builder.cuboid(place(GAP + 0.5, z), DVec3::new(0.08, 0.5, 0.08));
    }
    let rail = place(1.1 + 2.0 * GAP, begin + 0.5 * length);
    builder.cuboid(rail, DVec3::new(0.06, 0.05, 0.5 * length - GAP));
}

/// A trunk, and a crown above it.
fn tree(builder: &mut Builder, foot: DVec3, radius: f64) {
    let frame = Frame::upright(foot, 0.0);
    let trunk = [0.0, 4.0].map(|y| frame.ring(y, 0.4, 0.4, 6));
    builder.loft(foot, &trunk, foot + DVec3::Y * 4.0);
    let low = 4.0 + GAP;
    let crown = [(0.4, 0.8), (1.0, 1.0), (1.6, 0.7)]
        .map(|(up, wide)| frame.ring(low + up * radius, wide * radius, wide * radius, 8));
    let [bottom, top] = [low, low + 2.0 * radius].map(|y| foot + DVec3::Y * y);
    builder.loft(bottom, &crown, top);
}

/// A thin pole with an arm over the way, and a shade at its end.
fn lamp(builder: &mut Builder, foot: DVec3) {
    let inward = -foot.x.signum();
    let part = |x: f64, y: f64| Frame::upright(foot + DVec3::new(inward * x, y, 0.0), 0.0);
    builder.cuboid(part(0.0, 3.0), DVec3::new(0.07, 3.0, 0.07));
    builder.cuboid(part(0.8, 6.05 + GAP), DVec3::new(0.9, 0.05, 0.05));
    builder.cuboid(part(1.5, 5.8), DVec3::new(0.3, 0.15, 0.2));
}
