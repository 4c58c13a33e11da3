//! Linked passes: their steps refer to resources by id, and list their reads and writes.

use crate::{
    instantiate::flat::Run,
    kinds::step::{Stage, Step},
    resource::{ResourceId, SubresourceRange, Target},
    shader::reflect::Shader,
    source::span::{Located, Span},
};
use naga::ShaderStage;
use std::sync::Arc;

/// Id of a pass of one plan: its index in [`Plan::all_passes`](crate::Plan::all_passes), which has
/// the order of the documents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PassId(pub(crate) usize);

impl PassId {
    /// Returns the index, counted from 0.
    pub fn index(self) -> usize {
        self.0
    }
}

/// The [`LinkedPass::kind`] of the passes that planning adds for each [`Capture`](crate::Capture)
/// with `after`: they copy the captured material behind the pass that `after` names.
pub const CAPTURE: &str = "Capture";

/// A pass of a plan. Its steps refer to resources by [`ResourceId`] and hold their parsed shaders.
#[derive(Clone, Debug)]
pub struct LinkedPass {
    /// Full name with its place in the document: the name there, with the names of the groups and
    /// named includes around the pass in front, `blur.x`; `material@pass` for a capture.
    pub name: Located<String>,
    /// Kind of the pass, as the document writes it, such as `Compute`; or [`CAPTURE`].
    pub kind: &'static str,
    /// Work of the pass, in the order in which it is done.
    pub steps: Vec<Step<Ids>>,
    /// Every read and write of a resource by the steps, in the order of the steps.
    pub accesses: Vec<Access>,
    /// Frames in which the pass runs, if it is live.
    pub run: Run,
    /// Value of the expression in [`Run::When`]; true for every other [`Run`].
    pub enabled: bool,
}

impl LinkedPass {
    /// True if planning added the pass for a [`Capture`](crate::Capture), for which it copies a
    /// material.
    pub fn is_capture(&self) -> bool {
        self.kind == CAPTURE
    }

    /// Iterates over the bytes of the `params` uniform of each step, in the order of the steps;
    /// `None` for a step whose shader has no global `params`, and for one without a shader.
    pub fn params(&self) -> impl Iterator<Item = Option<&[u8]>> {
        self.steps.iter().map(|step| step.program()?.params())
    }
}

/// One use of a resource, or of a part of it, by a step: a read, a write or both.
#[derive(Clone, Debug)]
pub struct Access {
    /// Id of the resource that is used.
    pub resource: ResourceId,
    /// Mips and layers of a texture, or items of a buffer, that are used.
    pub part: SubresourceRange,
    /// True if the step reads the part.
    pub reads: bool,
    /// True if the step writes the part.
    pub writes: bool,
    /// True if the step certainly overwrites every texel or byte of the part.
    pub fully_overwrites: bool,
    /// True if a change of the resource's content is a reason for a pass with [`Run::OnChange`] to
    /// run. False only for the uniform `frame` if the shader reads just its flags.
    pub triggers: bool,
    /// Usage that the resource must be created with for this use.
    pub usage: Usage,
    /// Place in the document or shader that causes the use, for messages.
    pub span: Span,
    /// Index of the step in [`LinkedPass::steps`].
    pub step: usize,
}

/// Usage that one [`Access`] needs the resource to be created with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Usage {
    /// Usage of a texture.
    Texture(wgt::TextureUsages),
    /// Usage of a buffer.
    Buffer(wgt::BufferUsages),
    /// No usage: the resource is a sampler, an acceleration structure or work for the CPU.
    None,
}

/// The [`Stage`] of the steps in a plan ([`LinkedPass::steps`]): resources are ids, shaders are
/// parsed, and sizes are numbers of workgroups.
#[derive(Clone, Debug, PartialEq)]
pub struct Ids;

impl Stage for Ids {
    type Attachment = Attachment;
    type Operand = Target;
    type Arguments = Target;
    type Program = LinkedProgram;
    type Work = ResourceId;
    type Size = [u32; 3];
    type Canvas = Attachment;
}

