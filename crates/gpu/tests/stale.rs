//! Cases where a frame could find something stale: what ran for another plan, what the host changed
//! in between.

#[path = "support/host.rs"]
mod host;
#[path = "../../graph/tests/support/mod.rs"]
mod support;

use skiagraph_graph::{
    Capture, Executor, Frame, FrameReport, Import, NoProvider, ParamValue, Provided, Provider,
    ProviderError,
};
use support::{
    Files,
    host::{GPU, encoder, executor, frame, numbers, planned, request},
};

/// A compute shader of one invocation.
fn shader(globals: &str, body: &str) -> String {
    format!("{globals} @compute @workgroup_size(1) fn main() {{ {body} }}")
}

const OUT: &str = "var<storage, read_write> out: array<u32>;";
const INPUT: &str = "var<storage, read> input: array<u32>;";

fn compute(name: &str, more: &str, bind: &str) -> String {
    format!("Compute(name: \"{name}\", dispatch: Groups(1, 1, 1), {more} bind: {{{bind}}}),")
}

fn document(params: &str, buffers: &[&str], passes: &[String], outputs: &[&str]) -> Files {
    let buffers: String = buffers
        .iter()
        .map(|name| format!("Buffer(name: \"{name}\", count: 1),"))
        .collect();
    let outputs: String = outputs
        .iter()
        .map(|name| format!("(name: \"{name}\"),"))
        .collect();
    let text = format!(
        "(format: 2, params: [{params}], materials: [{buffers}], passes: [{}], outputs: \
         [{outputs}])",
        passes.concat()
    );
    Files::new([]).with("graph.ron", text)
}

