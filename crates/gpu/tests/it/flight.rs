//! Several frames under way at once: each reports its own requests, without waiting.

use crate::support::{Files, Triangle, load, right};
use crate::tiny::{self, image, u32s};
use skiagraph_gpu::{ExecuteError, Executor, Frame, FrameReport, device};
use skiagraph_graph::{NoProvider, ParamValue, PlanRequest};
use std::sync::{LazyLock, mpsc::channel};
use std::time::{Duration, Instant};

/// A device of these tests' own: on one that others use, too, a poll clears up after their frames.
static GPU: LazyLock<device::Gpu> =
    LazyLock::new(|| device::open(None).unwrap_or_else(|error| panic!("{error}")));

fn made(files: &Files) -> Executor {
    let mut request = PlanRequest::new(tiny::SIZE, &Triangle);
    request.limits = GPU.device.limits();
    request.features = GPU.device.features();
    let plan = right(right(load(files)).plan(&request));
    Executor::new(&GPU.device, &GPU.queue, plan, &mut Triangle)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn encoder() -> wgpu::CommandEncoder {
    GPU.device.create_command_encoder(&Default::default())
}

/// Every frame writes its number, and is slow with many items.
///
/// ```text
/// frame ─▶ count ─▶ number
///              └──▶ sums
/// ```
fn slow() -> Files {
    Files::graph(
        r#"
    params: [U32(name: "items", default: 64)],
    materials: [Buffer(name: "number", count: 1), Buffer(name: "sums", count: "items")],
    passes: [Compute(name: "count", dispatch: Over("sums.count"))],
    outputs: ["number", "sums"],
"#,
    )
    .with(
        "count.wgsl",
        "struct Frame { index: u32, seconds: f32 }
         var<uniform> frame: Frame;
         var<storage, read_write> number: array<u32>;
         var<storage, read_write> sums: array<u32>;
         @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
             var sum = id.x;
             for (var round = 0u; round < 20000u; round++) {
                 sum = (sum ^ (sum >> 7u)) * 1664525u + round;
             }
             sums[id.x] = sum;
             if id.x == 0u { number[0] = frame.index; }
         }",
    )
}

/// Least duration of the slow pass.
const LONG: Duration = Duration::from_millis(150);

/// An executor whose frames take long on the GPU, and how long.
fn long() -> (Executor, Duration) {
    let mut executor = made(&slow());
    let mut items = 4096;
    loop {
        let value = ParamValue::U32(items);
        let set = executor.set_param("items", value, &mut NoProvider);
        set.unwrap_or_else(|error| panic!("{error}"));
        // The first frame compiles shaders on some drivers.
        let time = (0..2)
            .map(|_| {
                let began = Instant::now();
                submit(&mut executor, &Frame::default());
                executor.finish().unwrap_or_else(|error| panic!("{error}"));
                began.elapsed()
            })
            .min();
        match time {
            Some(time) if time >= LONG => return (executor, time),
            _ => items *= 2,
        }
    }
}

/// Encodes and submits a frame; its number, and how long the graph's part of it took.
fn submit(executor: &mut Executor, frame: &Frame<'_>) -> (u32, Duration) {
    let mut encoder = encoder();
    let began = Instant::now();
    let index = executor.encode(&mut encoder, frame);
    let took = began.elapsed();
    GPU.queue.submit([encoder.finish()]);
    (index.unwrap_or_else(|error| panic!("{error}")), took)
}

fn poll(executor: &mut Executor) -> Option<FrameReport> {
    executor.poll().unwrap_or_else(|error| panic!("{error}"))
}

fn has_timestamps() -> bool {
    let features = GPU.device.features();
    features.contains(wgpu::Features::TIMESTAMP_QUERY)
}

/// A frame's own number and, if it was timed, times that are its own: as long as the slow pass, and
/// not as long as two of them.
fn is_its_own(report: &FrameReport, index: u32, timing: bool, long: Duration) {
    assert_eq!(report.index, index);
    let names: Vec<&str> = report.readbacks.iter().map(|read| &*read.name).collect();
    assert_eq!(names, ["number"]);
    assert_eq!(u32s(&report.readbacks[0].content), [index]);
    assert_eq!(report.timing.is_some(), timing);
    if let Some(times) = &report.timing {
        assert_eq!(times.passes.len(), 1);
        assert_eq!(times.passes[0].name, "count");
        if has_timestamps() {
            let gpu = times.gpu().expect("a pass that dispatches has times");
            assert!(gpu > long / 4, "frame {index}: {gpu:?} of {long:?}");
        }
    }
}

