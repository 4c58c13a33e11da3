//! Signals from wgpu's callbacks that work of the GPU is done, polled without waiting.

use std::sync::{
    Arc,
    atomic::{AtomicU8, Ordering},
};

/// How far something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    /// Not submitted, or not done.
    UnderWay,
    /// It has come, or nothing was asked for.
    Done,
    /// wgpu refused it, or the device is lost.
    Failed,
    /// It will not come: the encoder was dropped and not submitted.
    Dropped,
}

/// State of finished work, and of a signal that was never waited for.
const DONE: u8 = 0;
const UNDER_WAY: u8 = 1;
const FAILED: u8 = 2;
const DROPPED: u8 = 3;

/// The progress of one thing after the other.
#[derive(Debug, Default)]
pub(crate) struct Signal(Arc<AtomicU8>);

/// The other end of a [`Signal`], which a callback holds.
struct Teller(Arc<AtomicU8>);

impl Signal {
    pub fn progress(&self) -> Progress {
        match self.0.load(Ordering::Acquire) {
            UNDER_WAY => Progress::UnderWay,
            DONE => Progress::Done,
            FAILED => Progress::Failed,
            _ => Progress::Dropped,
        }
    }

    /// Says when the GPU is done with what is in the encoder.
    pub fn when_done(&self, encoder: &wgpu::CommandEncoder) {
        let teller = self.teller();
        encoder.on_submitted_work_done(move || teller.tell(DONE));
    }

    /// Maps a buffer as soon as the encoder is submitted, and says when it is mapped.
    pub fn when_mapped(
        &self,
        buffer: &wgpu::Buffer,
        mode: wgpu::MapMode,
        encoder: &wgpu::CommandEncoder,
    ) {
        let teller = self.teller();
        encoder.map_buffer_on_submit(buffer, mode, .., move |result| {
            teller.tell(if result.is_ok() { DONE } else { FAILED });
        });
    }

    /// Asks for the mapping of a buffer that no submitted work uses, and says when it is mapped;
    /// where the device is lost, says at once that it failed.
    pub fn when_mapped_now(&self, buffer: &wgpu::Buffer, mode: wgpu::MapMode) {
        let teller = self.teller();
        buffer.map_async(mode, .., move |result| {
            teller.tell(if result.is_ok() { DONE } else { FAILED });
        });
    }

    /// Returns the teller of new work; earlier work must be over.
    fn teller(&self) -> Teller {
        self.0.store(UNDER_WAY, Ordering::Release);
        Teller(self.0.clone())
    }
}

impl Teller {
    fn tell(&self, how: u8) {
        self.0.store(how, Ordering::Release);
    }
}

/// wgpu drops the callbacks of an encoder that is dropped.
impl Drop for Teller {
    fn drop(&mut self) {
        if self.0.load(Ordering::Acquire) == UNDER_WAY {
            self.tell(DROPPED);
        }
    }
}
