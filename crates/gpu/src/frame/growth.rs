//! Buffers and textures that grow: after a frame the counter says how many items or layers it would
//! have needed.

use super::{executor::Executor, growth_readback::GrowthReadback, replan::ReplanReport};
use crate::{
    error::{ExecuteError, poll},
    provider::{Provider, ProviderError},
};
use skiagraph_graph::{Describe, Plan, Provided};
use std::collections::BTreeMap;

/// Stands for the provider where nothing of its has changed: by name, the version that the executor
/// has, or what is missing.
struct Unchanged(BTreeMap<String, Result<u64, String>>);

impl Executor {
    /// Makes buffers and textures larger that have `grow` and were too small for a frame that is
    /// done, as the next [`encode`](Self::encode) would do; for a host that wants the new plan at a
    /// time of its own, or to know of it. It never waits: a counter that has not arrived is looked
    /// at the next time. `None` if there was nothing to do. Where the memory limit or the device
    /// refuses more, what the document does for items that have no room holds, and nothing is tried
    /// until the plan changes otherwise.
    ///
    /// # Errors
    /// If the device was lost, or a provided resource that has changed cannot be built. The
    /// executor is as it was then, and the next frame asks again.
    pub fn grow(
        &mut self,
        provider: &mut dyn Provider,
    ) -> Result<Option<ReplanReport>, ExecuteError> {
        if !self
            .state
            .growth_readbacks
            .iter()
            .any(GrowthReadback::is_asked)
        {
            return Ok(None);
        }
        poll(&self.device, wgpu::PollType::Poll)?;
        let Some(plan) = self.larger() else {
            return Ok(None);
        };
        let report = self.grow_to(plan, provider)?;
        if report.is_some() {
            self.note_changes(provider);
        }
        Ok(report)
    }

    /// The same with what the executor has of the provider, by the counters that submissions have
    /// brought.
    pub(super) fn grow_by_itself(&mut self) -> Result<(), ExecuteError> {
        let Some(plan) = self.larger() else {
            return Ok(());
        };
        let memory = &self.state.memory;
        let known = memory.provided().map(|(id, version)| {
            let missing = || memory.missing(id).unwrap_or_default().to_owned();
            (
                self.plan().resource(id).name.clone(),
                version.ok_or_else(missing),
            )
        });
        let mut unchanged = Unchanged(known.collect());
        self.grow_to(plan, &mut unchanged).map(drop)
    }

    /// The plan with room for all that frames which are done have asked for; `None` if they had it.
    fn larger(&mut self) -> Option<Result<Plan, ExecuteError>> {
        let growth_readbacks = self.state.growth_readbacks.iter_mut();
        let wanted = growth_readbacks.filter_map(|readback| {
            let wanted = readback.wanted()?;
            Some((readback.name.clone(), wanted))
        });
        let wanted: Vec<(String, u64)> = wanted.collect();
        if wanted.is_empty() {
            return None;
        }
        let mut grown = self.plan().grown().clone();
        grown.extend(wanted);
        let larger = self.plan().with(|request| request.grown = grown);
        // An error is the host's limit for memory.
        Some(larger.map_err(ExecuteError::from))
    }

    fn grow_to(
        &mut self,
        plan: Result<Plan, ExecuteError>,
        provider: &mut dyn Provider,
    ) -> Result<Option<ReplanReport>, ExecuteError> {
        match plan.and_then(|plan| self.put_in(plan, provider)) {
            Err(
                ExecuteError::Plan(_)
                | ExecuteError::OutOfMemory { .. }
                | ExecuteError::Resource { .. }
                | ExecuteError::Gpu { .. },
            ) => {
                self.state.growth_readbacks.clear();
                Ok(None)
            }
            report => report.map(Some),
        }
    }
}

impl Describe for Unchanged {
    fn names(&self) -> Vec<String> {
        self.0.keys().cloned().collect()
    }

    /// Nothing: what the plan says of it holds.
    fn describe(&self, _: &str) -> Option<Provided> {
        None
    }
}

impl Provider for Unchanged {
    fn version(&self, name: &str) -> u64 {
        let known = self.0.get(name).and_then(|known| known.as_ref().ok());
        known.copied().unwrap_or_default()
    }

    fn missing(&self, name: &str) -> Option<String> {
        match self.0.get(name) {
            Some(Ok(_)) => None,
            Some(Err(missing)) => Some(missing.clone()),
            None => Some("call `Executor::refresh`".to_owned()),
        }
    }

    fn build(
        &mut self,
        name: &str,
        _: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        Err(ProviderError(format!("`{name}` was there before")))
    }
}
