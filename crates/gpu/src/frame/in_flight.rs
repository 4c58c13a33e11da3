//! Frames between their encoding and their report. Any number may be in flight; each has its own
//! readbacks, timer and copy of the uniform `frame`.

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

/// An encoded frame with the requests of the host.
#[derive(Default)]
pub(super) struct FrameInFlight {
    pub index: u32,
    done: Signal,
    /// Timer of a timed frame, kept for the next timed one.
    pub timer: Option<Timer>,
    pub is_timed: bool,
    /// Counters, if the frame asks for statistics.
    pub counters: Option<Counters>,
    /// CPU time of encoding each pass that runs, by name, if the frame is timed. Names are used
    /// because the next plan may have other passes.
    pub cpu: Vec<(Arc<str>, Duration)>,
    pub skipped: Vec<Arc<str>>,
    pub fetches: Vec<Fetch>,
    /// True if no mapping is waited for any longer.
    is_given_up: bool,
    /// Source of the uniform `frame`, kept for the next frame as the timer is.
    pub uniform: Option<FrameUniform>,
}

/// The frames in flight, and the parts of finished ones that later frames reuse.
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

    /// True if a buffer is not mapped yet although the frame is done: another thread that polls the
    /// device holds the callback, and is about to call it.
    fn is_being_mapped(&self) -> bool {
        let mut fetches = self.fetches.iter();
        let counters = self.counters.as_ref();
        !self.is_given_up
            && (fetches.any(Fetch::is_being_mapped)
                || counters.is_some_and(Counters::is_being_mapped))
    }

    /// Starts the mapping of the timestamps and returns the frame's times. `None` if another thread
    /// that polls the device has not yet signalled that they are mapped.
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
    /// Returns the number of frames that will bring a report.
    pub fn asked(&self) -> usize {
        self.under_way
            .iter()
            .filter(|frame_in_flight| frame_in_flight.is_asked())
            .count()
    }

    /// Returns an empty frame, with the reusable parts of a finished one.
    pub fn begin(&mut self) -> FrameInFlight {
        self.sweep();
        self.spare.pop().unwrap_or_default()
    }

    /// Puts an encoded frame in flight.
    pub fn submit(&mut self, frame_in_flight: FrameInFlight, encoder: &wgpu::CommandEncoder) {
        frame_in_flight.done.when_done(encoder);
        self.under_way.push_back(frame_in_flight);
    }

    /// Keeps the reusable parts of a frame that is finished or was not encoded.
    pub fn recycle(&mut self, mut frame_in_flight: FrameInFlight) {
        for fetch in frame_in_flight.fetches.drain(..) {
            fetch.give_up(&mut self.staging);
        }
        frame_in_flight.cpu.clear();
        frame_in_flight.skipped.clear();
        frame_in_flight.is_timed = false;
        frame_in_flight.is_given_up = false;
        frame_in_flight.counters = None;
        self.spare.push(frame_in_flight);
    }

    /// Recycles the finished frames without requests.
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

    /// Returns the report of the oldest frame with requests; `None` if the GPU has not finished it.
    /// Frames that were never submitted bring none.
    pub fn report(
        &mut self,
        device: &wgpu::Device,
        presence: &Presence,
    ) -> Result<Option<FrameReport>, ExecuteError> {
        self.sweep();
        while let Some(mut frame_in_flight) = self.under_way.pop_front() {
            match frame_in_flight.done.progress() {
                Progress::Done if !frame_in_flight.is_being_mapped() => {}
                Progress::Done | Progress::UnderWay => {
                    self.under_way.push_front(frame_in_flight);
                    // A lost device does not report that work under way will never come.
                    presence.check()?;
                    return Ok(None);
                }
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

    /// Gives up the GPU times of the oldest frame with requests, and waits for no mapping, if the
    /// GPU is done: they did not arrive.
    pub fn give_up(&mut self) {
        if let Some(frame_in_flight) = self
            .under_way
            .iter_mut()
            .find(|frame_in_flight| frame_in_flight.is_asked())
            && frame_in_flight.done.progress() == Progress::Done
        {
            frame_in_flight.timer = None;
            frame_in_flight.is_given_up = true;
        }
    }
}

pub(super) fn names(names: &[Arc<str>]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}
