//! Changes of a param, the size or the graph; and failed changes, which alter nothing.

use crate::host::{GPU, encoder, executor, frame, numbers, planned, request, words};
use crate::support::Files;
use skiagraph_gpu::{ExecuteError, Executor, Frame, ReplanReport};
use skiagraph_graph::{NoProvider, ParamValue, PlanRequest};

/// Every kind of place that a param can stand in, each with its own.
const PARAMS: &str = r#"
    params: [
        U32(name: "gain", default: 1, max: 100),
        U32(name: "offset", default: 0),
        U32(name: "both", default: 0),
        Choice(name: "face", words: [none, front, back], default: none),
        F32(name: "slope", default: 0),
        F32(name: "far", default: 1, min: 0, max: 1),
        U32(name: "edge", default: 8),
        U32(name: "layers", default: 2, min: 2),
        U32(name: "items", default: 64, min: 1),
        U32(name: "corners", default: 3),
        U32(name: "groups", default: 1),
        U32(name: "times", default: 2),
        Bool(name: "enabled", default: true),
        Bool(name: "more", default: false),
    ],
    materials: [
        Texture(name: "depth", format: Depth32Float, size: "edge"),
        Texture(name: "stack", format: R32Uint, size: 4, layers: "layers"),
        Buffer(name: "list", count: "items"),
        Texture(name: "sum", format: R16Float, size: 1),
        Buffer(name: "sometimes", count: 1),
        Texture(name: "image", format: R32Uint),
        Texture(name: "extra", format: R16Float, size: 1),
    ],
    passes: [
        Raster(
            name: "draw",
            draw: "corners",
            cull: "face",
            depth: (target: "depth", load: Clear("far"), bias: (slope_scale: "slope")),
        ),
        Compute(name: "pile", dispatch: Groups(1, 1, "groups")),
        Compute(name: "fill", dispatch: Over("list.count")),
        Clear(name: "zero", target: "sum"),
        Fullscreen(
            name: "add",
            repeat: "times",
            color: [(target: "sum", load: Load, blend: Additive)],
        ),
        Compute(
            name: "switch",
            run: When("enabled"),
            dispatch: Groups(1, 1, 1),
            bind: {"old": "sometimes.previous"},
        ),
        Fullscreen(name: "shade", color: ["image"]),
        Fullscreen(name: "one_more", if: "more", shader: "add", color: ["extra"]),
    ],
    outputs: [
        "image", "depth", "stack", "list", "sum", "sometimes", (name: "extra", if: "more"),
    ],
"#;

fn params() -> Files {
    Files::graph(PARAMS)
        .with(
            "draw.wgsl",
            "@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
                 let corner = vec2(index & 1u, index >> 1u);
                 return vec4<f32>(vec2<f32>(corner) * 4.0 - 1.0, 0.5, 1.0);
             }",
        )
        .with(
            "pile.wgsl",
            "var stack: texture_storage_2d_array<r32uint, write>;
             @compute @workgroup_size(4, 4) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
                 for (var layer = 0u; layer < textureNumLayers(stack); layer++) {
                     textureStore(stack, at.xy, layer, vec4(layer));
                 }
             }",
        )
        .with(
            "fill.wgsl",
            "var<storage, read_write> list: array<u32>;
             @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
                 if id.x < arrayLength(&list) { list[id.x] = id.x; }
             }",
        )
        .with(
            "add.wgsl",
            "@fragment fn fragment() -> @location(0) f32 { return 1.0; }",
        )
        .with(
            "switch.wgsl",
            "var<storage, read> old: array<u32>;
             var<storage, read_write> sometimes: array<u32>;
             @compute @workgroup_size(1) fn main() { sometimes[0] = old[0] + 1u; }",
        )
        .with(
            "shade.wgsl",
            "struct Params { gain: u32, both: u32 }
             var<uniform> params: Params;
             override offset: u32;
             override both: u32;
             @fragment fn fragment() -> @location(0) u32 {
                 return 7u * params.gain + offset + params.both + both;
             }",
        )
}

