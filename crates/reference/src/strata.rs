//! Points spread over a square, one in each of some parts of equal area, and from there over a
//! disk.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Parts of equal area of the unit square: columns as wide as they have rows.
/// `shaders/shared/strata.wgsl` has the same.
pub(crate) struct Strata(Vec<Stratum>);

struct Stratum {
    low: [f64; 2],
    size: [f64; 2],
}

impl Strata {
    pub(crate) fn new(count: u32) -> Self {
        let columns = f64::from(count).sqrt().round() as u32;
        let (count, columns) = (u64::from(count), u64::from(columns));
        let column = |column: u64| {
            let first = column * count / columns;
            let rows = (column + 1) * count / columns - first;
            let size = [rows as f64 / count as f64, 1.0 / rows as f64];
            let left = first as f64 / count as f64;
            (0..rows).map(move |row| Stratum {
                low: [left, row as f64 / rows as f64],
                size,
            })
        };
        Self((0..columns).flat_map(column).collect())
    }

    pub(crate) fn count(&self) -> u32 {
        self.0.len() as u32
    }

    /// A point in each part; others for another seed.
    pub(crate) fn points(&self, seed: [u32; 3]) -> impl Iterator<Item = [f64; 2]> {
        let mut random = Random::new(seed);
        self.0.iter().map(move |Stratum { low, size }| {
            let [x, y] = [random.next(), random.next()];
            [low[0] + x * size[0], low[1] + y * size[1]]
        })
    }
}

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).
struct Random(u64);

impl Random {
    fn new(seed: [u32; 3]) -> Self {
        let mut random = Self(0);
        for word in seed {
            random.0 ^= u64::from(word);
            random.0 = random.bits();
        }
        random
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// In 0..1.
    fn next(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// From the unit square to the unit disk; parts of equal area stay so (Shirley, Chiu, *A Low
/// Distortion Map Between Disk and Square*, JGT 2(3), 1997).
pub(crate) fn disk([x, y]: [f64; 2]) -> [f64; 2] {
    let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0; 2];
    }
    let (radius, angle) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * (b / a))
    } else {
        (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
    };
    [radius * angle.cos(), radius * angle.sin()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_has_one_point_and_parts_are_of_equal_area() {
        for count in [1, 2, 3, 7, 64, 100, 257] {
            let strata = Strata::new(count);
            let points: Vec<_> = strata.points([3, 5, 7]).collect();
            assert_eq!(points.len(), count as usize);
            assert_eq!(points, strata.points([3, 5, 7]).collect::<Vec<_>>());
            assert_ne!(points, strata.points([5, 3, 7]).collect::<Vec<_>>());
            // With n points in equal parts, the share left of any x is off by a column at most.
            for bound in [0.1, 0.3, 0.5, 0.9] {
                for axis in 0..2 {
                    let below = points.iter().filter(|point| point[axis] < bound).count();
                    let error = (below as f64 / f64::from(count) - bound).abs();
                    let most = 2.0 / f64::from(count).sqrt();
                    assert!(error <= most, "{count} {bound} {axis}: {error}");
                }
            }
        }
    }

    #[test]
    fn areas_stay_equal_on_the_disk() {
        let points: Vec<_> = Strata::new(40_000).points([0; 3]).map(disk).collect();
        assert!(points.iter().all(|[x, y]| x.hypot(*y) <= 1.0));
        // A disk of half the radius holds a quarter, a half plane a half, a quadrant a quarter.
        let share = |is: fn(f64, f64) -> bool| {
            points.iter().filter(|[x, y]| is(*x, *y)).count() as f64 / 40_000.0
        };
        assert!((share(|x, y| x.hypot(y) < 0.5) - 0.25).abs() < 2e-3);
        assert!((share(|x, y| x + 0.5 * y < 0.0) - 0.5).abs() < 2e-3);
        assert!((share(|x, y| x > 0.0 && y < 0.0) - 0.25).abs() < 2e-3);
    }
}
