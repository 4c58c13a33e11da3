//! Frames before which nothing has changed: no pass runs, and the outputs are those of before.

use crate::given::{Number, buffer, with_more, write};
use crate::host::{self, GPU, encoder, frame, planned, request, set, submit, words};
use crate::support::Files;
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::{NoProvider, ParamValue};

const PASSES: [&str; 2] = ["add", "double"];

/// ```text
/// params ─▶ add ─▶ sum ─▶ double ─▶ out
/// ```
fn files() -> Files {
    Files::graph(
        r#"
    params: [U32(name: "more", default: 1)],
    materials: [Buffer(name: "sum"), Buffer(name: "out")],
    passes: [
        Compute(name: "add", dispatch: Groups(1, 1, 1)),
        Compute(name: "double", dispatch: Groups(1, 1, 1)),
    ],
    outputs: ["out"],
"#,
    )
    .with(
        "add.wgsl",
        "struct Params { more: u32 }
         var<uniform> params: Params;
         var<storage, read_write> sum: u32;
         @compute @workgroup_size(1) fn main() { sum = 10u + params.more; }",
    )
    .with(
        "double.wgsl",
        "var<storage, read> sum: u32;
         var<storage, read_write> out: u32;
         @compute @workgroup_size(1) fn main() { out = 2u * sum; }",
    )
}

/// As [`files`], where the number to add stands in a buffer.
fn files_of(buffer: &str) -> Files {
    let global = format!("var<storage, read> {buffer}: u32");
    files()
        .edited("add.wgsl", "struct Params { more: u32 }", "")
        .edited("add.wgsl", "var<uniform> params: Params", &global)
        .edited("add.wgsl", "params.more", buffer)
}

/// Runs a frame that shows `out`, and tells whether its passes ran.
#[track_caller]
fn runs(executor: &mut Executor, out: u32) -> bool {
    let report = frame(executor, &["out"]);
    assert_eq!(words(&report, 0), [out]);
    match &report.skipped[..] {
        [] => true,
        skipped => {
            assert_eq!(skipped, PASSES);
            false
        }
    }
}

#[test]
fn passes_run_again_only_after_a_change() {
    let mut executor = host::executor(&files(), &request(&NoProvider));
    assert!(runs(&mut executor, 22));
    assert!(!runs(&mut executor, 22));
    assert!(!runs(&mut executor, 22));
    set(&mut executor, "more", ParamValue::U32(5));
    assert!(runs(&mut executor, 30));
    assert!(!runs(&mut executor, 30));
    // All that a host may ask for besides is there.
    let report = submit(&mut executor, &Frame::new().with_all(true));
    assert_eq!(report.skipped, [""; 0]);
    let timed = submit(&mut executor, &Frame::new().with_timing(true));
    assert_eq!(timed.skipped, [""; 0]);
    assert_eq!(timed.timing.expect("it was asked for").passes.len(), 2);
    assert!(!runs(&mut executor, 30));
    // Another plan has other memory.
    let plan = planned(&files(), &request(&NoProvider));
    executor.replace_graph(plan, &mut NoProvider).unwrap();
    assert!(runs(&mut executor, 22));
    assert!(!runs(&mut executor, 22));
}

/// Until the GPU is done with a frame it may still be dropped.
#[test]
fn frames_that_are_not_done_are_repeated() {
    let mut executor = host::executor(&files(), &request(&NoProvider));
    let encode = |executor: &mut Executor| {
        let mut encoder = encoder();
        executor.encode(&mut encoder, &Frame::default()).unwrap();
        encoder
    };
    drop(encode(&mut executor));
    let (first, second) = (encode(&mut executor), encode(&mut executor));
    GPU.queue.submit([first.finish()]);
    drop(second);
    // The first one may be done behind this, or not.
    runs(&mut executor, 22);
    assert!(!runs(&mut executor, 22));
    // The frame of the change is dropped, one before it is done.
    let before = encode(&mut executor);
    set(&mut executor, "more", ParamValue::U32(7));
    let changed = encode(&mut executor);
    GPU.queue.submit([before.finish()]);
    drop(changed);
    assert!(runs(&mut executor, 34));
    assert!(!runs(&mut executor, 34));
}