/// The table of docs/embedding.md, row by row: what a change of a param comes to, and the image
/// after it.
#[test]
fn a_param_costs_what_follows_from_it() {
    let mut executor = executor(&params(), &request(&NoProvider));
    assert_eq!(numbers(&mut executor, "image"), [7; 64]);
    let number = ParamValue::U32;
    let word = |word: &str| ParamValue::Choice(word.to_owned());
    type Names<'a> = &'a [&'a str];
    let rows: [(&str, ParamValue, Names, Names, Names, u32); 17] = [
        // param, value, uploads, pipelines, resources, image
        ("gain", number(2), &["shade"], &[], &[], 14),
        ("gain", number(2), &[], &[], &[], 14),
        ("offset", number(3), &[], &["shade"], &[], 17),
        ("both", number(1), &["shade"], &["shade"], &[], 19),
        ("face", word("back"), &[], &["draw"], &[], 19),
        ("slope", ParamValue::F32(1.5), &[], &["draw"], &[], 19),
        ("far", ParamValue::F32(0.75), &[], &[], &[], 19),
        ("corners", number(6), &[], &[], &[], 19),
        ("groups", number(2), &[], &[], &[], 19),
        ("edge", number(32), &[], &[], &["depth"], 19),
        ("layers", number(4), &[], &[], &["stack"], 19),
        ("items", number(100), &[], &[], &["list"], 19),
        ("times", number(4), &[], &["add[2]", "add[3]"], &[], 19),
        ("times", number(3), &[], &[], &[], 19),
        (
            "more",
            ParamValue::Bool(true),
            &[],
            &["one_more"],
            &["extra"],
            19,
        ),
        ("more", ParamValue::Bool(false), &[], &[], &[], 19),
        ("enabled", ParamValue::Bool(false), &[], &[], &[], 19),
    ];
    for (name, value, uploads, pipelines, resources, image) in rows {
        let report = executor
            .set_param(name, value.clone(), &mut NoProvider)
            .unwrap_or_else(|error| panic!("{error}"));
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        let mut expected = ReplanReport::default();
        expected.uploads = names(uploads);
        expected.pipelines = names(pipelines);
        expected.resources = names(resources);
        assert_eq!(report, expected, "{name} = {value}");
        assert_eq!(executor.plan().param(name), Some(&value));
        let values = numbers(&mut executor, "image");
        assert_eq!(values, [image; 64], "{name} = {value}");
    }
    // The changes took effect.
    let report = frame(&mut executor, &["depth", "list", "sometimes", "sum"]);
    assert_eq!(report.skipped, ["switch"]);
    let depth = report.readbacks[0].content.as_f32().unwrap();
    assert_eq!(depth.len(), 32 * 32);
    assert_eq!(words(&report, 1).len(), 100);
    assert_eq!(
        words(&report, 2),
        [17],
        "it ran in each frame until it was switched off"
    );
    assert_eq!(report.readbacks[3].content.as_f32().unwrap(), [3.0]);
}

/// ```text
/// total.previous ─▶ count ─▶ total ; viewport ─▶ image
/// ```
fn counter(step: &str) -> Files {
    Files::graph(
        r#"
    params: [U32(name: "most", default: 5, max: 9), U32(name: "items", default: 1)],
    materials: [Buffer(name: "total", count: "items"), Texture(name: "image", format: R32Uint)],
    passes: [
        Compute(name: "count", dispatch: Groups(1, 1, 1), bind: {"old": "total.previous"}),
        Fullscreen(name: "draw", color: ["image"]),
    ],
    outputs: ["total", "image"],
"#,
    )
    .with(
        "draw.wgsl",
        "@fragment fn fragment() -> @location(0) u32 { return 1u; }",
    )
    .with(
        "count.wgsl",
        format!(
            "struct Params {{ most: u32 }} var<uniform> params: Params;
             var<storage, read> old: array<u32>; var<storage, read_write> total: array<u32>;
             @compute @workgroup_size(1) fn main() {{ total[0] = old[0] + {step}; }}"
        ),
    )
}

/// The device refuses what the plan's limits allowed.
fn boundless() -> PlanRequest<'static> {
    let mut request = request(&NoProvider);
    request.limits.max_texture_dimension_2d = 1 << 20;
    request.limits.max_compute_workgroup_size_x = 1 << 12;
    request.limits.max_compute_invocations_per_workgroup = 1 << 12;
    request.limits.max_storage_buffer_binding_size = 1 << 30;
    request
}

