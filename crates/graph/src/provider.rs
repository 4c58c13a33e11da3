//! Resources that a graph does not make itself, described by name for planning. (The GPU crate
//! builds them.)

use crate::{document::materials::Filter, provided_kind::ProvidedKind};
use std::collections::BTreeMap;

/// Describes what a graph does not make itself: scene buffers, camera and light uniforms,
/// acceleration structures.
///
/// Names have dots (`scene.positions`); a shader global spells them with underscores
/// (`scene_positions`).
pub trait Describe {
    /// Every name that [`Describe::describe`] knows, for suggestions.
    fn names(&self) -> Vec<String>;

    /// Describes the resource behind a name: enough to plan with. Must be cheap, and must not build
    /// anything.
    fn describe(&self, name: &str) -> Option<Provided>;
}

/// Description of a provided buffer or acceleration structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Provided {
    /// Number of items, where it is known without building.
    pub items: Option<u64>,
    /// Bytes per item; of a uniform, its whole size; 0 of what is no buffer.
    pub stride: u64,
    /// How shaders may bind it.
    pub binding: ProvidedBinding,
    /// Which of several kinds it is, where plans depend on that.
    pub kind: Option<ProvidedKind>,
}

impl Provided {
    /// Resource that shaders see as `acceleration_structure`.
    pub const ACCELERATION_STRUCTURE: Self = Self {
        items: None,
        stride: 0,
        binding: ProvidedBinding::AccelerationStructure,
        kind: None,
    };
}

/// How shaders may bind what is provided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProvidedBinding {
    /// `var<uniform>`.
    Uniform,
    /// `var<storage, read>`.
    Storage,
    /// Either: an array whose items can be bound alone, as `lights[2]`.
    Both,
    /// `acceleration_structure`, which ray queries ask: no buffer.
    AccelerationStructure,
}

impl ProvidedBinding {
    /// The usages that the buffer is made with; none of what is no buffer.
    pub fn usages(self) -> wgt::BufferUsages {
        match self {
            Self::Uniform => wgt::BufferUsages::UNIFORM,
            Self::Storage => wgt::BufferUsages::STORAGE,
            Self::Both => wgt::BufferUsages::UNIFORM | wgt::BufferUsages::STORAGE,
            Self::AccelerationStructure => wgt::BufferUsages::empty(),
        }
    }
}

/// Description of what the host hands over for an input of the root document. Its content is there
/// before the first pass; a pass that writes it is never left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Import {
    /// A texture.
    Texture {
        /// Format.
        format: wgt::TextureFormat,
        /// Width and height of mip 0, texels.
        size: [u32; 2],
        /// Number of mips.
        mips: u32,
        /// Number of layers, or of slices of a 3D texture.
        layers: u32,
        /// True for a 3D texture.
        is_3d: bool,
        /// Samples of each texel.
        samples: u32,
        /// Usages that it was made with.
        usage: wgt::TextureUsages,
    },
    /// A buffer.
    Buffer {
        /// Size in bytes.
        bytes: u64,
        /// Number of items, where a pass is dispatched over them or counts them.
        items: Option<u64>,
        /// Usages that it was made with.
        usage: wgt::BufferUsages,
    },
    /// A sampler.
    Sampler {
        /// Filtering of the sampler.
        filter: Filter,
        /// True if it compares.
        compare: bool,
    },
}

impl std::fmt::Debug for dyn Describe + '_ {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Describe").field(&self.names()).finish()
    }
}

/// Describes what another provider described, for plans that are made again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Described(pub BTreeMap<String, Provided>);

impl Described {
    pub fn by(provider: &dyn Describe) -> Self {
        let describe = |name: String| provider.describe(&name).map(|provided| (name, provided));
        Self(provider.names().into_iter().filter_map(describe).collect())
    }
}

impl Describe for Described {
    fn names(&self) -> Vec<String> {
        self.0.keys().cloned().collect()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        self.0.get(name).copied()
    }
}

/// Provides nothing: for graphs that need no scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProvider;

impl Describe for NoProvider {
    fn names(&self) -> Vec<String> {
        Vec::new()
    }

    fn describe(&self, _: &str) -> Option<Provided> {
        None
    }
}