#[test]
fn what_a_host_changes_is_seen() {
    let mut provider = Number::new(false);
    provider.has_versions = true;
    let plan = planned(&files_of("host_number"), &request(&provider));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider).unwrap();
    assert!(runs(&mut executor, 22));
    executor.refresh(&mut provider).unwrap();
    assert!(!runs(&mut executor, 22));
    provider.value = 2;
    executor.refresh(&mut provider).unwrap();
    assert!(runs(&mut executor, 24));
    assert!(!runs(&mut executor, 24));
    write(&provider.buffer, 3);
    executor.touch("host.number").unwrap();
    assert!(runs(&mut executor, 26));
    // A provider that promises no versions may write behind the executor.
    provider.has_versions = false;
    executor.refresh(&mut provider).unwrap();
    write(&provider.buffer, 4);
    assert!(runs(&mut executor, 28));
    assert!(runs(&mut executor, 28));
}

/// A host may write to its own buffers without a word, unless it tells their versions.
#[test]
fn a_plan_with_imports_rests_by_their_versions() {
    let (mut executor, more) = with_more(files_of("more"), 1);
    for (number, out) in [(1, 22), (2, 24), (2, 24)] {
        write(&more, number);
        assert!(runs(&mut executor, out));
    }
    let mut shown = |number: u32, version: u64, out: u32| {
        write(&more, number);
        executor.import_buffer("more", &more).unwrap();
        executor.set_import_version("more", version).unwrap();
        runs(&mut executor, out)
    };
    assert!(shown(3, 0, 26));
    assert!(!shown(3, 0, 26));
    // A change without a new version is not seen.
    assert!(!shown(4, 0, 26));
    assert!(shown(4, 1, 28));
    assert!(!shown(4, 1, 28));
    assert!(shown(4, 7, 28));
    // Another buffer, a word of the host and another plan are changes, too.
    let other = buffer(&[5], more.usage());
    executor.import_buffer("more", &other).unwrap();
    assert!(runs(&mut executor, 30));
    executor.import_buffer("more", &other).unwrap();
    assert!(!runs(&mut executor, 30));
    executor.touch("more").unwrap();
    assert!(runs(&mut executor, 30));
    let plan = executor.plan().with(|request| request.viewport = [2, 2]);
    executor
        .replace_graph(plan.unwrap(), &mut NoProvider)
        .unwrap();
    assert!(runs(&mut executor, 30));
    assert!(!runs(&mut executor, 30));
}

#[test]
fn an_import_whose_version_goes_back_is_told_and_counts_as_changed() {
    let (mut executor, more) = with_more(files_of("more"), 1);
    executor.set_import_version("more", 8).unwrap();
    assert!(runs(&mut executor, 22));
    write(&more, 2);
    let error = executor.set_import_version("more", 3).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the import `more` went back from version 8 to 3: give a larger number for each change; \
         its content counts as changed"
    );
    assert!(runs(&mut executor, 24));
    assert!(!runs(&mut executor, 24));
    let error = executor.set_import_version("less", 1).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the plan has no import `less`; it has more"
    );
}

/// A lost frame has not seen the version that it was encoded with.
#[test]
fn a_version_of_a_lost_frame_is_seen_by_the_next() {
    let (mut executor, more) = with_more(files_of("more"), 1);
    executor.set_import_version("more", 1).unwrap();
    assert!(runs(&mut executor, 22));
    write(&more, 2);
    executor.set_import_version("more", 2).unwrap();
    let mut dropped = encoder();
    executor.encode(&mut dropped, &Frame::default()).unwrap();
    drop(dropped);
    assert!(runs(&mut executor, 24));
    assert!(!runs(&mut executor, 24));
}

/// Frames that look back, or that tell their number, compute something new.
#[test]
fn a_plan_that_remembers_never_rests() {
    let previous = files()
        .edited(
            "graph.ron",
            "Compute(name: \"add\",",
            "Compute(name: \"add\", bind: {\"before\": \"sum.previous\"},",
        )
        .edited(
            "add.wgsl",
            "var<uniform>",
            "var<storage, read> before: u32; var<uniform>",
        )
        .edited("add.wgsl", "10u", "before");
    let numbered = files()
        .edited(
            "add.wgsl",
            "struct Params",
            "struct Frame { index: u32 } var<uniform> frame: Frame; struct Params",
        )
        .edited("add.wgsl", "10u", "frame.index");
    for files in [previous, numbered] {
        let mut executor = host::executor(&files, &request(&NoProvider));
        for out in [2, 4, 6] {
            assert!(runs(&mut executor, out));
        }
    }
}
