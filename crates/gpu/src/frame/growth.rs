//! Buffers that grow: after a frame the counter says how many items it would have needed.

use super::{executor::Executor, replan::ReplanReport};
use crate::{
    error::{ExecuteError, poll, scoped},
    memory::{
        memory::{Memory, bytes},
        physical::PingPong,
    },
    provider::Provider,
};
use skiagraph_graph::{Growth, Plan, ResourceId, ResourceKind};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Bytes of a counter.
const COUNTER: u64 = 4;

/// A buffer that may grow, and its counter on the way to the host.
pub(super) struct Watch {
    name: String,
    count: u64,
    growth: Growth,
    staging: wgpu::Buffer,
    state: State,
}

enum State {
    Idle,
    /// Copied in a frame that was encoded.
    Copied,
    Mapping(Receiver<Result<(), wgpu::BufferAsyncError>>),
}

impl Watch {
    /// Those of a plan that have not yet grown as far as they may.
    pub fn all(plan: &Plan, device: &wgpu::Device) -> Result<Vec<Self>, ExecuteError> {
        let watch = |(id, growth): (ResourceId, Growth)| {
            let resource = plan.resource(id);
            let ResourceKind::Buffer(buffer) = &resource.kind else {
                return None;
            };
            let count = buffer.count.filter(|count| *count < growth.max)?;
            let staging = scoped(device, &resource.name, || {
                device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("counter"),
                    size: COUNTER,
                    usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                })
            });
            Some(staging.map(|staging| Self {
                name: resource.name.clone(),
                count,
                growth,
                staging,
                state: State::Idle,
            }))
        };
        plan.growing().into_iter().filter_map(watch).collect()
    }

    /// Encodes the copy of the counter, unless an earlier one is under way.
    pub fn copy(
        &mut self,
        plan: &Plan,
        memory: &Memory,
        ping_pong: &PingPong,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let counter = &self.growth.counter;
        if !matches!(self.state, State::Idle) {
            return;
        }
        let Ok(buffer) = memory.buffer(counter.id, ping_pong) else {
            return;
        };
        let part = bytes(plan.resource(counter.id), &counter.part, buffer.size());
        encoder.copy_buffer_to_buffer(buffer, part.start, &self.staging, 0, COUNTER);
        self.state = State::Copied;
    }

    /// Starts the mapping; the frame must have been submitted.
    pub fn map(&mut self) {
        if !matches!(self.state, State::Copied) {
            return;
        }
        let (send, receive) = channel();
        self.staging
            .map_async(wgpu::MapMode::Read, .., move |result| {
                // The receiver is gone if the executor was dropped meanwhile.
                let _ = send.send(result);
            });
        self.state = State::Mapping(receive);
    }

    /// How many items the buffer should have, if it has too few and the counter has arrived.
    fn wanted(&mut self) -> Option<u64> {
        let State::Mapping(receiver) = &self.state else {
            return None;
        };
        match receiver.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Ok(Ok(())) => self.state = State::Idle,
            // The device is lost: the next frame says so.
            Ok(Err(_)) | Err(TryRecvError::Disconnected) => {
                self.state = State::Idle;
                return None;
            }
        }
        let mapped = self.staging.get_mapped_range(..).ok()?;
        let word: Option<[u8; 4]> = mapped.get(..4).and_then(|word| word.try_into().ok());
        drop(mapped);
        self.staging.unmap();
        let needed = u64::from(u32::from_ne_bytes(word?));
        // A quarter more, so that a moving camera does not make it anew in every frame.
        let wanted = needed.saturating_add(needed / 4).min(self.growth.max);
        (needed > self.count).then_some(wanted)
    }
}

impl Executor {
    /// Makes buffers with `grow` larger that were too small for a frame that is done; call it
    /// between frames. It never waits: a counter that has not arrived is looked at the next time.
    /// `None` if there was nothing to do. Where the memory limit or the device refuses larger
    /// buffers, what the document does for items that have no room holds, and nothing is tried
    /// until the plan changes otherwise.
    ///
    /// # Errors
    /// If the device was lost, or a provided resource that has changed cannot be built. The
    /// executor is as it was then, and the next frame asks again.
    pub fn grow(
        &mut self,
        provider: &mut dyn Provider,
    ) -> Result<Option<ReplanReport>, ExecuteError> {
        let mut states = self.state.watches.iter().map(|watch| &watch.state);
        if !states.any(|state| matches!(state, State::Mapping(_))) {
            return Ok(None);
        }
        poll(&self.device, wgpu::PollType::Poll)?;
        let mut grown = self.plan().grown().clone();
        let mut is_new = false;
        for watch in &mut self.state.watches {
            if let Some(wanted) = watch.wanted() {
                grown.insert(watch.name.clone(), wanted);
                is_new = true;
            }
        }
        if !is_new {
            return Ok(None);
        }
        let larger = self.plan().with(|request| request.grown = grown);
        let report = match larger {
            Ok(plan) => self.replace_graph(plan, provider),
            // The host's limit for memory.
            Err(diagnostics) => Err(diagnostics.into()),
        };
        match report {
            Err(
                ExecuteError::Plan(_)
                | ExecuteError::OutOfMemory { .. }
                | ExecuteError::Resource { .. }
                | ExecuteError::Gpu { .. },
            ) => {
                self.state.watches.clear();
                Ok(None)
            }
            report => report.map(Some),
        }
    }
}
