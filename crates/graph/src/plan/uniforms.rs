//! Params whose values stand in uniforms alone: another value is other bytes, and the same plan.

use crate::link::pass::{Block, LinkedPass, block_mut};

/// Writes the words into the uniforms of all passes; true for those that read other bytes now.
pub(super) fn write(passes: &mut [LinkedPass], name: &str, words: &[u32]) -> Vec<bool> {
    let mut changed = vec![false; passes.len()];
    for (pass, changed) in passes.iter_mut().zip(&mut changed) {
        for step in &mut pass.steps {
            *changed |= block_mut(step).is_some_and(|block| set(block, name, words));
        }
    }
    changed
}

/// Writes the words wherever the param stands. True if any byte has changed.
fn set(block: &mut Block, name: &str, words: &[u32]) -> bool {
    let offsets = block.params.iter().filter(|(param, _)| param == name);
    let offsets: Vec<usize> = offsets.map(|(_, offset)| *offset).collect();
    let mut changed = false;
    for offset in offsets {
        changed |= block.write(offset, words);
    }
    changed
}
