//! Work of the CPU in the middle of a frame: what is encoded so far is submitted, items are copied
//! back, and what the work wrote is uploaded in front of the rest.

use crate::buffer;
use crate::error::{ExecuteError, scoped, submit, wait};
use crate::pipelines::handles::{GpuOperand, Handles};
use crate::signal::{Progress, Signal};
use skiagraph_graph::step::CpuCall;
use std::{ops::Range, time::Duration};
use web_time::Instant;

/// How often a frame that waits for the GPU asks whether it should go on.
const POLL_INTERVAL: Duration = Duration::from_millis(100);

/// Buffer that items are copied back through, kept for the next frame.
#[derive(Default)]
pub(super) struct Staging(Option<wgpu::Buffer>);

/// Means by which a frame waits.
pub(super) struct CpuTurn<'t> {
    pub device: &'t wgpu::Device,
    pub queue: &'t wgpu::Queue,
    pub staging: &'t mut Staging,
    /// Asked from time to time: true ends the frame.
    pub gives_up: &'t dyn Fn() -> bool,
    /// Time that the work of the pass took so far; `None` if it had none.
    pub worked: Option<Duration>,
    /// Number of the frame.
    pub frame: u32,
    /// True if a part of the frame was submitted.
    pub has_submitted: bool,
}

/// A range of bytes of a buffer.
type Bytes<'b> = (&'b wgpu::Buffer, Range<u64>);

impl CpuTurn<'_> {
    /// Has a call done; `encoder` is then a new one.
    pub fn call(
        &mut self,
        call: &CpuCall<Handles>,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), ExecuteError> {
        let (counter, place) = bytes(&call.count)?;
        let counter = [(counter, place.start..place.start + 4)];
        let count = self.read(&counter, encoder, |read| {
            let word = read[0].first_chunk().copied().unwrap_or_default();
            Ok(u64::from(u32::from_ne_bytes(word)))
        })?;
        let lists = call.reads.iter().chain([&call.writes]);
        let lists = lists.map(|items| Ok((bytes(&items.buffer)?, items.bytes)));
        let lists: Vec<(Bytes<'_>, u64)> = lists.collect::<Result<_, ExecuteError>>()?;
        let room = lists.iter();
        let room = room.map(|((_, place), size)| (place.end - place.start) / (*size).max(1));
        let count = room.fold(count, u64::min);
        if count == 0 {
            self.worked.get_or_insert_default();
            return Ok(());
        }
        let filled = lists.into_iter().map(|((buffer, place), size)| {
            let bytes = place.start..place.start + count * size;
            (buffer, bytes)
        });
        let mut reads: Vec<Bytes<'_>> = filled.collect();
        let target = reads.pop();
        let mut written = vec![0; (count * call.writes.bytes) as usize];
        let mut worked = Duration::ZERO;
        self.read(&reads, encoder, |read| {
            let began = Instant::now();
            let done = call.work.work.0.run(&call.entry, read, &mut written);
            worked = began.elapsed();
            done.map_err(|why| ExecuteError::CpuWork {
                name: call.work.name.clone(),
                why,
            })
        })?;
        *self.worked.get_or_insert_default() += worked;
        if let Some((target, place)) = target {
            self.queue.write_buffer(target, place.start, &written);
        }
        Ok(())
    }

    /// Submits what is encoded with copies of some bytes behind it, waits, and hands the bytes to
    /// `take`.
    fn read<T>(
        &mut self,
        from: &[Bytes<'_>],
        encoder: &mut wgpu::CommandEncoder,
        take: impl FnOnce(&[&[u8]]) -> Result<T, ExecuteError>,
    ) -> Result<T, ExecuteError> {
        let mut places = Vec::new();
        let mut end = 0;
        for (_, bytes) in from {
            let length = bytes.end - bytes.start;
            places.push(end..end + length);
            end = (end + length).next_multiple_of(wgpu::MAP_ALIGNMENT);
        }
        let staging = self.staging.take(end, self.device)?;
        for ((buffer, bytes), place) in from.iter().zip(&places) {
            let length = bytes.end - bytes.start;
            encoder.copy_buffer_to_buffer(buffer, bytes.start, &staging, place.start, length);
        }
        let mapped = Signal::default();
        mapped.when_mapped(&staging, wgpu::MapMode::Read, encoder);
        let next = wgpu::CommandEncoderDescriptor {
            label: Some("frame, behind work of the CPU"),
        };
        let next = self.device.create_command_encoder(&next);
        let done = std::mem::replace(encoder, next);
        submit((self.device, self.queue), done, self.frame)?;
        self.has_submitted = true;
        // After an error it may be mapped yet: it comes back behind `unmap` alone.
        self.wait_for(&mapped)?;
        let taken = {
            let failed = |_| ExecuteError::DeviceLost("items could not be copied back".to_owned());
            let places = places.into_iter();
            let views = places.map(|place| staging.get_mapped_range(place));
            let views: Vec<_> = views.collect::<Result<_, _>>().map_err(failed)?;
            let views: Vec<&[u8]> = views.iter().map(|view| &**view).collect();
            take(&views)
        };
        staging.unmap();
        self.staging.0 = Some(staging);
        taken
    }

    fn wait_for(&self, mapped: &Signal) -> Result<(), ExecuteError> {
        let began = Instant::now();
        loop {
            wait(self.device, Some(POLL_INTERVAL))?;
            match mapped.progress() {
                Progress::Done => return Ok(()),
                Progress::UnderWay if (self.gives_up)() => {
                    return Err(ExecuteError::Unfinished {
                        after: began.elapsed(),
                        passes: "passes in front of work of the CPU".to_owned(),
                    });
                }
                // Another thread may have polled.
                Progress::UnderWay => std::thread::sleep(Duration::from_micros(50)),
                Progress::Failed | Progress::Dropped => {
                    let why = "items could not be copied back for the CPU";
                    return Err(ExecuteError::DeviceLost(why.to_owned()));
                }
            }
        }
    }
}

impl Staging {
    /// Takes the buffer out if it has at least `size` bytes, or else makes one that has.
    fn take(&mut self, size: u64, device: &wgpu::Device) -> Result<wgpu::Buffer, ExecuteError> {
        if let Some(buffer) = self.0.take().filter(|buffer| buffer.size() >= size) {
            return Ok(buffer);
        }
        let name = "items for the CPU";
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        scoped(device, name, || buffer::make(device, name, size, usage))
    }
}

fn bytes(operand: &GpuOperand) -> Result<Bytes<'_>, ExecuteError> {
    match operand {
        GpuOperand::Buffer { buffer, range } => Ok((buffer, range.clone())),
        GpuOperand::Texture { .. } => Err(ExecuteError::Internal("the CPU works on buffers alone")),
    }
}
