//! Steps with everything they need on the device.

use skiagraph_graph::{SubresourceRange, step::Stage};
use std::ops::Range;

/// The stage in which everything is a handle of wgpu's.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Handles;

impl Stage for Handles {
    type Attachment = GpuAttachment;
    type Operand = GpuOperand;
    type Arguments = (wgpu::Buffer, u64);
    type Program = GpuProgram;
    type Size = [u32; 3];
    type Canvas = GpuAttachment;
}

/// Attachment of a draw: a view, and the slice of it that a 3D texture has.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GpuAttachment {
    pub view: wgpu::TextureView,
    pub slice: Option<u32>,
}

/// Source or target of a copy or a clear.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum GpuOperand {
    Texture {
        texture: wgpu::Texture,
        part: SubresourceRange,
        /// Size of each mip of the part.
        mips: Vec<wgpu::Extent3d>,
        /// Each mip of each layer, where the step clears them.
        views: Vec<GpuAttachment>,
    },
    Buffer {
        buffer: wgpu::Buffer,
        range: Range<u64>,
    },
}

/// A pipeline and what is bound to it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GpuProgram {
    pub pipeline: PipelineKind,
    /// The bind groups with their indices; there may be gaps.
    pub groups: Vec<(u32, wgpu::BindGroup)>,
}

/// A pipeline of either kind.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PipelineKind {
    Render(wgpu::RenderPipeline),
    Compute(wgpu::ComputePipeline),
}
