//! Textures, buffers and samplers of a plan, and parts of them.

use crate::{
    document::materials::{Address, Filter},
    picture::Picture,
    provider::Provided,
    source::span::Span,
};
use std::{ops::Range, sync::Arc};

/// Id of a [`Resource`] of one plan: its index in [`Plan::resources`](crate::Plan::resources).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ResourceId(pub(crate) usize);

impl ResourceId {
    /// Returns the index, counted from 0.
    pub fn index(self) -> usize {
        self.0
    }
}

/// A texture, buffer, sampler or acceleration structure of a plan that passes may use, or its
/// uniform `frame`.
#[derive(Clone, Debug)]
pub struct Resource {
    /// Full name: the name in the document; for a material of a named include, with the include's
    /// name in front: `left.depth`.
    pub name: String,
    /// Place of the declaration in a document; `None` for a resource that no document declares,
    /// such as a provided one or a buffer that only one pass uses.
    pub declared: Option<Span>,
    /// Kind of the resource, with its description.
    pub kind: ResourceKind,
    /// Origin of the content: the graph, the document, the host, or the frame before.
    pub origin: Origin,
    /// Growth of the number of items of a buffer, or of layers of a texture, between frames; `None`
    /// if the number is fixed.
    pub growth: Option<Growth>,
    /// True if the content stays from frame to frame until a pass overwrites it (`keep: true` in
    /// the document).
    pub keep: bool,
}

impl Resource {
    /// Creates a resource that no document declares.
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

/// Origin of a resource's content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The graph: its passes write the content.
    Own,
    /// The document: a picture file, or numbers that stand in the document. No pass may write it.
    Constant,
    /// The host: the resource is imported or provided, and has content before the first pass.
    Host,
    /// The frame before: this resource holds the content that the resource with this id had at the
    /// end of that frame (`.previous` in documents).
    Previous(ResourceId),
}

/// Kind of a resource, with its description.
#[derive(Clone, Debug, PartialEq)]
pub enum ResourceKind {
    /// A texture.
    Texture(Texture),
    /// A buffer.
    Buffer(Buffer),
    /// A sampler.
    Sampler(Sampler),
    /// A buffer that the host's provider makes, by its description.
    Provided(Provided),
    /// An acceleration structure that the host's provider makes.
    AccelerationStructure,
    /// Work for the CPU that the host's provider makes.
    CpuWork,
    /// The uniform `frame`, which the executor fills before each frame: index, seconds and flags
    /// ([`FRAME_BYTES`], `shared/frame.wgsl`).
    Frame,
}

/// Size in bytes of the uniform `frame`: the frame's index as `u32`, the seconds as `f32`, the
/// flags `changed_scene`, `changed_light` and `fresh` as a `u32` each, then padding.
pub const FRAME_BYTES: u64 = 32;

/// Size in bytes of index and seconds, which stand at the start of the uniform `frame`.
pub(crate) const CLOCK_BYTES: u32 = 8;

/// Name by which shaders find the uniform `frame`.
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
            Self::CpuWork => "work for the CPU",
            Self::Frame => "the frame's uniform",
        }
    }

    /// Returns the size in bytes of a texture or buffer; 0 for every other kind, provided buffers
    /// included.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Texture(texture) => texture.bytes(),
            Self::Buffer(buffer) => buffer.bytes,
            _ => 0,
        }
    }
}

/// Description of a 2D texture, a 2D array texture or a 3D texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Format of the texels.
    pub format: wgt::TextureFormat,
    /// Width and height of mip 0 in texels.
    pub size: [u32; 2],
    /// Number of array layers, or of slices of mip 0 of a 3D texture; 1 for a plain 2D texture.
    pub layers: u32,
    /// True for a 3D texture, whose `layers` are slices.
    pub is_3d: bool,
    /// Number of mip levels.
    pub mips: u32,
    /// Number of samples of each texel; 1 without multisampling.
    pub samples: u32,
    /// Picture that the document fills the texture with (`file: …`); `None` for a texture without a
    /// picture.
    pub picture: Option<Picture>,
}

impl Texture {
    /// Returns the width and height in texels of the mip level `mip`, counted from 0.
    pub fn mip_size(&self, mip: u32) -> [u32; 2] {
        self.size.map(|edge| (edge >> mip).max(1))
    }

