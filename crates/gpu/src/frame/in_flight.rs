//! Frames between their encoding and their report. Any number may be under way; each has its own
//! readbacks, its own times and its own copy of the uniform `frame`.

use super::{
    fetch::{Fetch, StagingPool},
    report::FrameReport,
    statistics::Counters,
    timer::{Timer, times},
    times::FrameTiming,
    uniform::FrameUniform,
};
use crate::{
    error::{ExecuteError, poll},
    presence::Presence,
    signal::{Progress, Signal},
};
use std::{collections::VecDeque, sync::Arc, time::Duration};

/// A frame that was encoded, with what was asked of it.
#[derive(Default)]
pub(super) struct FrameInFlight {
    pub index: u32,
    done: Signal,
    /// Timer of a timed frame, kept for the next timed one.
    pub timer: Option<Timer>,
    pub is_timed: bool,
    /// Counters of a frame that asks how often its shaders run.
    pub counters: Option<Counters>,
    /// If it is timed: the passes that run, with the time that encoding them took. Names, because
    /// the next plan may have other passes.
    pub cpu: Vec<(Arc<str>, Duration)>,
    pub skipped: Vec<Arc<str>>,
    pub fetches: Vec<Fetch>,
    /// Kept like the timer.
    pub uniform: Option<FrameUniform>,
}

/// The frames that are under way, and what is left of earlier ones for the next.
#[derive(Default)]
pub(super) struct FramesInFlight {
    under_way: VecDeque<FrameInFlight>,
    spare: Vec<FrameInFlight>,
    pub staging: StagingPool,
}

impl FrameInFlight {
    fn is_asked(&self) -> bool {
        self.is_timed || self.counters.is_some() || !self.fetches.is_empty()
    }

    /// Starts the mapping of its timestamps, once the GPU is done with it, and takes them; `None`
    /// if another thread that polls the device is about to say that they are there.
    fn times(&mut self, device: &wgpu::Device) -> Result<Option<FrameTiming>, ExecuteError> {
        let Some(timer) = &mut self.timer else {
            return Ok(Some(times(&self.cpu, &[])));
        };
        if timer.end_frame()? {
            poll(device, wgpu::PollType::Poll)?;
        }
        Ok(timer.take(&self.cpu))
    }
}

impl FramesInFlight {
    /// The frames that bring a report.
    pub fn asked(&self) -> usize {
        self.under_way
            .iter()
            .filter(|frame_in_flight| frame_in_flight.is_asked())
            .count()
    }

    /// A frame to fill, out of what an earlier one has left.
    pub fn begin(&mut self) -> FrameInFlight {
        self.sweep();
        self.spare.pop().unwrap_or_default()
    }

    /// Takes in a frame all of which is encoded.
    pub fn submit(&mut self, frame_in_flight: FrameInFlight, encoder: &wgpu::CommandEncoder) {
        frame_in_flight.done.when_done(encoder);
        self.under_way.push_back(frame_in_flight);
    }

    /// Keeps what the next frame can use of one that is over, or was never encoded.
    pub fn recycle(&mut self, mut frame_in_flight: FrameInFlight) {
        for fetch in frame_in_flight.fetches.drain(..) {
            fetch.give_up(&mut self.staging);
        }
        frame_in_flight.cpu.clear();
        frame_in_flight.skipped.clear();
        frame_in_flight.is_timed = false;
        frame_in_flight.counters = None;
        self.spare.push(frame_in_flight);
    }

    /// Puts aside the frames that are over and of which nothing was asked.
    fn sweep(&mut self) {
        let mut at = 0;
        while let Some(frame_in_flight) = self.under_way.get(at) {
            if frame_in_flight.is_asked() || frame_in_flight.done.progress() == Progress::UnderWay {
                at += 1;
            } else if let Some(over) = self.under_way.remove(at) {
                self.recycle(over);
            }
        }
    }

    /// The report of the oldest frame that brings one, if it is done. Frames that were never
    /// submitted bring none.
    pub fn report(
        &mut self,
        device: &wgpu::Device,
        presence: &Presence,
    ) -> Result<Option<FrameReport>, ExecuteError> {
        self.sweep();
        while let Some(mut frame_in_flight) = self.under_way.pop_front() {
            match frame_in_flight.done.progress() {
                Progress::UnderWay => {
                    self.under_way.push_front(frame_in_flight);
                    // A lost device does not report that work under way will never come.
                    presence.check()?;
                    return Ok(None);
                }
                Progress::Done => {}
                Progress::Failed | Progress::Dropped => {
                    // Results already written into its queries are dropped.
                    frame_in_flight.timer = None;
                    self.recycle(frame_in_flight);
                    presence.check()?;
                    continue;
                }
            }
            let timing = if frame_in_flight.is_timed {
                match frame_in_flight.times(device) {
                    Ok(Some(timing)) => Some(timing),
                    Ok(None) => {
                        self.under_way.push_front(frame_in_flight);
                        // They never come from a device that is lost meanwhile.
                        presence.check()?;
                        return Ok(None);
                    }
                    Err(error) => {
                        frame_in_flight.timer = None;
                        self.recycle(frame_in_flight);
                        return Err(error);
                    }
                }
            } else {
                None
            };
            let fetched: Result<Vec<_>, _> = frame_in_flight
                .fetches
                .drain(..)
                .map(|fetch| fetch.take(&mut self.staging))
                .collect();
            let counted = frame_in_flight
                .counters
                .as_mut()
                .map(Counters::take)
                .transpose();
            let report = fetched.and_then(|readbacks| {
                Ok(FrameReport {
                    index: frame_in_flight.index,
                    timing,
                    statistics: counted?,
                    skipped: names(&frame_in_flight.skipped),
                    readbacks,
                })
            });
            self.recycle(frame_in_flight);
            if report.is_err() {
                presence.check()?;
            }
            return report.map(Some);
        }
        Ok(None)
    }

    /// Takes no GPU times of the oldest frame: they have not come although the GPU is done.
    pub fn give_up_times(&mut self) {
        if let Some(frame_in_flight) = self
            .under_way
            .iter_mut()
            .find(|frame_in_flight| frame_in_flight.is_asked())
        {
            frame_in_flight.timer = None;
        }
    }
}

pub(super) fn names(names: &[Arc<str>]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}