fn set(executor: &mut Executor, name: &str, value: ParamValue) {
    executor
        .set_param(name, value, &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"));
}

fn first(report: &FrameReport, index: usize) -> u32 {
    report.readbacks[index].content.as_u32().expect("numbers")[0]
}

/// ```text
/// start ─▶ sum ⟲ add[0..times]      all OnChange
/// ```
/// With fewer repeats the same passes are left, each as it was, but what the last ones added must
/// go.
#[test]
fn fewer_repeats_take_back_what_the_last_ones_added() {
    let add = compute(
        "add",
        "run: OnChange, repeat: \"times\",",
        "\"out\": \"sum\"",
    );
    let files = document(
        "U32(name: \"times\", default: 3, min: 1)",
        &["sum"],
        &[
            "Clear(name: \"start\", run: OnChange, target: \"sum\"),".to_owned(),
            add,
        ],
        &["sum"],
    )
    .with("add.wgsl", shader(OUT, "out[0] = out[0] + 1u;"));
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

impl Provider for Updated {
    fn names(&self) -> Vec<String> {
        vec!["host.value".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        (name == "host.value").then_some(Provided {
            items: Some(self.items),
            stride: 4,
            uniform: false,
        })
    }

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

/// What the provider changed in place is seen also if a change of the plan is what asks for it.
#[test]
fn a_change_in_place_is_seen_through_a_change_of_the_plan() {
    let files = document(
        "U32(name: \"other\", default: 0)",
        &["seen"],
        &[compute(
            "take",
            "run: OnChange,",
            "\"input\": \"host.value\", \"out\": \"seen\"",
        )],
        &["seen"],
    )
    .with(
        "take.wgsl",
        shader(&format!("{INPUT}{OUT}"), "out[0] = input[0];"),
    );
    let mut provider = Updated {
        buffer: buffer(1),
        value: 1,
        items: 1,
    };
    let plan = planned(&files, &request(&provider));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider)
        .unwrap_or_else(|error| panic!("{error}"));
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

/// The plan counts items; a provider that has others now cannot simply be refreshed.
#[test]
fn provided_items_that_the_plan_did_not_count_are_refused() {
    let files = document(
        "",
        &["seen"],
        &[
            "Compute(name: \"take\", dispatch: Over(\"host.value\"), bind: {\"input\": \
            \"host.value\", \"out\": \"seen\"}),"
                .to_owned(),
        ],
        &["seen"],
    )
    .with(
        "take.wgsl",
        shader(&format!("{INPUT}{OUT}"), "out[0] = arrayLength(&input);"),
    );
    let mut provider = Updated {
        buffer: buffer(1),
        value: 1,
        items: 1,
    };
    let plan = planned(&files, &request(&provider));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(numbers(&mut executor, "seen"), [1]);
    (provider.buffer, provider.items, provider.value) = (buffer(3), 3, 2);
    let refused = executor.refresh(&mut provider);
    assert!(refused.is_err(), "the plan dispatches over one item");
    // As it was, and with a plan that knows it is right again.
    assert_eq!(numbers(&mut executor, "seen"), [1]);
    let plan = planned(&files, &request(&provider));
    executor
        .replace_graph(plan, &mut provider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(numbers(&mut executor, "seen"), [3]);
}

/// An import is handed over once; a plan that does not use it for a while does not forget it.
#[test]
fn an_import_outlives_a_plan_that_does_not_use_it() {
    let files = document(
        "U32(name: \"times\", default: 0)",
        &["seen"],
        &[
            "Clear(name: \"start\", target: \"seen\"),".to_owned(),
            compute("make", "", "\"out\": \"seen\""),
            compute(
                "take",
                "repeat: \"times\",",
                "\"input\": \"given\", \"out\": \"seen\"",
            ),
        ],
        &["seen"],
    )
    .with(
        "take.wgsl",
        shader(&format!("{INPUT}{OUT}"), "out[0] = input[0];"),
    );
    let files = files.with("make.wgsl", shader(OUT, "out[0] = 0u;"));
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
        "U32(name: \"seed\", default: 1), Bool(name: \"on\", default: false)",
        &["m", "o", "p"],
        &[
            compute("make", "", "\"out\": \"m\""),
            compute("once", "run: Once, shader: \"make\",", "\"out\": \"o\""),
            compute(
                "when",
                "run: When(\"on\"), shader: \"make\",",
                "\"out\": \"p\"",
            ),
        ],
        &["m", "o", "p"],
    )
    .with(
        "make.wgsl",
        shader(
            &format!("struct Params {{ seed: u32 }} var<uniform> params: Params; {OUT}"),
            "out[0] = params.seed;",
        ),
    );
    let mut wanted = request(&NoProvider);
    for pass in ["once", "when"] {
        wanted.captures.push(Capture {
            material: "m".to_owned(),
            after: Some(pass.to_owned()),
        });
    }
    let mut executor = executor(&files, &wanted);
    for seed in 1..4 {
        set(&mut executor, "seed", ParamValue::U32(seed));
        let report = frame(&mut executor, &["m", "m@once", "m@when", "o"]);
        let all = [0, 1, 2, 3].map(|index| first(&report, index));
        assert_eq!(all, [seed, seed, seed, 1], "{:?}", report.skipped);
    }
}

/// Reading one mip while a pass below writes another is no reason to run again.
#[test]
fn another_part_written_below_is_no_change() {
    let files = Files::new([])
        .with(
            "graph.ron",
            "(format: 2, materials: [
            Texture(name: \"t\", format: R32Uint, size: (2, 2), mips: 2, views: [(name: \
                \"t0\", mip: 0, mips: 1), (name: \"t1\", mip: 1, mips: 1)]),
            Buffer(name: \"seen\", count: 1)],
          passes: [
            Clear(name: \"zero\", run: Once, target: \"t0\", value: (3, 0, 0, 0)),
            Compute(name: \"take\", run: OnChange, dispatch: Groups(1, 1, 1), bind: {\"input\": \
                \"t0\", \"out\": \"seen\"}),
            Clear(name: \"one\", run: Once, target: \"t1\"),
          ], outputs: [\"seen\", \"t1\"])",
        )
        .with(
            "take.wgsl",
            shader(
                &format!("var input: texture_2d<u32>; {OUT}"),
                "out[0] = \
        textureLoad(input, vec2(0u), 0).x;",
            ),
        );
    let mut executor = executor(&files, &request(&NoProvider));
    assert_eq!(frame(&mut executor, &["seen"]).skipped, [""; 0]);
    assert_eq!(
        frame(&mut executor, &["seen"]).skipped,
        ["zero", "take", "one"]
    );
}

/// What runs once does not run again because something that it does not touch comes or goes.
#[test]
fn once_stays_once_when_other_materials_come_and_go() {
    let files = document(
        "U32(name: \"times\", default: 1)",
        &["seen"],
        &[
            "Include(graph: \"inner.ron\", prefix: \"i\", repeat: \"times\"),".to_owned(),
            compute(
                "take",
                "run: Once,",
                "\"input\": \"host.value\", \"out\": \"seen\"",
            ),
        ],
        &["seen"],
    )
    .with(
        "inner.ron",
        "(format: 2, materials: [Buffer(name: \"b\", count: 1)], passes: \
        [Clear(name: \"c\", target: \"b\"), Compute(name: \"d\", dispatch: Groups(1, 1, 1), bind: \
        {\"out\": \"b\"})], outputs: [\"b\"])",
    )
    .with("d.wgsl", shader(OUT, "out[0] = 1u;"))
    .with(
        "take.wgsl",
        shader(&format!("{INPUT}{OUT}"), "out[0] = input[0];"),
    );
    let mut provider = Updated {
        buffer: buffer(1),
        value: 1,
        items: 1,
    };
    let plan = planned(&files, &request(&provider));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(frame(&mut executor, &[]).skipped, [""; 0]);
    executor
        .set_param("times", ParamValue::U32(2), &mut provider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(frame(&mut executor, &[]).skipped, ["take"]);
}

/// One param is one condition, in a group of an included document as outside of it.
#[test]
fn a_condition_is_the_same_in_a_group() {
    let inner = "(format: 2, params: [Bool(name: \"on\", default: true)], materials: \
        [Buffer(name: \"b\", count: 1)],
        passes: [Clear(name: \"c\", run: When(\"on\"), target: \"b\"),
                 Group(name: \"g\", passes: [Compute(name: \"d\", run: When(\"on\"), dispatch: \
                     Groups(1, 1, 1), bind: {\"out\": \"b\"})])],
        outputs: [\"b\"])";
    let files = Files::new([])
        .with(
            "graph.ron",
            "(format: 2, passes: [Include(graph: \"inner.ron\", prefix: \"i\")], \
            outputs: [(name: \"o\", material: \"i.b\")])",
        )
        .with("inner.ron", inner)
        .with("d.wgsl", shader(OUT, "out[0] = 1u;"));
    let mut executor = executor(&files, &request(&NoProvider));
    assert_eq!(numbers(&mut executor, "o"), [1]);
}

/// Two params of one name, of two documents, are two conditions.
#[test]
fn params_of_two_documents_are_two_conditions() {
    let inner = "(format: 2, params: [Bool(name: \"on\", default: true)], materials: \
        [Buffer(name: \"b\", count: 1)],
        passes: [Clear(name: \"c\", run: When(\"on\"), target: \"b\")], outputs: [\"b\"])";
    let files = Files::new([])
        .with(
            "graph.ron",
            "(format: 2, params: [Bool(name: \"on\", default: false)],
            passes: [Include(graph: \"inner.ron\"), Compute(name: \"d\", run: When(\"on\"), \
                dispatch: Groups(1, 1, 1), bind: {\"out\": \"b\"})],
            outputs: [\"b\"])",
        )
        .with("inner.ron", inner)
        .with("d.wgsl", shader(OUT, "out[0] = out[0] + 1u;"));
    let errors = support::plan(&files).expect_err("one runs, the other does not");
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
    let files = document("", &["n"], &[compute("make", "", "\"out\": \"n\"")], &["n"])
        .with("make.wgsl", shader(OUT, "out[0] = 5u;"));
    let mut executor = executor(&files, &request(&NoProvider));
    executor.finish().unwrap_or_else(|error| panic!("{error}"));
    executor
        .submitted()
        .unwrap_or_else(|error| panic!("{error}"));
    let read = ["n"];
    for timing in [false, true] {
        let wanted = Frame {
            timing,
            read: &read,
            ..Frame::default()
        };
        let mut commands = encoder();
        executor
            .encode(&mut commands, &wanted)
            .unwrap_or_else(|error| panic!("{error}"));
        // Not submitted yet: there is nothing to read, which is an error and no panic.
        assert!(executor.finish().is_err());
        GPU.queue.submit([commands.finish()]);
        let mut commands = encoder();
        executor
            .encode(&mut commands, &wanted)
            .unwrap_or_else(|error| panic!("{error}"));
        executor
            .encode(&mut commands, &wanted)
            .unwrap_or_else(|error| panic!("{error}"));
        GPU.queue.submit([commands.finish()]);
        executor
            .submitted()
            .unwrap_or_else(|error| panic!("{error}"));
        executor
            .submitted()
            .unwrap_or_else(|error| panic!("{error}"));
        let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(first(&report, 0), 5);
        assert_eq!(report.timing.is_some(), timing);
        let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
        assert!(report.readbacks.is_empty());
    }
    assert_eq!(numbers(&mut executor, "n"), [5]);
}

/// What a pass leaves unwritten of a material with a history is not last frame's: the pattern shows
/// it.
#[test]
fn poison_shows_what_a_write_leaves_of_a_material_with_a_history() {
    let files = Files::new([])
        .with(
            "graph.ron",
            "(format: 2, materials: [Buffer(name: \"x\", count: 2), Buffer(name: \"y\", count: 1)],
          passes: [
            Compute(name: \"make\", dispatch: Groups(1, 1, 1), bind: {\"out\": \"x\"}),
            Compute(name: \"take\", dispatch: Groups(1, 1, 1), bind: {\"input\": \"x.previous\", \
                \"out\": \"y\"}),
          ], outputs: [\"x\", \"y\"])",
        )
        .with("make.wgsl", shader(OUT, "out[0] = 5u;"))
        .with(
            "take.wgsl",
            shader(&format!("{INPUT}{OUT}"), "out[0] = input[0];"),
        );
    let mut wanted = request(&NoProvider);
    wanted.poison = Some(0x11);
    let mut executor = executor(&files, &wanted);
    for before in [0, 5, 5] {
        let report = frame(&mut executor, &["x", "y"]);
        assert_eq!(
            report.readbacks[0].content.as_u32(),
            Some(vec![5, 0x1111_1111])
        );
        assert_eq!(first(&report, 1), before);
    }
}
