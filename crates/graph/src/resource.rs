//! Textures, buffers and samplers of a plan, and parts of them.

use crate::{
    document::materials::{Address, Filter},
    picture::Picture,
    provider::Provided,
    source::span::Span,
};
use std::{ops::Range, sync::Arc};

/// Number of a resource of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ResourceId(pub(crate) usize);

impl ResourceId {
    /// The number: resources count from 0.
    pub fn index(self) -> usize {
        self.0
    }
}

/// A texture, buffer or sampler that passes may name.
#[derive(Clone, Debug)]
pub struct Resource {
    /// Its full name.
    pub name: String,
    /// Place where it is declared; resources of the host and a pass's own buffers have none.
    pub declared: Option<Span>,
    /// Kind of the resource.
    pub kind: ResourceKind,
    /// Whose content it holds.
    pub origin: Origin,
    /// How it grows between frames.
    pub growth: Option<Growth>,
    /// True if its content stays from frame to frame until a pass overwrites it.
    pub keep: bool,
}

impl Resource {
    /// One that no document declares.
    pub(crate) fn new(name: String, kind: ResourceKind, origin: Origin) -> Self {
        Self {
            name,
            declared: None,
            kind,
            origin,
            growth: None,
            keep: false,
        }
    }
}

/// Whose content a resource holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The graph's own, made by its passes in every frame.
    Own,
    /// The document's: a file or numbers that stand in it. It is never written.
    Constant,
    /// The host's: an import or a provided resource. It has content before the first pass.
    Host,
    /// Content of another resource at the end of the frame before.
    Previous(ResourceId),
}

/// Kind of a resource.
#[derive(Clone, Debug, PartialEq)]
pub enum ResourceKind {
    /// A texture.
    Texture(Texture),
    /// A buffer.
    Buffer(Buffer),
    /// A sampler.
    Sampler(Sampler),
    /// A buffer of the host's, described before it is built.
    Provided(Provided),
    /// An acceleration structure of the host's.
    AccelerationStructure,
    /// The graph's own uniform `frame`: number, seconds and flags of the frame
    /// (`shared/frame.wgsl`).
    Frame,
}

/// Bytes of the uniform `frame`: index `u32`, seconds `f32`, the flags `changed_scene`,
/// `changed_light` and `fresh`, each a `u32`, and padding.
pub const FRAME_BYTES: u64 = 32;

/// Bytes of its index and seconds, which stand in front of the flags.
pub(crate) const CLOCK_BYTES: u32 = 8;

/// The name under which shaders find the uniform `frame`.
pub(crate) const FRAME: &str = "frame";

impl ResourceKind {
    /// Returns the kind in words, for messages.
    pub(crate) fn describe(&self) -> &'static str {
        match self {
            Self::Texture(_) => "a texture",
            Self::Buffer(_) => "a buffer",
            Self::Sampler(Sampler {
                compare: Some(_), ..
            }) => "a sampler with `compare`",
            Self::Sampler(_) => "a sampler without `compare`",
            Self::Provided(_) => "a provided buffer",
            Self::AccelerationStructure => "an acceleration structure",
            Self::Frame => "the frame's uniform",
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Texture(texture) => texture.bytes(),
            Self::Buffer(buffer) => buffer.bytes,
            _ => 0,
        }
    }
}

/// A 2D texture, an array of such, or a 3D texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Format of its texels.
    pub format: wgt::TextureFormat,
    /// Width and height of mip 0 in texels.
    pub size: [u32; 2],
    /// Layers of an array, or slices of a 3D texture's mip 0.
    pub layers: u32,
    /// True if the layers are slices of a 3D texture.
    pub is_3d: bool,
    /// Mip levels.
    pub mips: u32,
    /// Samples of each texel.
    pub samples: u32,
    /// The picture that it holds.
    pub picture: Option<Picture>,
}

impl Texture {
    /// Width and height of a mip.
    pub fn mip_size(&self, mip: u32) -> [u32; 2] {
        self.size.map(|edge| (edge >> mip).max(1))
    }

