//! How long a graph takes from its text to a plan, without a GPU: the presets, and generated graphs
//! of 10, 100 and 1,000 passes.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use skiagraph_benches::{Generated, Shaders, VIEWPORT, graph};
use skiagraph_graph::{Describe, Graph, NoProvider, PlanRequest, Registry, Sources};
use skiagraph_passes::{EmbeddedSources, SceneProvider, presets, registry};
use skiagraph_scene::SceneLibrary;
use std::{hint::black_box, sync::Arc, time::Duration};

/// Measures `Graph::load` (all WGSL included), `Graph::plan` and both of one document.
fn measure(
    criterion: &mut Criterion,
    name: &str,
    (path, registry, sources): (&str, &Registry, &dyn Sources),
    request: &PlanRequest<'_>,
) {
    let load = || Graph::load(path, registry, sources).expect("the benchmarked graphs are sound");
    let loaded = load();
    let plan = |graph: &Graph| {
        graph
            .plan(request)
            .expect("the benchmarked graphs can be planned")
    };
    let mut group = criterion.benchmark_group(name);
    group.bench_function(BenchmarkId::from_parameter("load"), |bencher| {
        bencher.iter_with_large_drop(load);
    });
    group.bench_function(BenchmarkId::from_parameter("plan"), |bencher| {
        bencher.iter_with_large_drop(|| plan(black_box(&loaded)));
    });
    group.bench_function(BenchmarkId::from_parameter("load + plan"), |bencher| {
        bencher.iter_with_large_drop(|| plan(&load()));
    });
    group.finish();
}

fn of_presets(criterion: &mut Criterion) {
    let scene = SceneLibrary::from_environment().load("park");
    let (scene, _) = scene.expect("park is built in");
    let provider: &dyn Describe = &SceneProvider::new(Arc::new(scene));
    // Some presets need what few adapters have; planning asks no adapter.
    let request = PlanRequest::new([1920, 1080], provider)
        .with_device(wgpu::Limits::default(), wgpu::Features::all());
    let registry = registry();
    for preset in presets() {
        let document = (preset.path.as_str(), &registry, &EmbeddedSources as _);
        measure(criterion, &preset.name, document, &request);
    }
}

fn of_generated(criterion: &mut Criterion) {
    let registry = Registry::standard();
    let request = PlanRequest::new(VIEWPORT, &NoProvider);
    for (shaders, words) in [
        (Shaders::Few, "few shaders"),
        (Shaders::OnePerPass, "one shader per pass"),
    ] {
        for passes in [10, 100, 1000] {
            let generated: Generated = graph(passes, shaders, 1);
            let document = ("graph.ron", &registry, &generated as _);
            let name = format!("{passes} passes, {words}");
            measure(criterion, &name, document, &request);
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    targets = of_presets, of_generated
}
criterion_main!(benches);
