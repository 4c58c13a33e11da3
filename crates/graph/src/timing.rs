//! GPU timestamps that are true, or none.

use crate::{
    Graph, NoProvider, PlanRequest, Registry, SourceFile, Sources,
    document::params::ParamValue,
    execute::{ExecuteError, Executor, Frame},
    readback::CALLBACK,
};
use std::{
    collections::BTreeMap,
    sync::Arc,
    time::{Duration, Instant},
};
use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

/// Times of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameTiming {
    /// Times of the passes, in the order in which they ran.
    pub passes: Vec<PassTiming>,
}

/// Times of one pass.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTiming {
    /// The pass.
    pub name: String,
    /// When its first step began on the GPU, from the frame's first begin on; `None` where `gpu` is.
    pub begin: Option<Duration>,
    /// From the begin of its first step to the end of its last on the GPU; `None` where the adapter has no timestamps.
    pub gpu: Option<Duration>,
    /// Time that encoding it took on the CPU.
    pub cpu: Duration,
}

impl FrameTiming {
    /// From the first begin to the last end on the GPU. Not the sum of the passes: they may overlap, and there are gaps.
    pub fn gpu(&self) -> Option<Duration> {
        let timed = || {
            let passes = self.passes.iter();
            passes.filter_map(|pass| Some((pass.begin?, pass.gpu?)))
        };
        let begin = timed().map(|(begin, _)| begin).min()?;
        let end = timed().map(|(begin, length)| begin + length).max()?;
        Some(end - begin)
    }

    /// Time that encoding all passes took on the CPU.
    pub fn cpu(&self) -> Duration {
        self.passes.iter().map(|pass| pass.cpu).sum()
    }
}

/// Submitted frames whose times are kept until the host asks for them.
const MOST_PENDING: usize = 3;