    /// Layers of a mip: slices of a 3D texture become fewer.
    pub fn mip_layers(&self, mip: u32) -> u32 {
        if self.is_3d {
            (self.layers >> mip).max(1)
        } else {
            self.layers
        }
    }

    /// Returns the bytes of its texels.
    pub fn bytes(&self) -> u64 {
        let footprint = |format: wgt::TextureFormat| {
            format.theoretical_memory_footprint(wgt::Extent3d::default())
        };
        let texel = footprint(self.format).saturating_mul(u64::from(self.samples));
        // A host's limits may allow for more than 64 bits can count.
        let mip = |level: u32| {
            let edges = self.mip_size(level).map(u64::from);
            [edges[0], edges[1], u64::from(self.mip_layers(level))]
                .into_iter()
                .fold(texel, u64::saturating_mul)
        };
        (0..self.mips).map(mip).fold(0, u64::saturating_add)
    }

    /// All of it.
    pub fn whole(&self) -> SubresourceRange {
        SubresourceRange {
            mips: 0..self.mips,
            layers: 0..self.layers,
            aspect: wgt::TextureAspect::All,
        }
    }
}

/// A buffer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Buffer {
    /// Items of the runtime-sized array, where the document gives them.
    pub count: Option<u64>,
    /// Bytes from one item to the next, known after linking where a shader sees such an array.
    pub stride: u64,
    /// Size, known after linking (item layouts come from WGSL).
    pub bytes: u64,
    /// The numbers that it holds, item by item; bytes are laid out when a shader's type is known.
    pub data: Option<Arc<Vec<Vec<f64>>>>,
    /// The bytes of `data`.
    pub content: Option<Arc<[u8]>>,
}

/// How the items of a buffer or the layers of a texture become more between frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// The buffer, or the item of one, whose first `u32` says how many items or layers the frame
    /// would have needed.
    pub counter: Target,
    /// Most items or layers that the document lets it have.
    pub max: u64,
}

/// A sampler.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampler {
    /// Minification, magnification and mip filter.
    pub filter: Filter,
    /// Addressing in all directions.
    pub address: Address,
    /// Comparison of a comparison sampler.
    pub compare: Option<wgt::CompareFunction>,
}

/// Mips and layers of a texture (slices of a 3D one), or items of a buffer as layers of one mip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SubresourceRange {
    /// Mip levels; `0..1` of a buffer.
    pub mips: Range<u32>,
    /// Layers, slices or items.
    pub layers: Range<u32>,
    /// Depth or stencil of a texture that has both.
    pub aspect: wgt::TextureAspect,
}

impl SubresourceRange {
    /// A buffer, or whatever else has no parts.
    pub(crate) const WHOLE: Self = Self {
        mips: 0..1,
        layers: 0..u32::MAX,
        aspect: wgt::TextureAspect::All,
    };

    /// True if the two have something in common.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        use wgt::TextureAspect::{DepthOnly, StencilOnly};
        let meet = |a: &Range<u32>, b: &Range<u32>| a.start < b.end && b.start < a.end;
        let apart = matches!(
            (self.aspect, other.aspect),
            (DepthOnly, StencilOnly) | (StencilOnly, DepthOnly)
        );
        !apart && meet(&self.mips, &other.mips) && meet(&self.layers, &other.layers)
    }

    /// True if it is one mip of one layer.
    pub(crate) fn is_single(&self) -> bool {
        self.mips.len() == 1 && self.layers.len() == 1
    }

    /// The items of a buffer that are meant; `None` if all are.
    pub fn items(&self) -> Option<Range<u32>> {
        (*self != Self::WHOLE).then(|| self.layers.clone())
    }

    /// The same part of one aspect.
    pub(crate) fn of_aspect(&self, aspect: wgt::TextureAspect) -> Self {
        Self {
            aspect,
            ..self.clone()
        }
    }
}

/// A resource or a part of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// The resource.
    pub id: ResourceId,
    /// The part.
    pub part: SubresourceRange,
}
