//! Buffers and textures that grow between frames, and defaults of params that ask for the viewport.

use crate::support::{Files, load, names, plan, right, wrong};
use skiagraph_graph::{NoProvider, ParamValue, Plan, PlanRequest, ResourceKind};
use std::collections::BTreeMap;

/// Counts in a pass that no output needs.
///
/// ```text
/// reset ─▶ count ─▶ needed ─▷ items (host)
/// fill ─▶ items ─▶ output
/// ```
fn counted() -> Files {
    Files::graph(
        r#"
    params: [U32(name: "most", default: 64)],
    materials: [
        Buffer(name: "needed"),
        Buffer(name: "items", count: 4, grow: (counter: "needed", max: "most")),
        Buffer(name: "copies", count: "items.count"),
    ],
    passes: [
        Clear(name: "reset", target: "needed"),
        Compute(name: "count", dispatch: Over(8)),
        Compute(name: "fill", dispatch: Over("items.count")),
        Copy(name: "copy", from: "items", to: "copies"),
    ],
    outputs: ["copies"],
"#,
    )
    .with(
        "count.wgsl",
        "var<storage, read_write> needed: atomic<u32>;
         @compute @workgroup_size(8) fn main() { atomicAdd(&needed, 1u); }",
    )
    .with(
        "fill.wgsl",
        "var<storage, read_write> items: array<u32>;
         @compute @workgroup_size(8) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
             if id.x < arrayLength(&items) { items[id.x] = id.x; }
         }",
    )
}

/// Items of a buffer, layers of a texture.
fn count(plan: &Plan, name: &str) -> u64 {
    let mut resources = plan.resources().iter();
    let resource = resources.find(|resource| resource.name == name);
    match &resource.expect("it is there").kind {
        ResourceKind::Buffer(buffer) => buffer.count.expect("it has a count"),
        ResourceKind::Texture(texture) => texture.layers.into(),
        other => panic!("{name} is {other:?}"),
    }
}

/// Names of what may grow, with the most items or layers of each.
fn growing(plan: &Plan) -> Vec<(String, u64)> {
    let growing = plan.growing().into_iter();
    growing
        .map(|(id, growth)| (plan.resource(id).name.clone(), growth.max))
        .collect()
}

fn grown<const N: usize>(plan: &Plan, items: [(&str, u64); N]) -> Plan {
    let items = items.map(|(name, items)| (name.to_owned(), items));
    right(plan.with(|request| request.grown = BTreeMap::from(items)))
}

#[test]
fn a_counter_is_never_culled() {
    let plan = right(plan(&counted()));
    assert_eq!(names(&plan), ["reset", "count", "fill", "copy"]);
    // No other material may overwrite it before it is read.
    let aliases = &plan.schedule().aliases.list;
    let (_, growth) = &plan.growing()[0];
    let mut allocations = aliases.iter();
    let allocation = allocations.find(|allocation| allocation.aliases.contains(&growth.counter.id));
    assert_eq!(allocation.expect("it has memory").aliases.len(), 1);
}

#[test]
fn what_is_known_of_a_frame_sizes_the_next_plan() {
    let first = right(plan(&counted()));
    assert_eq!(count(&first, "items"), 4);
    assert_eq!(growing(&first), [("items".to_owned(), 64)]);
    let larger = grown(&first, [("items", 9), ("nothing", 7)]);
    // A material that is counted by its items follows.
    assert_eq!([count(&larger, "items"), count(&larger, "copies")], [9, 9]);
    // Other changes keep it.
    let resized = right(larger.with_viewport([5, 5]));
    assert_eq!(count(&resized, "items"), 9);
    let bounded = right(larger.with_param("most", ParamValue::U32(6)));
    assert_eq!(count(&bounded, "items"), 6);
    assert_eq!(count(&grown(&first, [("items", 1 << 40)]), "items"), 64);
    // Nothing grows beyond what the device binds, and nothing shrinks below its count.
    let small = first.with(|request| request.limits.max_storage_buffer_binding_size = 40);
    assert_eq!(growing(&right(small)), [("items".to_owned(), 10)]);
    assert_eq!(count(&grown(&first, [("items", 1)]), "items"), 4);
}

