//! Random numbers, and cosines and sines, with the same bits on every machine.

use glam::DVec3;

/// Random number generator SplitMix64 (Steele, Lea and Flood 2014): one addition and three
/// multiply-xorshifts per number.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Creates a generator whose sequence of numbers is determined by `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a uniformly distributed number, at least `low` and less than `high`.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        // The upper 53 bits fill the mantissa exactly.
        let unit = (self.next() >> 11) as f64 / (1u64 << 53) as f64;
        low + unit * (high - low)
    }

    /// Returns a uniformly distributed point inside the unit ball.
    pub fn in_ball(&mut self) -> DVec3 {
        loop {
            let point = DVec3::from([(); 3].map(|()| self.range(-1.0, 1.0)));
            if point.length_squared() < 1.0 {
                return point;
            }
        }
    }

    /// Returns a unit vector, uniformly distributed over all directions.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.in_ball();
            if point.length_squared() > 1e-4 {
                return point.normalize();
            }
        }
    }
}

/// Returns the cosine and the sine, in this order, of an angle that is given as a fraction of a
/// full turn: any finite number, also a negative one or more than one turn.
pub fn turn(fraction: f64) -> (f64, f64) {
    // A quarter turn at most goes through the series: 12 terms are exact to the last bit of an f32
    // many times over.
    let quarters = (fraction * 4.0).floor();
    let angle = (fraction * 4.0 - quarters) * std::f64::consts::FRAC_PI_2;
    let (mut cos, mut sin, mut term) = (0.0, 0.0, 1.0);
    for n in 0..24 {
        let signed = if n & 2 == 0 { term } else { -term };
        if n & 1 == 0 {
            cos += signed;
        } else {
            sin += signed;
        }
        term *= angle / f64::from(n + 1);
    }
    match (quarters as i64).rem_euclid(4) {
        0 => (cos, sin),
        1 => (-sin, cos),
        2 => (-cos, -sin),
        _ => (sin, -cos),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turn_is_cosine_and_sine() {
        for step in -50..50 {
            let fraction = f64::from(step) * 0.037;
            let (cos, sin) = turn(fraction);
            let angle = fraction * std::f64::consts::TAU;
            assert!(
                (cos - angle.cos()).abs() < 1e-13 && (sin - angle.sin()).abs() < 1e-13,
                "{fraction}"
            );
        }
    }
}
