//! Resources that the host builds for a graph, such as scene buffers.

use crate::identity::DeviceIdentity;
use skiagraph_graph::{Describe, NoProvider};
use std::error::Error;
use std::fmt::{self, Debug};
use std::sync::Arc;

/// Builds the resources that a graph expects from its host program: scene buffers, camera and light
/// uniforms, acceleration structures. The supertrait [`Describe`] describes them without a device.
/// An [`Executor`](crate::Executor) calls these methods with names that [`Describe::names`] lists.
pub trait Provider: Describe {
    /// Returns the version of the resource `name`: a number that changes whenever its content or
    /// buffer does. [`Executor::refresh`](crate::Executor::refresh) rebuilds the resources whose
    /// version has changed. The default implementation returns 0 for every name, so a built
    /// resource is never rebuilt.
    fn version(&self, name: &str) -> u64 {
        let _ = name;
        0
    }

    /// Returns true if each change of a resource's content or buffer changes its
    /// [version](Self::version), or is told by [`Executor::touch`](crate::Executor::touch);
    /// [`CpuWork`] that would give other results counts as changed, too. An executor then encodes
    /// no passes in frames that would compute the same again (see
    /// [`Executor::encode`](crate::Executor::encode)). The default implementation returns false, as
    /// a host may write into a buffer behind its provider. A provider around another one must hand
    /// the call on.
    fn has_versions(&self) -> bool {
        false
    }

    /// Returns the device that the built resources are on; `None`, the default, if there are none
    /// yet, or the provider does not know. Executors on another device refuse the provider by
    /// [`ExecuteError::OtherDevice`](crate::ExecuteError::OtherDevice). Of a provider that does not
    /// know, each buffer that it builds is looked at. A provider around another one must hand the
    /// call on.
    fn device(&self) -> Option<&DeviceIdentity> {
        None
    }

    /// Returns the reason, as text, why the resource `name` cannot be built yet, for example
    /// because the host has to set something first; `None`, the default, if it can be built now. An
    /// executor is created without missing resources, and [`refresh`](crate::Executor::refresh)
    /// asks for them again. Until then [`encode`](crate::Executor::encode) fails with the returned
    /// text if a pass that reads the resource runs.
    fn missing(&self, name: &str) -> Option<String> {
        let _ = name;
        None
    }

    /// Builds the buffer of the resource `name`, or returns the buffer built before. It is called
    /// only for names that a [live](skiagraph_graph#terms) pass binds. The buffer needs the
    /// [usages](skiagraph_graph::ProvidedBinding::usages) of its description's binding, and
    /// `COPY_SRC` if it may be read back, is read as `.previous` (as it was in the frame before) or
    /// by a pass that works on the CPU. It holds at least the described number of items. If it is
    /// larger, a shader that binds all of it sees the rest, too: `arrayLength` counts it, while
    /// numbers in the document, such as `scene.indices.count`, do not.
    ///
    /// The commands that fill the buffer are submitted before this method returns, or by
    /// [`submit_built`](Self::submit_built). A frame reads the content that the buffer has when the
    /// frame is submitted. A provider that changes a content while encoded frames wait for
    /// submission must return a new buffer for it, unless it records the change into the host's
    /// encoder between these frames.
    ///
    /// # Errors
    /// If the resource cannot be built; the executor reports
    /// [`ExecuteError::Provider`](crate::ExecuteError::Provider).
    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError>;

    /// Writes the content of the uniform `name`, which is small, into `content`, which has as many
    /// bytes as [`Describe::describe`] says, and returns true. The executor then does not call
    /// [`build`](Self::build): it keeps the uniform in a buffer of its own, which the commands of
    /// each frame fill with the content of the last [`refresh`](crate::Executor::refresh). So
    /// another content needs no new buffer, and nothing is bound anew. It is called only for names
    /// that a [live](skiagraph_graph#terms) pass binds, when their [version](Self::version) has
    /// changed; [`touch`](crate::Executor::touch) does not ask for the bytes again. The default
    /// implementation returns false: the resource is built. A provider around another one should
    /// hand the call on.
    ///
    /// # Errors
    /// If the content cannot be computed; the executor reports
    /// [`ExecuteError::Provider`](crate::ExecuteError::Provider).
    fn write_uniform(&mut self, name: &str, content: &mut [u8]) -> Result<bool, ProviderError> {
        let _ = (name, content);
        Ok(false)
    }

