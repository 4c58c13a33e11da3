//! Checks that the timestamps of an adapter agree with wall time.

use crate::device::partial;
use crate::error::ExecuteError;
use crate::frame::{Executor, Frame};
use skiagraph_graph::{Graph, MemorySources, NoProvider, ParamValue, PlanRequest, Registry};
use std::{collections::BTreeMap, time::Duration};
use web_time::Instant;

/// Result of [`check`]: tells if an adapter's GPU timestamps can be believed.
#[derive(Clone, Debug, PartialEq)]
pub enum Trust {
    /// The timestamps agree with the wall time measured on the CPU.
    Trusted,
    /// The timestamps disagree with wall time, are missing, or cannot be checked on this backend.
    Untrusted {
        /// Reason why they cannot be believed, as text for the user.
        reason: String,
    },
}

/// Shortest wall time of a dispatch that is compared. It is long against the cost of submitting and
/// waiting.
const LONG: Duration = Duration::from_millis(30);

/// Number of comparisons of dispatches of four times that length that disagree before timestamps
/// are not believed: other load may have been most of the wall time in all frames of some.
const COMPARISONS: u32 = 3;

/// Number of frames that are run for a comparison; the first one only warms up.
const FRAMES: usize = 5;

/// Checks a device's timestamps: runs a long dispatch after a raster pass and compares its GPU time
/// with the wall time of the frame. An [`Executor`] times the dispatch as it times the passes of
/// any graph. Call it once per device.
///
/// # Errors
/// If the check's own small graph fails on this device.
pub async fn check(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Trust, ExecuteError> {
    if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
        return Ok(untrusted("the adapter has no timestamp queries"));
    }
    if let Some(backend) = partial(device.adapter_info().backend) {
        let reason = format!("they are not checked on the backend {}", backend.name);
        return Ok(untrusted(reason));
    }
    let internal = |_| ExecuteError::Internal("the timestamp check's own graph is broken");
    // A raster pass and a long dispatch after it.
    let sources = MemorySources::new([
        ("check.ron", include_str!("check.ron")),
        ("draw.wgsl", include_str!("draw.wgsl")),
        ("work.wgsl", include_str!("work.wgsl")),
    ]);
    let graph = Graph::load("check.ron", &Registry::standard(), &sources).map_err(internal)?;
    let mut rounds = 64u32;
    let mut compared = 0;
    loop {
        let mut request = PlanRequest::new([64, 64], &NoProvider);
        request.params = BTreeMap::from([("rounds".to_owned(), ParamValue::U32(rounds))]);
        let plan = graph.plan(&request).map_err(internal)?;
        let mut executor = Executor::new(device, queue, plan, &mut NoProvider)?;
        let mut frames = Vec::new();
        for _ in 0..FRAMES {
            let mut encoder =
                device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let frame = Frame::new().with_timing(true);
            executor.encode(&mut encoder, &frame)?;
            let start = Instant::now();
            queue.submit([encoder.finish()]);
            let report = executor.finished().await?;
            let timing = report.timing;
            let gpu = timing.and_then(|timing| timing.passes.last()?.gpu);
            frames.push((start.elapsed(), gpu));
        }
        // The first frame compiles shaders on some drivers.
        let shortest = frames[1..].iter();
        let shortest = shortest.map(|(wall, _)| *wall).min().unwrap_or_default();
        let is_last = rounds >= 1 << 30;
        let trust = judge(&frames[1..]);
        if trust == Trust::Trusted && (shortest >= LONG || is_last) {
            return Ok(trust);
        }
        if shortest >= 4 * LONG || is_last {
            compared += 1;
            if compared == COMPARISONS {
                return Ok(trust);
            }
        } else {
            rounds = rounds.saturating_mul(4);
        }
    }
}

/// Waiting and other load add to wall time, so the GPU's share of it may be small in some frames,
/// but not in all of them; it is never above 1 but for the clocks' grain.
fn judge(frames: &[(Duration, Option<Duration>)]) -> Trust {
    let mut best: Option<(f64, f64)> = None;
    for (wall, gpu) in frames {
        let Some(gpu) = gpu else {
            return untrusted("the adapter gave no timestamps for a timed pass");
        };
        let (wall, gpu) = (wall.as_secs_f64(), gpu.as_secs_f64());
        if best.is_none_or(|(best_wall, best_gpu)| gpu / wall > best_gpu / best_wall) {
            best = Some((wall, gpu));
        }
    }
    match best {
        Some((wall, gpu)) if (0.5..=1.1).contains(&(gpu / wall)) => Trust::Trusted,
        Some((wall, gpu)) => untrusted(format!(
            "a dispatch that took {:.1} ms of wall time after a raster pass was timed as {:.1} ms",
            wall * 1e3,
            gpu * 1e3
        )),
        None => untrusted("no frame was timed"),
    }
}

fn untrusted(reason: impl Into<String>) -> Trust {
    let reason = reason.into();
    Trust::Untrusted { reason }
}

#[cfg(test)]
mod tests {
    use super::*;

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
