//! Materials with `keep: true`: dependences, order, and that nothing shares their memory.

use crate::support::{Files, names, plan, right};
use skiagraph_graph::Plan;

const OUT: &str = "var<storage, read_write> out: array<u32>;";
const INPUT: &str = "var<storage, read> input: array<u32>;";

/// Buffers of four items, of which `kept` stays, and passes of one thread.
fn files(passes: &str, outputs: &str) -> Files {
    let write = |globals: &str, body: &str| {
        format!("{globals} @compute @workgroup_size(1) fn main() {{ {body} }}")
    };
    let sections = format!(
        r#"params: [Bool(name: "on", default: true)],
        materials: [
            Buffer(name: "kept", count: 4, keep: true), Buffer(name: "a", count: 4),
            Buffer(name: "b", count: 4), Buffer(name: "c", count: 4),
        ],
        passes: [{passes}], outputs: [{outputs}]"#
    );
    Files::graph(&sections)
        .with("count.wgsl", write(OUT, "out[0] = out[0] + 1u;"))
        .with("write.wgsl", write(OUT, "out[0] = 1u;"))
        .with(
            "take.wgsl",
            write(&format!("{INPUT}{OUT}"), "out[0] = input[0];"),
        )
}

fn pass(name: &str, shader: &str, bind: &str, more: &str) -> String {
    format!(
        r#"Compute(name: "{name}", shader: "{shader}", dispatch: Groups(1, 1, 1),
        bind: {{{bind}}}, {more}),"#
    )
}

fn take(name: &str, from: &str, to: &str) -> String {
    let bind = format!(r#""input": "{from}", "out": "{to}""#);
    pass(name, "take", &bind, &format!(r#"overwrites: ["{to}"],"#))
}

const KEPT: &str = r#""out": "kept""#;

/// The name of what shares memory with others, if something does.
fn sharing(plan: &Plan) -> Vec<Vec<&str>> {
    let name = |id: &skiagraph_graph::ResourceId| plan.resource(*id).name.as_str();
    let list = plan.schedule().aliases.list.iter();
    let named = list.map(|allocation| allocation.aliases.iter().map(name).collect::<Vec<_>>());
    named.filter(|names| names.len() > 1).collect()
}

#[test]
fn what_a_later_frame_reads_is_live_and_runs_where_it_stands() {
    let passes = [
        take("before", "kept", "a"),
        pass("first", "write", KEPT, r#"overwrites: ["kept"],"#),
        take("between", "kept", "b"),
        pass("second", "count", KEPT, ""),
        pass("third", "write", KEPT, r#"overwrites: ["kept"],"#),
        take("after", "kept", "c"),
    ];
    let order = ["before", "first", "between", "second", "third", "after"];
    let full_plan = right(plan(&files(&passes.concat(), r#""a", "b", "c""#)));
    assert_eq!(names(&full_plan), order);
    assert!(full_plan.remembers());
    // One reader is enough, wherever it stands, and so is an output; without both nothing is
    // needed.
    for (output, live) in [
        ("a", &["before", "first", "second", "third"][..]),
        ("b", &["first", "between", "second", "third"]),
        ("c", &["first", "second", "third", "after"]),
        ("kept", &["first", "second", "third"]),
    ] {
        let plan = right(plan(&files(&passes.concat(), &format!("\"{output}\""))));
        assert_eq!(names(&plan), live, "{output}");
    }
    let apart = [passes[1].clone(), pass("own", "write", r#""out": "a""#, "")].concat();
    let cleared = format!(r#"Clear(name: "reset", target: "a"), {apart}"#);
    let plan = right(plan(&files(&cleared, r#""a""#)));
    assert_eq!(names(&plan), ["reset", "own"]);
    assert!(!plan.remembers());
}

/// `a` is done when `kept` is first used, and `kept` when `c` is: their memory would do.
#[test]
fn nothing_shares_its_memory() {
    let passes = |keep: &str| {
        let passes = [
            pass("one", "write", r#""out": "a""#, r#"overwrites: ["a"],"#),
            take("two", "a", "b"),
            pass("three", "write", KEPT, r#"overwrites: ["kept"],"#),
            take("four", "kept", "c"),
            take("last", "c", "d"),
        ];
        let more = r#"Buffer(name: "d", count: 4), Buffer(name: "kept", count: 4, KEEP)"#;
        files(&passes.concat(), r#""b", "d""#).edited(
            "graph.ron",
            r#"Buffer(name: "kept", count: 4, keep: true)"#,
            &more.replace("KEEP", keep),
        )
    };
    assert_eq!(sharing(&right(plan(&passes("")))), [["a", "kept"]]);
    let kept = right(plan(&passes("keep: true")));
    let shared = sharing(&kept);
    assert!(
        shared.iter().flatten().all(|name| *name != "kept"),
        "{shared:?}"
    );
    let bytes = |plan: &Plan| plan.memory_bytes();
    let apart = right(plan(&passes("")));
    assert_eq!(
        bytes(&kept),
        bytes(&apart) + if shared.is_empty() { 16 } else { 0 }
    );
}

/// Writers of several conditions: each runs by its own.
#[test]
fn its_writers_need_not_run_together() {
    let passes = [
        pass(
            "reset",
            "write",
            KEPT,
            r#"overwrites: ["kept"], run: Once,"#,
        ),
        pass("step", "count", KEPT, r#"run: When("on"),"#),
        take("take", "kept", "a"),
        pass("again", "count", KEPT, r#"run: When("on"),"#),
    ];
    let plan = right(plan(&files(&passes.concat(), r#""a""#)));
    assert_eq!(names(&plan), ["reset", "step", "take", "again"]);
    assert_eq!(plan.schedule().conditions.group, [0, 1, 2, 1]);
}
