//! Materials with `keep: true`: what is in them from frame to frame, and when that is lost.

use crate::buffers::{INPUT, OUT, SEED, SEED_PARAM, compute, document, shader, writes};
use crate::host::{GPU, encoder, executor, frame, numbers, planned, request, set, words};
use crate::support::Files;
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::{NoProvider, ParamValue};

const COUNT: &str = "out[0] = out[0] + 1u;";
const FRAME: &str = "#import \"frame.wgsl\"\n";

/// A document of which the buffers named `kept…` have `keep: true`.
fn keeping(params: &str, buffers: &[&str], passes: &[String], outputs: &[&str]) -> Files {
    let mut files = document(params, buffers, passes, outputs)
        .with("count.wgsl", shader(OUT, COUNT))
        .with("take.wgsl", writes(INPUT, "input[0]"))
        .with(
            "frame.wgsl",
            include_str!("../../../../shaders/shared/frame.wgsl"),
        )
        .with(
            "fresh.wgsl",
            writes(
                FRAME,
                "100u * frame.changed_scene + 10u * frame.changed_light + frame.fresh",
            ),
        );
    for name in buffers.iter().filter(|name| name.starts_with("kept")) {
        let plain = format!("Buffer(name: \"{name}\", count: 1)");
        let kept = format!("Buffer(name: \"{name}\", count: 1, keep: true)");
        files = files.edited("graph.ron", &plain, &kept);
    }
    files
}

fn pass(name: &str, shader: &str, more: &str, bind: &str) -> String {
    compute(name, &format!("shader: \"{shader}\", {more}"), bind)
}

const KEPT: &str = r#""out": "kept""#;

