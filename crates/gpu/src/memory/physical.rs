//! Memory of a resource on the device, and the turns that two allocations take.

use skiagraph_graph::ResourceId;
use std::collections::BTreeMap;

/// A texture, buffer, sampler or acceleration structure on the device.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Physical {
    Texture(wgpu::Texture),
    Buffer(wgpu::Buffer),
    Sampler(wgpu::Sampler),
    AccelerationStructure(wgpu::Tlas),
}

/// Which of its two allocations a resource is written to in a frame, and which one holds what it
/// was before; both the same in a frame that does not write it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Versions {
    pub current: usize,
    pub previous: usize,
}

/// Resources that are also read as they were in the frame before, and whose turn it is.
pub(crate) type PingPong = BTreeMap<ResourceId, Versions>;
