//! Measures the executor against the same frame written by hand in plain wgpu, and the cost of
//! making and changing an executor. Encoding and finishing the encoder is measured, submission is
//! not: no frame is submitted.

use criterion::{BenchmarkGroup, BenchmarkId, Criterion, measurement::WallTime};
use skiagraph_benches::chain::{ByHand, Kind, executor};
use skiagraph_benches::{Shaders, VIEWPORT, graph, median, open};
use skiagraph_gpu::device::{Gpu, Wanted};
use skiagraph_gpu::{Executor, Frame, Pipelines};
use skiagraph_graph::{NoProvider, ParamValue, Plan, PlanRequest, Registry};
use std::time::{Duration, Instant};

const SIZES: [usize; 3] = [10, 100, 1000];

fn main() {
    let Some(gpu) = open(&Wanted::default(), "") else {
        return;
    };
    // `cargo bench` says `--bench`; without it the benchmarks are only tried. First, because wgpu
    // is slower on a device that has seen many resources.
    if std::env::args().any(|argument| argument == "--bench") {
        compare(&gpu);
    }
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    changes(&mut criterion, &gpu);
    criterion.final_summary();
}

/// Encodes and finishes one frame; how long that took.
fn frame(gpu: &Gpu, encode: impl FnOnce(&mut wgpu::CommandEncoder)) -> Duration {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let start = Instant::now();
    encode(&mut encoder);
    let commands = encoder.finish();
    let time = start.elapsed();
    // Nothing is submitted, and without this wgpu keeps what is dropped.
    drop(commands);
    let _ = gpu.device.poll(wgpu::PollType::Poll);
    time
}

/// Prints the times of chains by hand and through the executor. The ways take turns frame by frame,
/// so that what else the machine does meets all of them; differences and ratios are those within
/// one turn.
fn compare(gpu: &Gpu) {
    println!("\nencode and finish, µs per pass: medians over turns (a frame of each)");
    println!(
        "kind     | passes | turns | by hand | executor | over by hand | ratio | over by hand \
         with debug groups | ratio"
    );
    for kind in Kind::ALL {
        for passes in SIZES {
            let by_hand = ByHand::new(gpu, kind, passes);
            let mut executor = executor(gpu, kind, passes).expect("the chain suits every device");
            let mut turn = |first: usize| {
                let mut times = [0.0; 3];
                // The first way finds other caches.
                for way in (0..3).map(|way| (first + way) % 3) {
                    let time = frame(gpu, |encoder| match way {
                        0 => encode(&mut executor, encoder),
                        1 => by_hand.encode(encoder, false),
                        _ => by_hand.encode(encoder, true),
                    });
                    times[way] = time.as_secs_f64() * 1e6 / passes as f64;
                }
                times
            };
            let turns = 40_000 / (passes + 30);
            let warm_up = turns / 10;
            let times: Vec<[f64; 3]> = (0..turns + warm_up).map(&mut turn).skip(warm_up).collect();
            let over = |by_hand: usize| {
                let pairs = || times.iter().map(|times| (times[0], times[by_hand]));
                [
                    median(pairs().map(|(executor, by_hand)| executor - by_hand)),
                    median(pairs().map(|(executor, by_hand)| executor / by_hand)),
                ]
            };
            let [executor, by_hand] =
                [0, 1].map(|way| median(times.iter().map(|times| times[way])));
            let [[over, ratio], [over_grouped, ratio_grouped]] = [over(1), over(2)];
            println!(
                "{:8} | {passes:6} | {turns:5} | {by_hand:7.3} | {executor:8.3} | {over:+12.3} | \
                 {ratio:5.3} | {over_grouped:+30.3} | {ratio_grouped:5.3}",
                kind.name(),
            );
        }
    }
}

/// Encodes all passes of a graph that was encoded before.
fn encode(executor: &mut Executor, encoder: &mut wgpu::CommandEncoder) {
    let encoded = executor.encode(encoder, &Frame::new().with_all(true));
    encoded.expect("the graph was encoded before");
}

fn planned(passes: usize) -> Plan {
    let sources = (&Registry::standard(), &graph(passes, Shaders::Few, 1) as _);
    let request = PlanRequest::new(VIEWPORT, &NoProvider);
    skiagraph_benches::planned("graph.ron", sources, &request)
}

/// Frames of generated graphs, and what an executor's making, another size and another value of a
/// param cost.
fn changes(criterion: &mut Criterion, gpu: &Gpu) {
    let make = |plan| {
        let made = Executor::with_pipelines(
            &Pipelines::new(&gpu.device),
            &gpu.queue,
            plan,
            &mut NoProvider,
        );
        made.expect("the generated graphs suit every device")
    };
    for passes in SIZES {
        let mut group = criterion.benchmark_group(format!("executor, {passes} passes"));
        each(&mut group, "new", || {
            let plan = planned(passes);
            settled(gpu, || make(plan))
        });
        let mut executor = make(planned(passes));
        each(&mut group, "encode", || {
            frame(gpu, |encoder| encode(&mut executor, encoder))
        });
        let mut wide = false;
        each(&mut group, "resize", || {
            wide = !wide;
            let viewport = [VIEWPORT[0] * if wide { 2 } else { 1 }, VIEWPORT[1]];
            settled(gpu, || {
                let resized = executor.resize(viewport, &mut NoProvider);
                resized.expect("both sizes suit every device")
            })
        });
        let mut strength = 0.0;
        each(&mut group, "set_param, upload", || {
            strength += 1.0;
            settled(gpu, || {
                let value = ParamValue::F32(strength);
                let renewed = executor.set_param("strength", value, &mut NoProvider);
                let renewed = renewed.expect("every value suits");
                assert!(renewed.pipelines.is_empty() && renewed.resources.is_empty());
                assert!(!renewed.uploads.is_empty());
            })
        });
        group.finish();
    }
}

/// Measures an operation. What it has made and dropped is freed behind that: wgpu does so when it
/// next submits, as a program does in every frame.
fn settled<T>(gpu: &Gpu, act: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    let made = act();
    let time = start.elapsed();
    drop(made);
    gpu.queue.submit([]);
    let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    time
}

/// Measures an operation that times itself.
fn each(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, mut once: impl FnMut() -> Duration) {
    group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
        bencher.iter_custom(|times| (0..times).map(|_| once()).sum());
    });
}
