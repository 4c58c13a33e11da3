//! Gives bit-equal vectors one index.

use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Vectors met so far, each once, in the order of their first appearance.
#[derive(Clone, Debug, Default)]
pub struct Welder {
    /// The vectors.
    pub values: Vec<Vec3>,
    by_bits: HashMap<[u32; 3], u32>,
}

/// Vectors to which others are welded.
#[derive(Clone, Debug, Default)]
pub struct Known(HashMap<[u32; 3], u32>);

impl Welder {
    /// Welds to other vectors from now on, and returns those that were known before: a part that
    /// moves by itself shares none with others.
    pub fn weld_to(&mut self, known: Known) -> Known {
        Known(std::mem::replace(&mut self.by_bits, known.0))
    }

    /// Index of a vector; −0 counts (and is stored) as 0.
    pub fn index(&mut self, value: Vec3) -> u32 {
        let value = value + Vec3::ZERO; // −0 + 0 = 0
        let next = self.values.len() as u32;
        let index = *self
            .by_bits
            .entry(value.to_array().map(f32::to_bits))
            .or_insert(next);
        if index == next {
            self.values.push(value);
        }
        index
    }
}

/// The same of texture coordinates.
#[derive(Clone, Debug, Default)]
pub struct UvWelder {
    /// The coordinates.
    pub values: Vec<Vec2>,
    by_bits: HashMap<[u32; 2], u32>,
}

impl UvWelder {
    /// Index of a pair; one that is not finite counts as (0, 0).
    pub fn index(&mut self, value: Vec2) -> u32 {
        let value = if value.is_finite() { value } else { Vec2::ZERO };
        let next = self.values.len() as u32;
        let key = value.to_array().map(f32::to_bits);
        let index = *self.by_bits.entry(key).or_insert(next);
        if index == next {
            self.values.push(value);
        }
        index
    }
}
