//! f32 as WGSL lets a compiler evaluate it, operation by operation: the roundings that
//! [its rules on accuracy](https://www.w3.org/TR/WGSL/#floating-point-accuracy) leave open.

/// The neighbour to which a result that f32 does not hold is rounded. WGSL asks for either one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// The nearest one.
    Nearest,
    /// The lower one.
    Down,
    /// The greater one.
    Up,
    /// The one nearer to zero.
    ToZero,
    /// One drawn anew for each operation, from this seed and the operands: the same operation on
    /// the same numbers has one result.
    Either(u32),
}

/// Which product goes into a sum of products unrounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fused {
    /// None.
    Neither,
    /// The first one, and in a sum of three the second one.
    First,
    /// The last one, and in a sum of three the second one.
    Last,
}

/// The order in which three terms are added up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// (a + b) + c, as WGSL reads a sum without brackets.
    Written,
    /// a + (b + c).
    Backwards,
    /// (a + c) + b.
    OuterFirst,
}

/// How f32 is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arithmetic {
    /// How an operation is rounded.
    pub rounding: Rounding,
    /// Which product of a sum is not.
    pub fused: Fused,
    /// True if subnormal results are flushed to zero.
    pub flushed: bool,
    /// In which order sums of three terms are.
    pub order: Order,
}

impl Arithmetic {
    /// Every operation rounded to the nearest, nothing fused, flushed or reordered.
    pub const PLAIN: Self = Self {
        rounding: Rounding::Nearest,
        fused: Fused::Neither,
        flushed: false,
        order: Order::Written,
    };

    /// Those that round to the nearest: plain, either product fused, subnormal results flushed.
    pub const NEAREST: [Self; 4] = Self::rounding(Rounding::Nearest);

    /// The same four under a rounding.
    pub const fn rounding(rounding: Rounding) -> [Self; 4] {
        let plain = Self {
            rounding,
            ..Self::PLAIN
        };
        [
            plain,
            Self {
                fused: Fused::First,
                ..plain
            },
            Self {
                fused: Fused::Last,
                ..plain
            },
            Self {
                flushed: true,
                ..plain
            },
        ]
    }

    /// The same four under every rounding, the drawn one from two seeds.
    pub fn every(seed: u32) -> impl Iterator<Item = Self> {
        use Rounding::{Down, Either, Nearest, ToZero, Up};
        [Nearest, Down, Up, ToZero, Either(seed), Either(!seed)]
            .into_iter()
            .flat_map(Self::rounding)
    }

    /// The most that one operation errs by, relative to its result, in half ulps of 1.
    pub fn half_ulps(self) -> f64 {
        match self.rounding {
            Rounding::Nearest => 1.0,
            _ => 2.0,
        }
    }

    /// a + b.
    pub fn add(self, a: f32, b: f32) -> f32 {
        if self.rounding == Rounding::Nearest {
            return self.flush(a + b);
        }
        self.round(exact_sum(a.into(), b.into()), [a, b, 0.0])
    }

    /// a − b.
    pub fn sub(self, a: f32, b: f32) -> f32 {
        self.add(a, -b)
    }

    /// a · b.
    pub fn mul(self, a: f32, b: f32) -> f32 {
        if self.rounding == Rounding::Nearest {
            return self.flush(a * b);
        }
        self.round((f64::from(a) * f64::from(b), 0.0), [a, b, 1.0])
    }

    /// a / b, correctly rounded; WGSL allows 2.5 ulps.
    pub fn div(self, a: f32, b: f32) -> f32 {
        let (x, y) = (f64::from(a), f64::from(b));
        // The quotient of two f32 is no midpoint of two f32, nor nearer to one than f64 tells, and
        // is an f32 in f64 only if it is one.
        self.round((x / y, 0.0), [a, b, 2.0])
    }

    /// √a, correctly rounded; WGSL allows more.
    pub fn sqrt(self, a: f32) -> f32 {
        self.round((f64::from(a).sqrt(), 0.0), [a, 0.0, 3.0])
    }

    /// a · b + c with one rounding.
    pub fn fma(self, a: f32, b: f32, c: f32) -> f32 {
        if self.rounding == Rounding::Nearest {
            return self.flush(a.mul_add(b, c));
        }
        self.round(exact_sum(f64::from(a) * f64::from(b), c.into()), [a, b, c])
    }

    /// a · b − c · d.
    pub fn products(self, [a, b]: [f32; 2], [c, d]: [f32; 2]) -> f32 {
        match self.fused {
            Fused::Neither => self.sub(self.mul(a, b), self.mul(c, d)),
            Fused::First => self.fma(a, b, -self.mul(c, d)),
            Fused::Last => self.fma(-c, d, self.mul(a, b)),
        }
    }

    /// a + b + c.
    pub fn sum(self, [a, b, c]: [f32; 3]) -> f32 {
        match self.order {
            Order::Written => self.add(self.add(a, b), c),
            Order::Backwards => self.add(a, self.add(b, c)),
            Order::OuterFirst => self.add(self.add(a, c), b),
        }
    }

    /// The dot product of two vectors.
    pub fn dot(self, p: [f32; 3], q: [f32; 3]) -> f32 {
        match self.fused {
            Fused::Neither => self.sum([0, 1, 2].map(|i| self.mul(p[i], q[i]))),
            Fused::First => self.fma(p[0], q[0], self.fma(p[1], q[1], self.mul(p[2], q[2]))),
            Fused::Last => self.fma(p[2], q[2], self.fma(p[1], q[1], self.mul(p[0], q[0]))),
        }
    }

