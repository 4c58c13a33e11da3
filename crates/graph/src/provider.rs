//! Descriptions, for planning, of the resources that a graph does not make itself. (The GPU crate
//! builds these resources.)

use crate::{document::Filter, provided_kind::ProvidedKind};
use std::collections::BTreeMap;

/// Source of descriptions of the resources that the host's renderer makes and a graph only reads:
/// scene buffers, camera and light uniforms, acceleration structures, work for the CPU.
///
/// Names may have dots, such as `scene.positions`; the parts are spelt as a [`Name`](crate::Name),
/// or are numbers of items as below. A shader's global has underscores in the place of the dots:
/// `scene_positions`. A list whose items differ in kind is described as a whole, as `lights` with
/// its number of [items](crate#terms), and item by item as `lights.0`, `lights.1` and so on: a
/// document's `lights[1]` is the resource `lights.1`. Of resources named `scene.…` the flag
/// `changed_scene` of the uniform [`frame`](crate::FRAME_BYTES) tells changes, and `changed_light`
/// of `light`, `lights`, `light_area`, `light_areas` and `scene.light_…`.
pub trait Describe {
    /// Returns every name that [`Describe::describe`] knows. Error messages suggest names from this
    /// list.
    fn names(&self) -> Vec<String>;

    /// Describes the resource `name` as far as planning needs; `None` if the name is unknown.
    /// Called often: it must be cheap and build nothing.
    fn describe(&self, name: &str) -> Option<Provided>;
}

/// Description of a buffer, an acceleration structure or work for the CPU that the host makes and a
/// graph only reads, as [`Describe::describe`] returns it.
///
/// ```
/// use skiagraph_graph::{Provided, ProvidedBinding};
///
/// let light = Provided::new(ProvidedBinding::Uniform, Some(1), 64);
/// assert_eq!((light.stride, light.kind), (64, None));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Provided {
    /// Number of [items](crate#terms) of the buffer; `None` if it is not known before the buffer is
    /// built, and for an acceleration structure.
    pub items: Option<u64>,
    /// Size in bytes of one item of the buffer, or of the whole buffer for one that is bound as a
    /// uniform; 0 for what is not a buffer.
    pub stride: u64,
    /// Ways in which shaders may bind the buffer or acceleration structure.
    pub binding: ProvidedBinding,
    /// Kind of the resource, if it comes in several kinds, as a light does; `None` for a resource
    /// without kinds.
    pub kind: Option<ProvidedKind>,
}

impl Provided {
    /// Description of an acceleration structure, which shaders declare as `acceleration_structure`;
    /// it has no items and no kind.
    pub const ACCELERATION_STRUCTURE: Self = Self {
        items: None,
        stride: 0,
        binding: ProvidedBinding::AccelerationStructure,
        kind: None,
    };

    /// Describes a buffer of items of `stride` bytes, without a kind. `items` is `None` if their
    /// number is not known before the buffer is built.
    pub const fn new(binding: ProvidedBinding, items: Option<u64>, stride: u64) -> Self {
        Self {
            items,
            stride,
            binding,
            kind: None,
        }
    }

    /// Sets [`kind`](Self::kind).
    #[must_use]
    pub const fn with_kind(mut self, kind: ProvidedKind) -> Self {
        self.kind = Some(kind);
        self
    }

    /// Description of work for the CPU, which a [`CpuCall`](crate::step::CpuCall) calls and no
    /// shader can bind; it has no items and no kind.
    pub const CPU_WORK: Self = Self {
        binding: ProvidedBinding::CpuWork,
        ..Self::ACCELERATION_STRUCTURE
    };
}