/// Last frame's version is no buffer of its own, for diagnostics neither.
#[test]
fn last_frames_version_does_not_grow_by_itself() {
    let from = |name: &str| format!("Copy(name: \"copy\", from: \"{name}\"");
    let files = counted().edited("graph.ron", &from("items"), &from("items.previous"));
    assert_eq!(growing(&right(plan(&files))), [("items".to_owned(), 64)]);
    let uncounted = files.edited("graph.ron", "counter: \"needed\"", "counter: \"other\"");
    let uncounted = uncounted.edited(
        "graph.ron",
        "Buffer(name: \"needed\"),",
        "Buffer(name: \"needed\"), Buffer(name: \"other\"),",
    );
    let errors: Vec<String> = wrong(plan(&uncounted))
        .iter()
        .map(|error| error.message.clone())
        .collect();
    assert_eq!(errors, ["`items` grows by `other`, which no pass writes"]);
}

/// A texture whose layers are counted, and as many numbers.
fn layered() -> Files {
    let files = counted().edited(
        "graph.ron",
        r#"Buffer(name: "items", count: 4, grow: (counter: "needed", max: "most")),"#,
        r#"Texture(name: "maps", format: R32Uint, size: 8, layers: 2,
            grow: (counter: "needed", max: "most")),
        Buffer(name: "items", count: "maps.layers"),"#,
    );
    files
        .edited(
            "graph.ron",
            r#"outputs: ["copies"]"#,
            r#"outputs: ["copies", "maps"]"#,
        )
        .edited(
            "fill.wgsl",
            "@compute",
            "var maps: texture_storage_2d_array<r32uint, write>;\n@compute",
        )
        .edited(
            "fill.wgsl",
            "if id.x < arrayLength(&items) {",
            "if id.x < textureNumLayers(maps) { textureStore(maps, id.xy, id.x, id.xxxx);",
        )
}

#[test]
fn layers_grow_as_items_do() {
    let first = right(plan(&layered()));
    assert_eq!(names(&first), ["reset", "count", "fill", "copy"]);
    assert_eq!(growing(&first), [("maps".to_owned(), 64)]);
    assert_eq!(
        ["maps", "items", "copies"].map(|name| count(&first, name)),
        [2; 3]
    );
    let larger = grown(&first, [("maps", 9)]);
    assert_eq!(
        ["maps", "items", "copies"].map(|name| count(&larger, name)),
        [9; 3]
    );
    let texels = 8 * 8 * 4;
    assert_eq!(
        larger.memory_bytes() - first.memory_bytes(),
        7 * (texels + 4 + 4)
    );
    assert_eq!(count(&right(larger.with_viewport([5, 5])), "maps"), 9);
    let bounded = right(larger.with_param("most", ParamValue::U32(6)));
    assert_eq!(count(&bounded, "maps"), 6);
    assert_eq!(count(&grown(&first, [("maps", 1)]), "maps"), 2);
    // Nothing grows beyond what the adapter has, whatever frames have counted.
    let small = right(first.with(|request| request.limits.max_texture_array_layers = 5));
    assert_eq!(growing(&small), [("maps".to_owned(), 5)]);
    assert_eq!(count(&grown(&small, [("maps", 1 << 40)]), "maps"), 5);
    // A picture brings its layers.
    let picture = layered().edited(
        "graph.ron",
        "format: R32Uint, size: 8, layers: 2",
        r#"format: R8Unorm, file: "noise.png""#,
    );
    let error = wrong(plan(&picture.picture("noise.png", 2, &[0; 4]))).to_string();
    assert!(
        error.contains("`maps` grows, but from which `layers`?"),
        "{error}"
    );
}

/// Each instance grows by its own counter, under its full name.
#[test]
fn included_and_repeated_buffers_grow_alone() {
    let outer = r#"
    materials: [Buffer(name: "all", count: 1)],
    passes: [
        Group(name: "level", repeat: 2, passes: [Include(graph: "inner.ron", name: "part")]),
        Compute(name: "sum", dispatch: Groups(1, 1, 1), bind: {
            "a": "level[0].part.copies",
            "b": "level[1].part.copies",
        }),
    ],
    outputs: ["all"],
"#;
    let files = counted();
    let inner = files.texts["graph.ron"].clone();
    let files = files
        .document("graph.ron", outer)
        .with("inner.ron", inner)
        .with(
            "sum.wgsl",
            "var<storage, read> a: array<u32>; var<storage, read> b: array<u32>;
         var<storage, read_write> all: array<u32>;
         @compute @workgroup_size(1) fn main() { all[0] = a[0] + b[0]; }",
        );
    let first = right(plan(&files));
    let names: Vec<String> = growing(&first).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["level[0].part.items", "level[1].part.items"]);
    let larger = grown(&first, [("level[1].part.items", 12)]);
    let counts = names.iter().map(|name| count(&larger, name));
    assert_eq!(counts.collect::<Vec<_>>(), [4, 12]);
}