    /// Returns the number of layers, or of slices of a 3D texture, of the mip level `mip`. An array
    /// has the same layers in every mip; the slices of a 3D texture are halved with each mip.
    pub fn mip_layers(&self, mip: u32) -> u32 {
        if self.is_3d {
            (self.layers >> mip).max(1)
        } else {
            self.layers
        }
    }

    /// Returns the size in bytes of all texels of all mips, layers and samples.
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

    /// Returns the range of all mips, all layers and all aspects.
    pub fn whole(&self) -> SubresourceRange {
        SubresourceRange {
            mips: 0..self.mips,
            layers: 0..self.layers,
            aspect: wgt::TextureAspect::All,
        }
    }
}

/// Description of a buffer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Buffer {
    /// Number of items of the buffer's runtime-sized array; `None` if the document gives none
    /// (`count: …`), because shaders declare the buffer with a fixed size.
    pub count: Option<u64>,
    /// Distance in bytes from one item to the next; 0 before linking, and if no shader declares the
    /// buffer as a runtime-sized array.
    pub stride: u64,
    /// Size in bytes. Before linking it is 0, because item layouts come from WGSL, except for an
    /// import.
    pub bytes: u64,
    /// Content that the document gives (`data: …`): one entry for each item, with one number for
    /// each scalar of the item. `None` for a buffer without `data`.
    pub data: Option<Arc<Vec<Vec<f64>>>>,
    /// The bytes of `data` in the layout of the shader; `None` before linking, or without `data`.
    pub content: Option<Arc<[u8]>>,
}

/// Rule by which a buffer gets more items, or a texture more layers, from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// Buffer, or item of a buffer, whose first `u32` holds the number of items or layers that the
    /// frame would have needed.
    pub counter: Target,
    /// Greatest number of items or layers, which the buffer or texture never exceeds.
    pub max: u64,
}

/// Description of a sampler.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampler {
    /// Filter for minification, for magnification and between mips.
    pub filter: Filter,
    /// Address mode in all directions, for coordinates outside of the texture.
    pub address: Address,
    /// Comparison function; `None` for a sampler that does not compare.
    pub compare: Option<wgt::CompareFunction>,
}

/// Part of a texture or buffer: a range of mips and layers of a texture (slices, if it is 3D), or a
/// range of items of a buffer. The items are in the field `layers`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SubresourceRange {
    /// Range of mip levels, counted from 0; `0..1` for a buffer.
    pub mips: Range<u32>,
    /// Range of array layers, slices or items, counted from 0; `0..u32::MAX` for a whole buffer.
    pub layers: Range<u32>,
    /// `DepthOnly` or `StencilOnly` if the part is one aspect of a texture with depth and stencil;
    /// otherwise `All`.
    pub aspect: wgt::TextureAspect,
}

impl SubresourceRange {
    /// The whole of a buffer, or of a resource without parts.
    pub(crate) const WHOLE: Self = Self {
        mips: 0..1,
        layers: 0..u32::MAX,
        aspect: wgt::TextureAspect::All,
    };

    /// True if two parts of a resource overlap.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        use wgt::TextureAspect::{DepthOnly, StencilOnly};
        let meet = |a: &Range<u32>, b: &Range<u32>| a.start < b.end && b.start < a.end;
        let apart = matches!(
            (self.aspect, other.aspect),
            (DepthOnly, StencilOnly) | (StencilOnly, DepthOnly)
        );
        !apart && meet(&self.mips, &other.mips) && meet(&self.layers, &other.layers)
    }

    /// True if the part is one mip of one layer, slice or item.
    pub(crate) fn is_single(&self) -> bool {
        self.mips.len() == 1 && self.layers.len() == 1
    }

    /// Returns the range of items if this is a part of a buffer; `None` if it is the whole buffer.
    pub fn items(&self) -> Option<Range<u32>> {
        (*self != Self::WHOLE).then(|| self.layers.clone())
    }

    /// Returns the same mips and layers in another aspect.
    pub(crate) fn of_aspect(&self, aspect: wgt::TextureAspect) -> Self {
        Self {
            aspect,
            ..self.clone()
        }
    }
}

/// A resource, and the part of it that is used.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Id of the resource.
    pub id: ResourceId,
    /// Mips and layers of the texture, or items of the buffer, that are used.
    pub part: SubresourceRange,
}
