//! Frames between their encoding and their report. Any number may be in flight; each has its own
//! readbacks, timer and copies of uniforms, and what is to be taken back if it never runs.
//!
//! A frame is encoded for the contents that the frames before it leave. So each tells, when it is
//! done, which one ran before it. If that is another one than the frame was encoded to follow, or a
//! frame never ran, then those that were encoded meanwhile may show something stale.

use super::contents::Contents;
use super::fetch::{Fetch, StagingPool};
use super::host_changes::Changed;
use super::report::{FaultKind, FrameFault, FrameReport};
use super::stamp::{Fate, Numbers, Stamp};
use super::statistics::Counters;
use super::timer::{Timer, times};
use super::times::FrameTiming;
use super::uniform::FrameUniforms;
use crate::error::{ExecuteError, poll};
use crate::memory::memory::Grown;
use crate::presence::Presence;
use std::{collections::VecDeque, sync::Arc, time::Duration};

/// Most faults that wait for the host; older ones are forgotten.
const FAULTS: usize = 1024;

/// An encoded frame with the requests of the host.
#[derive(Default)]
pub(super) struct FrameInFlight {
    pub index: u32,
    /// Number that the frame leaves on the GPU; 0 if it leaves none.
    pub number: u64,
    stamp: Option<Stamp>,
    fate: Fate,
    /// True if `fate` was not known when the frames were last looked at.
    is_news: bool,
    /// True if passes run in the frame, so that later ones find other contents.
    pub is_followed: bool,
    /// Number of the frame before.
    follows: u64,
    /// True if the frame must run right after that one; if not, after those before that leave
    /// contents which it goes on from.
    is_strict: bool,
    fault: Option<FaultKind>,
    /// Contents before the frame.
    pub before: Contents,
    /// Changes that its passes were told.
    pub changed: Changed,
    /// Contents that it copies into larger resources.
    pub grown: Vec<Grown>,
    /// Number of changes before it, if the next frame can rest after it.
    pub changes: Option<u64>,
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
    /// Source of the uniforms, kept for the next frame as the timer is.
    pub uniforms: Option<FrameUniforms>,
}

/// The frames in flight, and the parts of finished ones that later frames reuse.
pub(super) struct FramesInFlight {
    /// In the order of encoding.
    pub under_way: VecDeque<FrameInFlight>,
    spare: Vec<FrameInFlight>,
    pub staging: StagingPool,
    numbers: Numbers,
    /// Number of the last frame that was encoded and not found lost.
    newest: u64,
    /// True if the next frame must run right after that one.
    is_strict: bool,
    /// First number of the frames that were encoded since the last fault was found.
    since_fault: u64,
    /// Faults that the host has not asked for.
    pub faults: Vec<FrameFault>,
}

/// Consequences of the frames that are known to have run, or to be lost.
#[derive(Default)]
pub(super) struct Setback {
    /// Number of changes before the last frame that ran.
    pub settled: Option<u64>,
    /// True if a frame is lost.
    pub is_lost: bool,
    /// Number of the first lost frame behind which no other was encoded.
    pub rewind: Option<u64>,
    /// True if frames may have run on other contents than they were encoded for.
    pub forgets: bool,
}

impl FrameInFlight {
    fn is_asked(&self) -> bool {
        self.is_timed || self.counters.is_some() || !self.fetches.is_empty()
    }

    /// True if the frame is known to have never run.
    pub fn is_lost(&self) -> bool {
        self.fate == Fate::Lost
    }

    /// True if the frame, which ran right after that with the number `before`, goes on from
    /// contents of an earlier one that had not run by then.
    fn lacks(&self, earlier: &Self, before: u64) -> bool {
        let is_later = earlier.fate == Fate::Pending && earlier.number != before;
        is_later && (!earlier.grown.is_empty() || self.before.relies_on(earlier.number))
    }

