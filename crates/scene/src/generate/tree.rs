//! A tree: a trunk, branches, and leaves that touch nothing.

use super::numbers::{Random, turn};
use super::solid::{Builder, Frame, GAP};
use glam::DVec3;

/// Radius of a trunk at the ground.
const TRUNK: f64 = 2.5;

pub(super) struct Tree {
    pub foot: DVec3,
    /// Centre of the crown above the foot, and its half axes across and up.
    pub crown: f64,
    pub across: f64,
    pub up: f64,
    pub branches: u32,
    pub leaves: usize,
    /// Smallest and largest half length of a leaf.
    pub leaf: (f64, f64),
    pub seed: u64,
}

/// A tapering limb: what leaves keep away from.
struct Limb {
    from: DVec3,
    to: DVec3,
    radius: f64,
}

impl Limb {
    fn distance(&self, point: DVec3) -> f64 {
        let along = self.to - self.from;
        let t = ((point - self.from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (point - self.from - along * t).length() - self.radius
    }
}

impl Tree {
    /// Adds the tree; fewer leaves than asked for where no more find a place.
    pub fn grow(&self, builder: &mut Builder) {
        let mut random = Random::new(self.seed);
        let limbs = limbs(builder, self, &mut random);
        let centre = self.foot + DVec3::Y * self.crown;
        let half = DVec3::new(self.across, self.up, self.across);
        let mut leaves: Vec<(DVec3, f64)> = Vec::new();
        // Dart throwing: a leaf's bounding ball meets no other leaf's and no limb.
        for _ in 0..200_000 {
            if leaves.len() == self.leaves {
                break;
            }
            let position = centre + random.in_ball() * half;
            let radius = random.range(self.leaf.0, self.leaf.1);
            let is_apart = |(other, r): &(DVec3, f64)| position.distance(*other) > radius + r + GAP;
            let is_beside = |limb: &Limb| limb.distance(position) > radius + GAP;
            if leaves.iter().all(is_apart) && limbs.iter().all(is_beside) {
                leaves.push((position, radius));
            }
        }
        for (position, radius) in leaves {
            // Leaves lie rather than stand.
            let up = (random.direction() + DVec3::Y).try_normalize();
            let along = random.direction();
            let frame = Frame::along(position, up.unwrap_or(DVec3::Y), along);
            let frame = frame.moved_to(frame.at(-radius, 0.0, 0.0));
            builder.leaf(frame, 2.0 * radius, 0.8 * radius, 0.08 * radius, 6);
        }
    }
}

/// The trunk and its branches, which begin a gap outside it.
fn limbs(builder: &mut Builder, tree: &Tree, random: &mut Random) -> Vec<Limb> {
    let top = tree.crown + tree.up * 0.5;
    let radius = |y: f64| TRUNK - 1.3 * (y / top);
    let trunk: Vec<(DVec3, f64)> = (0..=4)
        .map(|i| GAP + (top - GAP) * f64::from(i) / 4.0)
        .map(|y| (tree.foot + DVec3::Y * y, radius(y)))
        .collect();
    builder.tube(&trunk, 8);
    let mut limbs = vec![Limb {
        from: tree.foot,
        to: tree.foot + DVec3::Y * top,
        radius: TRUNK,
    }];
    let count = tree.branches;
    for index in 0..count {
        let y = tree.crown - tree.up * 0.8 + tree.up * 1.2 * f64::from(index) / f64::from(count);
        let (cos, sin) = turn(0.382 * f64::from(index) + random.range(-0.03, 0.03));
        let out = DVec3::new(cos, 0.0, sin);
        let from = tree.foot + DVec3::Y * y + out * (radius(y) + 0.6 + GAP);
        let to = from + (out + DVec3::Y * 0.5) * (tree.across * random.range(0.5, 0.65));
        builder.tube(&[(from, 0.55), ((from + to) * 0.5, 0.35), (to, 0.12)], 6);
        limbs.push(Limb {
            from,
            to,
            radius: 0.55,
        });
    }
    limbs
}
