//! Steps of passes: draws, dispatches, copies, clears and work for the CPU. The types are generic
//! over a [`Stage`]: a step refers to resources and shaders by name when a pass kind makes it, by
//! id in a plan, and by GPU handle in an executor.
//!
//! A pass kind of a host adds steps in [`PassKind::lower`](crate::PassKind::lower):
//!
//! ```
//! use serde::Deserialize;
//! use skiagraph_graph::{Lowering, PassKind, Reference, Registry, step::{Operand, Step}};
//! # use skiagraph_graph::{Graph, NoProvider, PlanRequest, Sources};
//! # struct Files;
//! # impl Sources for Files {
//! #     fn read(&self, _: &str) -> Result<Option<std::sync::Arc<str>>, String> {
//! #         Ok(Some("(format: 3, materials: [Texture(name: \"image\", format: R32Float)],
//! #             passes: [Reset(name: \"reset\", target: \"image\")],
//! #             outputs: [\"image\"])".into()))
//! #     }
//! #     fn list(&self, _: &str) -> Vec<String> { Vec::new() }
//! # }
//!
//! /// Written in documents as `Reset(name: "reset", target: "image")`.
//! #[derive(Debug, Deserialize)]
//! struct Reset {
//!     target: Reference,
//! }
//!
//! impl PassKind for Reset {
//!     fn lower(&self, pass: &mut Lowering<'_>) {
//!         let target = Operand::from(&self.target);
//!         pass.step(Step::Clear { target, value: [0.0; 4] });
//!     }
//! }
//!
//! let mut registry = Registry::standard();
//! registry.register::<Reset>("Reset");
//! let graph = Graph::load("reset.ron", &registry, &Files)?;
//! let plan = graph.plan(&PlanRequest::new([64, 32], &NoProvider))?;
//! let pass = plan.live().next().ok_or("a pass runs")?;
//! assert!(matches!(pass.steps[..], [Step::Clear { value: [0.0, ..], .. }]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{language::Reference, source::Located};
use std::{fmt::Debug, ops::Range};

/// Types by which a [`Step`] refers to resources, shaders and sizes at one stage of processing. The
/// stages are [`Names`] when a pass kind makes the step, [`Ids`](crate::Ids) in a plan, and the GPU
/// handles of an executor.
pub trait Stage: Clone + Debug + PartialEq {
    /// Attachment of a draw: one mip of one layer or slice of a texture.
    type Attachment: Clone + Debug + PartialEq;
    /// Source or target of a copy or clear: a texture, a buffer, or a part of one.
    type Operand: Clone + Debug + PartialEq;
    /// Buffer with the arguments of an indirect draw or dispatch.
    type Arguments: Clone + Debug + PartialEq;
    /// Shader of a draw or dispatch, with its bindings.
    type Program: Clone + Debug + PartialEq;
    /// Work that the CPU does between GPU passes.
    type Work: Clone + Debug + PartialEq;
    /// Number of threads or workgroups of a dispatch that is not indirect.
    type Size: Clone + Debug + PartialEq;
    /// Target of a draw without attachments: its size, or a texture of that size
    /// ([`Draw::canvas`]).
    type Canvas: Clone + Debug + PartialEq;
}

/// The [`Stage`] of the steps that a pass kind makes in
/// [`PassKind::lower`](crate::PassKind::lower): resources and shaders are names in the document,
/// and sizes are numbers of threads.
#[derive(Clone, Debug, PartialEq)]
pub struct Names;

impl Stage for Names {
    type Attachment = Reference;
    type Operand = Operand;
    type Arguments = Operand;
    type Program = Program;
    type Work = Located<String>;
    type Size = Threads;
    type Canvas = Located<[u64; 2]>;
}

/// A texture or buffer that a [`Step`] uses: one that the document can name, or a buffer that only
/// the step's pass uses.
#[derive(Clone, Debug, PartialEq)]
pub enum Operand {
    /// A material or input of the document, a resource that the host's [provider](crate#terms)
    /// describes, or a part of one of these.
    Named(Reference),
    /// A buffer that only this pass uses, which [`Lowering::scratch`](crate::Lowering::scratch) has
    /// added.
    Scratch(Scratch),
}

/// Handle of a buffer that only one pass uses, which
/// [`Lowering::scratch`](crate::Lowering::scratch) returns. It is valid only in the same call of
/// [`PassKind::lower`](crate::PassKind::lower).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scratch(pub(crate) usize);

