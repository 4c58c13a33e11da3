//! A city of 144 blocks of four houses on a square kilometre. Streets and houses are always the
//! same; what grows with the number of triangles are the balconies, bays and tanks on their walls
//! and roofs: at 10⁴ triangles a house has one at most, at 10⁷ its walls are full of them, and a
//! ray along a street or towards the light passes many.
//!
//! Every part is a closed surface and touches no other.

use super::numbers::Random;
use super::solid::{Builder, Frame, GAP};
use super::stamp::{Stamp, turned};
use crate::mesh::Mesh;
use glam::DVec3;

/// Blocks along each side, and from a street's middle to the next one's.
const BLOCKS: u32 = 12;
const PITCH: f64 = 80.0;
/// Half the width of a street.
const STREET: f64 = 10.0;
/// Width of a lot; there are two by two in a block.
const LOT: f64 = 30.0;
/// Half the widths of houses, and their heights.
const HALF_WIDTH: (f64, f64) = (10.5, 13.0);
const HEIGHT: (f64, f64) = (18.0, 110.0);
/// How wide and high the place of a detail is at least.
const CELL: f64 = 2.7;
/// Triangles of every detail.
const DETAIL: u32 = 36;

/// A house: its middle on the ground, half its widths, its height.
struct House {
    foot: DVec3,
    half: [f64; 2],
    height: f64,
}

impl House {
    /// Returns the numbers of details, in places at least `cell` wide and high, beside and above
    /// each other on each wall and the roof. Walls that look along z come first, then those along
    /// x, then the roof.
    fn cells(&self, cell: f64) -> [[u32; 2]; 3] {
        let [x, z] = self.half.map(|half| (2.0 * half / cell) as u32);
        let y = (self.height / cell) as u32;
        [[x, y], [z, y], [x, z]]
    }

    fn details(&self, cell: f64) -> u32 {
        let [[x, y], [z, v], [u, w]] = self.cells(cell);
        2 * x * y + 2 * z * v + u * w
    }
}

/// Builds a city of about that many triangles.
pub(super) fn build(triangles: u32) -> Mesh {
    let mut random = Random::new(1986);
    let mut builder = Builder::default();
    builder.ground(f64::from(BLOCKS) * PITCH / 2.0 + 40.0);
    builder.group("houses");
    let houses = houses(&mut random);
    for house in &houses {
        let [x, z] = house.half;
        let middle = house.foot + DVec3::Y * (GAP + house.height / 2.0);
        let half = DVec3::new(x, house.height / 2.0, z);
        builder.cuboid(Frame::upright(middle, 0.0), half);
    }
    let details = triangles.saturating_sub(builder.triangles()) / DETAIL;
    let cell = cell(&houses, details);
    builder.group("details");
    let on_walls = [
        Stamp::new(&mut builder, balcony),
        Stamp::new(&mut builder, bay),
    ];
    let on_roofs = Stamp::new(&mut builder, tank);
    for house in &houses {
        furnish(&mut builder, house, cell, &on_walls, &on_roofs, &mut random);
    }
    builder.finish()
}

/// Higher ones in the middle of the city.
fn houses(random: &mut Random) -> Vec<House> {
    let mut houses = Vec::new();
    let lots = 2 * BLOCKS;
    let middle = |lot: u32| {
        let block = f64::from(lot / 2) - f64::from(BLOCKS) / 2.0;
        block * PITCH + STREET + (f64::from(lot % 2) + 0.5) * LOT
    };
    for (across, along) in (0..lots).flat_map(|x| (0..lots).map(move |z| (x, z))) {
        let foot = DVec3::new(middle(across), 0.0, middle(along));
        let share = foot.length() / (f64::from(BLOCKS) * PITCH / 2.0);
        let chance = random.range(0.0, 1.0);
        let tall = (1.2 - share).clamp(0.25, 1.0) * (0.3 + 0.7 * chance);
        houses.push(House {
            foot,
            half: [0; 2].map(|_| random.range(HALF_WIDTH.0, HALF_WIDTH.1)),
            height: HEIGHT.0 + (HEIGHT.1 - HEIGHT.0) * tall,
        });
    }
    houses
}

