//! Any hits per second of every engine of `Trace`, and of Embree (feature `embree`), on the same
//! rays: those of `rt` from Sponza's view `main` and from a view of `park`, and random ones through
//! Sponza. Every engine must find what the compute hierarchy finds.

mod engines;

use engines::{Engine, Rays, engines, rays, tracer::RAY_QUERY};
use skiagraph_benches::open;
use skiagraph_gpu::device;
use std::time::Duration;

/// No more of the rays may be answered in another way than by the compute hierarchy.
const MOST: f64 = 1e-4;

fn main() {
    // `cargo bench` says `--bench`; without it the engines are only tried.
    let measured = std::env::args().any(|argument| argument == "--bench");
    let (edge, turns) = if measured { (512, 5) } else { (48, 1) };
    let wanted = device::Wanted::default().with_features(RAY_QUERY);
    let unit = format!("; millions of any hits per second, medians of {turns}");
    let Some(gpu) = open(&wanted, &unit) else {
        return;
    };
    if !gpu.device.features().contains(RAY_QUERY) {
        println!("without RayQuery: the adapter has no EXPERIMENTAL_RAY_QUERY");
    }
    println!("| rays | engine | built in, ms | Mrays/s | blocked | unlike `Hierarchy` |");
    println!("|---|---|---|---|---|---|");
    for rays in rays(&gpu, edge) {
        let mut engines = engines(&gpu, &rays);
        let mut times = vec![Vec::new(); engines.len()];
        // Turn by turn, so that what else the machine does meets all of them.
        for turn in 0..=turns {
            for (engine, times) in engines.iter_mut().zip(&mut times) {
                let (time, blocked) = (engine.trace)();
                assert_eq!(blocked.len(), rays.set.rays.len(), "{}", engine.name);
                // The first turn warms up, and is what answers are compared by.
                match turn {
                    0 => engine.blocked = blocked,
                    _ => times.push(time),
                }
            }
        }
        report(&rays, &engines, &mut times);
    }
}

fn report(rays: &Rays, engines: &[Engine<'_>], times: &mut [Vec<Duration>]) {
    let count = rays.set.rays.len();
    let expected = &engines[0].blocked;
    for (engine, times) in engines.iter().zip(times) {
        times.sort();
        let median = times.get(times.len() / 2).copied().unwrap_or_default();
        let differing = engine.blocked.iter().zip(expected);
        let differing = differing.filter(|(a, b)| a != b).count();
        let blocked = engine.blocked.iter().filter(|blocked| **blocked).count();
        println!(
            "| {}, {count} | {} | {:.0} | {:.2} | {blocked} | {differing} |",
            rays.set.name,
            engine.name,
            engine.built.as_secs_f64() * 1e3,
            count as f64 / median.as_secs_f64() / 1e6,
        );
        assert!(
            differing as f64 <= (MOST * count as f64).max(1.0),
            "{} answers {differing} of {count} rays in another way",
            engine.name
        );
    }
}
