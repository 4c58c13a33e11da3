//! Changes of params that affect only uniforms: another value needs other bytes, but no other plan.

use crate::link::{Block, LinkedPass, pass::block_mut};

/// Writes the value of a param, as words, into the `params` uniforms of all passes. Returns an
/// entry for each pass: true if its bytes changed.
pub(super) fn write(passes: &mut [LinkedPass], name: &str, words: &[u32]) -> Vec<bool> {
    let mut changed = vec![false; passes.len()];
    for (pass, changed) in passes.iter_mut().zip(&mut changed) {
        for step in &mut pass.steps {
            *changed |= block_mut(step).is_some_and(|block| set(block, name, words));
        }
    }
    changed
}

/// Writes the value of a param, as words, to every place that it has in the uniform. Returns true
/// if any byte changed.
fn set(block: &mut Block, name: &str, words: &[u32]) -> bool {
    let offsets = block.params.iter().filter(|(param, _)| param == name);
    let offsets: Vec<usize> = offsets.map(|(_, offset)| *offset).collect();
    let mut changed = false;
    for offset in offsets {
        changed |= block.write(offset, words);
    }
    changed
}