fn resize(executor: &mut Executor, edge: u32) {
    executor
        .resize([edge, edge], &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"));
}

/// ```text
/// kept ─▶ before ─▶ a ;  count ─▶ kept ─▶ after ─▶ b ;  frame ─▶ fresh
/// ```
#[test]
fn a_buffer_is_counted_up_over_frames() {
    let passes = [
        pass("before", "take", "", r#""input": "kept", "out": "a""#),
        pass("count", "count", "", KEPT),
        pass("after", "take", "", r#""input": "kept", "out": "b""#),
        pass("fresh", "fresh", "", r#""out": "fresh""#),
    ];
    let outputs = ["a", "b", "fresh", "kept"];
    let files = keeping("", &["a", "b", "fresh", "kept"], &passes, &outputs);
    for poison in [None, Some(0xa5)] {
        let mut request = request(&NoProvider);
        request.poison = poison;
        let mut executor = executor(&files, &request);
        for count in 1..=5 {
            let report = frame(&mut executor, &outputs);
            let values: Vec<u32> = (0..4).map(|at| words(&report, at)[0]).collect();
            let fresh = if count == 1 { 111 } else { 0 };
            assert_eq!(values, [count - 1, count, fresh, count]);
            if count == 3 {
                // It does not follow the viewport.
                resize(&mut executor, 16);
            }
        }
        // Frames of one submission follow one another.
        let mut commands = encoder();
        for _ in 0..2 {
            executor.encode(&mut commands, &Frame::default()).unwrap();
        }
        GPU.queue.submit([commands.finish()]);
        assert_eq!(numbers(&mut executor, "kept"), [8]);
    }
}

/// Memory made anew is zero, also under poison, and the frame says so once.
#[test]
fn new_memory_is_zero_and_fresh() {
    let passes = [
        r#"Fullscreen(name: "add", shader: "one",
            color: [(target: "sum", load: Load, blend: Additive)]),"#
            .to_owned(),
        pass("fresh", "fresh", "", r#""out": "fresh""#),
    ];
    let files = keeping(
        "U32(name: \"other\", default: 0)",
        &["fresh"],
        &passes,
        &["sum", "fresh"],
    )
    .edited(
        "graph.ron",
        "materials: [",
        r#"materials: [Texture(name: "sum", format: R16Float, keep: true),"#,
    )
    .with(
        "one.wgsl",
        "@fragment fn fragment() -> @location(0) f32 { return 1.0; }",
    );
    for poison in [None, Some(0x11)] {
        let mut request = request(&NoProvider);
        request.poison = poison;
        let mut executor = executor(&files, &request);
        let expect = |executor: &mut Executor, sum: f32, fresh: u32, edge: usize| {
            let report = frame(executor, &["sum", "fresh"]);
            let sums = report.readbacks[0].content.as_f32().unwrap();
            assert_eq!(sums, vec![sum; edge * edge]);
            assert_eq!(words(&report, 1), [fresh]);
        };
        expect(&mut executor, 1.0, 111, 8);
        expect(&mut executor, 2.0, 0, 8);
        let plan = executor.plan().with_param("other", ParamValue::U32(1));
        executor
            .replace_graph(plan.unwrap(), &mut NoProvider)
            .unwrap();
        expect(&mut executor, 3.0, 0, 8);
        resize(&mut executor, 4);
        // A plan that fails between takes nothing back.
        assert!(executor.resize([0, 4], &mut NoProvider).is_err());
        expect(&mut executor, 1.0, 111, 4);
        expect(&mut executor, 2.0, 0, 4);
        // Content made without `keep` is not carried on.
        let without = files
            .clone()
            .edited("graph.ron", ", keep: true", "")
            .edited("graph.ron", "load: Load, blend: Additive", "load: Clear(5)");
        let plan = planned(&without, &request);
        executor.replace_graph(plan, &mut NoProvider).unwrap();
        expect(&mut executor, 1.0, 0, 8);
        let plan = planned(&files, &request);
        executor.replace_graph(plan, &mut NoProvider).unwrap();
        expect(&mut executor, 1.0, 111, 8);
    }
}

/// Writers of three conditions and readers around them.
///
/// ```text
/// kept ─▶ before (OnChange) ─▶ a
/// reset (Once) ─▶ kept ; seed ─▶ set (OnChange) ─▶ kept ; on ─▶ count (When) ─▶ kept
/// kept ─▶ after (OnChange) ─▶ b
/// ```
#[test]
fn passes_that_are_not_run_leave_it() {
    let passes = [
        pass(
            "before",
            "take",
            "run: OnChange,",
            r#""input": "kept", "out": "a""#,
        ),
        pass("reset", "reset", "run: Once,", KEPT),
        pass("set", "set", "run: OnChange,", KEPT),
        pass("count", "count", r#"run: When("on"),"#, KEPT),
        pass(
            "after",
            "take",
            "run: OnChange,",
            r#""input": "kept", "out": "b""#,
        ),
    ];
    let params = format!("{SEED_PARAM} Bool(name: \"on\", default: true)");
    let files = keeping(&params, &["a", "b", "kept"], &passes, &["a", "b"])
        .with("reset.wgsl", writes("", "out[0] + 1000u"))
        .with("set.wgsl", writes(SEED, "out[0] + 100u * params.seed"));
    let mut executor = executor(&files, &request(&NoProvider));
    let step = |executor: &mut Executor, [a, b]: [u32; 2], skipped: &[&str]| {
        let report = frame(executor, &["a", "b"]);
        assert_eq!(report.skipped, skipped);
        assert_eq!([words(&report, 0)[0], words(&report, 1)[0]], [a, b]);
    };
    step(&mut executor, [0, 1501], &[]);
    step(&mut executor, [1501, 1502], &["reset", "set"]);
    set(&mut executor, "seed", ParamValue::U32(2));
    step(&mut executor, [1502, 1703], &["reset"]);
    set(&mut executor, "on", ParamValue::Bool(false));
    // Content left by the frame before is new to `before`, and not to `after`.
    step(
        &mut executor,
        [1703, 1703],
        &["reset", "set", "count", "after"],
    );
    step(
        &mut executor,
        [1703, 1703],
        &["before", "reset", "set", "count", "after"],
    );
    set(&mut executor, "seed", ParamValue::U32(3));
    step(&mut executor, [1703, 2003], &["before", "reset", "count"]);
    step(
        &mut executor,
        [2003, 2003],
        &["reset", "set", "count", "after"],
    );
}

/// As many items are appended in each frame as are wanted; a larger buffer begins with what the
/// smaller one held, and no frame is fresh.
#[test]
fn growth_copies_what_there_was() {
    let files = Files::graph(
        r#"
    params: [U32(name: "wanted", default: 3)],
    materials: [
        Buffer(name: "needed", keep: true),
        Buffer(name: "list", count: 4, keep: true, grow: (counter: "needed", max: 64)),
        Buffer(name: "fresh", count: 1),
    ],
    passes: [
        Compute(name: "append", dispatch: Groups(1, 1, 1)),
        Compute(name: "fresh", dispatch: Groups(1, 1, 1), bind: {"out": "fresh"}),
    ],
    outputs: ["list", "needed", "fresh"],
"#,
    )
    .with(
        "frame.wgsl",
        include_str!("../../../../shaders/shared/frame.wgsl"),
    )
    .with("fresh.wgsl", writes(FRAME, "frame.fresh"))
    .with(
        "append.wgsl",
        "struct Params { wanted: u32 }
         var<uniform> params: Params;
         var<storage, read_write> needed: u32;
         var<storage, read_write> list: array<u32>;
         @compute @workgroup_size(1) fn main() {
             for (var item = 0u; item < params.wanted; item++) {
                 if needed < arrayLength(&list) { list[needed] = 10u + needed; }
                 needed++;
             }
         }",
    );
    let mut executor = executor(&files, &request(&NoProvider));
    let mut expect = |list: &[u32], needed: u32, fresh: u32| {
        let report = frame(&mut executor, &["list", "needed", "fresh"]);
        assert_eq!(words(&report, 0), list);
        assert_eq!(
            [words(&report, 1)[0], words(&report, 2)[0]],
            [needed, fresh]
        );
    };
    expect(&[10, 11, 12, 0], 3, 1);
    // Items 4 and 5 find no room, and are lost; from then on there is.
    expect(&[10, 11, 12, 13], 6, 0);
    expect(&[10, 11, 12, 13, 0, 0, 16], 9, 0);
    expect(&[10, 11, 12, 13, 0, 0, 16, 0, 0, 19, 20], 12, 0);
    let mut list = vec![10, 11, 12, 13, 0, 0, 16, 0, 0, 19, 20, 0, 22, 23, 24];
    expect(&list, 15, 0);
    // Two larger buffers before the next frame: the second begins with what the first one held.
    set(&mut executor, "wanted", ParamValue::U32(0));
    for items in [40, 50] {
        let plan = executor.plan().with(|request| {
            request.grown.insert("list".to_owned(), items);
        });
        let report = executor.replace_graph(plan.unwrap(), &mut NoProvider);
        assert!(report.unwrap().resources.is_empty(), "nothing is lost");
    }
    list.resize(50, 0);
    assert_eq!(numbers(&mut executor, "list"), list);
}

/// The same of layers: a page is drawn in each frame, if there is room for it, and all are summed.
#[test]
fn growth_of_layers_copies_what_there_was() {
    let files = Files::graph(
        r#"
    materials: [
        Buffer(name: "needed", keep: true),
        Texture(name: "pages", format: R32Uint, size: 1, layers: 2, keep: true,
            grow: (counter: "needed", max: 16)),
        Buffer(name: "found", count: 2),
    ],
    passes: [
        Compute(name: "append", dispatch: Groups(1, 1, 1)),
        Compute(name: "sum", dispatch: Groups(1, 1, 1), overwrites: ["found"]),
    ],
    outputs: ["found"],
"#,
    )
    .with(
        "append.wgsl",
        "var<storage, read_write> needed: u32;
         var pages: texture_storage_2d_array<r32uint, write>;
         @compute @workgroup_size(1) fn main() {
             if needed < textureNumLayers(pages) {
                 textureStore(pages, vec2(0u), needed, vec4(100u + needed));
             }
             needed += 1u;
         }",
    )
    .with(
        "sum.wgsl",
        "var pages: texture_2d_array<u32>;
         var<storage, read_write> found: array<u32>;
         @compute @workgroup_size(1) fn main() {
             found[0] = 0u;
             found[1] = textureNumLayers(pages);
             for (var layer = 0u; layer < found[1]; layer++) {
                 found[0] += textureLoad(pages, vec2(0u), layer, 0).x;
             }
         }",
    );
    let mut executor = executor(&files, &request(&NoProvider));
    let (mut expected, mut most) = (0, 0);
    for page in 0..12 {
        let report = frame(&mut executor, &["found"]);
        let layers = words(&report, 0)[1];
        if page < layers {
            expected += 100 + page;
        }
        assert_eq!(words(&report, 0)[0], expected, "page {page} of {layers}");
        most = most.max(layers);
    }
    assert!(most > 8, "{most} layers");
}
