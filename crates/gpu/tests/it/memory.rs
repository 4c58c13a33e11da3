//! Memory that materials share, memory that they must not, and patterns that show what is read
//! unwritten.

use crate::buffers::{INPUT, compute, document, writes};
use crate::host::{executor, planned, request, submit, words};
use crate::support::Files;
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::{Capture, NoProvider};
use std::fmt::Write as _;

/// The first number of an output after a frame in which every pass runs.
fn number(executor: &mut Executor, output: &str) -> u32 {
    let frame = Frame::new()
        .with_all(true)
        .with_read(std::slice::from_ref(&output));
    words(&submit(executor, &frame), 0)[0]
}

/// The bytes that a graph takes, and those that it saves.
fn pool(files: &Files) -> (u64, u64) {
    let plan = planned(files, &request(&NoProvider));
    (plan.memory_bytes(), plan.saved_bytes())
}

/// A chain of full-screen passes through `names`, each texel one more than the one before.
fn chain(names: &[&str], run: &str) -> Files {
    let textures: String = names
        .iter()
        .map(|name| format!("Texture(name: \"{name}\", format: R32Uint), "))
        .collect();
    let mut passes = format!("Clear(name: \"start\", {run} target: \"{}\"),", names[0]);
    for pair in names.windows(2) {
        let _ = write!(
            passes,
            "Fullscreen(name: \"to_{0}\", {run} shader: \"step\", color: [\"{0}\"], bind: \
             {{\"input\": \"{1}\"}}),",
            pair[1], pair[0]
        );
    }
    let last = names[names.len() - 1];
    Files::graph(&format!(
        "materials: [{textures}], passes: [{passes}], outputs: [\"{last}\"]"
    ))
    .with(
        "step.wgsl",
        "var input: texture_2d<u32>;
         @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 {
             return textureLoad(input, vec2<u32>(at.xy), 0).x + 1u;
         }",
    )
}

const NAMES: [&str; 5] = ["a", "b", "c", "d", "e"];

