//! Descriptions, for planning, of the resources that a graph does not make itself. (The GPU crate
//! builds these resources.)

use crate::{document::materials::Filter, provided_kind::ProvidedKind};
use std::collections::BTreeMap;

/// Source of descriptions of the resources that the host's renderer makes and a graph only reads:
/// scene buffers, camera and light uniforms, acceleration structures, work for the CPU.
///
/// Names have dots, such as `scene.positions`. A shader's global has underscores in their place:
/// `scene_positions`.
pub trait Describe {
    /// Returns every name that [`Describe::describe`] knows. Error messages suggest names from this
    /// list.
    fn names(&self) -> Vec<String>;

    /// Describes the resource `name` as far as planning needs; `None` if the name is unknown.
    /// Called often: it must be cheap and build nothing.
    fn describe(&self, name: &str) -> Option<Provided>;
}

/// Description of a provided buffer, acceleration structure or work for the CPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Provided {
    /// Number of items of the buffer; `None` if it is not known before the buffer is built.
    pub items: Option<u64>,
    /// Size in bytes of one item, or of the whole buffer for a uniform; 0 for what is not a
    /// buffer.
    pub stride: u64,
    /// Ways in which shaders may bind the resource.
    pub binding: ProvidedBinding,
    /// Kind of a resource that comes in several kinds, such as the kind of a light; `None` for a
    /// resource without kinds.
    pub kind: Option<ProvidedKind>,
}

impl Provided {
    /// Description of an acceleration structure, which shaders declare as `acceleration_structure`.
    pub const ACCELERATION_STRUCTURE: Self = Self {
        items: None,
        stride: 0,
        binding: ProvidedBinding::AccelerationStructure,
        kind: None,
    };

    /// Description of work for the CPU, which a [`CpuCall`](crate::step::CpuCall) calls and no
    /// shader can bind.
    pub const CPU_WORK: Self = Self {
        binding: ProvidedBinding::CpuWork,
        ..Self::ACCELERATION_STRUCTURE
    };
}

/// Ways in which shaders may bind a provided resource ([`Provided`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProvidedBinding {
    /// As `var<uniform>`, the whole buffer.
    Uniform,
    /// As `var<storage, read>`.
    Storage,
    /// As `var<storage, read>` for a whole array, or as `var<uniform>` for one of its items, such
    /// as `lights[2]`.
    Both,
    /// As `acceleration_structure`, for ray queries. The resource is not a buffer.
    AccelerationStructure,
    /// By no shader: a [`CpuCall`](crate::step::CpuCall) calls it. The resource is not a buffer.
    CpuWork,
}

impl ProvidedBinding {
    /// Returns the usages that the buffer must be created with; empty for what is not a buffer.
    pub fn usages(self) -> wgt::BufferUsages {
        match self {
            Self::Uniform => wgt::BufferUsages::UNIFORM,
            Self::Storage => wgt::BufferUsages::STORAGE,
            Self::Both => wgt::BufferUsages::UNIFORM | wgt::BufferUsages::STORAGE,
            Self::AccelerationStructure | Self::CpuWork => wgt::BufferUsages::empty(),
        }
    }
}

/// Description of a texture, buffer or sampler that the host hands over for an input of the loaded
/// document. The resource has content before the first pass runs. A pass that writes it is never
/// culled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Import {
    /// A texture.
    Texture {
        /// Format of the texels.
        format: wgt::TextureFormat,
        /// Width and height of mip 0 in texels.
        size: [u32; 2],
        /// Number of mip levels.
        mips: u32,
        /// Number of array layers, or of slices of mip 0 of a 3D texture.
        layers: u32,
        /// True for a 3D texture.
        is_3d: bool,
        /// Number of samples of each texel; 1 without multisampling.
        samples: u32,
        /// Usages that the texture was created with.
        usage: wgt::TextureUsages,
    },
    /// A buffer.
    Buffer {
        /// Size in bytes.
        bytes: u64,
        /// Number of items; may be `None` unless a pass is dispatched over the items or an
        /// expression asks for their `count`.
        items: Option<u64>,
        /// Usages that the buffer was created with.
        usage: wgt::BufferUsages,
    },
    /// A sampler.
    Sampler {
        /// Filter of the sampler.
        filter: Filter,
        /// True for a comparison sampler.
        compare: bool,
    },
}

impl std::fmt::Debug for dyn Describe + '_ {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Describe").field(&self.names()).finish()
    }
}

/// Copy of the descriptions of another provider, by name, with which a plan is made again.
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

/// A provider ([`Describe`]) without resources, for graphs that need no scene, camera or light.
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