#[test]
fn what_fails_changes_nothing() {
    let mut executor = executor(&counter("1u"), &boundless());
    let mut expected = 1;
    assert_eq!(numbers(&mut executor, "total"), [expected]);
    type Change = fn(&mut Executor) -> Result<ReplanReport, ExecuteError>;
    let changes: [(&str, Change); 8] = [
        ("the viewport has no pixels", |executor| {
            executor.resize([0, 8], &mut NoProvider)
        }),
        ("`image` could not be made", |executor| {
            executor.resize([1 << 19, 8], &mut NoProvider)
        }),
        ("did you mean `most`", |executor| {
            executor.set_param("mast", ParamValue::U32(1), &mut NoProvider)
        }),
        ("must be at most 9", |executor| {
            executor.set_param("most", ParamValue::U32(10), &mut NoProvider)
        }),
        ("must be of type u32", |executor| {
            executor.set_param("most", ParamValue::F32(1.0), &mut NoProvider)
        }),
        ("`image` could not be made", |executor| {
            let mut request = boundless();
            request.viewport = [1 << 19, 8];
            executor.replace_graph(planned(&counter("100u"), &request), &mut NoProvider)
        }),
        // Refused at the pipeline, when all memory is there …
        ("pass `count` was refused by the device", |executor| {
            let wide = ["workgroup_size(1)", "workgroup_size(2048)"];
            let files = counter("100u").edited("count.wgsl", wide[0], wide[1]);
            executor.replace_graph(planned(&files, &boundless()), &mut NoProvider)
        }),
        // … and at the bind group, when the new plan has taken the place of the old one.
        ("pass `count` was refused by the device", |executor| {
            executor.set_param("items", ParamValue::U32(40_000_000), &mut NoProvider)
        }),
    ];
    for (why, change) in changes {
        let message = change(&mut executor).expect_err(why).to_string();
        assert!(message.contains(why), "{message}\nshould say: {why}");
        expected += 1;
        assert_eq!(numbers(&mut executor, "total"), [expected], "after {why}");
        assert_eq!(numbers(&mut executor, "image"), [1; 64], "after {why}");
        expected += 1;
        assert_eq!(executor.plan().viewport(), [8, 8]);
    }
}

#[test]
fn an_edited_shader_keeps_what_was_there() {
    let mut executor = executor(&counter("1u"), &request(&NoProvider));
    assert_eq!(numbers(&mut executor, "total"), [1]);
    assert_eq!(numbers(&mut executor, "total"), [2]);
    let plan = planned(&counter("10u"), &request(&NoProvider));
    let report = executor.replace_graph(plan, &mut NoProvider).unwrap();
    let mut only = ReplanReport::default();
    only.pipelines.push("count".to_owned());
    assert_eq!(report, only);
    assert_eq!(numbers(&mut executor, "total"), [12]);
}

/// The report is that of the frame, whatever the executor's plan is by then.
#[test]
fn a_frame_that_was_encoded_before_a_change_is_reported_after_it() {
    let mut executor = executor(&params(), &request(&NoProvider));
    let mut encoder = encoder();
    let timed = Frame::new().with_timing(true).with_read(&["image"]);
    executor.encode(&mut encoder, &timed).unwrap();
    GPU.queue.submit([encoder.finish()]);
    let plan = planned(&counter("1u"), &request(&NoProvider));
    executor.replace_graph(plan, &mut NoProvider).unwrap();
    let report = executor.finish().unwrap();
    let timing = report.timing.as_ref().expect("times were asked for");
    let names: Vec<&str> = timing
        .passes
        .iter()
        .map(|pass| pass.name.as_str())
        .collect();
    assert_eq!(
        names,
        [
            "draw", "pile", "fill", "zero", "add[0]", "add[1]", "switch", "shade"
        ]
    );
    assert_eq!(words(&report, 0), [7; 64]);
}
