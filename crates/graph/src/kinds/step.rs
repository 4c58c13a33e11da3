//! Steps of passes: draws, dispatches, copies and clears. One type over names (as a pass kind
//! lowers to them), ids (linked with resources and shaders) and handles (made on a device).
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

use crate::{language::syntax::Reference, source::span::Located};
use std::fmt::Debug;

/// Form of the steps of a pass: [`Names`], ids or handles.
pub trait Stage: Clone + Debug + PartialEq {
    /// An attachment: one mip of one layer of a texture.
    type Attachment: Clone + Debug + PartialEq;
    /// A texture, a buffer, or a part of one, that is copied or cleared.
    type Operand: Clone + Debug + PartialEq;
    /// A buffer with the arguments of a draw or dispatch.
    type Arguments: Clone + Debug + PartialEq;
    /// A shader and how it is bound.
    type Program: Clone + Debug + PartialEq;
    /// How many workgroups are dispatched.
    type Size: Clone + Debug + PartialEq;
    /// The place of the attachments in a draw that has none.
    type Canvas: Clone + Debug + PartialEq;
}

/// The stage in which everything is a name of the document.
#[derive(Clone, Debug, PartialEq)]
pub struct Names;

impl Stage for Names {
    type Attachment = Reference;
    type Operand = Operand;
    type Arguments = Operand;
    type Program = Program;
    type Size = Threads;
    type Canvas = Located<[u64; 2]>;
}

/// A texture or buffer by name, or a pass's own buffer.
#[derive(Clone, Debug, PartialEq)]
pub enum Operand {
    /// One of the document, its inputs or the scene.
    Named(Reference),
    /// A buffer that only this pass uses.
    Scratch(Scratch),
}

/// A buffer that only one pass uses, from [`Lowering::scratch`](crate::Lowering::scratch).
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

/// How many threads a dispatch has.
#[derive(Clone, Debug, PartialEq)]
pub enum Threads {
    /// One for each of so many items, rounded up to whole workgroups. More workgroups than one
    /// dimension holds are folded to two: the item is
    /// `(workgroup.y * num_workgroups.x + workgroup.x) * workgroup_size + local index`.
    Items(u64),
    /// One for each texel, rounded up to whole workgroups in each direction.
    Texels([u64; 3]),
    /// So many workgroups.
    Groups([u32; 3]),
}

/// One piece of GPU work of a pass. The steps of a pass run in order and are timed together.
#[derive(Clone, Debug, PartialEq)]
pub enum Step<S: Stage> {
    /// A render pass with one draw call.
    Draw(Draw<S>),
    /// A compute pass with one dispatch.
    Dispatch(Dispatch<S>),
    /// A copy of a texture or buffer.
    Copy {
        /// Source.
        from: S::Operand,
        /// Destination, of equal format and size.
        to: S::Operand,
    },
    /// A clear of a texture or buffer.
    Clear {
        /// Target of the clear.
        target: S::Operand,
        /// Value per channel of a texture; buffers are cleared to zero.
        value: [f64; 4],
    },
}

impl<S: Stage> Step<S> {
    /// Returns the program that the step runs.
    pub fn program(&self) -> Option<&S::Program> {
        match self {
            Self::Draw(draw) => Some(&draw.program),
            Self::Dispatch(dispatch) => Some(&dispatch.program),
            Self::Copy { .. } | Self::Clear { .. } => None,
        }
    }
}

/// A shader and how it is bound.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// Name of the WGSL file without folder and ending.
    pub shader: Option<Located<String>>,
    /// Modules that it imports in the place of others, `(of, is)`, as an `#import` names them.
    pub imports: Vec<(String, String)>,
    /// Vertex entry point, where the file has several.
    pub vertex: Option<Located<String>>,
    /// Fragment entry point, where the file has several.
    pub fragment: Option<Located<String>>,
    /// A draw without a fragment stage, whatever fragment entry points the file has.
    pub no_fragment: bool,
    /// Compute entry point, where the file has several.
    pub compute: Option<Located<String>>,
    /// Values of pipeline-overridable constants, beside those named like params.
    pub constants: Vec<(String, f64)>,
    /// Shader globals that are bound to a resource of another name.
    pub bind: Vec<(Located<String>, Operand)>,
}

