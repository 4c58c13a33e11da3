//! Memory of a resource on the device, and the alternation of two allocations.

use crate::provider::CpuWork;
use skiagraph_graph::ResourceId;
use std::{collections::BTreeMap, sync::Arc};

/// A texture, buffer, sampler or acceleration structure on the device, or work for the CPU.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Physical {
    Texture(wgpu::Texture),
    Buffer(wgpu::Buffer),
    Sampler(wgpu::Sampler),
    AccelerationStructure(wgpu::Tlas),
    CpuWork(Work),
}

/// Work for the CPU, equal to itself alone.
#[derive(Clone, Debug)]
pub(crate) struct Work(pub Arc<dyn CpuWork>);

impl PartialEq for Work {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// Indices of the allocations that hold a resource's content in this frame and in the frame before.
/// Both are the same in a frame that does not write the resource.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Versions {
    pub current: usize,
    pub previous: usize,
}

/// The resources that are also read as `.previous`, with the allocations they use in a frame.
pub(crate) type PingPong = BTreeMap<ResourceId, Versions>;
