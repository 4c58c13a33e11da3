//! Trees on both sides of a straight ride. Their number grows with the square root of the number of
//! triangles, and so do the leaves of each: what light and eye have to pass gets denser twice.
//!
//! Every part is a closed surface and touches no other.

use super::numbers::Random;
use super::solid::{Builder, GAP};
use super::stamp::Stamp;
use super::tree::Tree;
use crate::mesh::Mesh;
use glam::DVec3;

/// Half the side of the ground, and half the width of the ride, which runs along z.
const HALF: f64 = 475.0;
const RIDE: f64 = 14.0;
/// Half axes of a crown.
const ACROSS: f64 = 18.0;
const UP: f64 = 14.0;
const BRANCHES: u32 = 5;
/// Triangles of a trunk with its branches, and of a leaf.
const LIMBS: u32 = 260;
const LEAF: u32 = 12;
/// Half the length of the leaves of a tree that has a thousand. With their number's fourth root
/// they shrink: a crown of more leaves is denser all the same.
const LEAF_OF_THOUSAND: f64 = 0.68;
/// Trees that differ by more than a turn.
const KINDS: u64 = 4;

/// Builds a forest of about that many triangles.
pub(super) fn build(triangles: u32) -> Mesh {
    let mut builder = Builder::default();
    builder.ground(HALF + 5.0);
    builder.group("trees");
    // As many on the right as on the left of the ride.
    let beside = (0.08 * f64::from(triangles).sqrt()).round().max(1.0) as u32;
    let trees = 2 * beside;
    let left = triangles.saturating_sub(builder.triangles() + trees * LIMBS);
    let leaves = left / (trees * LEAF);
    let leaf = LEAF_OF_THOUSAND * (1000.0 / f64::from(leaves.max(1))).sqrt().sqrt();
    let kinds: Vec<_> = (0..KINDS)
        .map(|seed| {
            let tree = Tree {
                foot: DVec3::ZERO,
                crown: 28.0 + 3.0 * seed as f64,
                across: ACROSS,
                up: UP,
                branches: BRANCHES,
                leaves: leaves as usize,
                leaf: (0.8 * leaf, 1.2 * leaf),
                seed: 40 + seed,
            };
            Stamp::new(&mut builder, |part| tree.grow(part))
        })
        .collect();
    let mut random = Random::new(1975);
    let feet = feet(beside, ACROSS + 1.2 * leaf + GAP, &mut random);
    for (index, foot) in feet.into_iter().enumerate() {
        let quarters = (random.range(0.0, 4.0)) as usize;
        kinds[index % kinds.len()].place(quarters, foot, &mut builder);
    }
    builder.finish()
}

/// Where trees stand: each somewhere in a cell of its own, `reach` from the cell's borders.
fn feet(beside: u32, reach: f64, random: &mut Random) -> Vec<DVec3> {
    let (wide, long) = (HALF - RIDE, 2.0 * HALF);
    let columns = (f64::from(beside) * wide / long).sqrt().ceil() as u32;
    let rows = beside.div_ceil(columns.max(1));
    let size = [wide / f64::from(columns), long / f64::from(rows)];
    let mut feet = Vec::new();
    for side in [-1.0, 1.0] {
        for tree in 0..beside {
            // Empty cells are spread among the others.
            let cell = tree * (columns * rows) / beside;
            let middle = [cell % columns, cell / columns].map(|i| f64::from(i) + 0.5);
            let [x, z] = [0, 1].map(|axis| {
                let room = (size[axis] / 2.0 - reach).max(0.0);
                middle[axis] * size[axis] + random.range(-room, room)
            });
            feet.push(DVec3::new(side * (RIDE + x), 0.0, z - HALF));
        }
    }
    feet
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_forest_has_trees() {
        assert!(build(1).triangles.len() > 2);
    }

    #[test]
    fn crowns_keep_apart_and_off_the_ride() {
        for (beside, reach) in [(8, 20.5), (253, ACROSS + 0.8)] {
            let feet = feet(beside, reach, &mut Random::new(1));
            assert_eq!(feet.len(), 2 * beside as usize);
            for (index, foot) in feet.iter().enumerate() {
                assert!(foot.x.abs() >= RIDE + reach, "{foot}");
                for other in &feet[..index] {
                    let apart = (*foot - *other).abs();
                    assert!(apart.x.max(apart.z) >= 2.0 * reach - 1e-9, "{foot} {other}");
                }
            }
        }
    }
}
