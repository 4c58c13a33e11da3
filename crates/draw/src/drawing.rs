//! [`Drawing`]: a plan as plain, serialisable values.

use serde::Serialize;
use skiagraph_graph::{Alone, Hazard};
use std::{collections::HashMap, ops::Range};

/// A graph's plan as plain values, for display and serialisation. Passes and materials (textures,
/// buffers, samplers, acceleration structures, work for the CPU) refer to each other by name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Drawing {
    /// Heading of the picture, for example the graph's path and the viewport.
    /// [`from_plan`](crate::from_plan) leaves it empty.
    pub title: String,
    /// All passes, each behind those that it depends on, including those that do not run and the
    /// copy passes of captures.
    pub passes: Vec<Pass>,
    /// All materials: declared, provided, imported, and those made for passes and captures. They
    /// have the order of [`Plan::resources`](skiagraph_graph::Plan::resources).
    pub materials: Vec<Material>,
    /// Reads and writes of materials by passes: an entry for each pass, material and part, in the
    /// order of `passes`.
    pub accesses: Vec<Access>,
    /// Pairs of passes that must run in a given order, each pair once, sorted by the place of
    /// `from` in `passes`, then by that of `to`. For a pass that does not run there are only edges
    /// from the passes whose results it would read.
    pub edges: Vec<Edge>,
    /// Bytes of the textures and buffers that the graph allocates; memory that materials share
    /// counts once.
    pub memory_bytes: u64,
    /// Bytes saved because materials share memory: those that `memory_bytes` would be more without
    /// it.
    pub saved_bytes: u64,
}

impl Drawing {
    /// Returns the drawing with `title` as its heading.
    #[must_use]
    pub fn titled(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// Maps the name of each material to the material.
    pub(crate) fn by_name(&self) -> HashMap<&str, &Material> {
        let materials = self.materials.iter();
        let materials = materials.map(|material| (&*material.name, material));
        materials.collect()
    }
}

/// A pass of the document, or the copy pass of a capture, which keeps the content that a material
/// has after another pass.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Pass {
    /// Full name, for example `sample[3].trace_rays`.
    pub name: String,
    /// Kind of the pass, as the document writes it, for example `Fullscreen`; `Capture` for the
    /// copy pass of a capture.
    pub kind: String,
    /// Paths of the shader files that the pass uses, each once.
    pub shaders: Vec<String>,
    /// Path of the document that declares the pass.
    pub file: String,
    /// Line of the pass's name in the document, counted from 1.
    pub line: usize,
    /// Position among the passes that run, in the order in which they run, counted from 0; `None`
    /// if the pass does not run.
    pub position: Option<usize>,
    /// Reason why the plan leaves the pass out, as text; `None` if the pass runs.
    pub culled: Option<String>,
    /// Run condition, as the document writes it, for example `OnChange`; `None` if the pass runs in
    /// every frame.
    pub run: Option<String>,
}

/// Kinds of materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Kind {
    /// A texture.
    Texture,
    /// A buffer.
    Buffer,
    /// A sampler.
    Sampler,
    /// An acceleration structure.
    AccelerationStructure,
    /// Work for the CPU ([`CPU_WORK`](skiagraph_graph::Provided::CPU_WORK)).
    CpuWork,
}

/// Sources from which materials come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Origin {
    /// Declared by the document and filled by passes.
    Declared,
    /// Declared by the document with its content: a file or numbers.
    Constant,
    /// Buffer that the graph makes for a single pass as working memory.
    Scratch,
    /// Copy of another material as it is after a pass, made to be read back.
    Capture,
    /// Built by the host's [provider](skiagraph_graph#terms): a buffer, acceleration structure or
    /// work for the CPU, such as a scene buffer.
    Provided,
    /// Texture, buffer or sampler that the host creates and hands over.
    Imported,
    /// The uniform [`frame`](skiagraph_graph::FRAME_BYTES), with the number, time and flags of the
    /// frame, which every graph can bind.
    Frame,
    /// Content of another material at the end of the previous frame.
    Previous,
}