/// More frames than any queue of the host's is deep, some timed, all read: every one is there, in
/// order, with its own content and times, and only `finish` waits.
#[test]
fn frames_in_flight_bring_what_is_theirs_and_nobody_waits() {
    let (mut executor, long) = long();
    let began = Instant::now();
    let mut longest = Duration::ZERO;
    let mut expected = Vec::new();
    for at in 0..5 {
        let wanted = Frame::new().with_timing(at != 1).with_read(&["number"]);
        let (index, took) = submit(&mut executor, &wanted);
        expected.push((index, wanted.timing));
        let polling = Instant::now();
        let early = poll(&mut executor);
        longest = longest.max(took).max(polling.elapsed());
        assert!(
            early.is_none() || began.elapsed() >= long / 4,
            "it cannot be done yet"
        );
        if let Some(early) = early {
            let (index, timing) = expected.remove(0);
            is_its_own(&early, index, timing, long);
        }
    }
    assert_eq!(executor.under_way(), expected.len());
    // The GPU is still busy with them.
    assert!(
        longest < long / 2,
        "{longest:?} of {long:?}: somebody waited"
    );
    // A poll that waits for a frame brings it: none would come back without one.
    let (mut polls, least) = (0, 2 * expected.len());
    for (index, timing) in expected {
        let report = loop {
            match poll(&mut executor) {
                Some(report) => break report,
                None => std::thread::sleep(Duration::from_millis(1)),
            }
            polls += 1;
        };
        is_its_own(&report, index, timing, long);
    }
    assert!(
        polls > least,
        "{polls} polls brought nothing: others waited"
    );
    assert!(poll(&mut executor).is_none());
    assert_eq!(executor.under_way(), 0);
}

/// `finish` waits, and hands out one frame after the other.
#[test]
fn frames_in_flight_are_waited_for_one_by_one() {
    let mut executor = made(&slow());
    let wanted = Frame::new().with_timing(true).with_read(&["number"]);
    // All are encoded before the first is submitted, and one of them asks for nothing.
    let mut submissions = Vec::new();
    for at in 0..4 {
        let mut encoder = encoder();
        let wanted = if at == 2 { Frame::default() } else { wanted };
        let index = executor.encode(&mut encoder, &wanted);
        submissions.push((index.unwrap_or_else(|error| panic!("{error}")), encoder));
    }
    assert_eq!(executor.under_way(), 3);
    let mut expected = Vec::new();
    for (at, (index, encoder)) in submissions.into_iter().enumerate() {
        GPU.queue.submit([encoder.finish()]);
        if at != 2 {
            expected.push(index);
        }
    }
    for index in expected {
        let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
        is_its_own(&report, index, true, Duration::ZERO);
    }
    let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
    assert!(report.readbacks.is_empty() && report.timing.is_none());
}

/// A host that drops encoders, which it should not, gets all that it has submitted.
#[test]
fn frames_that_were_dropped_bring_nothing() {
    let mut executor = made(&slow());
    let wanted = Frame::new().with_timing(true).with_read(&["number"]);
    let mut submitted = Vec::new();
    for _ in 0..3 {
        let mut dropped = encoder();
        executor
            .encode(&mut dropped, &wanted)
            .unwrap_or_else(|error| panic!("{error}"));
        drop(dropped);
        submitted.push(submit(&mut executor, &wanted).0);
    }
    for index in submitted {
        let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
        is_its_own(&report, index, true, Duration::ZERO);
    }
    assert_eq!(executor.under_way(), 0);
}

/// A report that is under way outlives a change of the plan, whatever that makes of the output.
#[test]
fn what_is_under_way_outlives_a_change_of_the_plan() {
    let mut executor = made(&image());
    let wanted = Frame::new().with_timing(true).with_read(&["image"]);
    submit(&mut executor, &wanted);
    let resized = executor.resize([3, 2], &mut NoProvider);
    resized.unwrap_or_else(|error| panic!("{error}"));
    submit(&mut executor, &wanted);
    for size in [tiny::SIZE, [3, 2]] {
        let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
        let content = &report.readbacks[0].content;
        assert_eq!(content.size(), Some(size));
        let numbered = tiny::pixels(size, |x, y| (x + 100 * y) as f32);
        assert_eq!(tiny::f32s(content), numbered);
        assert!(report.timing.is_some());
    }
}

