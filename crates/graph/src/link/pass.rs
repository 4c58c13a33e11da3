//! Linked passes: steps over ids, with their reads and writes.

use crate::{
    instantiate::flat::Run,
    kinds::step::{Stage, Step},
    resource::{ResourceId, SubresourceRange, Target},
    shader::reflect::Shader,
    source::span::{Located, Span},
};
use naga::ShaderStage;
use std::sync::Arc;

/// Number of a pass of a plan, in the order of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PassId(pub(crate) usize);

impl PassId {
    /// The number: passes count from 0.
    pub fn index(self) -> usize {
        self.0
    }
}

/// The kind of a pass that keeps a material as it stands after another pass.
pub const CAPTURE: &str = "Capture";

/// A pass with its steps resolved.
#[derive(Clone, Debug)]
pub struct LinkedPass {
    /// Full name, with its place in the document.
    pub name: Located<String>,
    /// Kind, as the document writes it, or [`CAPTURE`].
    pub kind: &'static str,
    /// The GPU work.
    pub steps: Vec<Step<Ids>>,
    /// Reads and writes of the steps.
    pub accesses: Vec<Access>,
    /// In which frames it runs.
    pub run: Run,
    /// The value of the expression in [`Run::When`]; true without one.
    pub enabled: bool,
}

impl LinkedPass {
    /// True if it only keeps the result of another pass.
    pub fn is_capture(&self) -> bool {
        self.kind == CAPTURE
    }

    /// The bytes of each step's `params` uniform.
    pub fn params(&self) -> impl Iterator<Item = Option<&[u8]>> {
        self.steps.iter().map(|step| step.program()?.params())
    }
}

/// One use of a part of a resource by a step.
#[derive(Clone, Debug)]
pub struct Access {
    /// The resource.
    pub resource: ResourceId,
    /// Its part.
    pub part: SubresourceRange,
    /// True if it is read.
    pub reads: bool,
    /// True if it is written.
    pub writes: bool,
    /// Everything in the part is overwritten.
    pub fully_overwrites: bool,
    /// True if other content is a change for [`Run::OnChange`]; false for flags of the uniform
    /// `frame`.
    pub triggers: bool,
    /// Usage that the resource must be made for.
    pub usage: Usage,
    /// Place in the document or the shader that causes it.
    pub span: Span,
    /// Number of the step.
    pub step: usize,
}

/// How a resource is bound; decides the usages it is created with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Usage {
    /// A texture's.
    Texture(wgt::TextureUsages),
    /// A buffer's.
    Buffer(wgt::BufferUsages),
    /// A sampler or an acceleration structure needs none.
    None,
}

/// The stage in which everything is a number of the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Ids;

impl Stage for Ids {
    type Attachment = Attachment;
    type Operand = Target;
    type Arguments = Target;
    type Program = LinkedProgram;
    type Size = [u32; 3];
    type Canvas = Attachment;
}

/// An attachment.
#[derive(Clone, Debug, PartialEq)]
pub struct Attachment {
    /// One mip of one layer.
    pub target: Target,
    /// The texture's format.
    pub format: wgt::TextureFormat,
    /// The texture's samples.
    pub samples: u32,
}

/// A shader with its entry points, constants and bindings.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkedProgram {
    /// The shader.
    pub shader: Arc<Shader>,
    /// Numbers of the entry points in stage order (vertex, fragment; or compute).
    pub entries: Vec<usize>,
    /// Values of pipeline-overridable constants by the key that wgpu knows them by.
    pub constants: Vec<(String, f64)>,
    /// Bindings of the program.
    pub bindings: Vec<LinkedBinding>,
}

impl LinkedProgram {
    /// The number of the entry point of a stage.
    pub fn entry(&self, stage: ShaderStage) -> Option<usize> {
        let points = &self.shader.module().entry_points;
        let mut entries = self.entries.iter().copied();
        entries.find(|entry| points[*entry].stage == stage)
    }

    /// The bytes of the `params` uniform.
    pub fn params(&self) -> Option<&[u8]> {
        self.bindings.iter().find_map(|it| match &it.target {
            BindTarget::Params(block) => Some(&block.bytes[..]),
            _ => None,
        })
    }
}

/// One binding of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkedBinding {
    /// Number of the bind group.
    pub group: u32,
    /// Number in the group.
    pub binding: u32,
    /// Target of the binding.
    pub target: BindTarget,
    /// As what.
    pub ty: wgt::BindingType,
    /// The stages that use it.
    pub visibility: wgt::ShaderStages,
}

/// Target of a binding.
#[derive(Clone, Debug, PartialEq)]
pub enum BindTarget {
    /// A buffer or some of its items.
    Buffer(Target),
    /// A texture or a part of one.
    Texture {
        /// The part.
        target: Target,
        /// Dimension that the shader sees.
        dimension: wgt::TextureViewDimension,
    },
    /// A sampler.
    Sampler(ResourceId),
    /// An acceleration structure.
    AccelerationStructure(ResourceId),
    /// The `params` uniform, already laid out.
    Params(Block),
}

/// The bytes of a `params` uniform. Two of one size are equal: other bytes are an upload, not
/// another binding.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Bytes that the shader reads.
    pub bytes: Vec<u8>,
    /// Members that are params of the root document, unchanged: their names and offsets in bytes.
    pub(crate) params: Vec<(String, usize)>,
}

impl Block {
    /// Writes words at an offset. True if others stood there. Words beyond the end are left out.
    pub(crate) fn write(&mut self, offset: usize, words: &[u32]) -> bool {
        let words = words.iter().flat_map(|word| word.to_le_bytes());
        let mut changed = false;
        for (place, byte) in self.bytes.iter_mut().skip(offset).zip(words) {
            changed |= *place != byte;
            *place = byte;
        }
        changed
    }
}

impl PartialEq for Block {
    fn eq(&self, other: &Self) -> bool {
        self.bytes.len() == other.bytes.len()
    }
}

/// The uniform `params` of a step's program.
pub(crate) fn block_mut(step: &mut Step<Ids>) -> Option<&mut Block> {
    let program = match step {
        Step::Draw(draw) => &mut draw.program,
        Step::Dispatch(dispatch) => &mut dispatch.program,
        Step::Copy { .. } | Step::Clear { .. } => return None,
    };
    let mut bindings = program.bindings.iter_mut();
    bindings.find_map(|binding| match &mut binding.target {
        BindTarget::Params(block) => Some(block),
        _ => None,
    })
}