/// The buffer that the authoring guide shows.
#[test]
fn the_buffer_of_the_guide_grows() {
    let guide = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/authoring.md");
    let guide = std::fs::read_to_string(guide).expect("it is part of the repository");
    let mut words = guide.split('`');
    let shown = words.find(|word| word.contains("grow: ("));
    let shown = shown.expect("the guide shows one");
    let files = counted()
        .edited(
            "graph.ron",
            r#"Buffer(name: "items", count: 4, grow: (counter: "needed", max: "most"))"#,
            shown,
        )
        .edited("graph.ron", "\"needed\"", "\"hit_count\"")
        .edited("graph.ron", "\"items\"", "\"hits\"")
        .edited("graph.ron", "items.count", "hits.count")
        .edited("count.wgsl", "needed", "hit_count")
        .edited("fill.wgsl", "items", "hits");
    let first = right(plan(&files));
    assert_eq!(growing(&first), [("hits".to_owned(), 1_048_576)]);
    assert_eq!(count(&first, "hits"), 1024);
    let larger = grown(&first, [("hits", 1 << 30)]);
    assert_eq!(count(&larger, "hits"), 1_048_576);
}

/// A graph whose grid is half as wide as the viewport, unless it is said otherwise.
fn halves() -> Files {
    Files::graph(
        r#"
    params: [
        U32(name: "grid", default: "viewport.width / 2", min: 1, max: 16),
        U32(name: "cells", default: "grid * viewport.height"),
    ],
    materials: [Buffer(name: "items", count: "cells")],
    passes: [Compute(name: "fill", dispatch: Over("items.count"))],
    outputs: ["items"],
    claims: {"small": (if: "viewport.width < 10", because: "an example")},
"#,
    )
    .with("fill.wgsl", counted().texts["fill.wgsl"].clone())
}

#[test]
fn a_default_follows_the_viewport() {
    let graph = right(load(&halves()));
    let plan = right(graph.plan(&PlanRequest::new([8, 6], &NoProvider)));
    assert_eq!(plan.param("grid"), Some(&ParamValue::U32(4)));
    assert_eq!(count(&plan, "items"), 24);
    let wider = right(plan.with_viewport([20, 6]));
    assert_eq!(wider.param("grid"), Some(&ParamValue::U32(10)));
    assert_eq!(count(&wider, "items"), 60);
    // A value that was set stays.
    let set = right(plan.with_param("grid", ParamValue::U32(3)));
    assert_eq!(count(&right(set.with_viewport([20, 6])), "items"), 18);
    // A value beyond the bounds is an error there, at the default.
    let error = wrong(plan.with_viewport([40, 6])).to_string();
    assert!(error.contains("`grid`") && error.contains("16"), "{error}");

    let none = BTreeMap::new();
    for (width, grid, claims) in [(8, 4, 1), (20, 10, 0)] {
        let features = wgt::Features::empty();
        let values = right(graph.values(&none, [width, 6], features));
        assert_eq!(values["grid"], ParamValue::U32(grid));
        let held = right(graph.claims(&none, [width, 6], features));
        let held = held.iter().filter(|claim| claim.holds).count();
        assert_eq!(held, claims);
    }
}

/// The defaults of an included document see the viewport, too.
#[test]
fn an_included_default_follows_the_viewport() {
    let files = halves();
    let inner = files.texts["graph.ron"].clone();
    let files = files.with("inner.ron", inner).document(
        "graph.ron",
        r#"
    passes: [Include(graph: "inner.ron", name: "inner")],
    outputs: [(name: "items", material: "inner.items")],
"#,
    );
    let first = right(plan(&files));
    assert_eq!(count(&first, "inner.items"), 32);
    let wider = right(first.with_viewport([20, 6]));
    assert_eq!(count(&wider, "inner.items"), 60);
}
