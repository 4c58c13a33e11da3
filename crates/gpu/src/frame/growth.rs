//! Buffers and textures that grow: after a frame, a counter says how many items or layers it
//! needed.

use crate::provider::{Provider, ProviderError};
use skiagraph_graph::{Describe, Provided};
use std::collections::BTreeMap;

/// Provider for a change of plan in which no provided resource has changed. It holds by name the
/// version that the executor has, or the missing part.
pub(super) struct Unchanged(pub BTreeMap<String, Result<u64, String>>);

impl Describe for Unchanged {
    fn names(&self) -> Vec<String> {
        self.0.keys().cloned().collect()
    }

    /// Returns `None`: the plan's descriptions still hold.
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
        Err(ProviderError::new(format!("`{name}` was there before")))
    }
}
