//! Counters of buffers that grow, on their way to the host: copied behind a frame, mapped after its
//! submission, looked at when they have arrived.

use crate::{
    error::{ExecuteError, scoped},
    memory::{
        memory::{Memory, bytes},
        physical::PingPong,
    },
};
use skiagraph_graph::{Growth, Plan, ResourceId, ResourceKind};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Bytes of a counter.
const COUNTER: u64 = 4;

/// A buffer that may grow, and its counter on the way to the host.
pub(super) struct Watch {
    /// Full name of the buffer.
    pub name: String,
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

    /// Goes on with what a plan before had under way for the same buffers: a host that changes its
    /// plan in every frame would lose each counter otherwise.
    pub fn take_over(watches: &mut [Self], before: Vec<Self>) {
        for old in before {
            if let Some(watch) = watches.iter_mut().find(|watch| watch.name == old.name) {
                (watch.staging, watch.state) = (old.staging, old.state);
            }
        }
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

    /// Whether a counter is on its way.
    pub fn is_mapping(&self) -> bool {
        matches!(self.state, State::Mapping(_))
    }

    /// How many items the buffer should have, if it has too few and the counter has arrived.
    pub fn wanted(&mut self) -> Option<u64> {
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
