//! Textures, buffers and samplers of a plan, and parts of them.

use crate::document::{Address, Filter};
use crate::picture::Picture;
use crate::provided_kind::ProvidedKind;
use crate::provider::Provided;
use crate::source::Span;
use std::{ops::Range, sync::Arc};

/// Id of a [`Resource`] of one plan: its index in [`Plan::resources`](crate::Plan::resources).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ResourceId(pub(crate) usize);

impl ResourceId {
    /// Returns the index of the resource in [`Plan::resources`](crate::Plan::resources), counted
    /// from 0.
    pub fn index(self) -> usize {
        self.0
    }
}

/// A texture, buffer, sampler, acceleration structure or work for the CPU that passes of a plan may
/// use, or the uniform buffer `frame` ([`ResourceKind::Frame`]).
#[derive(Clone, Debug)]
pub struct Resource {
    /// Full name of the resource: the name by which the loaded document knows it, `left.depth` for
    /// the output `depth` of the [include](crate#terms) `left`. A material that an included
    /// document keeps to itself has the names of the includes and groups around it in front:
    /// `gbuffer.scratch`. An include without a name counts by the name of its file. The content of
    /// the frame before has `.previous` behind the name.
    pub name: String,
    /// Place where a document declares the resource. `None` for a resource that no document
    /// declares, such as one that the host's provider describes ([`Describe`](crate::Describe)) or
    /// a buffer that only one pass uses.
    pub declared: Option<Span>,
    /// Kind of the resource (texture, buffer, …), with its format, sizes and other properties.
    pub kind: ResourceKind,
    /// Origin of the resource's content: the graph, the document, the host, or the frame before.
    pub origin: Origin,
    /// Growth of the number of [items](crate#terms) of a buffer, or of layers of a texture, between
    /// frames (`grow` in the document); `None` if the number is fixed.
    pub growth: Option<Growth>,
    /// True if the resource's content stays from frame to frame until a pass overwrites it (`keep:
    /// true` in the document).
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

    /// Name and kind of a provided resource; `None` for one without kinds, and all others.
    pub(crate) fn named_kind(&self) -> Option<(&str, ProvidedKind)> {
        match &self.kind {
            ResourceKind::Provided(provided) => Some((&self.name, provided.kind?)),
            _ => None,
        }
    }

    /// True if the resource has content before the first pass of a frame runs. Samplers count as
    /// such.
    pub(crate) fn has_content(&self) -> bool {
        self.keep || self.origin != Origin::Own || matches!(self.kind, ResourceKind::Sampler(_))
    }

    /// True if the host's provider describes the resource, and makes it.
    pub(crate) fn is_provided(&self) -> bool {
        self.origin == Origin::Host && self.kind.is_given() && self.kind != ResourceKind::Frame
    }
}

/// Origin of the content of a [`Resource`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The graph: its passes write the content. Samplers of the graph have this origin, too.
    Own,
    /// The document: the content is a picture file (`file: …`) or numbers (`data: …`) that the
    /// document gives. No pass may write the resource.
    Constant,
    /// The host: the resource is an import ([`Import`](crate::Import)), described by the host's
    /// provider ([`Describe`](crate::Describe)), or the uniform `frame`. It has content before the
    /// first pass runs.
    Host,
    /// The frame before: this resource holds the content that the resource with this id had at the
    /// end of that frame (`.previous` in documents). In the first frame it holds zeros, or for a
    /// resource of the host that resource's current content.
    Previous(ResourceId),
}

/// Kind of a [`Resource`], with its format, sizes and other properties.
#[derive(Clone, Debug, PartialEq)]
pub enum ResourceKind {
    /// A texture of the graph, or one that the host imports.
    Texture(Texture),
    /// A buffer of the graph, or one that the host imports.
    Buffer(Buffer),
    /// A sampler of the graph, or one that the host imports.
    Sampler(Sampler),
    /// A buffer that the host's provider makes, such as the scene's indices or the camera
    /// ([`Describe`](crate::Describe)).
    Provided(Provided),
    /// An acceleration structure, for ray queries, that the host's [provider](crate#terms) makes.
    AccelerationStructure,
    /// Work for the CPU that the host's [provider](crate#terms) makes, called by a
    /// [`CpuCall`](crate::step::CpuCall).
    CpuWork,
    /// The uniform buffer `frame`, which is filled before each frame: index, seconds and flags
    /// ([`FRAME_BYTES`]).
    Frame,
}

