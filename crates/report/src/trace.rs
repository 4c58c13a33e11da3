//! `profile --trace`: every timed frame in the Trace Event Format, which ui.perfetto.dev and
//! chrome://tracing open.
//! <https://docs.google.com/document/d/1CvAClvFfyA5R-PhYUmn5OOQtYMH4h6I0nSsKchNAySU>

use serde_json::{Value, json};
use skiagraph_compare::records::profile::Conditions;
use skiagraph_compare::records::samples::TimedFrame;
use skiagraph_compare::wording::size;
use std::time::Duration;

/// One process: a frame's tracks stand below each other.
const PROCESS: u32 = 1;
const FRAMES: u32 = 1;
const ENCODING: u32 = 2;
/// The first GPU track; further ones hold passes that overlap in time.
const GPU: u32 = 3;

/// Returns the content of the trace file: JSON with a slice for each frame and for each pass on the
/// CPU and the GPU. Times are microseconds since the start of the first timed frame's encoding. The
/// clocks of GPU and CPU have no common zero, so the GPU work of a frame is placed at the end of
/// its encoding, or after earlier GPU work; times within a frame are as measured. GPU slices are
/// missing if the adapter's timestamps cannot be trusted.
pub fn trace(conditions: &Conditions, frames: &[TimedFrame]) -> String {
    let mut events = Vec::new();
    let is_trusted = conditions.adapter.gpu_unavailable.is_none();
    let mut tracks = 0;
    let mut gpu_free = Duration::ZERO;
    let first = frames.first().map_or(Duration::ZERO, |frame| frame.began);
    for (index, frame) in frames.iter().enumerate() {
        let name = format!("frame {index}");
        let mut at = frame.began.saturating_sub(first);
        let span = [at, frame.wall];
        events.push(slice(&name, "frame", FRAMES, span, index));
        for pass in &frame.timing.passes {
            events.push(slice(&pass.name, "cpu", ENCODING, [at, pass.cpu], index));
            at += pass.cpu;
        }
        let zero = at.max(gpu_free);
        for pass in placed(frame).iter().filter(|_| is_trusted) {
            let span = [zero + pass.begin, pass.gpu];
            events.push(slice(pass.name, "gpu", GPU + pass.track, span, index));
            tracks = tracks.max(pass.track + 1);
            gpu_free = gpu_free.max(zero + pass.begin + pass.gpu);
        }
    }
    let mut named = vec![
        metadata("process_name", 0, json!({ "name": title(conditions) })),
        thread(FRAMES, "frames: from encoding until the GPU is done".into()),
        thread(ENCODING, "CPU: encoding".into()),
    ];
    named.extend((0..tracks).map(|track| match track {
        0 => thread(GPU, "GPU".into()),
        _ => thread(GPU + track, format!("GPU: at the same time, {}", track + 1)),
    }));
    named.append(&mut events);
    let trace = json!({
        "traceEvents": named,
        "displayTimeUnit": "ms",
        "otherData": conditions,
    });
    format!("{trace}\n")
}

fn title(conditions: &Conditions) -> String {
    let Conditions { preset, view, .. } = conditions;
    let (scene, adapter) = (&conditions.scene.name, &conditions.adapter.name);
    let size = size(conditions.viewport);
    format!("{preset} on {scene}, view {view}, {size}, {adapter}")
}

/// A pass on the GPU's time line.
struct Placed<'a> {
    name: &'a str,
    begin: Duration,
    gpu: Duration,
    track: u32,
}

/// The passes with GPU times. Slices of one track must not overlap partly, so each goes to the
/// first track that is free.
fn placed(frame: &TimedFrame) -> Vec<Placed<'_>> {
    let passes = frame.timing.passes.iter().filter_map(|pass| {
        Some(Placed {
            name: &pass.name,
            begin: pass.begin?,
            gpu: pass.gpu?,
            track: 0,
        })
    });
    let mut passes: Vec<Placed> = passes.collect();
    passes.sort_by_key(|pass| pass.begin);
    let mut ends: Vec<Duration> = Vec::new();
    for pass in &mut passes {
        let free = ends.iter().position(|end| *end <= pass.begin);
        let track = free.unwrap_or_else(|| {
            ends.push(Duration::ZERO);
            ends.len() - 1
        });
        ends[track] = pass.begin + pass.gpu;
        pass.track = track as u32;
    }
    passes
}

fn slice(
    name: &str,
    category: &str,
    track: u32,
    [begin, length]: [Duration; 2],
    frame: usize,
) -> Value {
    let us = |time: Duration| time.as_nanos() as f64 / 1e3;
    json!({
        "ph": "X",
        "name": name,
        "cat": category,
        "pid": PROCESS,
        "tid": track,
        "ts": us(begin),
        "dur": us(length),
        "args": { "frame": frame },
    })
}

fn metadata(name: &str, track: u32, args: Value) -> Value {
    json!({ "ph": "M", "name": name, "pid": PROCESS, "tid": track, "args": args })
}

fn thread(track: u32, name: String) -> Value {
    metadata("thread_name", track, json!({ "name": name }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn us(us: u64) -> Duration {
        Duration::from_micros(us)
    }

    #[test]
    fn overlapping_passes_get_tracks_of_their_own() {
        let mut ends: Vec<(u64, u64, u32)> = Vec::new();
        let frame = frame(&[(0, 10), (5, 3), (10, 2), (9, 4)]);
        for pass in placed(&frame) {
            ends.push((
                pass.begin.as_micros() as u64,
                pass.gpu.as_micros() as u64,
                pass.track,
            ));
        }
        assert_eq!(ends, [(0, 10, 0), (5, 3, 1), (9, 4, 1), (10, 2, 0)]);
    }

    fn frame(passes: &[(u64, u64)]) -> TimedFrame {
        use skiagraph_gpu::{FrameTiming, PassTiming};
        let pass = |&(begin, gpu): &(u64, u64)| {
            PassTiming::new(format!("p{begin}"), us(1)).with_gpu(us(begin), us(gpu))
        };
        TimedFrame {
            began: Duration::ZERO,
            timing: FrameTiming::new(passes.iter().map(pass).collect()),
            wall: us(20),
            upkeep: None,
            skipped: Vec::new(),
        }
    }

    #[test]
    fn untrusted_timestamps_are_not_drawn() {
        let mut conditions = crate::test_support::profile().conditions;
        let gpu_events = |conditions: &Conditions| {
            let text = trace(conditions, &[frame(&[(0, 10)])]);
            let trace: Value = serde_json::from_str(&text).unwrap();
            let events = trace["traceEvents"].as_array().unwrap().clone();
            events.iter().filter(|event| event["cat"] == "gpu").count()
        };
        assert_eq!(gpu_events(&conditions), 1);
        conditions.adapter.gpu_unavailable = Some("they lie".into());
        assert_eq!(gpu_events(&conditions), 0);
    }

    #[test]
    fn frames_follow_each_other_on_the_gpu_even_if_the_clocks_disagree() {
        let mut second = frame(&[(0, 10)]);
        second.began = us(5);
        let text = trace(
            &crate::test_support::profile().conditions,
            &[frame(&[(0, 10)]), second],
        );
        let trace: Value = serde_json::from_str(&text).unwrap();
        let begins: Vec<f64> = trace["traceEvents"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|event| event["cat"] == "gpu")
            .map(|event| event["ts"].as_f64().unwrap())
            .collect();
        assert_eq!(begins, [1.0, 11.0]);
    }
}
