//! Linked passes: their steps refer to resources by id, and list their reads and writes.

use crate::instantiate::Run;
use crate::kinds::{Stage, Step};
use crate::resource::{ResourceId, SubresourceRange, Target};
use crate::shader::Shader;
use crate::source::{Located, Span};
use naga::ShaderStage;
use std::sync::Arc;

/// Id of a pass of one plan: its index in [`Plan::all_passes`](crate::Plan::all_passes), which has
/// the order of the documents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PassId(pub(crate) usize);

impl PassId {
    /// Returns the index of the pass in [`Plan::all_passes`](crate::Plan::all_passes), counted from
    /// 0.
    pub fn index(self) -> usize {
        self.0
    }
}

/// The [`LinkedPass::kind`] of the passes that planning adds for each [`Capture`](crate::Capture)
/// with `after`: they copy the captured material behind the pass that `after` names.
pub const CAPTURE: &str = "Capture";

/// A pass of a plan. Its steps refer to resources by [`ResourceId`] and hold their parsed shaders.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LinkedPass {
    /// Full name with its place in the document: the name there, with the names of the groups and
    /// includes around the pass in front, `blur.x`, and the index of a repetition behind,
    /// `fill[0]`. An include without a name counts by the name of its file. `material@pass` for a
    /// [capture](crate#terms).
    pub name: Located<String>,
    /// Kind of the pass, as the document writes it, such as `Compute`; [`CAPTURE`] for a pass that
    /// planning added.
    pub kind: &'static str,
    /// Work of the pass (draws, dispatches, copies, clears, work for the CPU), in the order in
    /// which it is done.
    pub steps: Vec<Step<Ids>>,
    /// Every read and write of a resource by the pass, in the order of its steps.
    pub accesses: Vec<Access>,
    /// Frames in which the pass runs, if it is [live](crate#terms).
    pub run: Run,
    /// Values of the expression in [`Run::When`] with the plan's params, frame by frame until they
    /// repeat: the pass runs in the frame `n`, counted from 0 since its [executor](crate#terms) was
    /// made, if the value `n % turns.len()` is true. One true for every other [`Run`].
    pub turns: Vec<bool>,
}

impl LinkedPass {
    /// True if planning added the pass for a [`Capture`](crate::Capture), for which it copies a
    /// material.
    pub fn is_capture(&self) -> bool {
        self.kind == CAPTURE
    }

    /// True if the pass writes to a part of a resource.
    pub(crate) fn writes_to(&self, id: ResourceId, part: &SubresourceRange) -> bool {
        self.accesses
            .iter()
            .any(|access| access.writes_to(id, part))
    }

    /// Iterates over the bytes of the `params` uniform of each step, one entry per step, in the
    /// order of the steps. The uniform holds the values of params for the step's shader. `None` for
    /// a step whose shader has no global `params`, and for one without a shader.
    pub fn params(&self) -> impl Iterator<Item = Option<&[u8]>> {
        self.steps.iter().map(|step| step.program()?.params())
    }
}

/// One use of a resource, or of a part of it, by a step: a read, a write or both; neither for the
/// [`canvas`](crate::step::Draw::canvas) of a draw.
#[derive(Clone, Debug)]
pub struct Access {
    /// Id of the resource that the access reads or writes.
    pub resource: ResourceId,
    /// Part of the resource that the access reads or writes: mips and layers of a texture, or
    /// [items](crate#terms) of a buffer.
    pub part: SubresourceRange,
    /// True if the access reads its [`part`](Self::part) of the resource; an attachment that is not
    /// cleared counts as read, a part in the document's `overwrites` does not.
    pub reads: bool,
    /// True if the access writes its [`part`](Self::part) of the resource.
    pub writes: bool,
    /// True if the access certainly overwrites every texel or byte of its [`part`](Self::part) of
    /// the resource: as a clear, a copy or a cleared attachment does, or because the document
    /// promises it (`overwrites`).
    pub fully_overwrites: bool,
    /// True if a change of the resource's content makes a pass with [`Run::OnChange`] run. False
    /// only for the uniform `frame` if the shader reads no more of it than its flags.
    pub triggers: bool,
    /// Usage that the resource must be created with on the device for this access.
    pub usage: Usage,
    /// Place in the document or shader that causes the access, for messages.
    pub span: Span,
    /// Index in [`LinkedPass::steps`] of the step that makes the access.
    pub step: usize,
}