    /// Returns how many changes there were before the frame, if it has newly run as it should.
    fn settled(&self) -> Option<u64> {
        let ran = self.is_news && self.fault.is_none() && self.fate != Fate::Lost;
        self.changes.filter(|_| ran)
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
    pub fn new(device: &wgpu::Device) -> Result<Self, ExecuteError> {
        Ok(Self {
            under_way: VecDeque::new(),
            spare: Vec::new(),
            staging: StagingPool::default(),
            numbers: Numbers::new(device)?,
            newest: 0,
            is_strict: true,
            since_fault: 0,
            faults: Vec::new(),
        })
    }

    /// Returns the number of frames that will bring a report.
    pub fn asked(&self) -> usize {
        let asked = self.under_way.iter().filter(|frame| frame.is_asked());
        asked.count()
    }

    /// Returns the index of the oldest frame that will bring a report.
    pub fn oldest_asked(&self) -> Option<u32> {
        let mut asked = self.under_way.iter();
        asked.find(|it| it.is_asked()).map(|frame| frame.index)
    }

    /// True if it is not known of some frame whether it ran.
    pub fn is_pending(&self) -> bool {
        self.oldest_pending() < u64::MAX
    }

    /// Returns the least number of a frame of which it is not known whether it ran.
    pub fn oldest_pending(&self) -> u64 {
        let mut pending = self.under_way.iter();
        let oldest = pending.find(|frame| frame.fate == Fate::Pending);
        oldest.map_or(u64::MAX, |frame| frame.number)
    }

    /// Returns an empty frame, with the reusable parts of a finished one.
    pub fn begin(&mut self) -> FrameInFlight {
        self.spare.pop().unwrap_or_default()
    }

    /// Gives a frame its number, if it runs passes or brings a report.
    pub fn number(
        &mut self,
        frame_in_flight: &mut FrameInFlight,
        rests: bool,
        device: &wgpu::Device,
    ) -> Result<(), ExecuteError> {
        frame_in_flight.is_followed = !rests;
        if rests && !frame_in_flight.is_asked() {
            return Ok(());
        }
        if frame_in_flight.stamp.is_none() {
            frame_in_flight.stamp = Some(Stamp::new(device)?);
        }
        frame_in_flight.number = self.numbers.take(device)?;
        Ok(())
    }

    /// Puts an encoded frame in flight.
    pub fn submit(
        &mut self,
        mut frame_in_flight: FrameInFlight,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let (number, is_followed) = (frame_in_flight.number, frame_in_flight.is_followed);
        let Some(stamp) = frame_in_flight.stamp.as_ref().filter(|_| number > 0) else {
            // It has encoded nothing.
            return self.recycle(frame_in_flight);
        };
        stamp.copy(number, is_followed, &self.numbers, encoder);
        frame_in_flight.follows = self.newest;
        frame_in_flight.is_strict = self.is_strict;
        if is_followed {
            (self.newest, self.is_strict) = (number, true);
        }
        self.under_way.push_back(frame_in_flight);
    }

    /// Keeps the reusable parts of a frame that is finished or was not encoded.
    pub fn recycle(&mut self, mut frame_in_flight: FrameInFlight) {
        for fetch in frame_in_flight.fetches.drain(..) {
            fetch.give_up(&mut self.staging);
        }
        frame_in_flight.number = 0;
        frame_in_flight.fate = Fate::Pending;
        frame_in_flight.fault = None;
        frame_in_flight.grown.clear();
        frame_in_flight.changes = None;
        frame_in_flight.cpu.clear();
        frame_in_flight.skipped.clear();
        frame_in_flight.is_timed = false;
        frame_in_flight.is_given_up = false;
        frame_in_flight.counters = None;
        self.spare.push(frame_in_flight);
    }

    /// Recycles the lost frames, and the finished ones without requests.
    pub fn sweep(&mut self) {
        let mut at = 0;
        while let Some(frame) = self.under_way.get_mut(at) {
            frame.is_news = false;
            let is_lost = frame.fate == Fate::Lost;
            if frame.fate == Fate::Pending || frame.is_asked() && !is_lost {
                at += 1;
            } else if let Some(mut over) = self.under_way.remove(at) {
                if is_lost {
                    // Results already written into its queries are dropped.
                    over.timer = None;
                }
                self.recycle(over);
            }
        }
    }

    /// Finds out which frames have run since the last call, and notes the faults.
    pub fn settle(&mut self) -> Setback {
        // The last one first: what is not done then was not done before a later frame.
        for frame in self.under_way.iter_mut().rev() {
            if let (Fate::Pending, Some(stamp)) = (frame.fate, &frame.stamp) {
                frame.fate = stamp.fate(frame.number);
                frame.is_news = frame.fate != Fate::Pending;
            }
        }
        let mut setback = Setback::default();
        // Lost frames on which no other was built.
        for frame in self.under_way.iter().rev().filter(|it| it.is_followed) {
            if frame.fate != Fate::Lost || frame.number != self.newest {
                break;
            }
            // The one before it may be lost as well, if the frame is older than the last fault.
            self.is_strict = frame.is_strict && frame.number >= self.since_fault;
            self.newest = frame.follows;
            setback.rewind = Some(frame.number);
        }
        let rewound = setback.rewind.unwrap_or(u64::MAX);
        let is_lost = |it: &&FrameInFlight| it.fate == Fate::Lost && it.is_followed;
        let mut lost = self.under_way.iter().filter(is_lost);
        setback.is_lost = lost.clone().next().is_some();
        let built_on = lost.find(|it| it.number < rewound);
        if let Some(number) = built_on.map(|frame| frame.number) {
            self.doubt(number, FaultKind::WithoutPredecessor);
            setback.forgets = true;
        }
        if let Some(number) = self.disorder() {
            self.doubt(number, FaultKind::OutOfOrder);
            setback.forgets = true;
        }
        if setback.forgets {
            self.since_fault = self.numbers.next();
            self.is_strict = false;
        }
        for frame in self.under_way.iter_mut().filter(|frame| frame.is_news) {
            if frame.fate == Fate::Lost {
                frame.fault = Some(FaultKind::NeverRan);
            }
            if let Some(kind) = frame.fault {
                if self.faults.len() == FAULTS {
                    self.faults.remove(0);
                }
                let index = frame.index;
                self.faults.push(FrameFault { index, kind });
            }
            setback.settled = frame.settled().or(setback.settled);
        }
        setback
    }

    /// Notes that frames with a greater number than this may find other contents than they were
    /// encoded for.
    fn doubt(&mut self, number: u64, kind: FaultKind) {
        for frame in self.under_way.iter_mut().filter(|it| it.number > number) {
            if frame.is_news || frame.fate == Fate::Pending {
                frame.fault.get_or_insert(kind);
            }
        }
    }

    /// Finds the frames that have run in another order than they were encoded in. Returns the least
    /// number behind which frames are in doubt; `None` if there are none.
    fn disorder(&mut self) -> Option<u64> {
        let mut doubtful: Option<u64> = None;
        for at in 0..self.under_way.len() {
            let frame = &self.under_way[at];
            let (true, Fate::RanAfter(before)) = (frame.is_news, frame.fate) else {
                continue;
            };
            let mut earlier = self.under_way.iter().take(at);
            let is_right = match (frame.fault, frame.is_strict) {
                // It was in doubt already; those behind it were encoded without it.
                (Some(_), _) => before < self.since_fault,
                (None, true) => before == frame.follows,
                (None, false) => {
                    before < frame.number && !earlier.any(|other| frame.lacks(other, before))
                }
            };
            if is_right {
                continue;
            }
            let frame = &mut self.under_way[at];
            frame.fault.get_or_insert(FaultKind::OutOfOrder);
            if frame.is_followed {
                let least = before.min(frame.follows);
                doubtful = Some(doubtful.map_or(least, |first| first.min(least)));
            }
        }
        doubtful
    }

    /// Returns the report of the oldest frame with requests; `None` if the GPU has not finished it.
    pub fn report(
        &mut self,
        device: &wgpu::Device,
        presence: &Presence,
    ) -> Result<Option<FrameReport>, ExecuteError> {
        let asked = self.under_way.iter().position(FrameInFlight::is_asked);
        let Some((at, frame)) = asked.map(|at| (at, &mut self.under_way[at])) else {
            return Ok(None);
        };
        let timing = if frame.fate == Fate::Pending || frame.is_being_mapped() {
            Ok(None)
        } else if frame.is_timed {
            frame.times(device).map(|times| times.map(Some))
        } else {
            Ok(Some(None))
        };
        if matches!(timing, Ok(None)) {
            // A lost device does not report that work under way will never come.
            presence.check()?;
            return Ok(None);
        }
        let Some(mut frame_in_flight) = self.under_way.remove(at) else {
            return Ok(None);
        };
        if timing.is_err() {
            frame_in_flight.timer = None;
        }
        let fetches = frame_in_flight.fetches.drain(..);
        let fetched = fetches.map(|fetch| fetch.take(&mut self.staging));
        let fetched: Result<Vec<_>, _> = fetched.collect();
        let counters = frame_in_flight.counters.as_mut();
        let counted = counters.map(Counters::take).transpose();
        let report = fetched.and_then(|readbacks| {
            Ok(FrameReport {
                index: frame_in_flight.index,
                timing: timing?.flatten(),
                statistics: counted?,
                skipped: names(&frame_in_flight.skipped),
                readbacks,
                fault: frame_in_flight.fault,
            })
        });
        self.recycle(frame_in_flight);
        if report.is_err() {
            presence.check()?;
        }
        report.map(Some)
    }

    /// Gives up the GPU times of the oldest frame with requests, and waits for no mapping, if the
    /// GPU is done: they did not arrive.
    pub fn give_up(&mut self) {
        let mut under_way = self.under_way.iter_mut();
        let oldest = under_way.find(|frame| frame.is_asked());
        if let Some(frame) = oldest.filter(|frame| frame.fate != Fate::Pending) {
            frame.timer = None;
            frame.is_given_up = true;
        }
    }
}

pub(super) fn names(names: &[Arc<str>]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}

/// Joins names for a message.
pub(super) fn list<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    }
}