/// Size in bytes of the uniform buffer `frame`, which any shader may bind as a `var<uniform>` of
/// this name. It holds, in this order and 4 bytes each, the frame's index (`u32`, 0 for the first
/// frame), the time in seconds that the host gives (`f32`), and the flags `changed_scene`,
/// `changed_light` and `fresh` (`u32`, 1 or 0); the rest is padding.
///
/// The flags `changed_scene` and `changed_light` tell that the scene or a light has changed since
/// the frame before, `fresh` that a resource whose content lasts from frame to frame has new
/// memory. All three are 1 in the first frame.
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

    /// True if the kind is always the host's.
    pub(crate) fn is_given(&self) -> bool {
        match self {
            Self::Texture(_) | Self::Buffer(_) | Self::Sampler(_) => false,
            Self::Provided(_) | Self::AccelerationStructure | Self::CpuWork | Self::Frame => true,
        }
    }

    /// Returns the number of layers of a mip of a texture, slices of a 3D texture, or of items of a
    /// buffer; of one whose end is not known, the greatest number.
    pub(crate) fn layers(&self, mip: u32) -> u32 {
        let items = match self {
            Self::Texture(texture) => return texture.mip_layers(mip),
            Self::Buffer(buffer) => buffer.count,
            _ => None,
        };
        let items = items.and_then(|items| u32::try_from(items).ok());
        items.unwrap_or(u32::MAX)
    }

    /// Returns the kind of a buffer of `count` items.
    pub(crate) fn buffer_of(count: u64) -> Self {
        Self::Buffer(Buffer {
            count: Some(count),
            ..Buffer::default()
        })
    }

    /// Describes the kind, a texture with its format.
    pub(crate) fn describe_with_format(&self) -> String {
        match self {
            Self::Texture(texture) => format!("a texture {:?}", texture.format),
            other => other.describe().to_owned(),
        }
    }

    /// Returns the size in bytes of a texture or buffer, as [`Texture::bytes`] and
    /// [`Buffer::bytes`]; 0 for every other kind, provided buffers included.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Texture(texture) => texture.bytes(),
            Self::Buffer(buffer) => buffer.bytes,
            _ => 0,
        }
    }
}

/// Description of a 2D texture, a 2D array texture or a 3D texture, made by the graph or imported
/// by the host.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Format of the texture's texels.
    pub format: wgt::TextureFormat,
    /// Width and height in texels of the texture's mip 0.
    pub size: [u32; 2],
    /// Number of array layers of the texture, or of slices of mip 0 of a 3D texture; 1 for a plain
    /// 2D texture.
    pub layers: u32,
    /// True for a 3D texture, whose `layers` are slices; false for a 2D texture or a 2D array.
    pub is_3d: bool,
    /// Number of mip levels of the texture, at least 1.
    pub mips: u32,
    /// Number of samples of each texel of the texture; 1 without multisampling.
    pub samples: u32,
    /// Picture that the document fills the texture with (`file: …`); `None` for a texture without a
    /// picture, such as one that passes write.
    pub picture: Option<Picture>,
}

impl Texture {
    /// Returns the width and height in texels, each at least 1, of the mip level `mip`, counted
    /// from 0.
    pub fn mip_size(&self, mip: u32) -> [u32; 2] {
        self.size.map(|edge| halved(edge, mip))
    }

    /// Returns the number of layers, or of slices of a 3D texture, of the mip level `mip`. An array
    /// has the same layers in every mip; the slices of a 3D texture are halved with each mip.
    pub fn mip_layers(&self, mip: u32) -> u32 {
        if self.is_3d {
            halved(self.layers, mip)
        } else {
            self.layers
        }
    }

    /// Returns the size in bytes of all texels of all mips, layers and samples of the texture,
    /// without padding.
    pub fn bytes(&self) -> u64 {
        let footprint = |format: wgt::TextureFormat| {
            format.theoretical_memory_footprint(wgt::Extent3d::default())
        };
        let texel = footprint(self.format).saturating_mul(u64::from(self.samples));
        // A host's limits may allow for more than 64 bits can count.
        let mip = |level: u32| {
            let edges = self.mip_size(level).map(u64::from);
            let edges = [edges[0], edges[1], u64::from(self.mip_layers(level))];
            edges.into_iter().fold(texel, u64::saturating_mul)
        };
        (0..self.mips).map(mip).fold(0, u64::saturating_add)
    }

    /// Returns the part that holds all of the texture: every mip, every layer or slice, and every
    /// aspect.
    pub fn whole(&self) -> SubresourceRange {
        SubresourceRange {
            mips: 0..self.mips,
            layers: 0..self.layers,
            aspect: wgt::TextureAspect::All,
        }
    }
}

