//! Alpha of vertices under masks: masks that are made for it.

use super::materials::{Cut, Read};
use crate::{mask::Mask, texture::Wrap};
use glam::Vec2;
use std::{collections::HashMap, sync::Arc};

/// The most masks that are made of one file's textures with alphas of vertices.
const MOST_MASKS: usize = 64;

/// Materials of a document, and those that are made of them.
pub(super) struct Materials {
    /// The document's, then the one that stands in where there is none, then those made here.
    pub all: Vec<Read>,
    /// Number of the one that stands in.
    pub plain: usize,
    made: HashMap<(usize, Option<u32>), usize>,
}

/// A triangle's material, and texture coordinates that take the place of its own.
pub(super) type Chosen = (usize, Option<[Vec2; 3]>);

impl Materials {
    pub fn new(mut document: Vec<Read>) -> Self {
        let plain = document.len();
        document.push(Read::default());
        Self {
            all: document,
            plain,
            made: HashMap::new(),
        }
    }

    /// The material of a triangle whose corners have those alphas, under a masked one. `None` where
    /// no mask can be made of both.
    ///
    /// # Errors
    /// The texture cannot be read.
    pub fn with_alpha(
        &mut self,
        material: usize,
        cut: Cut,
        alphas: [f32; 3],
    ) -> Result<Option<Chosen>, String> {
        let [first, ..] = alphas;
        let is_even = alphas.iter().all(|alpha| *alpha == first);
        if is_even && first == 1.0 {
            return Ok(Some((material, None)));
        }
        if self.all[material].material.texture.is_none() {
            return Ok(Some((self.ramp(material), Some(along_ramp(cut, alphas)))));
        }
        let key = (material, Some(first.to_bits()));
        if let Some(&made) = self.made.get(&key).filter(|_| is_even) {
            return Ok(Some((made, None)));
        }
        if !is_even || self.made.len() >= MOST_MASKS {
            return Ok(None);
        }
        let mut own = self.all[material].clone();
        own.material.mask = own.masked(cut, first)?;
        Ok(Some((self.add(key, own), None)))
    }

    /// The material with a mask of two texels, the second one opaque.
    fn ramp(&mut self, material: usize) -> usize {
        let key = (material, None);
        if let Some(&made) = self.made.get(&key) {
            return made;
        }
        let mut own = self.all[material].clone();
        own.material.mask = Some(Arc::new(Mask::new([2, 1], [Wrap::Clamp; 2], |x, _| x == 1)));
        self.add(key, own)
    }

    fn add(&mut self, key: (usize, Option<u32>), read: Read) -> usize {
        self.all.push(read);
        self.made.insert(key, self.all.len() - 1);
        self.all.len() - 1
    }
}

/// Texture coordinates by which the ramp's second texel begins where alpha reaches the cutoff:
/// between the corners both change evenly.
fn along_ramp(cut: Cut, alphas: [f32; 3]) -> [Vec2; 3] {
    let alphas = alphas.map(|alpha| alpha * cut.alpha);
    let are_opaque = alphas.map(|alpha| alpha >= cut.cutoff);
    let at = |u: f32| Vec2::new(u, 0.5);
    match are_opaque {
        [true, true, true] => [at(0.75); 3],
        [false, false, false] => [at(0.25); 3],
        // A cutoff of 0 or less hides nothing, so that one above 0 is left.
        _ => alphas.map(|alpha| at(0.5 * alpha / cut.cutoff)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn a_ramp_cuts_where_alpha_reaches_the_cutoff() {
        let cut = Cut {
            alpha: 0.5,
            cutoff: 0.3,
        };
        let mut materials = Materials::new(vec![Read::default()]);
        let alphas = [0.2, 1.0, 1.0];
        let (made, uvs) = materials.with_alpha(0, cut, alphas).unwrap().unwrap();
        let uvs = uvs.unwrap();
        let mask = materials.all[made].material.mask.clone().unwrap();
        // Never at the cutoff itself, where the answer hangs on rounding.
        for step in 0..=10 {
            let weight = f64::from(step) / 11.0;
            let alpha = 0.5 * (0.2 + weight * 0.8);
            let uv: DVec2 = uvs[0].as_dvec2().lerp(uvs[1].as_dvec2(), weight);
            assert_eq!(mask.ask(uv, DVec2::ZERO).opaque, alpha >= 0.3, "{weight}");
        }
        // All of it is there or hidden, to the bit; the mask is the same one.
        for (alpha, opaque) in [(0.599, false), (0.6001, true)] {
            let (again, uvs) = materials.with_alpha(0, cut, [alpha; 3]).unwrap().unwrap();
            assert_eq!(again, made);
            let uv = uvs.unwrap()[0].as_dvec2();
            assert_eq!(mask.ask(uv, DVec2::ZERO).opaque, opaque);
        }
        assert_eq!(materials.with_alpha(0, cut, [1.0; 3]), Ok(Some((0, None))));
    }
}
