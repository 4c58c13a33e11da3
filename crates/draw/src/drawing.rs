//! [`Drawing`]: a plan as plain data.

use serde::Serialize;
use skiagraph_graph::Hazard;
use std::{collections::HashMap, ops::Range};

/// A plan, to be looked at. Serialises as it is; passes and materials are referred to by name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Drawing {
    /// Heading, for example the graph's path and the viewport. Empty as it comes from a plan, which
    /// knows neither.
    pub title: String,
    /// All passes in the order of the file, those that do not run included.
    pub passes: Vec<Pass>,
    /// All materials: declared, provided, imported, and what passes and captures made for
    /// themselves.
    pub materials: Vec<Material>,
    /// Which pass reads and writes which part of which material; a pass has one entry per part.
    pub accesses: Vec<Access>,
    /// Order of the passes. For a pass that does not run, only the passes whose results it would
    /// read.
    pub edges: Vec<Edge>,
    /// Bytes of the graph's own textures and buffers.
    pub memory_bytes: u64,
    /// Bytes that sharing saves.
    pub saved_bytes: u64,
}

impl Drawing {
    /// The same drawing under a heading.
    #[must_use]
    pub fn titled(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// The materials by name.
    pub(crate) fn by_name(&self) -> HashMap<&str, &Material> {
        let materials = self.materials.iter();
        materials
            .map(|material| (&*material.name, material))
            .collect()
    }
}

/// A pass of the document, or a copy that a capture asked for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Pass {
    /// Full name: `sample[3].trace_rays`.
    pub name: String,
    /// Kind, as the document writes it; `Capture` for a copy that is read back.
    pub kind: String,
    /// Shader files of its steps, each once.
    pub shaders: Vec<String>,
    /// The document it stands in.
    pub file: String,
    /// Line of its name there, from 1.
    pub line: usize,
    /// Place in the schedule, from 0; `None` if it does not run.
    pub position: Option<usize>,
    /// Why it does not run.
    pub culled: Option<String>,
    /// When it runs, if not in every frame; as the document writes it.
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
}

/// Where a material comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Origin {
    /// The document declares it, and the passes fill it.
    Declared,
    /// The document declares it with its content: a file, or numbers.
    Constant,
    /// A pass made it for itself.
    Scratch,
    /// A copy of a material as it stands after a pass.
    Capture,
    /// The provider gives it.
    Provided,
    /// The host owns it.
    Imported,
    /// The graph's own uniform `frame`: number and seconds of the frame.
    Frame,
    /// Content of another material at the end of the frame before.
    Previous,
}

impl Origin {
    /// Returns true if it has its content before the frame begins.
    pub fn is_given(self) -> bool {
        !matches!(self, Self::Declared | Self::Scratch | Self::Capture)
    }

    /// Returns true if it takes memory of the graph.
    pub fn is_made(self) -> bool {
        !self.is_given() || self == Self::Constant
    }
}

/// A texture, buffer or sampler.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Material {
    /// Full name.
    pub name: String,
    /// Kind of the material.
    pub kind: Kind,
    /// Where it comes from.
    pub origin: Origin,
    /// Format of a texture, as the document writes it.
    pub format: Option<String>,
    /// Width and height of a texture in texels.
    pub size: Option<[u32; 2]>,
    /// Mips of a texture; 1 otherwise.
    pub mips: u32,
    /// Layers of a texture, or slices of a 3D texture's mip 0; 1 otherwise.
    pub layers: u32,
    /// True if the layers are slices of a 3D texture.
    pub is_3d: bool,
    /// Samples of each texel of a texture; 1 otherwise.
    pub samples: u32,
    /// How many textures or buffers it takes: 2 if it is also read as it was in the frame before.
    pub versions: usize,
    /// Bytes of a texture or buffer that the graph makes, all versions together.
    pub bytes: Option<u64>,
    /// Places in the schedule of the first and the last pass that use it; `None` if none does, and
    /// it is not made.
    pub lifetime: Option<[usize; 2]>,
    /// Names of the outputs and captures that hand it out after the frame.
    pub outputs: Vec<String>,
    /// Materials of equal number live in the same memory, one after the other; `None` if it shares
    /// with none.
    pub memory: Option<usize>,
}

/// One use of a material by a pass.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Access {
    /// Name of the pass.
    pub pass: String,
    /// Name of the material.
    pub material: String,
    /// True if it reads.
    pub reads: bool,
    /// True if it writes.
    pub writes: bool,
    /// The part of a texture or buffer; `None` = the whole material.
    pub part: Option<Part>,
}

/// A part of a texture or buffer. Ranges count from 0, the end is not included.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Part {
    /// Mips of a texture; `None` = all.
    pub mips: Option<Range<u32>>,
    /// Layers of a texture, slices of a 3D texture or items of a buffer; `None` = all.
    pub layers: Option<Range<u32>>,
    /// One aspect of a texture that has two; `None` = all that it has.
    pub aspect: Option<Aspect>,
}

/// Aspects of a depth-stencil texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Aspect {
    /// Depth.
    Depth,
    /// Stencil.
    Stencil,
}

/// One pass that must come before another.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Edge {
    /// Name of the earlier pass.
    pub from: String,
    /// Name of the later pass.
    pub to: String,
    /// Why, the strongest reason first.
    pub because: Vec<Reason>,
    /// Other edges already keep the two in order.
    pub implied: bool,
}

impl Edge {
    /// The strongest reason.
    pub(crate) fn hazard(&self) -> Option<Hazard> {
        self.because.iter().map(|reason| reason.hazard).min()
    }
}

/// Why one pass must come before another.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Reason {
    /// Hazard in another order.
    pub hazard: Hazard,
    /// Names of the materials through which it would.
    pub materials: Vec<String>,
}
