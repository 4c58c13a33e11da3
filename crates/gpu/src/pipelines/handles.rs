//! Steps of passes as wgpu objects, ready to encode.

use crate::memory::physical::Work;
use skiagraph_graph::{SubresourceRange, step::Stage};
use std::ops::Range;

/// Stage of a step in which every resource is a wgpu object.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Handles;

impl Stage for Handles {
    type Attachment = GpuAttachment;
    type Operand = GpuOperand;
    type Arguments = (wgpu::Buffer, u64);
    type Program = GpuProgram;
    type Work = NamedWork;
    type Size = [u32; 3];
    type Canvas = GpuAttachment;
}

/// Attachment of a draw: a view, the slice if the texture is 3D, and if the content is stored.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GpuAttachment {
    pub view: wgpu::TextureView,
    pub slice: Option<u32>,
    pub store: wgpu::StoreOp,
}

/// Source or target of a copy or a clear.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum GpuOperand {
    Texture {
        texture: wgpu::Texture,
        part: SubresourceRange,
        /// Size of each mip of the part.
        mips: Vec<wgpu::Extent3d>,
        /// A view of each mip of each layer, if the step clears them; else empty.
        views: Vec<GpuAttachment>,
    },
    Buffer {
        buffer: wgpu::Buffer,
        range: Range<u64>,
    },
}

/// A pipeline with its bind groups.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GpuProgram {
    pub pipeline: PipelineKind,
    /// The bind groups with their indices; there may be gaps.
    pub groups: Vec<(u32, wgpu::BindGroup)>,
}

/// A render or compute pipeline.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PipelineKind {
    Render(wgpu::RenderPipeline),
    Compute(wgpu::ComputePipeline),
}

/// Work for the CPU with the name of its resource.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NamedWork {
    pub name: String,
    pub work: Work,
}
