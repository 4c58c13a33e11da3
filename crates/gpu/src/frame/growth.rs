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
        if !self.state.watches.iter().any(Watch::is_asked) {
            return Ok(None);
        }
        poll(&self.device, wgpu::PollType::Poll)?;
        let watches = self.state.watches.iter_mut();
        let wanted = watches.filter_map(|watch| {
            let wanted = watch.wanted()?;
            Some((watch.name.clone(), wanted))
        });
        let wanted: Vec<(String, u64)> = wanted.collect();
        if wanted.is_empty() {
            return Ok(None);
        }
        let mut grown = self.plan().grown().clone();
        grown.extend(wanted);
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