/// Description of a buffer, made by the graph or imported by the host.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Buffer {
    /// Number of items of the buffer: of the runtime-sized array that shaders declare, or of
    /// `data`; for a buffer that only one pass uses, of 4-byte words. `None` if the document gives
    /// neither `count` nor `data`, because shaders declare the buffer with a fixed size, and for an
    /// import without a known number.
    pub count: Option<u64>,
    /// Distance in bytes from one item of the buffer's runtime-sized array to the next, as shaders
    /// declare it, or the size of the items that a [`CpuCall`](crate::step::CpuCall) reads or
    /// writes. 0 for an import, and for a buffer that no shader of the graph declares as such an
    /// array and no `CpuCall` uses.
    pub stride: u64,
    /// Size of the buffer in bytes: of the layout that shaders declare, with all items, rounded up
    /// to a multiple of 4; for a buffer that is only copied, of the other buffer of the copy; for
    /// an import, of the host's buffer.
    pub bytes: u64,
    /// Content that the document gives the buffer (`data: …`): one entry for each item, with one
    /// number for each scalar of the item, in the order of the scalars' offsets. `None` for a
    /// buffer without `data`.
    pub data: Option<Arc<Vec<Vec<f64>>>>,
    /// The bytes of `data` in the item layout that shaders declare, numbers in little-endian order;
    /// `None` without `data`.
    pub content: Option<Arc<[u8]>>,
}

/// Halves an edge so often, rounded down, but to no less than 1.
fn halved(edge: u32, times: u32) -> u32 {
    edge.checked_shr(times).unwrap_or_default().max(1)
}

/// Rule by which a buffer gets more [items](crate#terms), or a texture more layers, in later frames
/// (`grow` in documents). If `counter` tells that a frame needed more than there are, the executor,
/// which runs the plan on a device, replaces the resource by one with the needed number and a
/// quarter more. Its content is lost unless it has `keep`.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// Buffer, or item of a buffer, whose first `u32` holds after a frame the number of
    /// [items](crate#terms) or layers that the frame would have needed.
    pub counter: Target,
    /// Greatest number of [items](crate#terms) or layers, which the growing buffer or texture never
    /// exceeds.
    pub max: u64,
}

/// Description of a sampler, made by the graph or imported by the host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampler {
    /// Filter of the sampler for minification, for magnification and between mips.
    pub filter: Filter,
    /// Address mode of the sampler in all directions, for coordinates outside of the texture;
    /// without meaning for an import.
    pub address: Address,
    /// Comparison function of a comparison sampler; `None` for a sampler that does not compare. Any
    /// function for an import that compares.
    pub compare: Option<wgt::CompareFunction>,
}

/// Part of a texture or buffer: a range of mips and layers of a texture (slices, if it is 3D), or a
/// range of [items](crate#terms) of a buffer. The items are in the field `layers`. Ends of ranges
/// are excluded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SubresourceRange {
    /// Range of a texture's mip levels, counted from 0, the end excluded; `0..1` for a buffer.
    pub mips: Range<u32>,
    /// Range of a texture's array layers or slices, or of a buffer's items, counted from 0, the end
    /// excluded; `0..u32::MAX` for a whole buffer.
    pub layers: Range<u32>,
    /// Aspect of a texture with depth and stencil: `DepthOnly` or `StencilOnly` for one of the two,
    /// `All` for both. `All` for any other texture or buffer.
    pub aspect: wgt::TextureAspect,
}

impl SubresourceRange {
    /// The whole of a buffer, or of a resource without parts.
    pub const WHOLE: Self = Self {
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

    /// Returns the range of [items](crate#terms), the end excluded, if this is a part of a buffer;
    /// `None` if it is the whole buffer. Call it for buffers only.
    pub fn items(&self) -> Option<Range<u32>> {
        (*self != Self::WHOLE).then(|| self.layers.clone())
    }

    /// Returns the reference by which documents name this part of the texture `name`.
    pub(crate) fn reference(&self, name: &str, texture: &Texture) -> String {
        let range = |range: &Range<u32>| match range.len() {
            1 => format!("[{}]", range.start),
            _ => format!("[{}..{}]", range.start, range.end),
        };
        let whole = texture.whole();
        let mut reference = name.to_owned();
        if self.layers != whole.layers {
            reference += &range(&self.layers);
        }
        if self.mips != whole.mips {
            reference += &format!(".mip{}", range(&self.mips));
        }
        reference
    }

    /// Returns the same mips and layers in another aspect.
    pub(crate) fn of_aspect(&self, aspect: wgt::TextureAspect) -> Self {
        Self {
            aspect,
            ..self.clone()
        }
    }
}

/// Returns the name by which the document of the pass `pass` knows a resource, from the full names
/// of both.
pub(crate) fn name_within<'n>(pass: &str, name: &'n str) -> &'n str {
    let within = pass.rsplit_once('.').map_or("", |(within, _)| within);
    let own = name.strip_prefix(within);
    own.and_then(|own| own.strip_prefix('.')).unwrap_or(name)
}

/// A resource of a plan, and the part of it that is meant, such as the part that a pass reads or an
/// output holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Id of the resource that is meant, whole or in part.
    pub id: ResourceId,
    /// Mips and layers of the texture, or [items](crate#terms) of the buffer, that are meant.
    pub part: SubresourceRange,
}