impl From<&Reference> for Operand {
    fn from(reference: &Reference) -> Self {
        Self::Named(reference.clone())
    }
}

impl From<Scratch> for Operand {
    fn from(scratch: Scratch) -> Self {
        Self::Scratch(scratch)
    }
}

/// Number of threads or workgroups of a [`Dispatch`], which does nothing if a number is 0. Planning
/// reports an error for more workgroups than the device allows.
#[derive(Clone, Debug, PartialEq)]
pub enum Threads {
    /// This many threads in one dimension, rounded up to whole workgroups: threads beyond the
    /// number must return. If the device does not allow so many workgroups in x, they are spread
    /// over x and y. The index of a thread is then `(workgroup_id.y * num_workgroups.x +
    /// workgroup_id.x) * n + local_invocation_index`, where n is the number of threads in a
    /// workgroup.
    Items(u64),
    /// This many threads in x, y and z, rounded up to whole workgroups in each direction: threads
    /// beyond the numbers must return.
    Texels([u64; 3]),
    /// This many workgroups in x, y and z.
    Groups([u32; 3]),
}

/// One piece of work of a pass. The steps of a pass run in order and are timed together. `S` is
/// the [`Stage`], which determines the types for resources, shaders and sizes.
#[derive(Clone, Debug, PartialEq)]
pub enum Step<S: Stage> {
    /// A render pass with one draw call.
    Draw(Draw<S>),
    /// A compute pass with one dispatch.
    Dispatch(Dispatch<S>),
    /// A copy of a texture, a buffer or a part of one.
    Copy {
        /// Texture, buffer, or part of one, that is copied from.
        from: S::Operand,
        /// Texture, buffer, or part of one, that is copied to: of the same format, size in texels,
        /// layers, mips and samples as `from`, or of the same number of bytes.
        to: S::Operand,
    },
    /// A clear of a texture, a buffer or a part of one.
    Clear {
        /// Texture, buffer, or part of one, that is cleared.
        target: S::Operand,
        /// Red, green, blue and alpha of a colour texture, whole numbers for an integer format; for
        /// a depth or stencil texture the depth in the first number, the stencil in the second. All
        /// zero for a buffer, which can be cleared to nothing else.
        value: [f64; 4],
    },
    /// Work of the CPU, for which the frame waits.
    Cpu(CpuCall<S>),
}

impl<S: Stage> Step<S> {
    /// Returns the program that a draw or dispatch runs; `None` for every other step.
    pub fn program(&self) -> Option<&S::Program> {
        match self {
            Self::Draw(draw) => Some(&draw.program),
            Self::Dispatch(dispatch) => Some(&dispatch.program),
            Self::Copy { .. } | Self::Clear { .. } | Self::Cpu(_) => None,
        }
    }
}

/// A shader of a draw or dispatch, by name, with its entry points, constants and bindings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// Name of the program's WGSL file without folder and ending. A program needs a shader:
    /// planning reports an error for `None`, the default.
    pub shader: Option<Located<String>>,
    /// Modules that replace others in the shader's imports: pairs of the path that an `#import`
    /// names and the path of the module that is imported instead. Each is looked for from the
    /// document in which it stands.
    pub imports: Vec<(Located<String>, Located<String>)>,
    /// Name of the vertex entry point. `None` takes the only one in the shader; planning reports an
    /// error if there are several, or none where a draw needs it.
    pub vertex: Option<Located<String>>,
    /// Name of the fragment entry point. `None` takes the only one in the shader; planning reports
    /// an error if there are several, or none where a draw needs it. A draw without colour
    /// attachments takes the only one without colour outputs, if there is one.
    pub fragment: Option<Located<String>>,
    /// True for a draw without a fragment stage, even if the shader has fragment entry points.
    /// Without effect on a draw that names [`fragment`](Self::fragment), has colour attachments or
    /// is [`fullscreen`](Draw::fullscreen).
    pub no_fragment: bool,
    /// Name of the compute entry point. `None` takes the only one in the shader; planning reports
    /// an error if there are several, or none for a dispatch.
    pub compute: Option<Located<String>>,
    /// Values of pipeline-overridable constants by name. A constant that is not listed gets the
    /// value that the pass's entry sets for it (`set`), or else the value of the param or named
    /// expression of the same name, or else the shader's default. The constant `index` gets the
    /// index of the innermost repetition, and one such as `light_kind` the
    /// [`number`](crate::ProvidedKind::number) of the kind of `light`. Planning reports an error
    /// for a constant without any value.
    pub constants: Vec<(String, f64)>,
    /// Names of shader globals, each with the resource that is bound to it. A global that is not
    /// listed is bound as a group around the pass says (`bind`), or else to the resource of the
    /// same name, in which dots are underscores.
    pub bind: Vec<(Located<String>, Operand)>,
}

