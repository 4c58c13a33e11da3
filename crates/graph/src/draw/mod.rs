//! Seeing a plan: [`Drawing`] holds as plain data what a plan made of a document, and draws itself as SVG or DOT.
//!
//! The SVG is a chart of lifetimes, not of nodes and links: passes are rows in the order in which they run, materials are columns, a
//! bar is the time that a material lives. It grows with passes × materials but never tangles; AMD's RPS visualiser draws the same way.

mod dot;
mod gather;
mod layout;
#[cfg(test)]
mod layout_tests;
mod legend;
mod svg;
pub(crate) mod text;
mod words;

use serde::Serialize;
use std::ops::Range;

/// A plan, to be looked at. Serialises as it is; passes and materials are referred to by name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Drawing {
    /// Heading, for example the graph's path and the viewport. Empty as it comes from a plan, which knows neither.
    pub title: String,
    /// All passes in the order of the file, those that do not run included.
    pub passes: Vec<Pass>,
    /// All materials: declared, provided, imported, and what passes and captures made for themselves.
    pub materials: Vec<Material>,
    /// Which pass reads and writes which part of which material; a pass has one entry per part.
    pub accesses: Vec<Access>,
    /// What must come before what. Of passes that do not run only whose results they would read.
    pub edges: Vec<Edge>,
    /// Bytes of the graph's own textures and buffers.
    pub memory_bytes: u64,
    /// Bytes that sharing saves.
    pub saved_bytes: u64,
}

/// A pass of the document, or a copy that a capture asked for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Pass {
    /// Name.
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

/// What a material is.
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
}

/// Where a material comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Origin {
    /// The document declares it, and the graph makes it.
    Declared,
    /// A pass made it for itself.
    Scratch,
    /// A copy of a material as it stands after a pass.
    Capture,
    /// The provider gives it.
    Provided,
    /// The host owns it.
    Imported,
    /// What another material held at the end of the frame before.
    Previous,
}

impl Origin {
    /// Whether it is there before the frame begins.
    pub fn is_given(self) -> bool {
        matches!(self, Self::Provided | Self::Imported | Self::Previous)
    }
}

/// A texture, buffer or sampler.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Material {
    /// Name.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// Where it comes from.
    pub origin: Origin,
    /// Format of a texture, as the document writes it.
    pub format: Option<String>,
    /// Width and height of a texture in texels.
    pub size: Option<[u32; 2]>,
    /// Mips of a texture; 1 otherwise.
    pub mips: u32,
    /// Layers of a texture; 1 otherwise.
    pub layers: u32,
    /// Bytes of a texture or buffer that the graph makes.
    pub bytes: Option<u64>,
    /// Places in the schedule of the first and the last pass that use it; `None` if none does, and it is not made.
    pub lifetime: Option<[usize; 2]>,
    /// Names of the outputs and captures that hand it out after the frame.
    pub outputs: Vec<String>,
    /// Materials of equal number live in the same memory, one after the other; `None` if it shares with none.
    pub memory: Option<usize>,
}

/// One use of a material by a pass.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Access {
    /// Name of the pass.
    pub pass: String,
    /// Name of the material.
    pub material: String,
    /// Whether it reads.
    pub reads: bool,
    /// Whether it writes.
    pub writes: bool,
    /// The part of a texture; `None` = the whole material.
    pub part: Option<Part>,
}

/// A part of a texture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Part {
    /// Mips, counted from 0, the end not included.
    pub mips: Range<u32>,
    /// Layers, counted from 0, the end not included.
    pub layers: Range<u32>,
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

/// Why one pass must come before another.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Reason {
    /// What would go wrong.
    pub hazard: Hazard,
    /// Names of the materials through which it would.
    pub materials: Vec<String>,
}

/// What would go wrong in another order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Hazard {
    /// The later one reads what the earlier one wrote.
    ReadAfterWrite,
    /// The later one overwrites what the earlier one reads.
    WriteAfterRead,
    /// The later one overwrites what the earlier one wrote.
    WriteAfterWrite,
}

impl Hazard {
    /// The later pass's part in a sentence.
    fn verb(self) -> &'static str {
        match self {
            Self::ReadAfterWrite => "reads what it wrote",
            Self::WriteAfterRead => "overwrites what it read",
            Self::WriteAfterWrite => "overwrites what it wrote",
        }
    }
}

impl Drawing {
    /// The same drawing under a heading.
    #[must_use]
    pub fn titled(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// A chart of passes (rows, in the order in which they run) and materials (columns, with their lifetimes), the derived edges on
    /// the left, what does not run and why below. One SVG file that refers to nothing outside itself.
    pub fn to_svg(&self) -> String {
        svg::render(&layout::Layout::new(self))
    }

    /// Nodes and links for Graphviz: passes are boxes, materials ellipses, passes that do not run dashed; what an include prefixed
    /// with `eye.` stands in the cluster `eye`.
    pub fn to_dot(&self) -> String {
        dot::render(self)
    }
}
