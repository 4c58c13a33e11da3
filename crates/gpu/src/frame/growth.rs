//! Buffers and textures that grow: after a frame, a counter says how many items or layers it
//! needed.

use crate::provider::{Provider, ProviderError};
use skiagraph_graph::{Describe, Plan, Provided};
use std::collections::BTreeMap;

/// Provider for a change of plan in which no provided resource has changed.
pub(super) struct Unchanged {
    /// The plan before, whose descriptions still hold.
    pub plan: Plan,
    /// Version of each resource that the executor has, or the part that is missing to build it.
    pub versions: BTreeMap<String, Result<u64, String>>,
}

impl Describe for Unchanged {
    fn names(&self) -> Vec<String> {
        self.plan.descriptions().names()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        self.plan.descriptions().describe(name)
    }
}

impl Provider for Unchanged {
    fn version(&self, name: &str) -> u64 {
        let version = self.versions.get(name).cloned();
        version.and_then(Result::ok).unwrap_or_default()
    }

    fn missing(&self, name: &str) -> Option<String> {
        match self.versions.get(name) {
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
        Err(ProviderError::new(format!("`{name}` was there before")))
    }
}
