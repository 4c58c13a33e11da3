//! Prepares the next plan on another thread: its shader modules and pipelines, which take most of
//! the time. Bindings to existing memory are made later, when the plan is put in.

use crate::error::{ExecuteError, with_table};
use crate::pipelines::pipelines::{Pipeline, Pipelines};
use crate::presence::Presence;
use skiagraph_graph::Plan;
use std::sync::Arc;

/// Creates the pipelines of an [`Executor`](super::Executor)'s next plan. It can be sent to another
/// thread, so that the executor goes on drawing. [`Executor::preparer`](super::Executor::preparer)
/// returns one.
#[derive(Debug)]
pub struct Preparer {
    pub(super) pipelines: Pipelines,
}

/// A plan and its finished pipelines: the result of [`Preparer::prepare`], to be passed to
/// [`Executor::replace`](super::Executor::replace).
#[derive(Debug)]
pub struct Prepared {
    pub(super) plan: Plan,
    /// Kept in use until the plan is put in.
    pub(super) pipelines: Vec<Arc<Pipeline>>,
}

impl Preparer {
    /// Creates those shader modules and pipelines of `plan` that the executor's
    /// [`Pipelines`](crate::Pipelines) lack.
    ///
    /// # Errors
    /// If the device refuses a shader or pipeline, or is lost. An error about a pass names the pass
    /// and its place in the graph document.
    pub fn prepare(self, plan: Plan) -> Result<Prepared, ExecuteError> {
        Presence::new(self.pipelines.device()).map_err(|error| with_table(error, &plan))?;
        let pipelines = self.pipelines.of_passes(plan.live());
        let pipelines = pipelines.map_err(|error| with_table(error, &plan))?;
        Ok(Prepared { plan, pipelines })
    }
}