/// Another thread that polls the device may hold the callback of a mapping while this one is told
/// that the frame is done.
#[test]
fn a_thread_that_polls_takes_no_content_away() {
    let gpu = device::open(None).unwrap_or_else(|error| panic!("{error}"));
    let mut request = PlanRequest::new(tiny::SIZE, &Triangle);
    request.features = gpu.device.features();
    let plan = right(right(load(&image())).plan(&request));
    let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut Triangle)
        .unwrap_or_else(|error| panic!("{error}"));
    let read = Frame::new().with_read(&["image"]);
    let counts = wgpu::Features::PIPELINE_STATISTICS_QUERY;
    let counted = gpu.device.features().contains(counts);
    let counted = counted.then(|| Frame::new().with_statistics(true).with_all(true));
    for wanted in [Some(read), counted].into_iter().flatten() {
        let report = while_mapping_is_held(&gpu, &mut executor, &wanted);
        match (&report.statistics, &report.readbacks[..]) {
            (Some(statistics), []) => assert_eq!(statistics.len(), 1),
            (None, [read]) => {
                let numbered = tiny::pixels(tiny::SIZE, |x, y| (x + 100 * y) as f32);
                assert_eq!(tiny::f32s(&read.content), numbered);
            }
            other => panic!("{other:?}"),
        }
    }
}

fn while_mapping_is_held(
    gpu: &device::Gpu,
    executor: &mut Executor,
    wanted: &Frame<'_>,
) -> FrameReport {
    let buffer = |usage| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage,
            mapped_at_creation: false,
        })
    };
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let ((taken, is_taken), (go_on, may_go_on)) = (channel(), channel());
    // The other thread stops at this callback, which comes before those of the frame.
    let held = buffer(wgpu::BufferUsages::MAP_READ);
    encoder.map_buffer_on_submit(&held, wgpu::MapMode::Read, .., move |_| {
        taken.send(()).unwrap();
        may_go_on.recv().unwrap();
    });
    executor.encode(&mut encoder, wanted).unwrap();
    // Its refusal is told at once: after the mappings, before the request to tell that all is done.
    let device = gpu.device.clone();
    let refused = buffer(wgpu::BufferUsages::COPY_DST);
    encoder.map_buffer_on_submit(&refused, wgpu::MapMode::Read, .., move |_| {
        std::thread::spawn(move || device.poll(wgpu::PollType::wait_indefinitely()));
        is_taken.recv().unwrap();
    });
    let refusal = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    gpu.queue.submit([encoder.finish()]);
    assert!(pollster::block_on(refusal.pop()).is_some());
    for _ in 0..3 {
        assert!(poll(executor).is_none());
    }
    go_on.send(()).unwrap();
    executor.finish().unwrap_or_else(|error| panic!("{error}"))
}

/// wgpu-core panics in a wait that times out while another thread polls the device.
#[test]
fn threads_that_wait_with_a_timeout_lose_no_device() {
    let gpu = device::open(None).unwrap_or_else(|error| panic!("{error}"));
    let mut request = PlanRequest::new(tiny::SIZE, &Triangle);
    request.features = gpu.device.features();
    let plan = right(right(load(&slow())).plan(&request));
    let wait_in_turns = &|timeout: Option<Duration>| {
        let mut executor = Executor::on(&gpu, plan.clone(), &mut Triangle).unwrap();
        for _ in 0..400 {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let wanted = Frame::new().with_read(&["number"]);
            executor.encode(&mut encoder, &wanted).unwrap();
            gpu.queue.submit([encoder.finish()]);
            while let Err(error) = executor.finish_within(timeout) {
                assert!(matches!(error, ExecuteError::Unfinished { .. }), "{error}");
            }
        }
    };
    std::thread::scope(|scope| {
        for timeout in [Some(Duration::from_micros(200)), None] {
            for _ in 0..2 {
                scope.spawn(move || wait_in_turns(timeout));
            }
        }
    });
}
