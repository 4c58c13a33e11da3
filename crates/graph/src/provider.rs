//! Resources that the caller provides: described by name for planning, built only when a live pass binds them.

/// Gives what a graph does not make itself: scene buffers, camera and light uniforms, acceleration structures.
///
/// Names have dots (`scene.positions`); a shader global spells them with underscores (`scene_positions`).
pub trait Provider {
    /// Every name that [`Provider::describe`] knows, for suggestions.
    fn names(&self) -> Vec<String>;

    /// What stands behind a name: enough to plan with. Must be cheap, and must not build anything.
    fn describe(&self, name: &str) -> Option<Provided>;

    /// Builds the buffer, or hands out the one built before. Called only for names that a live pass binds. The buffer needs
    /// the usage `UNIFORM` if it is described as uniform, else `STORAGE`; `COPY_SRC` where it may be saved.
    ///
    /// # Errors
    /// Why it cannot be built.
    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError>;
}

/// Description of a provided buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Provided {
    /// Number of items, where it is known without building.
    pub items: Option<u64>,
    /// Bytes per item; of a uniform, its whole size.
    pub stride: u64,
    /// Bound as `var<uniform>` rather than as read-only storage.
    pub uniform: bool,
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

/// Provides nothing: for graphs that need no scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProvider;

impl Provider for NoProvider {
    fn names(&self) -> Vec<String> {
        Vec::new()
    }

    fn describe(&self, _: &str) -> Option<Provided> {
        None
    }

    fn build(
        &mut self,
        name: &str,
        _: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        Err(ProviderError(format!(
            "nothing is provided under the name `{name}`"
        )))
    }
}
