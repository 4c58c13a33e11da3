//! Gives bit-equal vectors the same index.

use glam::{Vec2, Vec3};
use hashbrown::{DefaultHashBuilder, HashTable};
use std::hash::BuildHasher;

/// Assigns indices to vectors of `N` components. Bit-equal vectors get the same index, a new vector
/// gets the next index.
#[derive(Clone, Debug, Default)]
pub struct Welder<V = Vec3, const N: usize = 3> {
    /// Distinct vectors by index, in the order of their first appearance.
    pub values: Vec<V>,
    table: Known,
}

/// Lookup table of a [`Welder`], from vectors to their indices in [`Welder::values`].
/// [`Welder::weld_to`] exchanges it. The default table is empty.
#[derive(Clone, Debug, Default)]
pub struct Known {
    indices: HashTable<u32>,
    /// Random, so that no file can be made whose vectors collide.
    seed: DefaultHashBuilder,
}

impl<V: Copy + Into<[f32; N]>, const N: usize> Welder<V, N> {
    fn place(&mut self, value: V) -> u32 {
        let bits = |value: V| value.into().map(f32::to_bits);
        let (key, next) = (bits(value), self.values.len() as u32);
        let of_index = |index: &u32| self.values.get(*index as usize).copied().map(bits);
        let Known { indices, seed } = &mut self.table;
        let is_equal = |index: &u32| of_index(index) == Some(key);
        let hash = |index: &u32| of_index(index).map_or(0, |bits| seed.hash_one(bits));
        let entry = indices.entry(seed.hash_one(key), is_equal, hash);
        let index = *entry.or_insert(next).get();
        if index == next {
            self.values.push(value);
        }
        index
    }
}

impl Welder {
    /// Replaces the lookup table with `table` and returns the previous table;
    /// [`values`](Self::values) stay. A part that moves by itself is welded with a table of its
    /// own, so that it shares no vectors with other parts.
    pub fn weld_to(&mut self, table: Known) -> Known {
        std::mem::replace(&mut self.table, table)
    }

    /// Returns the index of a vector in [`values`](Self::values), where it is added if it is new.
    /// −0 is stored as 0.
    pub fn index(&mut self, value: Vec3) -> u32 {
        self.place(value + Vec3::ZERO) // −0 + 0 = 0
    }
}

/// Welder for pairs of texture coordinates.
pub type UvWelder = Welder<Vec2, 2>;

impl UvWelder {
    /// Returns the index of a pair in [`values`](Self::values), where it is added if it is new. A
    /// pair that is not finite counts as (0, 0).
    pub fn index(&mut self, value: Vec2) -> u32 {
        self.place(if value.is_finite() { value } else { Vec2::ZERO })
    }
}