impl Origin {
    /// True if the material has its content before the frame begins.
    pub fn is_given(self) -> bool {
        !matches!(self, Self::Declared | Self::Scratch | Self::Capture)
    }

    /// True if the graph allocates memory for the material itself. False for the content of the
    /// previous frame, which lies in a second allocation of the other material.
    pub fn is_made(self) -> bool {
        !self.is_given() || self == Self::Constant
    }
}

/// A material: a texture, buffer, sampler, acceleration structure or work for the CPU.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Material {
    /// Full name, for example `sample[3].rays`.
    pub name: String,
    /// Kind of the material.
    pub kind: Kind,
    /// Source of the material.
    pub origin: Origin,
    /// Format of a texture, as the document writes it, for example `R32Float`; `None` for other
    /// kinds.
    pub format: Option<String>,
    /// Width and height of a texture's mip 0 in texels; `None` for other kinds.
    pub size: Option<[u32; 2]>,
    /// Number of mips of a texture; 1 for other kinds.
    pub mips: u32,
    /// Number of layers of a texture, or of slices of a 3D texture's mip 0; 1 for other kinds.
    pub layers: u32,
    /// True if the layers are slices of a 3D texture.
    pub is_3d: bool,
    /// Samples per texel of a texture; 1 for other kinds.
    pub samples: u32,
    /// Number of allocations: 1, or 2 if the material is also read as it was in the previous frame.
    pub versions: usize,
    /// Bytes of all allocations of a texture or buffer of the graph, as if a pass used it; `None`
    /// for others, and for a buffer whose size no shader tells.
    pub bytes: Option<u64>,
    /// Positions ([`Pass::position`]) of the first and the last pass that use the material. `None`
    /// if no pass that runs uses it; it is then not allocated.
    pub lifetime: Option<[usize; 2]>,
    /// Names under which the host can read the material, or a part of it, back after the frame: its
    /// outputs and captures.
    pub outputs: Vec<String>,
    /// Number of the allocation that the material shares: materials with the same number use the
    /// same memory one after another, or lie side by side in it. `None` if the material shares no
    /// memory.
    pub memory: Option<usize>,
    /// Reason for which the material shares no memory; `None` if it does, or is not allocated.
    pub alone: Option<Alone>,
}

/// Use of a material, or of a part of it, by a pass.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Access {
    /// Name of the pass: [`Pass::name`].
    pub pass: String,
    /// Name of the material: [`Material::name`].
    pub material: String,
    /// True if the pass reads the part.
    pub reads: bool,
    /// True if the pass writes the part.
    pub writes: bool,
    /// The used part of a texture or buffer; `None` for the whole material.
    pub part: Option<Part>,
}

/// Part of a texture or buffer. Ranges count from 0 and exclude their end.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Part {
    /// Mips of a texture; `None` for all.
    pub mips: Option<Range<u32>>,
    /// Layers of a texture, slices of a 3D texture or items of a buffer; `None` for all.
    pub layers: Option<Range<u32>>,
    /// Depth or stencil of a texture that has both; `None` for all aspects.
    pub aspect: Option<Aspect>,
}

/// Aspects of a depth-stencil texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Aspect {
    /// The depth values.
    Depth,
    /// The stencil values.
    Stencil,
}

/// Order of two passes: one must run before the other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Edge {
    /// Name of the pass that must run first.
    pub from: String,
    /// Name of the pass that must run after it.
    pub to: String,
    /// Reasons for the order, one for each kind of conflict: read after write, write after read,
    /// write after write, in this order.
    pub because: Vec<Reason>,
    /// True if other edges together already imply this order; [`to_dot`](crate::to_dot) leaves such
    /// edges out.
    pub implied: bool,
}

impl Edge {
    /// Returns the kind of conflict of the first reason in the order of [`because`](Self::because);
    /// `None` without reasons.
    pub(crate) fn hazard(&self) -> Option<Hazard> {
        self.because.iter().map(|reason| reason.hazard).min()
    }
}

/// Reason why one pass must run before another.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Reason {
    /// Kind of conflict that the order avoids.
    pub hazard: Hazard,
    /// Names of the materials that cause the conflict, in the order of [`Drawing::materials`].
    pub materials: Vec<String>,
}
