//! The generated graphs are what the benchmarks say that they are.

use skiagraph_benches::{
    Generated, Shaders, VIEWPORT,
    chain::{self, Kind},
    graph,
};
use skiagraph_graph::{Graph, NoProvider, Plan, PlanRequest, Registry};
use std::collections::BTreeMap;

const SIZES: [usize; 8] = [1, 2, 3, 5, 10, 37, 100, 1000];

fn plan(generated: &Generated) -> Plan {
    let graph = Graph::load("graph.ron", &Registry::standard(), generated)
        .unwrap_or_else(|faults| panic!("{faults}"));
    assert!(graph.warnings().is_empty());
    graph
        .plan(&PlanRequest::new(VIEWPORT, &NoProvider))
        .unwrap_or_else(|faults| panic!("{faults}"))
}

fn every_graph() -> impl Iterator<Item = (usize, Shaders, u64)> {
    let of_size = |size| {
        [Shaders::Few, Shaders::OnePerPass]
            .into_iter()
            .flat_map(move |shaders| (0..3).map(move |seed| (size, shaders, seed)))
    };
    SIZES.into_iter().flat_map(of_size)
}

#[test]
fn every_pass_is_planned_and_none_culled() {
    for (size, shaders, seed) in every_graph() {
        let generated = graph(size, shaders, seed);
        let plan = plan(&generated);
        assert!(plan.culled().is_empty(), "{size} {shaders:?} {seed}");
        let mut kinds = BTreeMap::new();
        for pass in plan.passes() {
            *kinds.entry(pass.kind).or_insert(0) += 1;
        }
        let written = generated.kinds.iter();
        let written: BTreeMap<String, usize> = written
            .map(|(kind, count)| (kind.to_string(), *count))
            .collect();
        assert_eq!(kinds, written, "{size} {shaders:?} {seed}");
        assert_eq!(kinds.values().sum::<usize>(), size);
        assert_eq!(plan.outputs().len(), 1);
    }
}

#[test]
fn a_large_graph_has_passes_of_every_kind() {
    for seed in 0..3 {
        let kinds = graph(100, Shaders::Few, seed).kinds;
        let names: Vec<&str> = kinds.into_keys().collect();
        assert_eq!(names, ["Clear", "Compute", "Copy", "Fullscreen", "Raster"]);
    }
}

#[test]
fn a_seed_gives_one_graph() {
    let made = |seed| graph(100, Shaders::Few, seed);
    assert_eq!(made(1), made(1));
    assert_ne!(made(1), made(2));
}

#[test]
fn a_chain_runs_all_its_passes_in_order() {
    for kind in Kind::ALL {
        for passes in [1, 2, 3, 100] {
            let plan = chain::plan(kind, passes);
            assert!(plan.culled().is_empty() && plan.warnings().is_empty());
            let names: Vec<String> = plan.passes().into_iter().map(|pass| pass.name).collect();
            let expected = (0..passes).map(|at| format!("{}_{at}", kind.name()));
            assert!(expected.eq(names), "{kind:?} {passes}");
        }
    }
}
