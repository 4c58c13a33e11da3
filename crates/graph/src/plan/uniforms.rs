//! Changes of params that affect only uniforms: another value needs other bytes, but no other plan.

use crate::link::{LinkedPass, pass::block_mut};

/// Writes the value of a param, as words, into the `params` uniforms of all passes. Returns an
/// entry for each pass: true if its bytes changed.
pub(super) fn write(passes: &mut [LinkedPass], name: &str, words: &[u32]) -> Vec<bool> {
    let write = |pass: &mut LinkedPass| {
        let mut changed = false;
        for block in pass.steps.iter_mut().filter_map(block_mut) {
            changed |= block.set(name, words);
        }
        changed
    };
    passes.iter_mut().map(write).collect()
}