/// Texture that a draw renders into or resolves to, or that is the target of a draw without
/// attachments.
#[derive(Clone, Debug, PartialEq)]
pub struct Attachment {
    /// The texture, with the one mip and one layer or slice that is drawn to.
    pub target: Target,
    /// Format of the texture.
    pub format: wgt::TextureFormat,
    /// Number of samples of each texel; 1 without multisampling.
    pub samples: u32,
}

/// A shader of a draw or dispatch, with its entry points, constants and bindings.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkedProgram {
    /// The shader, which holds the naga module and its reflection.
    pub shader: Arc<Shader>,
    /// Indices of the entry points in `shader.module().entry_points`: for a draw the vertex and
    /// then the fragment entry point, as far as the draw has them; for a dispatch the compute entry
    /// point.
    pub entries: Vec<usize>,
    /// Values of pipeline-overridable constants by the key that wgpu expects: the constant's name,
    /// or its `@id`.
    pub constants: Vec<(String, f64)>,
    /// Bindings of the shader's globals that the entry points use.
    pub bindings: Vec<LinkedBinding>,
}

impl LinkedProgram {
    /// Returns the index in `shader.module().entry_points` of the program's entry point for a
    /// shader stage; `None` if the program does not have the stage.
    pub fn entry(&self, stage: ShaderStage) -> Option<usize> {
        let points = &self.shader.module().entry_points;
        let mut entries = self.entries.iter().copied();
        entries.find(|entry| points[*entry].stage == stage)
    }

    /// Returns the bytes of the `params` uniform; `None` if the entry points use no global
    /// `params`.
    pub fn params(&self) -> Option<&[u8]> {
        self.bindings.iter().find_map(|it| match &it.target {
            BindTarget::Params(block) => Some(&block.bytes[..]),
            _ => None,
        })
    }
}

/// One binding of a program: its numbers, and the resource or bytes bound to it.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkedBinding {
    /// Index of the bind group, counted from 0.
    pub group: u32,
    /// Number of the binding in its group, `@binding`.
    pub binding: u32,
    /// Resource or bytes that are bound.
    pub target: BindTarget,
    /// Type of the binding in the bind group layout.
    pub ty: wgt::BindingType,
    /// Shader stages that use the binding.
    pub visibility: wgt::ShaderStages,
}

/// Resource or bytes that a [`LinkedBinding`] binds.
#[derive(Clone, Debug, PartialEq)]
pub enum BindTarget {
    /// A buffer, or a range of its items.
    Buffer(Target),
    /// A texture or a part of one.
    Texture {
        /// The texture, with the mips and layers that are bound.
        target: Target,
        /// Dimension of the view, as the shader declares it.
        dimension: wgt::TextureViewDimension,
    },
    /// The sampler with this id.
    Sampler(ResourceId),
    /// The acceleration structure with this id.
    AccelerationStructure(ResourceId),
    /// The `params` uniform, a buffer that the executor makes and fills with these bytes.
    Params(Block),
}

/// The bytes of a `params` uniform, which holds the values of params for one program, laid out as
/// the shader declares it. Two blocks of equal size compare as equal: different bytes need an
/// upload, but not another binding.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Content of the uniform.
    pub bytes: Vec<u8>,
    /// Members whose value is a param of the root document, unchanged: the param's name, and the
    /// member's offset in bytes.
    pub(crate) params: Vec<(String, usize)>,
}

impl Block {
    /// Writes words at an offset in bytes, and returns true if any byte changed. Words beyond the
    /// end are left out.
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

/// Returns the `params` uniform of a step's program; `None` if it has none.
pub(crate) fn block_mut(step: &mut Step<Ids>) -> Option<&mut Block> {
    let program = match step {
        Step::Draw(draw) => &mut draw.program,
        Step::Dispatch(dispatch) => &mut dispatch.program,
        Step::Copy { .. } | Step::Clear { .. } | Step::Cpu(_) => return None,
    };
    let mut bindings = program.bindings.iter_mut();
    bindings.find_map(|binding| match &mut binding.target {
        BindTarget::Params(block) => Some(block),
        _ => None,
    })
}