/// Ways in which shaders may bind a resource that the host's provider describes ([`Provided`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProvidedBinding {
    /// The whole buffer, as `var<uniform>`.
    Uniform,
    /// The whole array or some of its items, as `var<storage, read>`. Items that are bound by
    /// themselves must begin at a multiple of the device's `min_storage_buffer_offset_alignment`.
    Storage,
    /// The whole array or some of its items, as `var<storage, read>`, or one of its items as
    /// `var<uniform>`. An item that is bound by itself must begin at a multiple of the device's
    /// `min_uniform_buffer_offset_alignment` (256 bytes on many), so the [stride](Provided::stride)
    /// must be such a multiple; planning refuses others. Shorter items that are described one by
    /// one, as `lights.2` is, need no such stride: each is a buffer of its own, with the binding
    /// [`Uniform`](Self::Uniform).
    Both,
    /// The whole acceleration structure, as `acceleration_structure`, for ray queries. The resource
    /// is not a buffer.
    AccelerationStructure,
    /// In no way: the resource is work for the CPU, which a [`CpuCall`](crate::step::CpuCall)
    /// calls. It is not a buffer.
    CpuWork,
}

impl ProvidedBinding {
    /// Returns the usages that a buffer needs to be bound in these ways; empty for what is not a
    /// buffer.
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
/// document. The resource has content before the first pass runs. A pass may write it only if the
/// document lists the input as an output, too; such a pass is never culled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Import {
    /// A texture, which the host has created.
    #[non_exhaustive]
    Texture {
        /// Format of the texture's texels.
        format: wgt::TextureFormat,
        /// Width and height of the texture's mip 0 in texels.
        size: [u32; 2],
        /// Number of mip levels, at least 1.
        mips: u32,
        /// Number of array layers, or of slices of mip 0 of a 3D texture; 1 for a plain 2D texture.
        layers: u32,
        /// True for a 3D texture, false for a 2D texture or a 2D array.
        is_3d: bool,
        /// Number of samples of each texel; 1 without multisampling.
        samples: u32,
        /// Usages that the texture was created with. Planning reports an error if a pass needs
        /// others.
        usage: wgt::TextureUsages,
    },
    /// A buffer, which the host has created.
    #[non_exhaustive]
    Buffer {
        /// Size of the buffer in bytes.
        bytes: u64,
        /// Number of [items](crate#terms) of the buffer; may be `None` unless a pass is dispatched
        /// over the items or an expression asks for their `count`.
        items: Option<u64>,
        /// Usages that the buffer was created with. Planning reports an error if a pass needs
        /// others.
        usage: wgt::BufferUsages,
    },
    /// A sampler, which the host has created.
    #[non_exhaustive]
    Sampler {
        /// Filter that the sampler was created with: `Linear` if any of its filters is linear.
        filter: Filter,
        /// True for a comparison sampler, which the document's input must then ask for (`compare:
        /// true`).
        compare: bool,
    },
}

impl Import {
    /// Describes the texture that a descriptor creates.
    pub fn texture<L, V>(descriptor: &wgt::TextureDescriptor<L, V>) -> Self {
        Self::Texture {
            format: descriptor.format,
            size: [descriptor.size.width, descriptor.size.height],
            mips: descriptor.mip_level_count,
            layers: descriptor.size.depth_or_array_layers,
            is_3d: descriptor.dimension == wgt::TextureDimension::D3,
            samples: descriptor.sample_count,
            usage: descriptor.usage,
        }
    }

    /// Describes a 2D texture of one mip, one layer and one sample. `size` is width and height in
    /// texels.
    pub fn plain_texture(
        format: wgt::TextureFormat,
        size: [u32; 2],
        usage: wgt::TextureUsages,
    ) -> Self {
        Self::Texture {
            format,
            size,
            mips: 1,
            layers: 1,
            is_3d: false,
            samples: 1,
            usage,
        }
    }

    /// Describes a buffer of so many bytes. `items` is the number of array items in the buffer;
    /// `None` is enough unless a pass is dispatched over the items or an expression uses their
    /// number.
    pub fn buffer(bytes: u64, items: Option<u64>, usage: wgt::BufferUsages) -> Self {
        Self::Buffer {
            bytes,
            items,
            usage,
        }
    }

    /// Describes a sampler; `compare` is true for a comparison sampler.
    pub fn sampler(filter: Filter, compare: bool) -> Self {
        Self::Sampler { filter, compare }
    }
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
