//! Cases where a frame could find something stale: what ran for another plan, what the host changed
//! in between.

use crate::buffers::{INPUT, SEED, SEED_PARAM, compute, document, writes};
use crate::host::{GPU, encoder, executor, frame, numbers, planned, request, set, words};
use crate::support::{self, Files, wrong};
use skiagraph_gpu::{Executor, Frame, Provider, ProviderError, import};
use skiagraph_graph::{Capture, Describe, NoProvider, ParamValue, Provided, ProvidedBinding};
use std::time::Duration;

/// ```text
/// start ─▶ sum ⟲ add[0..times]      all OnChange
/// ```
/// With fewer repeats the same passes are left, each as it was, but what the last ones added must
/// go.
#[test]
fn fewer_repeats_take_back_what_the_last_ones_added() {
    let add = compute(
        "add",
        r#"run: OnChange, repeat: "times","#,
        r#""out": "sum""#,
    );
    let start = r#"Clear(name: "start", run: OnChange, target: "sum"),"#;
    let files = document(
        r#"U32(name: "times", default: 3, min: 1)"#,
        &["sum"],
        &[start.to_owned(), add],
        &["sum"],
    )
    .with("add.wgsl", writes("", "out[0] + 1u"));
    let mut executor = executor(&files, &request(&NoProvider));
    for times in [3, 2, 2, 4, 1] {
        set(&mut executor, "times", ParamValue::U32(times));
        assert_eq!(numbers(&mut executor, "sum"), [times]);
    }
}

/// A provider of one number that keeps its buffer and writes the new one into it.
struct Updated {
    buffer: wgpu::Buffer,
    value: u64,
    items: u64,
}

impl Describe for Updated {
    fn names(&self) -> Vec<String> {
        vec!["host.value".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        (name == "host.value").then_some(Provided::new(
            ProvidedBinding::Storage,
            Some(self.items),
            4,
        ))
    }
}

impl Provider for Updated {
    fn version(&self, _: &str) -> u64 {
        self.value
    }

