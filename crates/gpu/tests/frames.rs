//! What passes find from frame to frame: last frame's versions, skipped passes, shared memory.

#[path = "support/host.rs"]
mod host;
#[path = "../../graph/tests/support/mod.rs"]
mod support;

use proptest::prelude::*;
use skiagraph_graph::{
    Executor, Frame, FrameReport, Import, NoProvider, ParamValue, PlanRequest, gpu,
};
use std::{collections::BTreeMap, fmt::Write as _, sync::LazyLock};
use support::{Files, load};

static GPU: LazyLock<device::Gpu> =
    LazyLock::new(|| device::open(None).unwrap_or_else(|error| panic!("{error}")));

fn request() -> PlanRequest<'static> {
    let mut request = PlanRequest::new([8, 8], &NoProvider);
    request.limits = GPU.device.limits();
    request.features = GPU.device.features();
    request
}

fn executor_for(files: &Files, request: &PlanRequest<'_>) -> Executor {
    let graph = load(files).unwrap_or_else(|errors| panic!("{errors}"));
    let plan = graph
        .plan(request)
        .unwrap_or_else(|errors| panic!("{errors}"));
    Executor::new(&GPU.device, &GPU.queue, plan, &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn executor(files: &Files) -> Executor {
    executor_for(files, &request())
}

fn frame(executor: &mut Executor, all: bool, read: &[&str]) -> FrameReport {
    let mut encoder = GPU
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let frame = Frame {
        timing: false,
        all,
        read,
    };
    executor
        .encode(&mut encoder, &frame)
        .unwrap_or_else(|error| panic!("{error}"));
    GPU.queue.submit([encoder.finish()]);
    executor
        .submitted()
        .unwrap_or_else(|error| panic!("{error}"));
    executor.finish().unwrap_or_else(|error| panic!("{error}"))
}

/// The first number of an output after a frame.
fn number(executor: &mut Executor, output: &str) -> u32 {
    let report = frame(executor, false, &[output]);
    report.readbacks[0]
        .content
        .as_u32()
        .expect("it holds numbers")[0]
}

fn set(executor: &mut Executor, name: &str, value: ParamValue) {
    executor
        .set_param(name, value, &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"));
}

/// A shader that writes `value` to `out` by one invocation.
fn writes(globals: &str, value: &str) -> String {
    format!(
        "{globals} var<storage, read_write> out: array<u32>;
         @compute @workgroup_size(1) fn main() {{ out[0] = {value}; }}"
    )
}

const OLD: &str = "var<storage, read> old: array<u32>;";
const INPUT: &str = "var<storage, read> input: array<u32>;";
const SEED: &str = "struct Params { seed: u32 } var<uniform> params: Params;";

fn document(params: &str, materials: &[&str], passes: &[&str], outputs: &[&str]) -> Files {
    let buffers = materials.iter().fold(String::new(), |mut text, name| {
        // Writing to a String cannot fail.
        let _ = write!(text, "Buffer(name: \"{name}\", count: 1),");
        text
    });
    let outputs: Vec<String> = outputs
        .iter()
        .map(|name| format!("(name: \"{name}\")"))
        .collect();
    Files::new([]).with(
        "graph.ron",
        format!(
            "(format: 2, params: [{params}], materials: [{buffers}], passes: [{}], outputs: [{}])",
            passes.join(","),
            outputs.join(",")
        ),
    )
}

const SEED_PARAM: &str = "U32(name: \"seed\", default: 5)";

/// ```text
/// Previous(total) ─▶ count ─▶ total
/// ```
#[test]
fn a_sum_over_frames_starts_from_zero() {
    let files = document(
        "",
        &["total"],
        &[
            "Compute(name: \"count\", dispatch: Groups(1, 1, 1), bind: {\"old\": \
            \"total.previous\", \"out\": \"total\"})",
        ],
        &["total"],
    )
    .with("count.wgsl", writes(OLD, "old[0] + 1u"));
    let mut executor = executor(&files);
    let counted: Vec<u32> = (0..5).map(|_| number(&mut executor, "total")).collect();
    assert_eq!(counted, [1, 2, 3, 4, 5]);
    // The buffer does not follow the viewport: it is kept.
    executor
        .resize([16, 16], &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(number(&mut executor, "total"), 6);
}

/// The same on a texture of the viewport's size, through a copy: after a resize it is zero again.
#[test]
fn last_frame_is_zero_after_a_resize() {
    let files = Files::new([]).with(
        "graph.ron",
        "(format: 2, materials: [Texture(name: \"age\", format: R32Uint), \
         Texture(name: \"was\", format: R32Uint)],
          passes: [Copy(name: \"keep\", from: \"age.previous\", to: \"was\"), Fullscreen(name: \
              \"grow\", color: [\"age\"])],
          outputs: [\"age\"])",
    ).with(
        "grow.wgsl",
        "var was: texture_2d<u32>;
         @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 { return textureLoad(was, vec2<u32>(at.xy), 0).x + 2u; }",
    );
    let mut executor = executor(&files);
    assert_eq!([0; 3].map(|_| number(&mut executor, "age")), [2, 4, 6]);
    let report = executor
        .resize([4, 2], &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(report.resources, ["age", "was"]);
    assert!(report.pipelines.is_empty());
    assert_eq!([0; 3].map(|_| number(&mut executor, "age")), [2, 4, 6]);
    assert_eq!(executor.plan().outputs()[0].size, [4, 2]);
}

/// ```text
/// seed ─▶ make ─▶ a ─▶ use ─▶ b ;  Previous(b) ─▶ watch ─▶ c
/// ```
/// What nobody wrote in a frame is still what it was at the end of the frame before.
#[test]
fn a_version_that_was_not_written_stays_the_last_one() {
    let files = document(
        &format!("{SEED_PARAM}, Bool(name: \"on\", default: true)"),
        &["b", "c"],
        &[
            "Compute(name: \"make\", dispatch: Groups(1, 1, 1), run: When(\"on\"), bind: \
             {\"out\": \"b\"})",
            "Compute(name: \"watch\", dispatch: Groups(1, 1, 1), bind: {\"old\": \"b.previous\", \
             \"out\": \"c\"})",
        ],
        &["b", "c"],
    )
    .with("make.wgsl", writes(SEED, "params.seed"))
    .with("watch.wgsl", writes(OLD, "old[0]"));
    let mut executor = executor(&files);
    let both = |executor: &mut Executor| {
        let report = frame(executor, false, &["b", "c"]);
        let first = |index: usize| report.readbacks[index].content.as_u32().map(|all| all[0]);
        (first(0), first(1), report.skipped)
    };
    let skipped = vec!["make".to_owned()];
    assert_eq!(both(&mut executor), (Some(5), Some(0), vec![]));
    set(&mut executor, "seed", ParamValue::U32(6));
    assert_eq!(both(&mut executor), (Some(6), Some(5), vec![]));
    set(&mut executor, "on", ParamValue::Bool(false));
    set(&mut executor, "seed", ParamValue::U32(7));
    assert_eq!(both(&mut executor), (Some(6), Some(6), skipped.clone()));
    assert_eq!(both(&mut executor), (Some(6), Some(6), skipped));
    set(&mut executor, "on", ParamValue::Bool(true));
    assert_eq!(both(&mut executor), (Some(7), Some(6), vec![]));
    assert_eq!(both(&mut executor), (Some(7), Some(7), vec![]));
}

/// ```text
/// seed ─▶ first (Once) ─▶ a ─┐
/// seed ─▶ second ────────▶ b ┴▶ third ─▶ c ─▶ fourth (Always) ─▶ d ;  host ─▶ fifth ─▶ e
/// ```
/// second, third, fifth run `OnChange`.
#[test]
fn what_did_not_change_is_not_made_again() {
    let files = document(
        &format!("{SEED_PARAM}, U32(name: \"other\", default: 1)"),
        &["a", "b", "c", "d", "e"],
        &[
            "Compute(name: \"first\", dispatch: Groups(1, 1, 1), run: Once, bind: {\"out\": \
             \"a\"})",
            "Compute(name: \"second\", dispatch: Groups(1, 1, 1), run: OnChange, bind: {\"out\": \
             \"b\"})",
            "Compute(name: \"third\", dispatch: Groups(1, 1, 1), run: OnChange, bind: {\"input\": \
             \"a\", \"more\": \"b\", \"out\": \"c\"})",
            "Compute(name: \"fourth\", shader: \"pass_on\", dispatch: Groups(1, 1, 1), bind: \
             {\"input\": \"c\", \"out\": \"d\"})",
            "Compute(name: \"fifth\", shader: \"pass_on\", dispatch: Groups(1, 1, 1), run: \
             OnChange, bind: {\"input\": \"host\", \"out\": \"e\"})",
        ],
        &["d", "e"],
    )
    .with("first.wgsl", writes(SEED, "params.seed"))
    .with("second.wgsl", writes(SEED, "params.seed * 10u"))
    .with(
        "third.wgsl",
        writes(
            &format!("{INPUT} var<storage, read> more: array<u32>;"),
            "input[0] + more[0]",
        ),
    )
    .with("pass_on.wgsl", writes(INPUT, "input[0]"));
    let host = GPU.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    GPU.queue.write_buffer(&host, 0, &9u32.to_le_bytes());
    let mut request = request();
    request
        .imports
        .insert("host".to_owned(), import::buffer(&host, Some(1)));
    let mut executor = executor_for(&files, &request);
    executor
        .import_buffer("host", &host)
        .unwrap_or_else(|error| panic!("{error}"));
    let step =
        |executor: &mut Executor, all: bool, what: &str, values: [u32; 2], skipped: &[&str]| {
            let report = frame(executor, all, &["d", "e"]);
            let numbers: Vec<u32> = report
                .readbacks
                .iter()
                .map(|readback| readback.content.as_u32().expect("numbers")[0])
                .collect();
            assert_eq!(numbers, values, "{what}");
            assert_eq!(report.skipped, skipped, "{what}");
        };
    let cached = ["first", "second", "third", "fifth"];
    step(&mut executor, false, "the first frame", [55, 9], &[]);
    step(&mut executor, false, "nothing changed", [55, 9], &cached);
    step(&mut executor, true, "everything is asked for", [55, 9], &[]);
    set(&mut executor, "other", ParamValue::U32(2));
    step(
        &mut executor,
        false,
        "a param that nobody reads",
        [55, 9],
        &cached,
    );
    // The first pass runs once: it keeps the seed that it saw.
    set(&mut executor, "seed", ParamValue::U32(6));
    step(
        &mut executor,
        false,
        "the seed",
        [65, 9],
        &["first", "fifth"],
    );
    step(
        &mut executor,
        false,
        "nothing changed again",
        [65, 9],
        &cached,
    );
    GPU.queue.write_buffer(&host, 0, &8u32.to_le_bytes());
    executor
        .touch("host")
        .unwrap_or_else(|error| panic!("{error}"));
    step(
        &mut executor,
        false,
        "the host's buffer",
        [65, 8],
        &["first", "second", "third"],
    );
}

fn pool(files: &Files) -> (u64, u64) {
    let graph = load(files).unwrap_or_else(|errors| panic!("{errors}"));
    let plan = graph
        .plan(&request())
        .unwrap_or_else(|errors| panic!("{errors}"));
    (plan.memory_bytes(), plan.saved_bytes())
}

/// A chain of full-screen passes through `names`, each texel one more than the one before.
fn chain(names: &[&str], run: &str, overwrite: bool) -> Files {
    let textures: String = names
        .iter()
        .map(|name| format!("Texture(name: \"{name}\", format: R32Uint),"))
        .collect();
    let load = if overwrite {
        "Clear(0, 0, 0, 0)"
    } else {
        "Load"
    };
    let mut passes = format!("Clear(name: \"start\", {run} target: \"{}\"),", names[0]);
    for pair in names.windows(2) {
        let _ = write!(
            passes,
            "Fullscreen(name: \"to_{0}\", {run} shader: \"step\", color: [(target: \"{0}\", load: \
             {load})], bind: {{\"input\": \"{1}\"}}),",
            pair[1], pair[0]
        );
    }
    let last = names[names.len() - 1];
    Files::new([(
        "step.wgsl",
        "var input: texture_2d<u32>;
         @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 { return textureLoad(input, vec2<u32>(at.xy), 0).x + 1u; }",
    )])
    .with(
        "graph.ron",
        format!("(format: 2, materials: [{textures}], passes: [{passes}], outputs: [(name: \
            \"{last}\")])"),
    )
}

/// ```text
/// a ─▶ b ─▶ c ─▶ d ─▶ e : c can have a's memory, d b's; e is an output
/// ```
#[test]
fn memory_is_shared_by_what_is_not_needed_at_once() {
    let names = ["a", "b", "c", "d", "e"];
    let texture = 8 * 8 * 4;
    assert_eq!(pool(&chain(&names, "", true)), (3 * texture, 2 * texture));
    let mut executor = executor(&chain(&names, "", true));
    assert_eq!([0; 2].map(|_| number(&mut executor, "e")), [4, 4]);
    // What a skipped pass keeps is nobody else's.
    let kept = chain(&names, "run: OnChange,", true);
    assert_eq!(pool(&kept), (5 * texture, 0));
    // What a capture or an output hands out is not written again in the frame.
    let mut wanted = request();
    wanted.captures.push(skiagraph_graph::Capture {
        material: "b".to_owned(),
        after: None,
    });
    let mut executor = executor_for(&chain(&names, "", true), &wanted);
    assert_eq!(number(&mut executor, "b"), 1);
    assert_eq!(executor.plan().saved_bytes(), texture);
}

/// ```text
/// all ─▶ a ─▶ sum ─▶ m ; half ─▶ b (its first item) ─▶ whole ─▶ e
/// ```
/// `b` could have `a`'s memory by its size and lifetime, but nothing proves that all of it is
/// written: it would show what `a` left.
#[test]
fn what_may_be_written_in_part_has_its_own_memory() {
    let pair = "Buffer(name: \"a\", count: 2), Buffer(name: \"b\", count: 2),";
    let files = document(
        "",
        &["m", "e"],
        &["Compute(name: \"all\", overwrites: [\"a\"], dispatch: Groups(1, 1, 1), bind: {\"out\": \
            \"a\"})",
          "Compute(name: \"sum\", dispatch: Groups(1, 1, 1), bind: {\"input\": \"a\", \"out\": \
           \"m\"})",
          "Compute(name: \"half\", dispatch: Groups(1, 1, 1), bind: {\"out\": \"b\"})",
          "Compute(name: \"whole\", shader: \"sum\", dispatch: Groups(1, 1, 1), bind: {\"input\": \
           \"b\", \"out\": \"e\"})"],
        &["m", "e"],
    )
    .edited("graph.ron", "materials: [", &format!("materials: [{pair}"))
    .with("all.wgsl", writes("", "3u; out[1] = 4u"))
    .with("half.wgsl", writes("", "1u"))
    .with("sum.wgsl", writes(INPUT, "input[0] + input[1]"));
    assert_eq!(pool(&files).1, 0);
    let mut executor = executor(&files);
    assert_eq!([0; 2].map(|_| number(&mut executor, "e")), [1, 1]);
    // With the author's word that it is, they do share.
    let promised = files
        .edited(
            "graph.ron",
            "name: \"half\"",
            "name: \"half\", overwrites: [\"b\"]",
        )
        .with("half.wgsl", writes("", "1u; out[1] = 0u"));
    assert_eq!(pool(&promised).1, 8);
    assert_eq!(number(&mut executor_for(&promised, &request()), "e"), 1);
}

/// With a pattern in all memory that a frame has not written, outputs are the same if only what was
/// written is read.
#[test]
fn poisoned_memory_shows_what_is_read_unwritten() {
    let numbers = |files: &Files| {
        [None, Some(0x11), Some(0xee)].map(|poison| {
            let mut request = request();
            request.poison = poison;
            let mut executor = executor_for(files, &request);
            let first = frame(&mut executor, true, &["e"]).readbacks;
            assert_eq!(frame(&mut executor, true, &["e"]).readbacks, first);
            first[0].content.as_u32().expect("numbers")
        })
    };
    let [plain, low, high] = numbers(&chain(&["a", "b", "c", "d", "e"], "", true));
    assert_eq!(plain, vec![4; 64]);
    assert_eq!(low, plain);
    assert_eq!(high, plain);
    // A buffer of which only some is written, read whole.
    let careless = document(
        "",
        &["e"],
        &[
            "Compute(name: \"some\", dispatch: Groups(1, 1, 1), bind: {\"out\": \"part\"})",
            "Compute(name: \"whole\", dispatch: Groups(1, 1, 1), bind: {\"input\": \"part\", \
             \"out\": \"e\"})",
        ],
        &["e"],
    );
    let careless = careless
        .edited(
            "graph.ron",
            "materials: [",
            "materials: [Buffer(name: \"part\", count: 2),",
        )
        .with("some.wgsl", writes("", "1u"))
        .with("whole.wgsl", writes(INPUT, "input[0] + input[1]"));
    let [plain, low, high] = numbers(&careless);
    assert_eq!(plain, [1]);
    assert_eq!(low, [0x1111_1112]);
    assert_eq!(high, [0xeeee_eeef]);
}

// ---- Random documents against a naive interpreter ----

/// How a pass of a random document reads a material.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Read {
    Now(usize),
    Before(usize),
    Host,
}

#[derive(Clone, Debug)]
struct Pass {
    reads: Vec<Read>,
    /// Written: which material, all of it or its first half.
    target: usize,
    whole: bool,
}

/// What happens before a frame.
#[derive(Clone, Copy, Debug)]
enum Event {
    Nothing,
    Seed(u32),
    Flag(bool),
    Host(u32),
    Resize(u32),
}

#[derive(Clone, Debug)]
struct Program {
    /// Run condition of whoever writes a material.
    runs: Vec<usize>,
    passes: Vec<Pass>,
    outputs: Vec<usize>,
    events: Vec<Event>,
    poison: Option<u8>,
}

const MATERIALS: usize = 4;
const ITEMS: usize = 4;
const RUNS: [&str; 4] = ["Always", "OnChange", "Once", "When(\"flag\")"];

type Value = [u32; ITEMS];

impl Program {
    /// The document: every material is set to zero before it is first used, so that lifetimes are
    /// short and memory is shared.
    fn files(&self) -> Files {
        let mut passes = String::new();
        let mut fresh: Vec<usize> = (0..MATERIALS).collect();
        let mut zero = |passes: &mut String, used: &dyn Fn(usize) -> bool| {
            for material in fresh.extract_if(.., |material| used(*material)) {
                let run = RUNS[self.runs[material]];
                let _ = write!(
                    passes,
                    "Compute(name: \"zero{material}\", shader: \"zero\", run: {run}, overwrites: \
                     [\"m{material}\"], \
                     dispatch: Groups(1, 1, 1), bind: {{\"out\": \"m{material}\"}}),"
                );
            }
        };
        // A shader, not `Clear`: the size of a buffer comes from the shaders that see it.
        let zeroing = format!(
            "var<storage, read_write> out: array<u32>;
             @compute @workgroup_size({ITEMS}) fn main(@builtin(local_invocation_index) i: u32) {{ out[i] = 0u; }}"
        );
        let mut files = Files::new([]).with("zero.wgsl", zeroing);
        for (index, pass) in self.passes.iter().enumerate() {
            zero(&mut passes, &|material| {
                material == pass.target || pass.reads.contains(&Read::Now(material))
            });
            let run = RUNS[self.runs[pass.target]];
            let mut bind = format!("\"out\": \"m{}\"", pass.target);
            let (mut globals, mut sum) = (String::new(), format!("{}u + params.seed", index + 1));
            for (number, read) in pass.reads.iter().enumerate() {
                let of = match read {
                    Read::Now(material) => format!("\"m{material}\""),
                    Read::Before(material) => format!("Previous(\"m{material}\")"),
                    Read::Host => "\"host\"".to_owned(),
                };
                let _ = write!(bind, ", \"r{number}\": {of}");
                let _ = writeln!(globals, "var<storage, read> r{number}: array<u32>;");
                let _ = write!(sum, " + {}u * r{number}[i]", 2 * number + 3);
            }
            let most = if pass.whole { ITEMS } else { ITEMS / 2 };
            let overwrites = if pass.whole {
                format!("overwrites: [\"m{}\"],", pass.target)
            } else {
                String::new()
            };
            let _ = write!(
                passes,
                "Compute(name: \"p{index}\", run: {run}, {overwrites} dispatch: Groups(1, 1, 1), \
                 bind: {{{bind}}}),"
            );
            files = files.with(
                &format!("p{index}.wgsl"),
                format!(
                    "{globals} struct Params {{ seed: u32 }} var<uniform> params: Params;
                     var<storage, read_write> out: array<u32>;
                     @compute @workgroup_size({most}) fn main(@builtin(local_invocation_index) i: u32) {{ out[i] = ({sum}) * 2654435761u; }}"
                ),
            );
        }
        zero(&mut passes, &|_| true);
        let materials: String = (0..MATERIALS)
            .map(|material| format!("Buffer(name: \"m{material}\", count: {ITEMS}),"))
            .collect();
        let outputs: String = self
            .outputs
            .iter()
            .map(|material| format!("(name: \"m{material}\"),"))
            .collect();
        files.with(
            "graph.ron",
            format!(
                "(format: 2, params: [{SEED_PARAM}, Bool(name: \"flag\", default: true)], \
                 materials: [{materials}], passes: [{passes}], outputs: [{outputs}])"
            ),
        )
    }

    /// The outputs after each frame when every pass is run in file order, those that run `Once` in
    /// the first frame only and those that run by the flag when it is set. That `OnChange` saves
    /// work must not be seen.
    fn interpret(&self) -> Vec<Vec<Value>> {
        let mut now = [[0u32; ITEMS]; MATERIALS];
        let mut before = now;
        let (mut seed, mut flag, mut host) = (5u32, true, 9u32);
        let mut frames = Vec::new();
        for (number, event) in self.events.iter().enumerate() {
            match *event {
                Event::Seed(value) => seed = value,
                Event::Flag(value) => flag = value,
                Event::Host(value) => host = value,
                Event::Nothing | Event::Resize(_) => {}
            }
            let runs = |material: usize| match self.runs[material] {
                2 => number == 0,
                3 => flag,
                _ => true,
            };
            for (material, value) in now.iter_mut().enumerate() {
                if runs(material) {
                    *value = [0; ITEMS];
                }
            }
            for (index, pass) in self
                .passes
                .iter()
                .enumerate()
                .filter(|(_, pass)| runs(pass.target))
            {
                let most = if pass.whole { ITEMS } else { ITEMS / 2 };
                let values: Vec<Value> = pass
                    .reads
                    .iter()
                    .map(|read| match read {
                        Read::Now(material) => now[*material],
                        Read::Before(material) => before[*material],
                        Read::Host => [host; ITEMS],
                    })
                    .collect();
                for item in 0..most {
                    let sum = values.iter().enumerate().fold(
                        (index as u32 + 1).wrapping_add(seed),
                        |sum, (number, value)| {
                            sum.wrapping_add((2 * number as u32 + 3).wrapping_mul(value[item]))
                        },
                    );
                    now[pass.target][item] = sum.wrapping_mul(2_654_435_761);
                }
            }
            frames.push(self.outputs.iter().map(|material| now[*material]).collect());
            before = now;
        }
        frames
    }
}

fn any_pass() -> impl Strategy<Value = Pass> {
    let read = prop_oneof![
        3 => (0..MATERIALS).prop_map(Read::Now),
        2 => (0..MATERIALS).prop_map(Read::Before),
        1 => Just(Read::Host),
    ];
    (
        prop::collection::vec(read, 0..3),
        0..MATERIALS,
        prop::bool::weighted(0.7),
    )
        .prop_map(|(mut reads, target, whole)| {
            // A pass cannot bind what it writes a second time.
            reads.retain(|read| *read != Read::Now(target));
            Pass {
                reads,
                target,
                whole,
            }
        })
}

fn any_event() -> impl Strategy<Value = Event> {
    prop_oneof![
        3 => Just(Event::Nothing),
        2 => any::<u32>().prop_map(Event::Seed),
        1 => any::<bool>().prop_map(Event::Flag),
        2 => any::<u32>().prop_map(Event::Host),
        1 => (1..9u32).prop_map(Event::Resize),
    ]
}

fn any_program() -> impl Strategy<Value = Program> {
    (
        prop::collection::vec(
            prop_oneof![3 => Just(0usize), 3 => Just(1), 1 => Just(2), 1 => Just(3)],
            MATERIALS,
        ),
        prop::collection::vec(any_pass(), 1..7),
        prop::collection::btree_set(0..MATERIALS, 1..3),
        prop::collection::vec(any_event(), 3..7),
        prop_oneof![Just(None), Just(Some(0xa5))],
    )
        .prop_map(|(runs, passes, outputs, events, poison)| Program {
            runs,
            passes,
            outputs: outputs.into_iter().collect(),
            events,
            poison,
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, max_global_rejects: 8192, failure_persistence: None, ..ProptestConfig::default() })]

    /// Culling, order, sharing, two versions, skipped passes, uploads: none of it may be seen in a
    /// value.
    #[test]
    fn frames_mean_what_the_file_says(program in any_program()) {
        let files = program.files();
        let graph = load(&files).unwrap_or_else(|errors| panic!("{errors}"));
        let host = GPU.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4 * ITEMS as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let fill = |value: u32| GPU.queue.write_buffer(&host, 0, &value.to_le_bytes().repeat(ITEMS));
        fill(9);
        let mut request = request();
        request.poison = program.poison;
        request.imports = BTreeMap::from([("host".to_owned(), import::buffer(&host, None))]);
        // Writers of several conditions that meet in one group are refused; that is tested
        // elsewhere.
        let plan = match graph.plan(&request) {
            Ok(plan) => plan,
            Err(errors) => {
                let refused = errors.iter().all(|error| error.code == skiagraph_graph::Code::RunCondition);
                prop_assert!(refused, "{}", errors);
                return Err(TestCaseError::reject("mixed run conditions"));
            }
        };
        let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut NoProvider).unwrap_or_else(|error| panic!("{error}"));
        executor.import_buffer("host", &host).unwrap_or_else(|error| panic!("{error}"));
        let names: Vec<String> = program.outputs.iter().map(|material| format!("m{material}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        for (number, (event, expected)) in program.events.iter().zip(program.interpret()).enumerate() {
            match *event {
                Event::Nothing => {}
                Event::Seed(value) => set(&mut executor, "seed", ParamValue::U32(value)),
                Event::Flag(value) => set(&mut executor, "flag", ParamValue::Bool(value)),
                Event::Host(value) => {
                    fill(value);
                    // Refused where nothing live reads it.
                    let _ = executor.touch("host");
                }
                // No buffer follows the viewport, so nothing changes.
                Event::Resize(edge) => {
                    executor.resize([edge, edge], &mut NoProvider).unwrap_or_else(|error| panic!("{error}"));
                }
            }
            let report = frame(&mut executor, false, &names);
            let values: Vec<Value> = report
                .readbacks
                .iter()
                .map(|readback| readback.content.as_u32().expect("numbers").try_into().expect("as many as there are items"))
                .collect();
            prop_assert_eq!(values, expected, "frame {} after {:?}, skipped {:?}", number, event, report.skipped);
        }
    }
}