/// A shader that a pass runs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ShaderUse {
    /// Name of the WGSL file without folder and ending.
    pub name: Located<String>,
    /// Modules that replace others in the shader's imports: pairs `(of, is)`.
    pub imports: Vec<(Located<String>, Located<String>)>,
}

impl Program {
    /// Returns the shader with its replaced modules; `None` if no shader is named.
    pub(crate) fn shader_use(&self) -> Option<ShaderUse> {
        let name = self.shader.clone()?;
        let imports = self.imports.clone();
        Some(ShaderUse { name, imports })
    }
}

/// A render pass with one draw call, a [`Step`]. All attachments have the same size and number of
/// samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw<S: Stage> {
    /// Shader of the draw, with the vertex and fragment entry points.
    pub program: S::Program,
    /// True if the draw's vertex stage is a built-in triangle over the whole target, of the 3
    /// vertices that [`call`](Self::call) must have, instead of an entry point of the program.
    pub fullscreen: bool,
    /// Colour attachments of the draw; the index in the list is the fragment shader's `@location`.
    /// `None` for one whose condition does not hold: what the shader writes there is lost.
    pub colors: Vec<Option<ColorTarget<S>>>,
    /// Depth attachment of the draw; `None` for a draw without a depth test.
    pub depth: Option<DepthTarget<S>>,
    /// Stencil attachment of the draw; `None` for a draw without a stencil test. If there is a
    /// depth attachment, too, both are the same texture.
    pub stencil: Option<StencilTarget<S>>,
    /// Target of a draw without attachments, whose fragment shader writes buffers or storage
    /// textures: at the stage [`Names`] its width and height in texels, at the stage
    /// [`Ids`](crate::Ids) a texture of that size that is never read. `None` for a draw with
    /// attachments.
    pub canvas: Option<S::Canvas>,
    /// Viewport and scissor rectangle of the draw in texels of the target: x and y of its upper
    /// left corner, width, height. It lies inside the target and is not empty. `None` draws to the
    /// whole target. A `clear` of an attachment clears all of it even so.
    pub area: Option<[u32; 4]>,
    /// Numbers of vertices and instances of the draw, as numbers or in a buffer.
    pub call: DrawCall<S>,
    /// Primitive topology of the draw, and winding and culling of its triangles.
    pub primitive: wgt::PrimitiveState,
}

/// Numbers of vertices and instances of a [`Draw`]. There are no vertex buffers: shaders read
/// vertices by `vertex_index`.
#[derive(Clone, Debug, PartialEq)]
pub enum DrawCall<S: Stage> {
    /// Numbers that are known when the graph is planned.
    Direct {
        /// Indices of the vertices of each instance.
        vertices: Range<u32>,
        /// Indices of the instances.
        instances: Range<u32>,
    },
    /// Numbers that the GPU reads from this buffer: `vertex_count, instance_count, first_vertex,
    /// first_instance`, a u32 each.
    Indirect(S::Arguments),
}

impl<S: Stage> DrawCall<S> {
    /// Returns the same draw call at another [`Stage`]. `arguments` converts the buffer of an
    /// indirect draw call.
    ///
    /// # Errors
    /// The error that `arguments` returns.
    pub fn in_stage<T: Stage, E>(
        &self,
        arguments: impl FnOnce(&S::Arguments) -> Result<T::Arguments, E>,
    ) -> Result<DrawCall<T>, E> {
        Ok(match self {
            Self::Direct {
                vertices,
                instances,
            } => DrawCall::Direct {
                vertices: vertices.clone(),
                instances: instances.clone(),
            },
            Self::Indirect(from) => DrawCall::Indirect(arguments(from)?),
        })
    }
}

