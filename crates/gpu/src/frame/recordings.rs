//! Commands that were recorded into encoders of the host, until they are known to have run.

use super::stamp::{Fate, Numbers, Stamp};
use crate::error::{ExecuteError, poll};
use std::collections::VecDeque;

/// Commands that a provider has recorded into encoders of the host, with what is needed to record
/// them again. The host may drop an encoder, or submit two in the other order. So commands are kept
/// until they have run in the order of recording, which numbers on the GPU tell.
pub struct Recordings<T> {
    numbers: Option<Numbers>,
    kept: VecDeque<Recording<T>>,
    /// Stamps of commands that have run.
    spare: Vec<Stamp>,
}

struct Recording<T> {
    commands: T,
    number: u64,
    stamp: Stamp,
    fate: Fate,
}

impl<T> Default for Recordings<T> {
    fn default() -> Self {
        Self {
            numbers: None,
            kept: VecDeque::new(),
            spare: Vec::new(),
        }
    }
}

impl<T> Recordings<T> {
    /// Keeps commands that were just recorded into an encoder, which follow all that are kept.
    ///
    /// # Errors
    /// [`ExecuteError::OutOfMemory`] or [`ExecuteError::Gpu`] if the device refuses the buffers for
    /// a number.
    pub fn keep(
        &mut self,
        commands: T,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), ExecuteError> {
        let numbers = match &mut self.numbers {
            Some(numbers) => numbers,
            none => none.insert(Numbers::new(device)?),
        };
        let number = numbers.take(device)?;
        let stamp = self.spare.pop();
        let stamp = stamp.map_or_else(|| Stamp::new(device), Ok)?;
        stamp.copy(number, true, numbers, encoder);
        self.kept.push_back(Recording {
            commands,
            number,
            stamp,
            fate: Fate::Pending,
        });
        Ok(())
    }

    /// Forgets commands that have run. Returns those that must be recorded again, in order: those
    /// of an encoder that was dropped or refused, or that ran after a later one, and all behind
    /// them.
    ///
    /// # Errors
    /// [`ExecuteError::DeviceLost`] if the device is lost.
    pub fn lost(&mut self, device: &wgpu::Device) -> Result<Vec<T>, ExecuteError> {
        if self.kept.is_empty() {
            return Ok(Vec::new());
        }
        poll(device, wgpu::PollType::Poll)?;
        let pending = self.kept.iter_mut();
        for it in pending.filter(|it| it.fate == Fate::Pending) {
            it.fate = it.stamp.fate(it.number);
        }
        let has_run = |it: &Recording<T>| matches!(it.fate, Fate::RanAfter(n) if n < it.number);
        let is_lost = |it: &Recording<T>| it.fate != Fate::Pending && !has_run(it);
        let first = self.kept.iter().position(is_lost);
        let lost = first.map(|first| self.kept.drain(first..).map(|it| it.commands).collect());
        while self.kept.front().is_some_and(has_run) {
            self.spare.extend(self.kept.pop_front().map(|it| it.stamp));
        }
        Ok(lost.unwrap_or_default())
    }

    /// Takes all commands that are not known to have run, in order.
    pub fn take(&mut self) -> Vec<T> {
        self.kept.drain(..).map(|it| it.commands).collect()
    }

    /// Returns all commands that are not known to have run, in order.
    pub fn iter(&self) -> impl Iterator<Item = &T> {
        self.kept.iter().map(|it| &it.commands)
    }
}
