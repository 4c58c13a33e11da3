//! Finds places in the streets of a town: a wide mesh on which many things stand apart.

use super::room::Room;
use crate::records::statistics::median;
use glam::{DVec2, DVec3};
use itertools::Itertools;
use skiagraph_reference::sight::sights;
use skiagraph_scene::Mesh;

/// Columns along each of the two horizontal axes.
const COLUMNS: usize = 64;

/// Columns to each side of one within which the lowest surface is its floor: more than half the
/// width of a house.
const NEAR: usize = 7;

/// Share of the height of the highest roofs from which on something is a roof.
const ROOF: f64 = 0.25;

/// Fewest things that stand apart, and most of the columns that they may take up.
const HOUSES: usize = 5;
const MOST_BUILT: f64 = 0.85;

/// Times that a town is wider than its houses are high, in the median.
const WIDE: f64 = 3.0;

/// Most of the steps from column to column in which the floor may rise like a roof: the outline of
/// a body in the air has more.
const STEEP: f64 = 0.008;

/// Height, width and distance of houses, and height of an eye, all in metres; and how much each of
/// the first three counts: streets differ least.
const HOUSE: [f64; 3] = [9.0, 13.0, 10.0];
const WEIGHTS: [f64; 3] = [0.2, 0.3, 0.5];
const EYE: f64 = 1.7;

/// Units per metre that files have, and the factor by which an estimate may differ.
const UNITS: [f64; 5] = [1.0, 100.0, 39.37, 0.01, 1000.0];
const FACTOR: f64 = 2.4;

/// Places that are looked at, and that are looked through.
const PLACES: usize = 60;
const EYES: usize = 8;

/// A town seen from above.
struct Roofs {
    /// Height of the floor, column by column, and by how much what is seen from above is higher.
    floors: Vec<f64>,
    rises: Vec<f64>,
    is_roof: Vec<bool>,
    /// Distance from column to column along both axes.
    steps: [f64; 2],
}

/// Returns places in the streets of a town, at the height of an eye above its floor, and that
/// height; `None` if the mesh is none.
pub(super) fn street_eyes(room: &Room<'_>) -> Option<(Vec<DVec3>, f64)> {
    let roofs = Roofs::new(room)?;
    let height = roofs.eye_height()?;
    let is_street = |number: &usize| roofs.is_street(*number);
    let numbers = (0..COLUMNS * COLUMNS).filter(is_street).collect_vec();
    let step = numbers.len().div_ceil(PLACES).max(1);
    let places = numbers.iter().step_by(step).map(|number| {
        let [x, z] = [number % COLUMNS, number / COLUMNS];
        column(room, roofs.steps, x, z) + room.up * (roofs.floors[*number] + height)
    });
    let open = |place: DVec3| {
        let seen = room.all_around(place, 16, &[0.05]);
        let walls = seen.iter().flatten().map(|sight| sight.distance);
        let walls = walls.collect_vec();
        let nearest = walls.iter().copied().fold(f64::INFINITY, f64::min);
        let most = 3.0 * HOUSE[1] / EYE * height;
        let total = walls.iter().map(|distance| distance.min(most)).sum::<f64>();
        let is_street = walls.len() >= 6 && nearest > 0.5 * height && !room.is_buried(place);
        is_street.then_some((total, place))
    };
    let places = places.filter_map(open);
    let places = places.sorted_by(|(one, _), (other, _)| other.total_cmp(one));
    let places = places.take(EYES).map(|(_, place)| place).collect_vec();
    (!places.is_empty()).then_some((places, height))
}

/// Moves a place up or down to a height above the highest surface of a mesh that is so far below it
/// but for an error.
pub(super) fn raised(mesh: &Mesh, place: DVec3, up: DVec3, (height, error): (f64, f64)) -> DVec3 {
    let (right, back) = up.any_orthonormal_pair();
    let heights = mesh.triangles.iter().filter_map(|corners| {
        let corners = corners.map(|corner| mesh.positions[corner as usize].as_dvec3() - place);
        let [a, b, c] = corners.map(|it| DVec2::new(it.dot(right), it.dot(back)));
        let sides = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
        let sum: f64 = sides.iter().sum();
        let is_in = sum != 0.0 && sides.iter().all(|side| side * sum >= 0.0);
        let at = sides.iter().zip(corners);
        let at = at.map(|(side, corner)| corner * *side);
        is_in.then(|| -at.sum::<DVec3>().dot(up) / sum)
    });
    let floors = heights.filter(|below| (below - height).abs() <= 1.5 * error);
    let highest = floors.reduce(f64::min);
    place + up * highest.map_or(0.0, |highest| height - highest)
}