/// A colour attachment of a [`Draw`].
#[derive(Clone, Debug, PartialEq)]
pub struct ColorTarget<S: Stage> {
    /// Texture that the draw writes colours to: one mip of one layer or slice.
    pub target: S::Attachment,
    /// Texture that a multisampled `target` is resolved into after the draw; `None` if it is not
    /// resolved.
    pub resolve: Option<S::Attachment>,
    /// Red, green, blue and alpha that the target is cleared to before the draw, linear, or whole
    /// numbers for an integer format; `None` keeps the target's content.
    pub clear: Option<[f64; 4]>,
    /// Blending of the drawn colour with the colour in the target; `None` replaces the colour in
    /// the target.
    pub blend: Option<wgt::BlendState>,
    /// Value of the blend factor `Constant`, equal in all attachments of a draw that have one;
    /// `None` for 0.
    pub blend_constant: Option<[f64; 4]>,
    /// Colour channels that the draw writes; the others keep their content.
    pub write: wgt::ColorWrites,
}

/// A depth attachment of a [`Draw`].
#[derive(Clone, Debug, PartialEq)]
pub struct DepthTarget<S: Stage> {
    /// Texture that the draw tests and writes depths in: one mip of one layer or slice.
    pub target: S::Attachment,
    /// Depth, from 0 to 1, that the target is cleared to before the draw; `None` keeps the target's
    /// content.
    pub clear: Option<f32>,
    /// Depth test: a fragment passes if its depth stands in this relation to the depth in the
    /// target, with `Less` if it is less.
    pub compare: wgt::CompareFunction,
    /// True if fragments that pass the depth test write their depth.
    pub write: bool,
    /// Bias that the rasteriser adds to the depth of fragments.
    pub bias: wgt::DepthBiasState,
}

/// A stencil attachment of a [`Draw`].
#[derive(Clone, Debug, PartialEq)]
pub struct StencilTarget<S: Stage> {
    /// Texture that the draw tests and writes stencil values in: one mip of one layer or slice.
    pub target: S::Attachment,
    /// Stencil value, from 0 to 255, that the target is cleared to before the draw; `None` keeps
    /// the target's content.
    pub clear: Option<u32>,
    /// Stencil tests and operations of the draw for front and back faces, with the bits that are
    /// read and written.
    pub state: wgt::StencilState,
    /// Value that the stencil tests compare with, and that the operation `Replace` writes.
    pub reference: u32,
}

/// A compute pass with one dispatch, a [`Step`].
#[derive(Clone, Debug, PartialEq)]
pub struct Dispatch<S: Stage> {
    /// Shader of the dispatch, with the compute entry point.
    pub program: S::Program,
    /// Numbers of workgroups of the dispatch in x, y and z, as numbers or in a buffer.
    pub groups: Groups<S>,
}

/// Numbers of workgroups of a [`Dispatch`] in x, y and z.
#[derive(Clone, Debug, PartialEq)]
pub enum Groups<S: Stage> {
    /// Numbers that are known when the graph is planned: numbers of workgroups at the stage
    /// [`Ids`](crate::Ids), [`Threads`] at the stage [`Names`].
    Direct(S::Size),
    /// Numbers of workgroups in x, y and z that the GPU reads from this buffer, a u32 each.
    Indirect(S::Arguments),
}

/// Work of the CPU on the [items](crate#terms) of buffers, a [`Step`]. The frame waits for it: an
/// [executor](crate#terms) ends the GPU's work before it, copies the items back, has the work done,
/// and uploads what it wrote. Only `Executor::submit` of `skiagraph-gpu` runs passes with such a
/// step.
#[derive(Clone, Debug, PartialEq)]
pub struct CpuCall<S: Stage> {
    /// Provided resource that does the work: one that is described as
    /// [`CPU_WORK`](crate::Provided::CPU_WORK).
    pub work: S::Work,
    /// Name of the task to do, one of those that the work knows. `CpuWork::run` of `skiagraph-gpu`
    /// gets it.
    pub entry: String,
    /// Buffer of one u32: the number of [items](crate#terms) that the work reads of each buffer and
    /// writes. Items beyond the end of the shortest buffer are left out, and for 0 items the work
    /// is not called.
    pub count: S::Operand,
    /// Buffers whose first `count` [items](crate#terms) the work reads.
    pub reads: Vec<CpuItems<S>>,
    /// Buffer whose first `count` [items](crate#terms) the work writes, every one of them.
    pub writes: CpuItems<S>,
}

/// Buffer whose items a [`CpuCall`] reads or writes.
#[derive(Clone, Debug, PartialEq)]
pub struct CpuItems<S: Stage> {
    /// The buffer, whole or in part.
    pub buffer: S::Operand,
    /// Size of an item in bytes, a multiple of 4: the stride that shaders or the provider give the
    /// buffer, if they do.
    pub bytes: u64,
}
