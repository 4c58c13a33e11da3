//! Resources that a graph does not make itself, built when a live pass binds them.

use skiagraph_graph::{Describe, NoProvider};

/// Gives what a graph does not make itself: scene buffers, camera and light uniforms, acceleration
/// structures. [`Describe`] describes them, which needs no device.
pub trait Provider: Describe {
    /// Counts the changes of what stands behind a name.
    /// [`Executor::refresh`](crate::Executor::refresh) builds anew what has another version than
    /// before.
    fn version(&self, name: &str) -> u64 {
        let _ = name;
        0
    }

    /// Names the part that the host has to set before a resource can be built; `None` if it can be
    /// built now. Executors are made without what is missing, [`refresh`](crate::Executor::refresh)
    /// asks again, and until it is there `encode` fails with these words, in passes that read it.
    fn missing(&self, name: &str) -> Option<String> {
        let _ = name;
        None
    }

    /// Builds the buffer, or hands out the one built before. Frames that are encoded and not yet
    /// submitted read what it holds when they are submitted: a provider whose executors may be
    /// encoded for one submission hands out another buffer for another content. Called only for
    /// names that a live pass binds. The buffer needs the
    /// [usages](skiagraph_graph::ProvidedBinding::usages) that it is described with; `COPY_SRC`
    /// where it may be saved, or read as it was in the frame before.
    ///
    /// # Errors
    /// Why it cannot be built.
    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError>;

    /// Builds what is described as
    /// [`ACCELERATION_STRUCTURE`](skiagraph_graph::Provided::ACCELERATION_STRUCTURE), or hands out
    /// the one built before, its build submitted to the queue. Called only for names that a live
    /// pass binds, on devices with `EXPERIMENTAL_RAY_QUERY`.
    ///
    /// # Errors
    /// Why it cannot be built; that of a provider that describes none, if it has no such function.
    fn build_acceleration_structure(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Tlas, ProviderError> {
        let _ = (device, queue);
        Err(ProviderError(format!(
            "this provider builds no acceleration structure `{name}`"
        )))
    }
}

/// Why a provided resource could not be built.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub struct ProviderError(pub String);

impl From<String> for ProviderError {
    fn from(why: String) -> Self {
        Self(why)
    }
}

impl Provider for NoProvider {
    fn build(
        &mut self,
        name: &str,
        _: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        Err(ProviderError(format!("`{name}` is not provided")))
    }
}
