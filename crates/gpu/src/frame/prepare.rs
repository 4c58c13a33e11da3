//! Prepares the next plan on another thread: its shader modules and pipelines, which take most of
//! the time. Bindings to existing memory are made later, when the plan is put in.

use crate::{
    error::{ExecuteError, named, scoped},
    pipelines::pipelines::{Pipelines, same_pipeline},
    presence::Presence,
};
use skiagraph_graph::{Ids, Plan, step::Step};
use std::collections::HashMap;

/// Creates the pipelines of an [`Executor`](super::Executor)'s next plan. It can be sent to another
/// thread, so that the executor goes on drawing. [`Executor::preparer`](super::Executor::preparer)
/// returns one.
pub struct Preparer {
    pub(super) device: wgpu::Device,
    pub(super) pipelines: Pipelines,
    /// Steps of each pass of the executor's plan, by pass name; their pipelines exist already.
    pub(super) known: HashMap<String, Vec<Step<Ids>>>,
}

/// A plan and its finished pipelines: the result of [`Preparer::prepare`], to be passed to
/// [`Executor::replace`](super::Executor::replace).
pub struct Prepared {
    pub(super) plan: Plan,
    pub(super) pipelines: Pipelines,
}

impl Preparer {
    /// Creates those shader modules and pipelines of `plan` that the executor did not have when
    /// [`Executor::preparer`](super::Executor::preparer) was called.
    ///
    /// # Errors
    /// If the device refuses a shader or pipeline, or is lost. An error about a pass names the pass
    /// and its place in the graph document.
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
