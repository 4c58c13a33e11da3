//! Timestamps of frames: written, and read when the GPU has written them.

use super::times::{FrameTiming, PassTiming};
use crate::{error::ExecuteError, readback::CALLBACK};
use std::{
    sync::Arc,
    time::{Duration, Instant},
};
use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

/// Submitted frames whose times are kept until the host asks for them.
const MOST_PENDING: usize = 3;

/// Writes and reads the timestamps of frames.
pub(crate) struct Timer {
    profiler: GpuProfiler,
    /// One query that nobody reads. Mesa 22.3's lavapipe takes the begin timestamp of a compute
    /// pass that follows a render pass only when the dispatch is over, unless the pass itself
    /// begins with a timestamp.
    spare: Option<wgpu::QuerySet>,
    period: f32,
    /// Whether a frame was encoded that was not submitted yet.
    is_open: bool,
    /// Frames that were submitted and not taken.
    pending: usize,
    /// How long it is waited for their times.
    timeout: Duration,
}

impl Timer {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self, ExecuteError> {
        let inside = device
            .features()
            .contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES);
        let spare = inside.then(|| {
            device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("spare timestamp"),
                ty: wgpu::QueryType::Timestamp,
                count: 1,
            })
        });
        Ok(Self {
            profiler: profiler(device)?,
            spare,
            period: queue.get_timestamp_period(),
            is_open: false,
            pending: 0,
            timeout: CALLBACK,
        })
    }

    /// To be called before a timed frame is encoded.
    pub fn open(&mut self, device: &wgpu::Device) -> Result<(), ExecuteError> {
        if std::mem::replace(&mut self.is_open, true) {
            // The host never submitted the last one, whose queries would be taken for this one's.
            self.profiler = profiler(device)?;
            self.pending = 0;
        }
        Ok(())
    }

    pub fn profiler(&self) -> &GpuProfiler {
        &self.profiler
    }

    /// To be called first in every compute pass that is timed.
    pub fn open_compute(&self, pass: &mut wgpu::ComputePass<'_>) {
        if let Some(spare) = &self.spare {
            pass.write_timestamp(spare, 0);
        }
    }

    pub fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        self.profiler.resolve_queries(encoder);
    }

    pub fn submitted(&mut self) -> Result<(), ExecuteError> {
        if !std::mem::take(&mut self.is_open) {
            return Ok(());
        }
        self.profiler
            .end_frame()
            .map_err(|error| ExecuteError::Timing(error.to_string()))?;
        // Of more frames the profiler drops the last but one.
        self.pending = MOST_PENDING.min(self.pending + 1);
        Ok(())
    }

    /// The frame's times, after the device was polled; `passes` are names and CPU times in order.
    pub fn take(&mut self, passes: &[(Arc<str>, Duration)]) -> FrameTiming {
        // A host that submitted several frames before it asks wants the last one.
        let (mut results, began) = (Vec::new(), Instant::now());
        while self.pending > 0 {
            if let Some(frame) = self.profiler.process_finished_frame(self.period) {
                results = frame;
                self.pending -= 1;
            } else if began.elapsed() < self.timeout {
                // Another thread that polls the device may be about to say that they are there.
                std::thread::yield_now();
            } else {
                // The profiler never gives up a frame that cannot be mapped, and hands out none
                // after it.
                self.timeout = Duration::ZERO;
                results.clear();
                break;
            }
        }
        let first = Stretch::over(results.iter());
        let of_pass = |(name, cpu): &(Arc<str>, Duration)| {
            let stretch = Stretch::over(results.iter().filter(|query| query.label == **name));
            let length = stretch.and_then(Stretch::length);
            PassTiming {
                name: name.to_string(),
                begin: length.and(stretch).zip(first).and_then(|(pass, first)| {
                    let offset = Stretch {
                        begin: first.begin,
                        end: pass.begin,
                    };
                    offset.length()
                }),
                gpu: length,
                cpu: *cpu,
            }
        };
        FrameTiming {
            passes: passes.iter().map(of_pass).collect(),
        }
    }
}

fn profiler(device: &wgpu::Device) -> Result<GpuProfiler, ExecuteError> {
    let settings = GpuProfilerSettings {
        enable_debug_groups: false,
        max_num_pending_frames: MOST_PENDING,
        ..GpuProfilerSettings::default()
    };
    GpuProfiler::new(device, settings).map_err(|error| ExecuteError::Timing(error.to_string()))
}

/// From the first begin to the last end of some queries, seconds of the GPU's clock.
#[derive(Clone, Copy)]
struct Stretch {
    begin: f64,
    end: f64,
}

impl Stretch {
    /// `None` if no query has times: without timestamps between passes, copies and clears have
    /// none; their time falls between their neighbours'.
    fn over<'a>(queries: impl Iterator<Item = &'a GpuTimerQueryResult>) -> Option<Self> {
        queries
            .filter_map(|query| query.time.as_ref())
            .map(|time| Self {
                begin: time.start,
                end: time.end,
            })
            .reduce(|all, one| Self {
                begin: all.begin.min(one.begin),
                end: all.end.max(one.end),
            })
    }

    /// Timestamps that run backwards are no measurement.
    fn length(self) -> Option<Duration> {
        Duration::try_from_secs_f64(self.end - self.begin).ok()
    }
}
