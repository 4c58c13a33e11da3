//! The next graph, made ready on another thread: its shader modules and pipelines, which take most
//! of the time. Parts that depend on existing memory are made when it is put in.

use crate::{
    error::{ExecuteError, named, scoped},
    pipelines::pipelines::{Pipelines, same_pipeline},
    presence::Presence,
};
use skiagraph_graph::{Ids, Plan, step::Step};
use std::collections::HashMap;

/// Parts of an executor that its next graph can use: from
/// [`Executor::preparer`](super::Executor::preparer), for another thread.
pub struct Preparer {
    pub(super) device: wgpu::Device,
    pub(super) pipelines: Pipelines,
    /// The steps of the passes that there are, which have pipelines.
    pub(super) known: HashMap<String, Vec<Step<Ids>>>,
}

/// A plan with its pipelines, for [`Executor::replace`](super::Executor::replace).
pub struct Prepared {
    pub(super) plan: Plan,
    pub(super) pipelines: Pipelines,
}

impl Preparer {
    /// Makes the shader modules and pipelines of a plan that the executor does not have yet.
    ///
    /// # Errors
    /// The device refuses a step, named with its pass and place, or it is lost.
    pub fn prepare(self, plan: Plan) -> Result<Prepared, ExecuteError> {
        let Self {
            device,
            mut pipelines,
            known,
        } = self;
        Presence::new(&device)?;
        for pass in plan.live() {
            let old = known.get(pass.name.as_str());
            let is_new = |(at, step): (usize, _)| {
                let before = old.and_then(|old| old.get(at));
                let serves = before.is_some_and(|before| same_pipeline(before, step));
                (!serves).then_some(step)
            };
            let steps = pass.steps.iter().enumerate().map(is_new);
            scoped(&device, &pass.name, || {
                pipelines.prepare(&device, &pass.name, steps);
            })
            .map_err(|error| named(error, &pass.name, &pass.name.span.to_string()))?;
        }
        Ok(Prepared { plan, pipelines })
    }
}

impl std::fmt::Debug for Preparer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Preparer").finish_non_exhaustive()
    }
}

impl std::fmt::Debug for Prepared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Prepared")
            .field("plan", &self.plan)
            .finish_non_exhaustive()
    }
}