    /// The cross product of two vectors.
    pub fn cross(self, p: [f32; 3], q: [f32; 3]) -> [f32; 3] {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| self.products([p[i], q[j]], [p[j], q[i]]))
    }

    /// The length of a vector.
    pub fn length(self, p: [f32; 3]) -> f32 {
        self.sqrt(self.dot(p, p))
    }

    fn flush(self, value: f32) -> f32 {
        if self.flushed && value.is_subnormal() {
            0.0
        } else {
            value
        }
    }

    /// An exact result, the sum of two numbers of which the second is what rounding left over of
    /// the first.
    fn round(self, (high, low): (f64, f64), operands: [f32; 3]) -> f32 {
        let nearest = high as f32;
        let error = high - f64::from(nearest);
        let error = if error == 0.0 { low } else { error };
        if !nearest.is_finite() || error == 0.0 || error.is_nan() {
            return self.flush(nearest);
        }
        let [lower, greater] = if error > 0.0 {
            [nearest, nearest.next_up()]
        } else {
            [nearest.next_down(), nearest]
        };
        self.flush(match self.rounding {
            Rounding::Nearest => nearest,
            Rounding::Down => lower,
            Rounding::Up => greater,
            Rounding::ToZero if high > 0.0 => lower,
            Rounding::ToZero => greater,
            Rounding::Either(seed) if is_drawn(seed, operands) => lower,
            Rounding::Either(_) => greater,
        })
    }
}

/// a + b, and what rounding the sum left over: Knuth's TwoSum.
fn exact_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// One of two, from a seed and the operands; the finisher is MurmurHash3's.
fn is_drawn(seed: u32, operands: [f32; 3]) -> bool {
    let mixed = operands.iter().fold(seed, |state, operand| {
        let mut x = (state ^ operand.to_bits()).wrapping_mul(0x9E37_79B9);
        x = (x ^ (x >> 16)).wrapping_mul(0x85EB_CA6B);
        x = (x ^ (x >> 13)).wrapping_mul(0xC2B2_AE35);
        x ^ (x >> 16)
    });
    mixed & 1 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const DIRECTED: [Rounding; 3] = [Rounding::Down, Rounding::Up, Rounding::ToZero];

    fn plain(rounding: Rounding) -> Arithmetic {
        Arithmetic {
            rounding,
            ..Arithmetic::PLAIN
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// Down and up are neighbours around the exact result, or it; the nearest one is among
        /// them, and so is whatever is drawn.
        #[test]
        fn results_are_the_neighbours_of_the_exact_ones(
            a in -1e3f32..1e3,
            b in prop_oneof![-1e3f32..1e3, -1e-6f32..1e-6],
            c in prop_oneof![-1e6f32..1e6, -1e-3f32..1e-3],
            seed: u32,
        ) {
            type Operation = fn(Arithmetic, f32, f32, f32) -> f32;
            let operations: [(Operation, f32); 5] = [
                (|arithmetic, a, b, _| arithmetic.add(a, b), a + b),
                (|arithmetic, a, b, _| arithmetic.mul(a, b), a * b),
                (|arithmetic, a, b, _| arithmetic.div(a, b), a / b),
                (|arithmetic, a, _, _| arithmetic.sqrt(a.abs()), a.abs().sqrt()),
                (|arithmetic, a, b, c| arithmetic.fma(a, b, c), a.mul_add(b, c)),
            ];
            for (index, (operation, nearest)) in operations.into_iter().enumerate() {
                let rounded = |rounding| operation(plain(rounding), a, b, c);
                prop_assert_eq!(rounded(Rounding::Nearest), nearest, "{}", index);
                let [down, up, to_zero] = DIRECTED.map(rounded);
                prop_assert!(down == up || down.next_up() == up, "{index}: {down} {up}");
                prop_assert!([down, up].contains(&nearest), "{index}: {nearest}");
                prop_assert!([down, up].contains(&rounded(Rounding::Either(seed))), "{index}");
                prop_assert_eq!(to_zero.abs(), down.abs().min(up.abs()), "{}", index);
            }
            // Exactly, as f64 has these.
            let exact = f64::from(a) * f64::from(b);
            let [down, up] = [Rounding::Down, Rounding::Up].map(|r| plain(r).mul(a, b));
            prop_assert!((f64::from(down)..=f64::from(up)).contains(&exact));
        }
    }

    #[test]
    fn either_neighbour_is_drawn_about_as_often() {
        let lower = (1..10_000u16)
            .filter(|&i| {
                let a = f32::from(i) * 0.731_9;
                let drawn = plain(Rounding::Either(7)).mul(a, a);
                drawn == plain(Rounding::Down).mul(a, a)
            })
            .count();
        assert!((4_500..5_500).contains(&lower), "{lower}");
    }

    #[test]
    fn a_sum_far_below_the_other_term_is_rounded_too() {
        let tiny = 1e-30;
        assert_eq!(plain(Rounding::Up).add(1.0, tiny), 1.0f32.next_up());
        assert_eq!(plain(Rounding::Down).add(1.0, tiny), 1.0);
        assert_eq!(plain(Rounding::Down).sub(1.0, tiny), 1.0f32.next_down());
        assert_eq!(plain(Rounding::Up).fma(tiny, tiny, 1.0), 1.0f32.next_up());
    }
}
