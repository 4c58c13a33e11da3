//! Numbers that frames leave on the GPU. They tell which frames ran, and in which order: wgpu calls
//! the callbacks of commands that it has refused, too.

use super::read_buffer::ReadBuffer;
use crate::buffer;
use crate::error::{ExecuteError, scoped};

/// Bytes of a number.
const BYTES: u64 = 8;

/// How many numbers are made at once.
const NUMBERS: u64 = 1024;

/// The numbers of frames, counted from 1 and never used again, and that of the frame that ran last.
pub(super) struct Numbers {
    /// Number of the last frame that ran and that later ones follow; 0 before the first one.
    last: wgpu::Buffer,
    /// The numbers from `first` on, to be copied.
    source: wgpu::Buffer,
    first: u64,
    next: u64,
}

impl Numbers {
    pub fn new(device: &wgpu::Device) -> Result<Self, ExecuteError> {
        let usage = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        Ok(Self {
            last: scoped(device, NAME, || buffer::make(device, NAME, BYTES, usage))?,
            source: source(1, device)?,
            first: 1,
            next: 1,
        })
    }

    /// Returns the number of the next frame.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Takes a number.
    pub fn take(&mut self, device: &wgpu::Device) -> Result<u64, ExecuteError> {
        if self.next == self.first + NUMBERS {
            self.source = source(self.next, device)?;
            self.first = self.next;
        }
        self.next += 1;
        Ok(self.next - 1)
    }
}

/// Creates the buffer of numbers that begin with `first`.
fn source(first: u64, device: &wgpu::Device) -> Result<wgpu::Buffer, ExecuteError> {
    let numbers = (first..first + NUMBERS).flat_map(u64::to_ne_bytes);
    let content: Vec<u8> = numbers.collect();
    let (usage, failed) = (wgpu::BufferUsages::COPY_SRC, "the numbers were not mapped");
    scoped(device, NAME, || {
        buffer::filled(device, NAME, &content, usage, failed)
    })?
}

/// Knowledge about a frame that was encoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Fate {
    /// It is not submitted or not done.
    #[default]
    Pending,
    /// It ran, and the frame before it has this number.
    RanAfter(u64),
    /// It never ran: its encoder was dropped, or wgpu refused its commands.
    Lost,
}

/// Readback of a frame's number, and of that of the frame that ran before it.
pub(super) struct Stamp(ReadBuffer);

impl Stamp {
    pub fn new(device: &wgpu::Device) -> Result<Self, ExecuteError> {
        ReadBuffer::new(device, NAME, NAME, 2 * BYTES).map(Self)
    }

    /// Encodes the copies, behind all else of the frame. Later frames follow it if `is_followed` is
    /// set.
    pub fn copy(
        &self,
        number: u64,
        is_followed: bool,
        numbers: &Numbers,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let Numbers { last, source, .. } = numbers;
        let at = (number - numbers.first) * BYTES;
        encoder.copy_buffer_to_buffer(last, 0, &self.0.buffer, 0, BYTES);
        encoder.copy_buffer_to_buffer(source, at, &self.0.buffer, BYTES, BYTES);
        if is_followed {
            encoder.copy_buffer_to_buffer(source, at, last, 0, BYTES);
        }
        self.0.map(encoder);
    }

    /// Returns what is known of the frame with this number. After another answer than `Pending` the
    /// stamp can be used for another frame.
    pub fn fate(&self, number: u64) -> Fate {
        if self.0.is_being_mapped() {
            return Fate::Pending;
        }
        // wgpu-core drops callbacks, too, where it panics in a wait (see `poll`): then the buffer
        // is mapped all the same.
        let numbers = self.0.take(|bytes| {
            let numbers = bytes.as_chunks().0.first_chunk();
            numbers.map(|[before, own]| [*before, *own].map(u64::from_ne_bytes))
        });
        // In a buffer that commands did not write, an earlier number stands.
        match numbers.flatten() {
            Some([before, own]) if own == number => Fate::RanAfter(before),
            _ => Fate::Lost,
        }
    }
}

const NAME: &str = "numbers of frames";
