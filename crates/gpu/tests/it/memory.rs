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