impl Roofs {
    /// `None` if what is seen from above does not look like a town.
    fn new(room: &Room<'_>) -> Option<Self> {
        let [right, back] = room.across;
        let steps = [right, back].map(|axis| 2.0 * room.reach(axis) / COLUMNS as f64);
        let numbers = (0..COLUMNS).cartesian_product(0..COLUMNS);
        let above = room.reach(room.up) * 1.01;
        let rays = numbers.map(|(z, x)| (column(room, steps, x, z) + room.up * above, -room.up));
        let seen = sights(&room.oracle, &rays.collect_vec());
        let lowest = -room.reach(room.up);
        let height = |distance: f64| (above - distance).max(lowest);
        let tops = seen.iter();
        let tops = tops.map(|it| it.map_or(lowest, |it| height(it.distance)));
        let tops = tops.collect_vec();
        let floors = extremes(&extremes(&tops, f64::min), f64::max);
        let rises = tops.iter().zip(&floors).map(|(top, floor)| top - floor);
        let rises = rises.collect_vec();
        let mut sorted = rises.iter().copied().sorted_by(f64::total_cmp);
        let highest = sorted.nth(rises.len() * 98 / 100)?;
        let roofs = Self {
            is_roof: rises.iter().map(|rise| *rise > ROOF * highest).collect(),
            floors,
            rises,
            steps,
        };
        let built = roofs.is_roof.iter().filter(|is_roof| **is_roof).count() as f64;
        let width = steps[0].min(steps[1]) * COLUMNS as f64;
        let is_town = highest > 1e-6 * width
            && built <= MOST_BUILT * roofs.rises.len() as f64
            && roofs.houses() >= HOUSES
            && roofs.steep(ROOF * highest) <= STEEP
            && width >= WIDE * roofs.median_rise();
        is_town.then_some(roofs)
    }

    fn median_rise(&self) -> f64 {
        let rises = self.rises.iter().zip(&self.is_roof);
        let rises = rises.filter(|(_, is_roof)| **is_roof);
        median(rises.map(|(rise, _)| *rise).collect())
    }

    /// Share of the steps from column to column in which the floor rises or falls by so much.
    fn steep(&self, least: f64) -> f64 {
        let numbers = 0..self.floors.len();
        let steps = numbers.flat_map(|at| neighbours(at).map(move |other| (at, other)));
        let rise = |(at, other): (usize, usize)| (self.floors[at] - self.floors[other]).abs();
        let (steep, count) = steps.fold((0.0, 0.0), |(steep, count), step| {
            (steep + f64::from(u8::from(rise(step) > least)), count + 1.0)
        });
        steep / count
    }

    /// How many roofs stand apart.
    fn houses(&self) -> usize {
        let (mut left, mut count) = (self.is_roof.clone(), 0);
        while let Some(first) = left.iter().position(|is_roof| *is_roof) {
            count += 1;
            let mut next = vec![first];
            while let Some(at) = next.pop() {
                if std::mem::take(&mut left[at]) {
                    next.extend(neighbours(at).filter(|other| left[*other]));
                }
            }
        }
        count
    }

    /// True if a column is none of a roof nor beside one, and not at the edge.
    fn is_street(&self, number: usize) -> bool {
        let (x, z) = (number % COLUMNS, number / COLUMNS);
        let is_inner = [x, z].iter().all(|at| (4..COLUMNS - 4).contains(at));
        is_inner && !self.is_roof[number]
    }

    /// The height of an eye in the unit that houses and streets suggest.
    fn eye_height(&self) -> Option<f64> {
        let [mut roofs, mut streets] = [Vec::new(), Vec::new()];
        let axes = [[COLUMNS, 1], [1, COLUMNS]].into_iter().zip(self.steps);
        for ([to_row, to_next], step) in axes {
            for row in 0..COLUMNS {
                let numbers = (0..COLUMNS).map(|at| row * to_row + at * to_next);
                let is_roof = numbers.map(|number| self.is_roof[number]);
                let runs = is_roof.dedup_with_count().collect_vec();
                // Those at the ends go on beyond them.
                let inner = runs.get(1..runs.len() - 1).unwrap_or_default();
                for (count, is_roof) in inner {
                    let length = *count as f64 * step;
                    if *is_roof { &mut roofs } else { &mut streets }.push(length);
                }
            }
        }
        let sizes = [self.median_rise(), median(roofs), median(streets)];
        let ratios = sizes.iter().zip(HOUSE).map(|(size, house)| size / house);
        let ratios = ratios.zip(WEIGHTS).map(|(ratio, power)| ratio.powf(power));
        let ratio = ratios.product::<f64>();
        if !(ratio > 0.0 && ratio.is_finite()) {
            return None;
        }
        let distance = |unit: &f64| (ratio / unit).ln().abs();
        let is_near = |unit: &f64| distance(unit) < FACTOR.ln();
        let units = UNITS.into_iter().filter(is_near);
        let unit = units.min_by(|one, other| distance(one).total_cmp(&distance(other)));
        Some(EYE * unit.unwrap_or(ratio))
    }
}

/// Place in the middle of a column, at the height of the room's middle.
fn column(room: &Room<'_>, steps: [f64; 2], x: usize, z: usize) -> DVec3 {
    let aside = |number: usize| number as f64 + 0.5 - COLUMNS as f64 * 0.5;
    let [right, back] = room.across;
    room.middle + right * (aside(x) * steps[0]) + back * (aside(z) * steps[1])
}

fn neighbours(number: usize) -> impl Iterator<Item = usize> {
    skiagraph_reference::pixels::neighbours(number, [COLUMNS; 2])
}

/// The least or greatest value near each column.
fn extremes(values: &[f64], extreme: fn(f64, f64) -> f64) -> Vec<f64> {
    let near = |at: usize| at.saturating_sub(NEAR)..(at + NEAR + 1).min(COLUMNS);
    let numbers = || (0..COLUMNS).cartesian_product(0..COLUMNS);
    let rows = numbers().map(|(z, x)| {
        let row = near(x).map(|x| values[z * COLUMNS + x]);
        row.reduce(extreme).unwrap_or_default()
    });
    let rows = rows.collect_vec();
    let columns = numbers().map(|(z, x)| {
        let column = near(z).map(|z| rows[z * COLUMNS + x]);
        column.reduce(extreme).unwrap_or_default()
    });
    columns.collect()
}
