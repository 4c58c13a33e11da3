//! Buffers that grow: after a frame the counter says how many items it would have needed.

use super::{executor::Executor, replan::ReplanReport, watch::Watch};
use crate::{
    error::{ExecuteError, poll},
    provider::Provider,
};

impl Executor {
    /// Makes buffers with `grow` larger that were too small for a frame that is done; call it
    /// between frames. It never waits: a counter that has not arrived is looked at the next time.
    /// `None` if there was nothing to do. Where the memory limit or the device refuses larger
    /// buffers, what the document does for items that have no room holds, and nothing is tried
    /// until the plan changes otherwise.
    ///
    /// # Errors
    /// If the device was lost, or a provided resource that has changed cannot be built. The
    /// executor is as it was then, and the next frame asks again.
    pub fn grow(
        &mut self,
        provider: &mut dyn Provider,
    ) -> Result<Option<ReplanReport>, ExecuteError> {
        if !self.state.watches.iter().any(Watch::is_mapping) {
            return Ok(None);
        }
        poll(&self.device, wgpu::PollType::Poll)?;
        let mut grown = self.plan().grown().clone();
        let mut is_new = false;
        for watch in &mut self.state.watches {
            if let Some(wanted) = watch.wanted() {
                grown.insert(watch.name.clone(), wanted);
                is_new = true;
            }
        }
        if !is_new {
            return Ok(None);
        }
        let larger = self.plan().with(|request| request.grown = grown);
        let report = match larger {
            Ok(plan) => self.replace_graph(plan, provider),
            // The host's limit for memory.
            Err(diagnostics) => Err(diagnostics.into()),
        };
        match report {
            Err(
                ExecuteError::Plan(_)
                | ExecuteError::OutOfMemory { .. }
                | ExecuteError::Resource { .. }
                | ExecuteError::Gpu { .. },
            ) => {
                self.state.watches.clear();
                Ok(None)
            }
            report => report.map(Some),
        }
    }
}