    fn build(
        &mut self,
        _: &str,
        _: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        queue.write_buffer(&self.buffer, 0, &(self.value as u32).to_le_bytes());
        Ok(self.buffer.clone())
    }
}

fn buffer(items: u64) -> wgpu::Buffer {
    GPU.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4 * items,
        usage: wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

/// A provider of one number.
fn one() -> Updated {
    Updated {
        buffer: buffer(1),
        value: 1,
        items: 1,
    }
}

/// An executor whose provider is that one.
fn provided(files: &Files, provider: &mut Updated) -> Executor {
    let plan = planned(files, &request(provider));
    Executor::new(&GPU.device, &GPU.queue, plan, provider).unwrap_or_else(|error| panic!("{error}"))
}

/// A change in place by the provider is seen even if it arrives with a change of the plan.
#[test]
fn a_change_in_place_is_seen_through_a_change_of_the_plan() {
    let take = compute(
        "take",
        "run: OnChange,",
        r#""input": "host.value", "out": "seen""#,
    );
    let files = document(
        r#"U32(name: "other", default: 0)"#,
        &["seen"],
        &[take],
        &["seen"],
    )
    .with("take.wgsl", writes(INPUT, "input[0]"));
    let mut provider = one();
    let mut executor = provided(&files, &mut provider);
    assert_eq!(numbers(&mut executor, "seen"), [1]);
    provider.value = 2;
    executor
        .set_param("other", ParamValue::U32(1), &mut provider)
        .unwrap_or_else(|error| panic!("{error}"));
    executor
        .refresh(&mut provider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(numbers(&mut executor, "seen"), [2]);
}

/// The plan counts items, for which a refresh plans anew.
#[test]
fn provided_items_that_the_plan_did_not_count_are_counted_by_a_refresh() {
    let take = r#"Compute(
        name: "take",
        dispatch: Over("host.value.count"),
        bind: {"input": "host.value", "out": "seen"},
    ),"#;
    let files = document("", &["seen"], &[take.to_owned()], &["seen"])
        .with("take.wgsl", writes(INPUT, "arrayLength(&input)"));
    let mut provider = one();
    let mut executor = provided(&files, &mut provider);
    assert_eq!(numbers(&mut executor, "seen"), [1]);
    (provider.buffer, provider.items, provider.value) = (buffer(3), 3, 2);
    executor
        .refresh(&mut provider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(numbers(&mut executor, "seen"), [3]);
}

/// An import is handed over once; a plan that does not use it for a while does not forget it.
#[test]
fn an_import_outlives_a_plan_that_does_not_use_it() {
    let files = document(
        r#"U32(name: "times", default: 0)"#,
        &["seen"],
        &[
            r#"Clear(name: "start", target: "seen"),"#.to_owned(),
            compute("make", "", r#""out": "seen""#),
            compute(
                "take",
                r#"repeat: "times","#,
                r#""input": "given", "out": "seen""#,
            ),
        ],
        &["seen"],
    )
    .edited(
        "graph.ron",
        "params:",
        r#"inputs: [Buffer(name: "given")], params:"#,
    )
    .with("take.wgsl", writes(INPUT, "input[0]"))
    .with("make.wgsl", writes("", "0u"));
    let given = buffer(1);
    GPU.queue.write_buffer(&given, 0, &7u32.to_le_bytes());
    let mut wanted = request(&NoProvider);
    wanted
        .imports
        .insert("given".to_owned(), import::buffer(&given, Some(1)));
    let mut executor = executor(&files, &wanted);
    executor
        .import_buffer("given", &given)
        .unwrap_or_else(|error| panic!("{error}"));
    for (times, seen) in [(0, 0), (1, 7), (0, 0), (1, 7)] {
        set(&mut executor, "times", ParamValue::U32(times));
        assert_eq!(numbers(&mut executor, "seen"), [seen]);
    }
}

/// ```text
/// seed ─▶ make (Always) ─▶ m ;  once (Once) ─▶ o
/// ```
/// `m@once` is `m` at that place of the frame, whether or not `once` runs.
#[test]
fn a_capture_after_a_skipped_pass_is_of_this_frame() {
    let files = document(
        &format!(r#"{SEED_PARAM} Bool(name: "on", default: false)"#),
        &["m", "o", "p"],
        &[
            compute("make", "", r#""out": "m""#),
            compute("once", r#"run: Once, shader: "make","#, r#""out": "o""#),
            compute(
                "when",
                r#"run: When("on"), shader: "make","#,
                r#""out": "p""#,
            ),
        ],
        &["m", "o", "p"],
    )
    .with("make.wgsl", writes(SEED, "params.seed"));
    let mut wanted = request(&NoProvider);
    for pass in ["once", "when"] {
        wanted.captures.push(Capture::new("m").with_after(pass));
    }
    let mut executor = executor(&files, &wanted);
    for seed in 1..4 {
        set(&mut executor, "seed", ParamValue::U32(seed));
        let report = frame(&mut executor, &["m", "m@once", "m@when", "o"]);
        let values = [0, 1, 2, 3].map(|index| words(&report, index)[0]);
        assert_eq!(values, [seed, seed, seed, 1], "{:?}", report.skipped);
    }
}

/// Reading one mip while a pass below writes another is no reason to run again.
#[test]
fn another_part_written_below_is_no_change() {
    let files = Files::graph(
        r#"
    materials: [
        Texture(name: "t", format: R32Uint, size: 2, mips: 2),
        Buffer(name: "seen", count: 1),
    ],
    passes: [
        Clear(name: "zero", run: Once, target: "t.mip[0]", value: (3, 0, 0, 0)),
        Compute(
            name: "take",
            run: OnChange,
            dispatch: Groups(1, 1, 1),
            bind: {"input": "t.mip[0]", "out": "seen"},
        ),
        Clear(name: "one", run: Once, target: "t.mip[1]"),
    ],
    outputs: ["seen", (name: "coarse", material: "t.mip[1]")],
"#,
    )
    .with(
        "take.wgsl",
        writes(
            "var input: texture_2d<u32>;",
            "textureLoad(input, vec2(0u), 0).x",
        ),
    );
    let mut executor = executor(&files, &request(&NoProvider));
    assert_eq!(frame(&mut executor, &["seen"]).skipped, [""; 0]);
    assert_eq!(
        frame(&mut executor, &["seen"]).skipped,
        ["zero", "take", "one"]
    );
}

/// A pass that runs once does not run again because something that it does not touch comes or goes.
#[test]
fn once_stays_once_when_other_materials_come_and_go() {
    let inner = r#"
    materials: [Buffer(name: "b", count: 1)],
    passes: [
        Clear(name: "c", target: "b"),
        Compute(name: "d", dispatch: Groups(1, 1, 1), bind: {"out": "b"}),
    ],
    outputs: ["b"],
"#;
    let files = document(
        r#"U32(name: "times", default: 1)"#,
        &["seen"],
        &[
            r#"Include(graph: "inner.ron", name: "i", repeat: "times"),"#.to_owned(),
            compute(
                "take",
                "run: Once,",
                r#""input": "host.value", "out": "seen""#,
            ),
        ],
        &["seen"],
    )
    .document("inner.ron", inner)
    .with("d.wgsl", writes("", "1u"))
    .with("take.wgsl", writes(INPUT, "input[0]"));
    let mut provider = one();
    let mut executor = provided(&files, &mut provider);
    assert_eq!(frame(&mut executor, &[]).skipped, [""; 0]);
    executor
        .set_param("times", ParamValue::U32(2), &mut provider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(frame(&mut executor, &[]).skipped, ["take"]);
}

/// One param is one condition, in a group of an included document as outside of it.
#[test]
fn a_condition_is_the_same_in_a_group() {
    let inner = r#"
    params: [Bool(name: "on", default: true)],
    materials: [Buffer(name: "b", count: 1)],
    passes: [
        Clear(name: "c", run: When("on"), target: "b"),
        Group(name: "g", passes: [
            Compute(name: "d", run: When("on"), dispatch: Groups(1, 1, 1), bind: {"out": "b"}),
        ]),
    ],
    outputs: ["b"],
"#;
    let files = Files::graph(
        r#"
    passes: [Include(graph: "inner.ron", name: "i")],
    outputs: [(name: "o", material: "i.b")],
"#,
    )
    .document("inner.ron", inner)
    .with("d.wgsl", writes("", "1u"));
    let mut executor = executor(&files, &request(&NoProvider));
    assert_eq!(numbers(&mut executor, "o"), [1]);
}

/// The same words are another condition in each repetition.
#[test]
fn a_condition_over_the_index_is_one_for_each_repetition() {
    let files = Files::graph(
        r#"
    params: [U32(name: "chosen", default: 0)],
    materials: [Buffer(name: "b", count: 1)],
    passes: [
        Compute(
            name: "d",
            repeat: 2,
            run: When("index == chosen"),
            dispatch: Groups(1, 1, 1),
            bind: {"out": "b"},
        ),
    ],
    outputs: ["b"],
"#,
    )
    .with("d.wgsl", writes("", "1u"));
    let errors = wrong(support::plan(&files));
    assert!(
        errors
            .to_string()
            .contains("must run or be skipped together"),
        "{errors}"
    );
}

/// Two params of one name, of two documents, are two conditions.
#[test]
fn params_of_two_documents_are_two_conditions() {
    let inner = r#"
    params: [Bool(name: "on", default: true)],
    materials: [Buffer(name: "b", count: 1)],
    passes: [Clear(name: "c", run: When("on"), target: "b")],
    outputs: ["b"],
"#;
    let files = Files::graph(
        r#"
    params: [Bool(name: "on", default: false)],
    passes: [
        Include(graph: "inner.ron"),
        Compute(name: "d", run: When("on"), dispatch: Groups(1, 1, 1), bind: {"out": "b"}),
    ],
    outputs: ["b"],
"#,
    )
    .document("inner.ron", inner)
    .with("d.wgsl", writes("", "out[0] + 1u"));
    let errors = wrong(support::plan(&files));
    assert!(
        errors
            .to_string()
            .contains("must run or be skipped together"),
        "{errors}"
    );
}

/// Out of turn, but harmless: nothing to wait for, the same frame twice, two frames before one
/// submission.
#[test]
fn calls_out_of_turn_are_no_panics() {
    let files = document("", &["n"], &[compute("make", "", r#""out": "n""#)], &["n"])
        .with("make.wgsl", writes("", "5u"));
    let mut executor = executor(&files, &request(&NoProvider));
    executor.finish().unwrap_or_else(|error| panic!("{error}"));
    let read = ["n"];
    for timing in [false, true] {
        let wanted = Frame::new().with_timing(timing).with_read(&read);
        let mut commands = encoder();
        executor
            .encode(&mut commands, &wanted)
            .unwrap_or_else(|error| panic!("{error}"));
        // Not submitted yet: there is nothing to read, which is an error and no panic.
        assert!(executor.finish_within(Some(Duration::ZERO)).is_err());
        GPU.queue.submit([commands.finish()]);
        let mut commands = encoder();
        executor
            .encode(&mut commands, &wanted)
            .unwrap_or_else(|error| panic!("{error}"));
        executor
            .encode(&mut commands, &wanted)
            .unwrap_or_else(|error| panic!("{error}"));
        GPU.queue.submit([commands.finish()]);
        for _ in 0..3 {
            let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(words(&report, 0)[0], 5);
            assert_eq!(report.timing.is_some(), timing);
        }
        let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
        assert!(report.readbacks.is_empty());
    }
    assert_eq!(numbers(&mut executor, "n"), [5]);
}

/// Texels that a pass leaves unwritten in a material with a history are not last frame's: the
/// pattern shows it.
#[test]
fn poison_shows_what_a_write_leaves_of_a_material_with_a_history() {
    let files = document(
        "",
        &["y"],
        &[
            compute("make", "", r#""out": "x""#),
            compute("take", "", r#""input": "x.previous", "out": "y""#),
        ],
        &["x", "y"],
    )
    .edited(
        "graph.ron",
        "materials: [",
        r#"materials: [Buffer(name: "x", count: 2), "#,
    )
    .with("make.wgsl", writes("", "5u"))
    .with("take.wgsl", writes(INPUT, "input[0]"));
    let mut wanted = request(&NoProvider);
    wanted.poison = Some(0x11);
    let mut executor = executor(&files, &wanted);
    for before in [0, 5, 5] {
        let report = frame(&mut executor, &["x", "y"]);
        assert_eq!(
            report.readbacks[0].content.as_u32(),
            Some(vec![5, 0x1111_1111])
        );
        assert_eq!(words(&report, 1)[0], before);
    }
}
