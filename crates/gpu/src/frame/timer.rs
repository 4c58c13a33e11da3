//! Writes the timestamps of frames, and reads them when the GPU has written them.

use super::times::{FrameTiming, PassTiming};
use crate::error::ExecuteError;
use std::{ops::Range, sync::Arc, time::Duration};
use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

/// Timestamps of one frame after another. Frames in flight have a timer each: a profiler cannot
/// separate the queries of two frames that are not submitted yet, and drops those of more frames
/// than it was created for.
pub(crate) struct Timer {
    profiler: GpuProfiler,
    /// One query that is never read. Mesa 22.3's lavapipe takes the begin timestamp of a compute
    /// pass that follows a render pass only when the dispatch is over, unless the pass itself
    /// begins with a timestamp.
    spare: Option<wgpu::QuerySet>,
    period: f32,
    /// True if the mapping of the frame's timestamps was started.
    is_ended: bool,
}

impl Timer {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self, ExecuteError> {
        let inside = wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES;
        let inside = device.features().contains(inside);
        let spare = inside.then(|| {
            device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("spare timestamp"),
                ty: wgpu::QueryType::Timestamp,
                count: 1,
            })
        });
        let settings = GpuProfilerSettings {
            enable_debug_groups: false,
            max_num_pending_frames: 1,
            ..GpuProfilerSettings::default()
        };
        let profiler = GpuProfiler::new(device, settings)
            .map_err(|error| ExecuteError::Timing(error.to_string()))?;
        Ok(Self {
            profiler,
            spare,
            period: queue.get_timestamp_period(),
            is_ended: false,
        })
    }

    pub fn profiler(&self) -> &GpuProfiler {
        &self.profiler
    }

    /// Starts the timing of a compute pass; must be called before its other commands.
    pub fn open_compute(&self, pass: &mut wgpu::ComputePass<'_>) {
        if let Some(spare) = &self.spare {
            pass.write_timestamp(spare, 0);
        }
    }

    pub fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        self.profiler.resolve_queries(encoder);
    }

    /// Starts the mapping of the timestamps of a submitted frame. Returns false if it was started
    /// before.
    pub fn end_frame(&mut self) -> Result<bool, ExecuteError> {
        if self.is_ended {
            return Ok(false);
        }
        let ended = self.profiler.end_frame();
        ended.map_err(|error| ExecuteError::Timing(error.to_string()))?;
        self.is_ended = true;
        Ok(true)
    }

    /// Returns the times of the frame; `None` if its timestamps are not mapped yet. `passes` holds
    /// the name and the CPU time of each pass that ran, in the order in which they ran. The GPU
    /// time of a pass is from the begin of the first to the end of the last query labelled with
    /// its name; without such a query it has none. After `Some` the timer can be used for another
    /// frame.
    pub fn take(&mut self, passes: &[(Arc<str>, Duration)]) -> Option<FrameTiming> {
        let results = self.profiler.process_finished_frame(self.period)?;
        self.is_ended = false;
        Some(times(passes, &results))
    }
}

/// Combines the CPU times of passes with the results of their timestamp queries, if there are any.
pub(crate) fn times(
    passes: &[(Arc<str>, Duration)],
    results: &[GpuTimerQueryResult],
) -> FrameTiming {
    let first = stretch_over(results.iter());
    let of_pass = |(name, cpu): &(Arc<str>, Duration)| {
        let stretch = stretch_over(results.iter().filter(|query| query.label == **name));
        let length = stretch.clone().and_then(length_of);
        let ends = length.and(stretch).zip(first.clone());
        PassTiming {
            name: name.to_string(),
            begin: ends.and_then(|(pass, first)| length_of(first.start..pass.start)),
            gpu: length,
            cpu: *cpu,
        }
    };
    FrameTiming {
        passes: passes.iter().map(of_pass).collect(),
    }
}

/// From the first begin to the last end of some queries, seconds of the GPU's clock; `None` if no
/// query has times: without timestamps between passes, copies and clears have none; their time
/// falls between their neighbours'.
fn stretch_over<'a>(queries: impl Iterator<Item = &'a GpuTimerQueryResult>) -> Option<Range<f64>> {
    queries
        .filter_map(|query| query.time.clone())
        .reduce(|span, one| span.start.min(one.start)..span.end.max(one.end))
}

/// Timestamps that run backwards are no measurement.
fn length_of(stretch: Range<f64>) -> Option<Duration> {
    Duration::try_from_secs_f64(stretch.end - stretch.start).ok()
}