/// The size of a detail's place at which there are at most that many, and hardly less.
fn cell(houses: &[House], details: u32) -> f64 {
    let count = |cell: f64| houses.iter().map(|house| house.details(cell)).sum::<u32>();
    // Larger than any wall: none.
    let (mut fits, mut exceeds) = (2.0 * HEIGHT.1, CELL);
    for _ in 0..60 {
        let middle = (fits + exceeds) / 2.0;
        if count(middle) <= details {
            fits = middle;
        } else {
            exceeds = middle;
        }
    }
    fits
}

fn furnish(
    builder: &mut Builder,
    house: &House,
    cell: f64,
    on_walls: &[Stamp; 2],
    on_roofs: &Stamp,
    random: &mut Random,
) {
    // The middle of the i-th of n equal parts of a length, from the middle of the length.
    let part = |length: f64, i: u32, n: u32| length * ((f64::from(i) + 0.5) / f64::from(n) - 0.5);
    let [x, z] = house.half;
    let cells = house.cells(cell);
    for quarters in 0..4 {
        let [wide, away] = if quarters % 2 == 0 { [x, z] } else { [z, x] };
        let [columns, rows] = cells[quarters % 2];
        for (column, row) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
            let place = DVec3::new(
                part(2.0 * wide, column, columns),
                GAP + house.height / 2.0 + part(house.height, row, rows),
                away,
            );
            let kind = usize::from(random.range(0.0, 1.0) < 0.4);
            let place = house.foot + turned(place, quarters);
            on_walls[kind].place(quarters, place, builder);
        }
    }
    let [columns, rows] = cells[2];
    for (column, row) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
        let place = DVec3::new(
            part(2.0 * x, column, columns),
            GAP + house.height,
            part(2.0 * z, row, rows),
        );
        on_roofs.place(0, house.foot + place, builder);
    }
}

/// A box around a point, upright.
fn block(builder: &mut Builder, middle: [f64; 3], half: [f64; 3]) {
    let frame = Frame::upright(middle.into(), 0.0);
    builder.cuboid(frame, half.into());
}

/// A slab, its parapet and an awning above: in front of a wall that looks along z.
fn balcony(builder: &mut Builder) {
    block(builder, [0.0, -1.0, 0.68], [1.2, 0.08, 0.64]);
    block(builder, [0.0, -0.48, 1.26], [1.2, 0.4, 0.05]);
    let [middle, axis] = [[0.0, 1.0, 0.55], [0.0, 0.8, 0.6]].map(DVec3::from);
    let tilted = Frame::along(middle, axis, DVec3::X);
    builder.cuboid(tilted, DVec3::new(1.15, 0.04, 0.5));
}

/// A bay with a flower box and a sign before it.
fn bay(builder: &mut Builder) {
    block(builder, [0.0, 0.0, 0.27], [1.0, 1.15, 0.23]);
    block(builder, [0.35, -0.9, 0.86], [0.55, 0.2, 0.3]);
    block(builder, [-0.75, 0.35, 0.9], [0.05, 0.6, 0.36]);
}

/// A tank on a foundation.
fn tank(builder: &mut Builder) {
    block(builder, [0.0, 0.32, 0.0], [1.1, 0.28, 1.1]);
    let frame = Frame::upright(DVec3::ZERO, 0.0);
    let rings = [0.65, 2.2].map(|y| frame.ring(y, 0.9, 0.9, 6));
    let [low, high] = [0.65, 2.2].map(|y| DVec3::Y * y);
    builder.loft(low, &rings, high);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_detail_has_as_many_triangles_and_room_at_ten_million() {
        for draw in [balcony, bay, tank] {
            let mut builder = Builder::default();
            draw(&mut builder);
            assert_eq!(builder.triangles(), DETAIL);
        }
        let houses = houses(&mut Random::new(1986));
        let cell = cell(&houses, 10_000_000 / DETAIL);
        assert!(cell > CELL + 0.01, "{cell}");
    }
}
