//! Params whose values stand in uniforms alone: another value is other bytes, and the same plan.

use super::plan::Plan;
use crate::{
    document::params::{ParamType, ParamValue},
    link::{params::words, pass::Block},
};

impl Plan {
    /// True if a param may have this value without planning anew: it has the type and lies in the
    /// range, and nothing but members of `var<uniform> params` follows from it.
    pub fn is_in_uniforms(&self, name: &str, value: &ParamValue) -> bool {
        self.graph.param(name).is_ok_and(|param| {
            // A document that is included may count its words in another order.
            let is_counted = matches!(param.ty, ParamType::Choice(_));
            !is_counted && !self.depends_on.contains(name) && param.check(value).is_ok()
        })
    }

    /// Gives a param that [`is_in_uniforms`](Self::is_in_uniforms) another value. Returns the
    /// positions in the schedule of the passes that read other bytes now. Other params are left as
    /// they are.
    pub fn set_in_uniforms(&mut self, name: &str, value: ParamValue) -> Vec<usize> {
        let Ok(param) = self.graph.param(name) else {
            return Vec::new();
        };
        if !self.is_in_uniforms(name, &value) {
            return Vec::new();
        }
        let (_, words) = words(param, &value);
        let mut changed = vec![false; self.passes.len()];
        for (pass, changed) in self.passes.iter_mut().zip(&mut changed) {
            for step in &mut pass.steps {
                *changed |= step
                    .block_mut()
                    .is_some_and(|block| set(block, name, &words));
            }
        }
        self.values.insert(name.to_owned(), value.clone());
        self.request.params.insert(name.to_owned(), value);
        let live = self.schedule.passes.iter().enumerate();
        live.filter(|(_, id)| changed[id.0])
            .map(|(position, _)| position)
            .collect()
    }
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