    /// Builds the top-level acceleration structure of the resource `name`, which
    /// [`Describe::describe`] describes as
    /// [`ACCELERATION_STRUCTURE`](skiagraph_graph::Provided::ACCELERATION_STRUCTURE), or returns
    /// the structure built before. The commands that build it must be submitted to `queue` before
    /// this method returns, or be in the host's encoder before the frame's. It is called only for
    /// names that a [live](skiagraph_graph#terms) pass binds, on devices with
    /// `EXPERIMENTAL_RAY_QUERY`.
    ///
    /// # Errors
    /// If the structure cannot be built. The default implementation always fails.
    fn build_acceleration_structure(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Tlas, ProviderError> {
        let _ = (device, queue);
        Err(ProviderError::new(format!(
            "this provider builds no acceleration structure `{name}`"
        )))
    }

    /// Submits the commands that [`build`](Self::build) has recorded and not submitted, such as
    /// copies into the buffers that it returned. An executor calls it once after it has asked for
    /// all resources, also if one of them failed. So what is recorded for several resources is one
    /// submission. The default implementation does nothing: it is that of providers whose `build`
    /// submits by itself. A provider around another one must hand the call on.
    ///
    /// # Errors
    /// If the commands are refused. The executor then asks for all these resources again at the
    /// next [`refresh`](crate::Executor::refresh); until then they count as
    /// [missing](Self::missing).
    fn submit_built(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<(), ProviderError> {
        let _ = (device, queue);
        Ok(())
    }

    /// Makes the work for the CPU of the resource `name`, which [`Describe::describe`] describes as
    /// [`CPU_WORK`](skiagraph_graph::Provided::CPU_WORK), or returns the work made before.
    ///
    /// # Errors
    /// If the work cannot be made. The default implementation always fails.
    fn build_cpu_work(&mut self, name: &str) -> Result<Arc<dyn CpuWork>, ProviderError> {
        Err(ProviderError::new(format!(
            "this provider has no work for the CPU `{name}`"
        )))
    }
}

/// Work that the CPU does in the middle of a frame: [`Executor::submit`](crate::Executor::submit)
/// calls it for passes with a [`CpuCall`](skiagraph_graph::step::CpuCall).
pub trait CpuWork: Debug + Send + Sync {
    /// Does the task that `entry` names
    /// ([`CpuCall::entry`](skiagraph_graph::step::CpuCall::entry)). `reads` has the bytes of the
    /// items of each buffer that the call reads, in the order of
    /// [`CpuCall::reads`](skiagraph_graph::step::CpuCall::reads). `writes` is for the items of the
    /// buffer that the call writes, and zero at first. `writes` and each of `reads` hold the same
    /// number of items, at least 1.
    ///
    /// # Errors
    /// If the work cannot be done; the executor reports
    /// [`ExecuteError::CpuWork`](crate::ExecuteError::CpuWork).
    fn run(&self, entry: &str, reads: &[&[u8]], writes: &mut [u8]) -> Result<(), ProviderError>;
}

/// Reason why a [`Provider`] could not build a resource, or why [`CpuWork`] failed: a text for the
/// user, and the error that caused it, if there is one.
#[derive(Clone, Debug)]
pub struct ProviderError {
    why: String,
    source: Option<Arc<dyn Error + Send + Sync>>,
}

impl ProviderError {
    /// Creates the error from a text for the user.
    pub fn new(why: impl Into<String>) -> Self {
        Self {
            why: why.into(),
            source: None,
        }
    }

    /// Creates the error from `error`, which becomes its [source](Error::source); both have the
    /// same text.
    pub fn from_error(error: impl Error + Send + Sync + 'static) -> Self {
        Self {
            why: error.to_string(),
            source: Some(Arc::new(error)),
        }
    }
}

impl fmt::Display for ProviderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.why)
    }
}

// By hand, since a derived one would give the `Arc` as the source.
impl Error for ProviderError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        let source = self.source.as_deref()?;
        Some(source)
    }
}

impl From<String> for ProviderError {
    fn from(why: String) -> Self {
        Self::new(why)
    }
}

impl From<&str> for ProviderError {
    fn from(why: &str) -> Self {
        Self::new(why)
    }
}

impl Provider for NoProvider {
    fn build(
        &mut self,
        name: &str,
        _: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        Err(ProviderError::new(format!("`{name}` is not provided")))
    }
}