/// Writes and reads the timestamps of frames.
pub(crate) struct Timer {
    profiler: GpuProfiler,
    /// One query that nobody reads. Mesa 22.3's lavapipe takes the begin timestamp of a compute pass that follows a render
    /// pass only when the dispatch is over, unless the pass itself begins with a timestamp.
    spare: Option<wgpu::QuerySet>,
    period: f32,
    /// Whether a frame was encoded that was not submitted yet.
    is_open: bool,
    /// Frames that were submitted and not taken.
    pending: usize,
    /// How long it is waited for their times.
    patience: Duration,
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
            patience: CALLBACK,
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
            } else if began.elapsed() < self.patience {
                // Another thread that polls the device may be about to say that they are there.
                std::thread::yield_now();
            } else {
                // The profiler never gives up a frame that cannot be mapped, and hands out none after it.
                self.patience = Duration::ZERO;
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
    /// `None` if no query has times: without timestamps between passes, copies and clears have none; their time falls between
    /// their neighbours'.
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

/// Whether an adapter's timestamps can be believed.
#[derive(Clone, Debug, PartialEq)]
pub enum Trust {
    /// They agree with wall time.
    Trusted,
    /// They do not, or there are none.
    Untrusted {
        /// Why.
        reason: String,
    },
}

/// The shortest dispatch, in wall time, that is compared: long against the cost of submitting and waiting.
const LONG: Duration = Duration::from_millis(30);

/// Frames that are compared, one to warm up included.
const FRAMES: usize = 5;

/// Compares the GPU time of a long dispatch that follows a raster pass with wall time, by the very means that time frames.
///
/// # Errors
/// If the little graph that it runs fails on this device.
pub fn check(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Trust, ExecuteError> {
    if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
        return Ok(Trust::Untrusted {
            reason: "the adapter has no timestamp queries".to_owned(),
        });
    }
    let internal = |_| ExecuteError::Internal("the timestamp check's own graph is broken");
    let graph = Graph::load("check.ron", &Registry::standard(), &CheckSources).map_err(internal)?;
    let mut rounds = 64u32;
    let mut was_long = false;
    loop {
        let mut request = PlanRequest::new([64, 64], &NoProvider);
        request.params = BTreeMap::from([("rounds".to_owned(), ParamValue::U32(rounds))]);
        let mut executor = Executor::new(
            device,
            queue,
            graph.plan(&request).map_err(internal)?,
            &mut NoProvider,
        )?;
        let mut frames = Vec::new();
        for _ in 0..FRAMES {
            let mut encoder =
                device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            executor.encode(
                &mut encoder,
                &Frame {
                    timing: true,
                    ..Frame::default()
                },
            )?;
            let start = Instant::now();
            queue.submit([encoder.finish()]);
            executor.submitted(queue)?;
            let report = executor.finish()?;
            let gpu = report
                .timing
                .and_then(|timing| timing.passes.last().and_then(|pass| pass.gpu));
            frames.push((start.elapsed(), gpu));
        }
        // The first frame compiles shaders on some drivers.
        let shortest = frames[1..]
            .iter()
            .map(|(wall, _)| *wall)
            .min()
            .unwrap_or_default();
        let is_long = shortest >= LONG || rounds >= 1 << 30;
        let trust = judge(&frames[1..]);
        if is_long && (was_long || trust == Trust::Trusted) {
            return Ok(trust);
        }
        // Once more, four times as long: other load may have been most of the wall time.
        was_long = is_long;
        rounds = rounds.saturating_mul(4);
    }
}

/// Waiting and other load add to wall time, so the GPU's share of it may be small in some frames, but not in all of them; it
/// is never above 1 but for the clocks' grain.
fn judge(frames: &[(Duration, Option<Duration>)]) -> Trust {
    let mut best: Option<(f64, f64)> = None;
    for (wall, gpu) in frames {
        let Some(gpu) = gpu else {
            return Trust::Untrusted {
                reason: "the adapter gave no timestamps for a timed pass".to_owned(),
            };
        };
        let (wall, gpu) = (wall.as_secs_f64(), gpu.as_secs_f64());
        if best.is_none_or(|(best_wall, best_gpu)| gpu / wall > best_gpu / best_wall) {
            best = Some((wall, gpu));
        }
    }
    match best {
        Some((wall, gpu)) if (0.5..=1.1).contains(&(gpu / wall)) => Trust::Trusted,
        Some((wall, gpu)) => Trust::Untrusted {
            reason: format!(
                "a dispatch that took {:.1} ms of wall time after a raster pass was timed as {:.1} ms",
                wall * 1e3,
                gpu * 1e3
            ),
        },
        None => Trust::Untrusted {
            reason: "no frame was timed".to_owned(),
        },
    }
}

/// A raster pass and a long dispatch after it.
struct CheckSources;

impl Sources for CheckSources {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        let text = match path {
            "check.ron" => include_str!("timing/check.ron"),
            "draw.wgsl" => include_str!("timing/draw.wgsl"),
            "work.wgsl" => include_str!("timing/work.wgsl"),
            _ => return Ok(None),
        };
        Ok(Some(SourceFile::new(path, text).text))
    }

    fn list(&self, _: &str) -> Vec<String> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_no_sum_of_its_passes() {
        let ms = |ms| Some(Duration::from_millis(ms));
        let pass = |begin, gpu| PassTiming {
            name: String::new(),
            begin,
            gpu,
            cpu: Duration::ZERO,
        };
        let of = |passes: &[_]| FrameTiming {
            passes: passes.to_vec(),
        };
        let overlapping = of(&[pass(ms(0), ms(9)), pass(ms(4), ms(3)), pass(None, None)]);
        assert_eq!(overlapping.gpu(), ms(9));
        let apart = of(&[pass(ms(0), ms(2)), pass(ms(6), ms(2))]);
        assert_eq!(apart.gpu(), ms(8));
        assert_eq!(of(&[pass(None, None)]).gpu(), None);
    }

    fn frames(frames: &[(u64, Option<u64>)]) -> Vec<(Duration, Option<Duration>)> {
        frames
            .iter()
            .map(|(wall, gpu)| (Duration::from_millis(*wall), gpu.map(Duration::from_millis)))
            .collect()
    }

    #[test]
    fn a_loaded_machine_does_not_make_true_timestamps_false() {
        assert_eq!(
            judge(&frames(&[(300, Some(35)), (40, Some(36)), (90, Some(30))])),
            Trust::Trusted
        );
    }

    #[test]
    fn timestamps_that_miss_the_dispatch_in_every_frame_are_not_believed() {
        let Trust::Untrusted { reason } = judge(&frames(&[(40, Some(0)), (41, Some(1))])) else {
            panic!("believed")
        };
        assert_eq!(
            reason,
            "a dispatch that took 41.0 ms of wall time after a raster pass was timed as 1.0 ms"
        );
    }

    #[test]
    fn more_gpu_time_than_wall_time_is_not_believed() {
        assert!(matches!(
            judge(&frames(&[(40, Some(39)), (40, Some(80))])),
            Trust::Untrusted { .. }
        ));
    }

    #[test]
    fn a_frame_without_timestamps_is_no_measurement() {
        assert!(matches!(
            judge(&frames(&[(40, Some(39)), (40, None)])),
            Trust::Untrusted { .. }
        ));
    }
}
