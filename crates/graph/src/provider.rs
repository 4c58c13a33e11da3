//! Resources that the caller provides: described by name for planning, built only when a live pass binds them.

use std::collections::BTreeMap;

/// Gives what a graph does not make itself: scene buffers, camera and light uniforms, acceleration structures.
///
/// Names have dots (`scene.positions`); a shader global spells them with underscores (`scene_positions`).
pub trait Provider {
    /// Every name that [`Provider::describe`] knows, for suggestions.
    fn names(&self) -> Vec<String>;

    /// What stands behind a name: enough to plan with. Must be cheap, and must not build anything.
    fn describe(&self, name: &str) -> Option<Provided>;

    /// Counts the changes of what stands behind a name. [`Executor::refresh`](crate::Executor::refresh) builds anew what has
    /// another version than before.
    fn version(&self, name: &str) -> u64 {
        let _ = name;
        0
    }

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

/// Description of a texture or buffer of the host that passes may use by name, as a provided one: `gbuffer.depth` is
/// `gbuffer_depth` in a shader. Its content is there before the first pass; a pass that writes it is never left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Import {
    /// A 2D texture or array.
    Texture {
        /// Format.
        format: wgpu::TextureFormat,
        /// Width and height of mip 0, texels.
        size: [u32; 2],
        /// Number of mips.
        mips: u32,
        /// Number of layers.
        layers: u32,
        /// What it was made for.
        usage: wgpu::TextureUsages,
    },
    /// A buffer.
    Buffer {
        /// Size in bytes.
        bytes: u64,
        /// Number of items, where a pass is dispatched over them or counts them.
        items: Option<u64>,
        /// What it was made for.
        usage: wgpu::BufferUsages,
    },
}

impl Import {
    /// The description of a texture.
    pub fn texture(texture: &wgpu::Texture) -> Self {
        Self::Texture {
            format: texture.format(),
            size: [texture.width(), texture.height()],
            mips: texture.mip_level_count(),
            layers: texture.depth_or_array_layers(),
            usage: texture.usage(),
        }
    }

    /// The description of a buffer; `items` where a pass is dispatched over them.
    pub fn buffer(buffer: &wgpu::Buffer, items: Option<u64>) -> Self {
        Self::Buffer {
            bytes: buffer.size(),
            items,
            usage: buffer.usage(),
        }
    }
}

/// Provides what another provider described, for plans that are made again; builds nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Described(pub BTreeMap<String, Provided>);

impl Described {
    pub fn by(provider: &dyn Provider) -> Self {
        let describe = |name: String| provider.describe(&name).map(|provided| (name, provided));
        Self(provider.names().into_iter().filter_map(describe).collect())
    }
}

impl Provider for Described {
    fn names(&self) -> Vec<String> {
        self.0.keys().cloned().collect()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        self.0.get(name).copied()
    }

    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        NoProvider.build(name, device, queue)
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
