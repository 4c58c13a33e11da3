//! Signals by which wgpu's callbacks tell that GPU work is done. They are polled without waiting.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// State of a piece of work that a [`Signal`] follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    /// The work is done, or none was started.
    Done,
    /// The work is not submitted or not done.
    UnderWay,
    /// wgpu refused it, or the device is lost.
    Failed,
    /// The work will never be done: its encoder was dropped without being submitted.
    Dropped,
}

/// Bits of the state of a piece of work.
const STATE: u32 = 0b11;

impl Progress {
    /// All states by number.
    const ALL: [Self; 4] = [Self::Done, Self::UnderWay, Self::Failed, Self::Dropped];
}

/// Follows the progress of one piece of work after another. Holds the number of the work and, in
/// the two lowest bits, its state.
#[derive(Debug, Default)]
pub(crate) struct Signal(Arc<AtomicU32>);

/// The other end of a [`Signal`], which a callback holds, and the value while its work is under
/// way. A callback of earlier work, which another thread may be ending, thus tells nothing.
struct Teller(Arc<AtomicU32>, u32);

impl Signal {
    pub fn progress(&self) -> Progress {
        Progress::ALL[(self.0.load(Ordering::Acquire) & STATE) as usize]
    }

    /// Maps a buffer as soon as the encoder is submitted, and signals when it is mapped.
    pub fn when_mapped(
        &self,
        buffer: &wgpu::Buffer,
        mode: wgpu::MapMode,
        encoder: &wgpu::CommandEncoder,
    ) {
        let teller = self.teller();
        encoder.map_buffer_on_submit(buffer, mode, .., move |result| teller.tell_mapped(&result));
    }

    /// Starts mapping a buffer that no submitted work uses, and signals when it is mapped. On a
    /// lost device it signals the failure at once.
    pub fn when_mapped_now(&self, buffer: &wgpu::Buffer, mode: wgpu::MapMode) {
        let teller = self.teller();
        buffer.map_async(mode, .., move |result| teller.tell_mapped(&result));
    }

    /// Returns the teller of new work. Earlier work must be over, though its callback may not be.
    fn teller(&self) -> Teller {
        let work = (self.0.load(Ordering::Acquire) | STATE).wrapping_add(1);
        let under_way = work | Progress::UnderWay as u32;
        self.0.store(under_way, Ordering::Release);
        Teller(self.0.clone(), under_way)
    }
}

impl Teller {
    fn tell_mapped(&self, result: &Result<(), wgpu::BufferAsyncError>) {
        self.tell(match result {
            Ok(()) => Progress::Done,
            Err(_) => Progress::Failed,
        });
    }

    /// Tells how the work ended, unless it has been told, or the signal follows other work.
    fn tell(&self, how: Progress) {
        let ended = self.1 & !STATE | how as u32;
        let (before, after) = (Ordering::AcqRel, Ordering::Acquire);
        self.0.compare_exchange(self.1, ended, before, after).ok();
    }
}

/// wgpu drops the callbacks of an encoder that is dropped.
impl Drop for Teller {
    fn drop(&mut self) {
        self.tell(Progress::Dropped);
    }
}
