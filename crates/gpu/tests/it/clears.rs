//! Clears of buffers, which frames encode ahead of the compute pass that dispatches share.

use crate::buffers::{INPUT, OUT, compute, document, shader, writes};
use crate::host::{executor, request, submit, words};
use crate::support::Files;
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::NoProvider;

const CLEAR: &str = "        Clear(name: \"CLEAR\", target: \"BUFFER\"),\n";

fn clear(name: &str, buffer: &str) -> String {
    CLEAR.replace("CLEAR", name).replace("BUFFER", buffer)
}

/// Runs three frames, and returns the first number of two outputs after each.
fn run(files: &Files) -> (Executor, [[u32; 2]; 3]) {
    let mut executor = executor(files, &request(&NoProvider));
    let seen = [0; 3].map(|_| {
        // As if something had changed in each.
        let frame = Frame::new().with_all(true).with_read(&["first", "second"]);
        let report = submit(&mut executor, &frame);
        [0, 1].map(|index| words(&report, index)[0])
    });
    (executor, seen)
}

/// ```text
/// clear sum ─▶ add ─▶ first ;  clear sum ─▶ add ─▶ second
/// ```
/// The second clear stays behind the first sum.
#[test]
fn a_buffer_is_cleared_again_after_its_use() {
    let sum = "var<storage, read_write> sum: array<u32>;";
    let add = shader(&format!("{sum} {OUT}"), "sum[0] += 5u; out[0] = sum[0];");
    for again in ["", r#"clear: ["sum"],"#] {
        let both = |out: &str| format!(r#""sum": "sum", "out": "{out}""#);
        let mut passes = vec![
            clear("start", "sum"),
            compute("add", "", &both("first")),
            compute(
                "add_again",
                &format!(r#"shader: "add", {again}"#),
                &both("second"),
            ),
        ];
        if again.is_empty() {
            passes.insert(2, clear("restart", "sum"));
        }
        let files = document(
            "",
            &["sum", "first", "second"],
            &passes,
            &["first", "second"],
        );
        let (_, seen) = run(&files.with("add.wgsl", add.clone()));
        assert_eq!(seen, [[5, 5]; 3], "{again}");
    }
}

/// ```text
/// make ─▶ used ─▶ pass_on ─▶ first ;  clear later ─▶ count ─▶ second
/// ```
/// `later` lies in the memory of `used`, and is cleared when that is done with.
#[test]
fn a_clear_stays_behind_the_last_use_of_the_memory() {
    let passes = [
        compute("make", r#"clear: ["used"],"#, r#""out": "used""#),
        compute("pass_on", "", r#""input": "used", "out": "first""#),
        clear("start", "later"),
        compute("count", "", r#""input": "later", "out": "second""#),
    ];
    let buffers = ["used", "later", "first", "second"];
    let files = document("", &buffers, &passes, &["first", "second"])
        .with("make.wgsl", writes("", "7u"))
        .with("pass_on.wgsl", writes(INPUT, "input[0]"))
        .with("count.wgsl", writes(INPUT, "input[0] + 1u"));
    let (executor, seen) = run(&files);
    assert_eq!(seen, [[7, 1]; 3]);
    let plan = executor.plan();
    let allocation = |name: &str| {
        let mut ids = plan.schedule().aliases.of.iter();
        ids.find(|(id, _)| plan.resource(**id).name == name)
            .map(|(_, at)| *at)
    };
    assert!(allocation("used").is_some());
    assert_eq!(
        allocation("used"),
        allocation("later"),
        "they share memory, or this tests nothing"
    );
}