impl Access {
    /// Creates an access to a target that reads, writes and fully overwrites as `used` says.
    pub(super) fn new(
        target: &Target,
        (reads, writes, fully_overwrites): (bool, bool, bool),
        usage: Usage,
        span: &Span,
    ) -> Self {
        Self {
            resource: target.id,
            part: target.part.clone(),
            reads,
            writes,
            fully_overwrites,
            triggers: true,
            usage,
            span: span.clone(),
            step: 0,
        }
    }

    /// True if the access writes to a part of a resource.
    pub(crate) fn writes_to(&self, id: ResourceId, part: &SubresourceRange) -> bool {
        self.writes && self.resource == id && self.part.overlaps(part)
    }
}

/// Usage that one [`Access`] needs the resource to be created with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Usage {
    /// Usage of a texture, such as `TEXTURE_BINDING`.
    Texture(wgt::TextureUsages),
    /// Usage of a buffer, such as `STORAGE`.
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
    /// The attached texture, with the one mip and one layer or slice that is drawn to.
    pub target: Target,
    /// Format of the attached texture.
    pub format: wgt::TextureFormat,
    /// Number of samples of each texel of the attached texture; 1 without multisampling.
    pub samples: u32,
}

/// A shader of a draw or dispatch, with its entry points, constants and bindings.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LinkedProgram {
    /// The program's shader, which holds the naga module and its reflection.
    pub shader: Arc<Shader>,
    /// Indices of the entry points in `shader.module().entry_points`: for a draw the vertex and
    /// then the fragment entry point, as far as the draw has them; for a dispatch the compute entry
    /// point.
    pub entries: Vec<usize>,
    /// Values of pipeline-overridable constants by the key that wgpu expects: the constant's name,
    /// or its `@id` in decimal. A constant that is not listed keeps the shader's default.
    pub constants: Vec<(String, f64)>,
    /// Bindings of the shader's globals that the entry points use, in the order of their
    /// declaration. Other globals are not bound.
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

    /// Returns the bytes of the `params` uniform, which holds the values of params for this
    /// program; `None` if the entry points use no global `params`.
    pub fn params(&self) -> Option<&[u8]> {
        self.bindings.iter().find_map(|it| match &it.target {
            BindTarget::Params(block) => Some(&block.bytes[..]),
            _ => None,
        })
    }
}

/// One binding of a program: its numbers, and the resource or bytes bound to it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LinkedBinding {
    /// Index of the bind group that holds the binding, counted from 0 (`@group`).
    pub group: u32,
    /// Number of the binding in its group (`@binding`), counted from 0.
    pub binding: u32,
    /// Resource, part of one, or bytes that the binding gives the shader.
    pub target: BindTarget,
    /// Type of the binding in the bind group layout.
    pub ty: wgt::BindingType,
    /// Shader stages of the program whose entry points use the binding.
    pub visibility: wgt::ShaderStages,
}

/// Resource or bytes that a [`LinkedBinding`] binds.
#[derive(Clone, Debug, PartialEq)]
pub enum BindTarget {
    /// A buffer, or a range of its [items](crate#terms), bound as a uniform or storage buffer.
    Buffer(Target),
    /// A texture or a part of one, bound as a sampled or storage texture.
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
    /// The `params` uniform: a buffer that the executor, which runs the plan on a device, makes and
    /// fills with these bytes.
    Params(Block),
}

/// The bytes of a `params` uniform, which holds the values of params for one program, laid out as
/// the shader declares it. Two blocks of equal size compare as equal: different bytes need an
/// upload, but not another binding.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Content of the uniform, in the layout of the shader's struct, numbers in little-endian
    /// order.
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

    /// Writes the value of a param, as words, to every place that it has. Returns true if any byte
    /// changed.
    pub(crate) fn set(&mut self, name: &str, words: &[u32]) -> bool {
        let places = std::mem::take(&mut self.params);
        let own = places.iter().filter(|(param, _)| param == name);
        let changed = own.fold(false, |changed, (_, offset)| {
            self.write(*offset, words) || changed
        });
        self.params = places;
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
