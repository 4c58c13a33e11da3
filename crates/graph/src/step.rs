//! What passes are made of: draws, dispatches, copies and clears, with every resource still a name.

use crate::document::{located::Located, materials::Count, value::Compare};

/// One piece of GPU work of a pass. The steps of a pass run in order and are timed together.
#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "a graph has a handful, each made once"
)]
pub enum Step {
    /// A render pass with one draw call.
    Draw(Draw),
    /// A compute pass with one dispatch.
    Dispatch(Dispatch),
    /// A copy of a whole texture or buffer.
    Copy {
        /// Source.
        from: Located<String>,
        /// Destination, of equal format and size.
        to: Located<String>,
    },
    /// A clear of a whole texture or buffer.
    Clear {
        /// What is cleared.
        target: Located<String>,
        /// Value per channel of a texture; buffers are cleared to zero.
        value: [f64; 4],
    },
}

impl Step {
    /// Calls `each` with every resource name that the step holds.
    pub(crate) fn names(&mut self, each: &mut dyn FnMut(&mut Located<String>)) {
        match self {
            Self::Draw(draw) => {
                for color in &mut draw.colors {
                    each(&mut color.target);
                }
                if let Some(depth) = &mut draw.depth {
                    each(&mut depth.target);
                }
                match &mut draw.call {
                    DrawCall::Direct { count, instances } => {
                        count.names(each);
                        instances.names(each);
                    }
                    DrawCall::Indirect(name) => each(name),
                }
            }
            Self::Dispatch(dispatch) => match &mut dispatch.groups {
                Groups::Over(name) | Groups::Indirect(name) => each(name),
                Groups::Fixed(_) => {}
            },
            Self::Copy { from, to } => {
                each(from);
                each(to);
            }
            Self::Clear { target, .. } => each(target),
        }
        if let Some(program) = self.program_mut() {
            program.bind.iter_mut().for_each(|(_, name)| each(name));
        }
    }

    /// What the step runs.
    pub(crate) fn program(&self) -> Option<&Program> {
        match self {
            Self::Draw(draw) => Some(&draw.program),
            Self::Dispatch(dispatch) => Some(&dispatch.program),
            Self::Copy { .. } | Self::Clear { .. } => None,
        }
    }

    fn program_mut(&mut self) -> Option<&mut Program> {
        match self {
            Self::Draw(draw) => Some(&mut draw.program),
            Self::Dispatch(dispatch) => Some(&mut dispatch.program),
            Self::Copy { .. } | Self::Clear { .. } => None,
        }
    }
}

/// A shader and how it is bound.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// Name of the WGSL file without folder and ending.
    pub shader: Option<Located<String>>,
    /// Vertex entry point, where the file has several.
    pub vertex: Option<Located<String>>,
    /// Fragment entry point, where the file has several.
    pub fragment: Option<Located<String>>,
    /// Compute entry point, where the file has several.
    pub compute: Option<Located<String>>,
    /// Values of pipeline-overridable constants, beside those named like params.
    pub constants: Vec<(String, f64)>,
    /// Shader globals that are bound to a resource of another name.
    pub bind: Vec<(Located<String>, Located<String>)>,
}

/// A draw call into attachments.
#[derive(Clone, Debug)]
pub struct Draw {
    /// Vertex and fragment shader.
    pub program: Program,
    /// The vertex stage is the graph's own triangle over the whole target.
    pub fullscreen: bool,
    /// Colour attachments, by location.
    pub colors: Vec<ColorTarget>,
    /// Depth attachment.
    pub depth: Option<DepthTarget>,
    /// What is drawn.
    pub call: DrawCall,
    /// Culling, topology, winding.
    pub primitive: wgpu::PrimitiveState,
}

/// What a draw call draws; vertices are pulled by `vertex_index`.
#[derive(Clone, Debug)]
pub enum DrawCall {
    /// As many vertices as `count` says, for each of `instances`.
    Direct {
        /// Number of vertices.
        count: Count,
        /// Number of instances.
        instances: Count,
    },
    /// The arguments (`vertex_count, instance_count, first_vertex, first_instance`, u32 each) stand in a buffer.
    Indirect(Located<String>),
}

/// A colour attachment.
#[derive(Clone, Debug)]
pub struct ColorTarget {
    /// Texture or view, one mip and one layer.
    pub target: Located<String>,
    /// Value it is cleared to; `None` keeps what is there.
    pub clear: Option<[f64; 4]>,
    /// Blending; `None` overwrites.
    pub blend: Option<wgpu::BlendState>,
}

/// A depth attachment.
#[derive(Clone, Debug)]
pub struct DepthTarget {
    /// Texture or view, one mip and one layer.
    pub target: Located<String>,
    /// Value it is cleared to; `None` keeps what is there.
    pub clear: Option<f32>,
    /// Depth test.
    pub compare: Compare,
    /// Whether depth is written.
    pub write: bool,
    /// Depth bias of the rasteriser.
    pub bias: wgpu::DepthBiasState,
}

/// A dispatch.
#[derive(Clone, Debug)]
pub struct Dispatch {
    /// Compute shader.
    pub program: Program,
    /// How many workgroups.
    pub groups: Groups,
}

/// How many workgroups are dispatched.
#[derive(Clone, Debug)]
pub enum Groups {
    /// One invocation per texel of a texture or item of a buffer, rounded up to whole workgroups. Item dispatches of more
    /// workgroups than one dimension holds are folded to two: the item is
    /// `(workgroup.y * num_workgroups.x + workgroup.x) * workgroup_size + local index`.
    Over(Located<String>),
    /// A fixed number.
    Fixed([u32; 3]),
    /// Three u32 in a buffer, at offset 0.
    Indirect(Located<String>),
}
