//! Signals from wgpu's callbacks that work of the GPU is done, polled without waiting.

use std::sync::{
    Arc,
    atomic::{AtomicU8, Ordering},
};

/// How far something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    /// It has come, or nothing was asked for.
    Done,
    /// Not submitted, or not done.
    UnderWay,
    /// wgpu refused it, or the device is lost.
    Failed,
    /// It will not come: the encoder was dropped and not submitted.
    Dropped,
}

impl Progress {
    /// By their numbers.
    const ALL: [Self; 4] = [Self::Done, Self::UnderWay, Self::Failed, Self::Dropped];
}

/// The progress of one thing after the other.
#[derive(Debug, Default)]
pub(crate) struct Signal(Arc<AtomicU8>);

/// The other end of a [`Signal`], which a callback holds.
struct Teller(Arc<AtomicU8>);

impl Signal {
    pub fn progress(&self) -> Progress {
        Progress::ALL[usize::from(self.0.load(Ordering::Acquire))]
    }

    /// Says when the GPU is done with what is in the encoder.
    pub fn when_done(&self, encoder: &wgpu::CommandEncoder) {
        let teller = self.teller();
        encoder.on_submitted_work_done(move || teller.tell(Progress::Done));
    }

    /// Maps a buffer as soon as the encoder is submitted, and says when it is mapped.
    pub fn when_mapped(
        &self,
        buffer: &wgpu::Buffer,
        mode: wgpu::MapMode,
        encoder: &wgpu::CommandEncoder,
    ) {
        let teller = self.teller();
        encoder.map_buffer_on_submit(buffer, mode, .., move |result| teller.tell_mapped(&result));
    }

    /// Asks for the mapping of a buffer that no submitted work uses, and says when it is mapped;
    /// where the device is lost, says at once that it failed.
    pub fn when_mapped_now(&self, buffer: &wgpu::Buffer, mode: wgpu::MapMode) {
        let teller = self.teller();
        buffer.map_async(mode, .., move |result| teller.tell_mapped(&result));
    }

    /// Returns the teller of new work; earlier work must be over.
    fn teller(&self) -> Teller {
        let teller = Teller(self.0.clone());
        teller.tell(Progress::UnderWay);
        teller
    }
}

impl Teller {
    fn tell_mapped(&self, result: &Result<(), wgpu::BufferAsyncError>) {
        self.tell(match result {
            Ok(()) => Progress::Done,
            Err(_) => Progress::Failed,
        });
    }

    fn tell(&self, how: Progress) {
        self.0.store(how as u8, Ordering::Release);
    }
}

/// wgpu drops the callbacks of an encoder that is dropped.
impl Drop for Teller {
    fn drop(&mut self) {
        if self.0.load(Ordering::Acquire) == Progress::UnderWay as u8 {
            self.tell(Progress::Dropped);
        }
    }
}