/// ```text
/// a ─▶ b ─▶ c ─▶ d ─▶ e : c can have a's memory, d b's; e is an output
/// ```
#[test]
fn memory_is_shared_by_what_is_not_needed_at_once() {
    let texture = 8 * 8 * 4;
    let files = chain(&NAMES, "");
    assert_eq!(pool(&files), (3 * texture, 2 * texture));
    let mut chained = executor(&files, &request(&NoProvider));
    assert_eq!([0; 2].map(|_| number(&mut chained, "e")), [4, 4]);
    // Memory that a skipped pass keeps is not shared.
    assert_eq!(pool(&chain(&NAMES, "run: OnChange,")), (5 * texture, 0));
    // Memory handed out by a capture or an output is not written again in the frame.
    let mut wanted = request(&NoProvider);
    wanted.captures.push(Capture::new("b"));
    let mut executor = executor(&files, &wanted);
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
    let pair = r#"Buffer(name: "a", count: 2), Buffer(name: "b", count: 2),"#;
    let files = document(
        "",
        &["m", "e"],
        &[
            compute("all", r#"overwrites: ["a"],"#, r#""out": "a""#),
            compute("sum", "", r#""input": "a", "out": "m""#),
            compute("half", "", r#""out": "b""#),
            compute("whole", r#"shader: "sum","#, r#""input": "b", "out": "e""#),
        ],
        &["m", "e"],
    )
    .edited("graph.ron", "materials: [", &format!("materials: [{pair}"))
    .with("all.wgsl", writes("", "3u; out[1] = 4u"))
    .with("half.wgsl", writes("", "1u"))
    .with("sum.wgsl", writes(INPUT, "input[0] + input[1]"));
    assert_eq!(pool(&files).1, 0);
    let mut careful = executor(&files, &request(&NoProvider));
    assert_eq!([0; 2].map(|_| number(&mut careful, "e")), [1, 1]);
    // With the author's word that it is, they do share.
    let promised = files
        .edited(
            "graph.ron",
            r#"name: "half","#,
            r#"name: "half", overwrites: ["b"],"#,
        )
        .with("half.wgsl", writes("", "1u; out[1] = 0u"));
    assert_eq!(pool(&promised).1, 8);
    let mut executor = executor(&promised, &request(&NoProvider));
    assert_eq!(number(&mut executor, "e"), 1);
}

/// With a pattern in all memory that a frame has not written, outputs are the same if only what was
/// written is read.
#[test]
fn poisoned_memory_shows_what_is_read_unwritten() {
    let numbers = |files: &Files| {
        [None, Some(0x11), Some(0xee)].map(|poison| {
            let mut request = request(&NoProvider);
            request.poison = poison;
            let mut executor = executor(files, &request);
            let frame = Frame::new().with_all(true).with_read(&["e"]);
            let first = submit(&mut executor, &frame);
            assert_eq!(submit(&mut executor, &frame).readbacks, first.readbacks);
            words(&first, 0)
        })
    };
    let [plain, low, high] = numbers(&chain(&NAMES, ""));
    assert_eq!(plain, vec![4; 64]);
    assert_eq!(low, plain);
    assert_eq!(high, plain);
    // A buffer of which only some is written, read whole.
    let careless = document(
        "",
        &["e"],
        &[
            compute("some", "", r#""out": "part""#),
            compute("whole", "", r#""input": "part", "out": "e""#),
        ],
        &["e"],
    )
    .edited(
        "graph.ron",
        "materials: [",
        r#"materials: [Buffer(name: "part", count: 2), "#,
    )
    .with("some.wgsl", writes("", "1u"))
    .with("whole.wgsl", writes(INPUT, "input[0] + input[1]"));
    let [plain, low, high] = numbers(&careless);
    assert_eq!(plain, [1]);
    assert_eq!(low, [0x1111_1112]);
    assert_eq!(high, [0xeeee_eeef]);
}

/// Items of the buffers of `chains/graph.ron`.
const CHAINS: [[u32; 4]; 3] = [
    [14_400, 4_800, 11_200, 3_200],
    [8_000, 12_800, 4_800, 9_600],
    [10_400, 5_600, 12_000, 6_400],
];

fn chains() -> Files {
    Files::default()
        .with("graph.ron", include_str!("chains/graph.ron"))
        .with("begin.wgsl", include_str!("chains/begin.wgsl"))
        .with("next.wgsl", include_str!("chains/next.wgsl"))
        .with("add.wgsl", include_str!("chains/add.wgsl"))
}

/// The last number of a chain, as its shaders make it.
fn end_of(chain: [u32; 4]) -> u32 {
    let first: Vec<u32> = (0..chain[0])
        .map(|item| item.wrapping_mul(2_654_435_761))
        .collect();
    let last = chain[1..].iter().fold(first, |before, &count| {
        let item = |item: u32| {
            let read = before[item as usize % before.len()];
            read.wrapping_mul(3).wrapping_add(item)
        };
        (0..count).map(item).collect()
    });
    last.into_iter()
        .fold(0u32, |sum, item| sum.wrapping_mul(31).wrapping_add(item))
}

/// Three chains of buffers, no two of one size, take little more than is ever needed at once; each
/// shader sees its own.
#[test]
fn buffers_of_any_size_lie_in_the_memory_of_others() {
    let plan = planned(&chains(), &request(&NoProvider));
    let schedule = plan.schedule();
    let needed = |at: usize| -> u64 {
        let lifetimes = schedule.lifetimes.iter();
        let alive = lifetimes.filter(|(_, life)| (life.first..=life.last).contains(&at));
        alive.map(|(id, _)| plan.resource(*id).kind.bytes()).sum()
    };
    let peak = (0..schedule.passes.len()).map(needed).max().unwrap();
    let taken = plan.memory_bytes();
    assert!(
        taken * 10 <= peak * 11,
        "{taken} bytes, {peak} at once\n{}",
        plan.memory_table()
    );
    for pass in plan.live() {
        let slot = |access: &skiagraph_graph::Access| schedule.aliases.of[&access.resource];
        let mut slots: Vec<usize> = pass.accesses.iter().map(slot).collect();
        slots.sort_unstable();
        slots.dedup();
        assert_eq!(
            slots.len(),
            pass.accesses.len(),
            "{} uses one buffer twice",
            pass.name
        );
    }
    let expected = CHAINS.map(end_of);
    for poison in [None, Some(0x11), Some(0xee)] {
        let mut request = request(&NoProvider);
        request.poison = poison;
        let mut executor = executor(&chains(), &request);
        for _ in 0..2 {
            let frame = Frame::new().with_all(true).with_read(&["a", "b", "c"]);
            let report = submit(&mut executor, &frame);
            assert_eq!(
                [0, 1, 2].map(|at| words(&report, at)[0]),
                expected,
                "{poison:?}"
            );
        }
    }
}

/// A texture that is drawn and not used again is not stored; one that a later pass reads, that is
/// read back, or whose memory begins with a copy or a store is.
#[test]
fn what_is_not_used_again_is_not_stored() {
    let files = Files::graph(
        r#"
    materials: [
        Texture(name: "depth", format: Depth32Float), Texture(name: "image", format: R32Uint),
        Texture(name: "seen", format: Depth32Float), Texture(name: "shown", format: R32Uint),
    ],
    passes: [
        Raster(name: "first", shader: "draw", draw: 3, color: ["image"], depth: "depth"),
        Raster(name: "second", shader: "draw", draw: 3, color: ["shown"], depth: "seen"),
        Raster(name: "third", shader: "draw", draw: 3, color: [(target: "shown", load: Load)],
            depth: (target: "seen", load: Load)),
    ],
    outputs: ["image", "shown"],
"#,
    )
    .with(
        "draw.wgsl",
        "@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
             return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0);
         }
         @fragment fn fragment() -> @location(0) u32 { return 7u; }",
    );
    let discarded = |plan: &skiagraph_graph::Plan| -> Vec<Vec<String>> {
        let name = |target: skiagraph_graph::Target| plan.resource(target.id).name.clone();
        let positions = 0..plan.schedule().passes.len();
        positions
            .map(|at| plan.discarded(at).into_iter().map(name).collect())
            .collect()
    };
    let plan = planned(&files, &request(&NoProvider));
    assert_eq!(discarded(&plan), [vec!["depth"], vec![], vec!["seen"]]);
    let mut executor = executor(&files, &request(&NoProvider));
    assert_eq!(
        [
            number(&mut executor, "image"),
            number(&mut executor, "shown")
        ],
        [7, 7]
    );
    // Once it is read back, it is stored, by the pass that is there already.
    let wanted = executor
        .plan()
        .with(|request| request.captures.push(Capture::new("depth")));
    executor
        .replace_graph(wanted.unwrap(), &mut NoProvider)
        .unwrap();
    assert_eq!(discarded(executor.plan()), [vec![], vec![], vec!["seen"]]);
    let report = submit(&mut executor, &Frame::new().with_read(&["depth"]));
    let depths = report.readbacks[0].content.as_f32();
    assert_eq!(depths.unwrap()[0], 0.5);
}