/// A shader that a pass runs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ShaderUse {
    /// Its file without folder and ending.
    pub name: Located<String>,
    /// Modules that the pass kind has it import in the place of others.
    pub imports: Vec<(String, String)>,
}

impl Program {
    /// The shader with its modules, where one is named.
    pub(crate) fn shader_use(&self) -> Option<ShaderUse> {
        let name = self.shader.clone()?;
        let imports = self.imports.clone();
        Some(ShaderUse { name, imports })
    }
}

/// A draw call into attachments.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw<S: Stage> {
    /// Vertex and fragment shader.
    pub program: S::Program,
    /// The vertex stage is the graph's own triangle over the whole target.
    pub fullscreen: bool,
    /// Colour attachments, by location.
    pub colors: Vec<ColorTarget<S>>,
    /// Depth attachment.
    pub depth: Option<DepthTarget<S>>,
    /// Stencil attachment: the same texture where there are both.
    pub stencil: Option<StencilTarget<S>>,
    /// Width and height in texels of a draw without attachments, whose fragment shader writes
    /// buffers or storage textures; linked, a texture of that size that is never read.
    pub canvas: Option<S::Canvas>,
    /// Viewport and scissor rectangle in texels: x, y, width, height. `None`: the whole target.
    pub area: Option<[u32; 4]>,
    /// The draw call.
    pub call: DrawCall<S>,
    /// Culling, topology, winding.
    pub primitive: wgt::PrimitiveState,
}

/// Draw call; vertices are pulled by `vertex_index`.
#[derive(Clone, Debug, PartialEq)]
pub enum DrawCall<S: Stage> {
    /// So many vertices for each of so many instances.
    Direct {
        /// Number of vertices.
        vertices: u32,
        /// Number of instances.
        instances: u32,
    },
    /// The arguments (`vertex_count, instance_count, first_vertex, first_instance`, u32 each) stand
    /// in a buffer.
    Indirect(S::Arguments),
}

impl<S: Stage> DrawCall<S> {
    /// The same call in another stage; `arguments` finds those of an indirect one there.
    ///
    /// # Errors
    /// That of `arguments`.
    pub fn in_stage<T: Stage, E>(
        &self,
        arguments: impl FnOnce(&S::Arguments) -> Result<T::Arguments, E>,
    ) -> Result<DrawCall<T>, E> {
        Ok(match self {
            Self::Direct {
                vertices,
                instances,
            } => DrawCall::Direct {
                vertices: *vertices,
                instances: *instances,
            },
            Self::Indirect(from) => DrawCall::Indirect(arguments(from)?),
        })
    }
}

/// A colour attachment.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorTarget<S: Stage> {
    /// Texture, one mip and one layer.
    pub target: S::Attachment,
    /// Texture that a multisampled target is resolved into.
    pub resolve: Option<S::Attachment>,
    /// Value it is cleared to; `None` keeps what is there.
    pub clear: Option<[f64; 4]>,
    /// Blending; `None` overwrites.
    pub blend: Option<wgt::BlendState>,
    /// Channels that are written.
    pub write: wgt::ColorWrites,
}

/// A depth attachment.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthTarget<S: Stage> {
    /// Texture, one mip and one layer.
    pub target: S::Attachment,
    /// Value it is cleared to; `None` keeps what is there.
    pub clear: Option<f32>,
    /// Depth test.
    pub compare: wgt::CompareFunction,
    /// True if depth is written.
    pub write: bool,
    /// Depth bias of the rasteriser.
    pub bias: wgt::DepthBiasState,
}

/// A stencil attachment.
#[derive(Clone, Debug, PartialEq)]
pub struct StencilTarget<S: Stage> {
    /// Texture, one mip and one layer.
    pub target: S::Attachment,
    /// Value it is cleared to; `None` keeps what is there.
    pub clear: Option<u32>,
    /// Tests and operations.
    pub state: wgt::StencilState,
    /// Value that the tests compare with.
    pub reference: u32,
}

/// A dispatch.
#[derive(Clone, Debug, PartialEq)]
pub struct Dispatch<S: Stage> {
    /// Compute shader.
    pub program: S::Program,
    /// How many workgroups.
    pub groups: Groups<S>,
}

/// How many workgroups are dispatched.
#[derive(Clone, Debug, PartialEq)]
pub enum Groups<S: Stage> {
    /// So many.
    Direct(S::Size),
    /// Three u32 in a buffer.
    Indirect(S::Arguments),
}
