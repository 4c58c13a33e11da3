//! Reads back the counters of buffers and textures that grow: copied after a frame, mapped when it
//! is submitted, read when they have arrived. Each resource has at most one counter in flight; a
//! need that is missed meanwhile shows in the next one, or has passed.

use super::read_buffer::ReadBuffer;
use crate::{error::ExecuteError, memory::memory::InFrame, signal::Progress};
use skiagraph_graph::{Growth, Plan, ResourceId, ResourceKind};

/// Bytes of a counter.
const COUNTER: u64 = 4;

/// A buffer or texture that may grow, with the readback of its counter.
pub(super) struct GrowthReadback {
    /// Full name of the buffer or texture.
    pub name: String,
    /// Number of items or layers that the plan gives it.
    count: u64,
    growth: Growth,
    staging: ReadBuffer,
    /// True while a counter is in flight.
    is_asked: bool,
    /// Number of the last change before the frame of the last counter; `None` before the first one
    /// of this plan.
    counted: Option<u64>,
}

impl GrowthReadback {
    /// Returns the growing resources of a plan that are not at their greatest size.
    pub fn all(plan: &Plan, device: &wgpu::Device) -> Result<Vec<Self>, ExecuteError> {
        let readback = |(id, growth): (ResourceId, Growth)| {
            let resource = plan.resource(id);
            let count = match &resource.kind {
                ResourceKind::Buffer(buffer) => buffer.count?,
                ResourceKind::Texture(texture) => u64::from(texture.layers),
                _ => return None,
            };
            if count >= growth.max {
                return None;
            }
            let staging = ReadBuffer::new(device, &resource.name, "counter", COUNTER);
            Some(staging.map(|staging| Self {
                name: resource.name.clone(),
                count,
                growth,
                staging,
                is_asked: false,
                counted: None,
            }))
        };
        plan.growing().into_iter().filter_map(readback).collect()
    }

    /// Takes over the counters in flight for a former plan, by name. Otherwise a host that changes
    /// its plan in every frame would never see one.
    pub fn take_over(growth_readbacks: &mut [Self], before: Vec<Self>) {
        for old in before {
            let mut readbacks = growth_readbacks.iter_mut();
            if let Some(readback) = readbacks.find(|readback| readback.name == old.name) {
                readback.staging = old.staging;
                readback.is_asked = old.is_asked;
            }
        }
    }

    /// Encodes the copy of the counter, unless an earlier one is in flight. Returns true if the
    /// counter of this frame will be read, or that of an earlier one since the last change, which
    /// has the number `change`.
    pub fn copy(
        &mut self,
        change: u64,
        frame: InFrame<'_>,
        encoder: &mut wgpu::CommandEncoder,
    ) -> bool {
        if self.is_asked {
            return self.counted == Some(change);
        }
        let Ok((buffer, part)) = frame.bytes(&self.growth.counter) else {
            return false;
        };
        encoder.copy_buffer_to_buffer(buffer, part.start, &self.staging.buffer, 0, COUNTER);
        self.staging.map(encoder);
        self.is_asked = true;
        self.counted = Some(change);
        true
    }

    /// True while a counter is in flight.
    pub fn is_asked(&self) -> bool {
        self.is_asked
    }

    /// True while a counter has not arrived, which in a browser may come after its frame's end.
    #[cfg(target_arch = "wasm32")]
    pub fn is_under_way(&self) -> bool {
        self.is_asked && self.staging.is_being_mapped()
    }

    /// Returns the number of items or layers to grow to; `None` if the counter has not arrived or
    /// everything fits.
    pub fn wanted(&mut self) -> Option<u64> {
        let progress = self.staging.progress();
        if !self.is_asked || progress == Progress::UnderWay {
            return None;
        }
        self.is_asked = false;
        // Else the frame was never submitted, or the device is lost, as the next frame says.
        if progress != Progress::Done {
            return None;
        }
        let word = self.staging.take(|bytes| bytes.first_chunk().copied())??;
        let needed = u64::from(u32::from_ne_bytes(word));
        // A quarter more, so that a moving camera does not make it anew in every frame.
        let wanted = needed.saturating_add(needed / 4).min(self.growth.max);
        (needed > self.count).then_some(wanted)
    }
}
