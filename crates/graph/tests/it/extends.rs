//! `extends`: a document is another one with edits, as if the result had been written out.

use crate::support::{Files, Triangle, checked, codes, load, names, plan, right, wrong};
use skiagraph_graph::{Code, Graph, PlanRequest, Registry};

const FILL: &str = "struct Params { value: f32 } var<uniform> params: Params;
    @fragment fn fragment() -> @location(0) f32 { return params.value; }";

/// Two textures, a group of passes, a claim.
const BASE: &str = r#"
    description: "the base",
    params: [F32(name: "value", default: 1), U32(name: "edge", default: 4)],
    materials: [
        Texture(name: "first", format: R32Float, size: "edge"),
        Texture(name: "second", format: R32Float, size: "edge"),
    ],
    passes: [
        Group(name: "both", passes: [
            Fullscreen(name: "one", shader: "fill", color: ["first"]),
            Fullscreen(name: "two", shader: "fill", color: ["second"], set: {"value": 2}),
        ]),
        Copy(name: "over", from: "first", to: "second"),
    ],
    outputs: ["second"],
    claims: {"exact": (because: "it is the base")}"#;

/// `graph.ron`, which extends the base.
fn extending(sections: &str) -> Files {
    Files::graph(&format!("extends: \"base.ron\", {sections}"))
        .document("base.ron", BASE)
        .with("fill.wgsl", FILL)
}

/// The passes in the order of the file.
#[track_caller]
fn all(files: &Files) -> Vec<String> {
    let plan = right(plan(files));
    let passes = plan.all_passes().iter();
    passes.map(|pass| pass.name.value.clone()).collect()
}

#[test]
fn a_document_that_edits_nothing_is_the_one_that_it_extends() {
    let files = extending("");
    let graph = right(load(&files));
    assert_eq!(graph.description(), "the base");
    assert_eq!(graph.outputs(), ["second"]);
    assert_eq!(all(&files), ["both.one", "both.two", "over"]);
    assert_eq!(graph.path(), "graph.ron");
}

/// A method's promise holds for the method as written, not for those that extend it.
#[test]
fn a_claim_is_never_inherited() {
    let claims = |files: &Files| {
        let graph = right(load(files));
        let claims = right(graph.claims(&Default::default(), [8, 8], Default::default()));
        claims
            .iter()
            .map(|claim| claim.because.clone())
            .collect::<Vec<_>>()
    };
    let base = Files::graph(BASE).with("fill.wgsl", FILL);
    assert_eq!(claims(&base), ["it is the base"]);
    assert_eq!(claims(&extending("")).len(), 0);
    let own = r#"claims: {"certain": (because: "it is another")}"#;
    assert_eq!(claims(&extending(own)), ["it is another"]);
}

/// A diagnostic tells of the method as written, too.
#[test]
fn an_output_on_request_is_never_inherited() {
    let asked = r#"outputs: [(name: "first", material: "first", on_request: true), "second"]"#;
    let base = |own: &str| extending(own).edited("base.ron", r#"outputs: ["second"]"#, asked);
    assert_eq!(right(load(&base(""))).outputs(), ["second"]);
    assert_eq!(right(load(&base(asked))).outputs(), ["first", "second"]);
}

#[test]
fn sections_replace_or_add() {
    let files = extending(
        r#"description: "another", requires: ["SUBGROUP"],
        params: [F32(name: "value", default: 5), F32(name: "more", default: 6)],
        materials: [
            Texture(name: "second", format: R32Float, size: "edge + 1"),
            Texture(name: "third", format: R32Float),
        ],
        passes: [
            Remove(pass: "over"),
            Fullscreen(name: "last", after: "both", shader: "fill", color: ["third"],
                set: {"value": "more"}),
        ],
        outputs: ["second", "third"]"#,
    );
    let files = files.edited(
        "base.ron",
        "description",
        r#"requires: ["TIMESTAMP_QUERY"], description"#,
    );
    let graph = right(load(&files));
    assert_eq!(graph.description(), "another");
    assert_eq!(graph.outputs(), ["second", "third"]);
    let params: Vec<&str> = graph
        .params()
        .iter()
        .map(|param| param.name.as_str())
        .collect();
    assert_eq!(params, ["value", "edge", "more"]);
    let features = graph.features();
    let required: Vec<&str> = features.iter_names().map(|(name, _)| name).collect();
    assert_eq!(required, ["SUBGROUP", "TIMESTAMP_QUERY"]);
    let mut request = PlanRequest::new([8, 8], &Triangle);
    request.features = features;
    let plan = right(graph.plan(&request));
    assert_eq!(names(&plan), ["both.two", "last"]);
    let outputs = plan.outputs().into_iter().map(|output| output.size);
    assert_eq!(outputs.collect::<Vec<_>>(), [[5, 5], [8, 8]]);
}

#[test]
fn set_gives_params_other_defaults() {
    let files = extending(r#"set: {"edge": 6}"#);
    let set_plan = right(plan(&files));
    assert_eq!(set_plan.outputs()[0].size, [6, 6]);
    let wide = files.edited("graph.ron", "6", r#""value""#);
    assert_eq!(codes(wrong(plan(&wide)).iter()), [Code::ParamValue]);
    let unknown = extending(r#"set: {"egde": 6}"#);
    let diagnostics = checked(&unknown);
    assert_eq!(codes(&diagnostics), [Code::UnknownParam]);
    assert!(
        diagnostics[0]
            .help
            .as_deref()
            .unwrap_or_default()
            .contains("`edge`"),
        "{diagnostics:?}"
    );
}

/// `Change` replaces the fields that it gives, `bind` and `set` key by key.
#[test]
fn a_change_replaces_what_it_gives() {
    let value = |files: &Files, name: &str| {
        let plan = right(plan(files));
        let pass = plan.all_passes().iter().find(|pass| *pass.name == *name);
        let bytes = pass
            .expect("it is there")
            .params()
            .next()
            .flatten()
            .map(<[u8]>::to_vec);
        f32::from_le_bytes(
            bytes.expect("it has params")[..4]
                .try_into()
                .expect("it has four"),
        )
    };
    assert_eq!(value(&extending(""), "both.two"), 2.0);
    let set = r#"passes: [
        Change(pass: "both.two", set: {"value": 7}), Change(pass: "both.one", set: {"value": 8}),
    ]"#;
    let files = extending(set);
    assert_eq!(value(&files, "both.two"), 7.0);
    assert_eq!(value(&files, "both.one"), 8.0);
    // A field of the group, and one of a pass: the rest is as it was.
    let files = extending(
        r#"passes: [Change(pass: "both", repeat: 2), Change(pass: "both.two", color: ["first"])]"#,
    );
    let expected = [
        "both[0].one",
        "both[0].two",
        "both[1].one",
        "both[1].two",
        "over",
    ];
    assert_eq!(all(&files), expected);
    assert_eq!(value(&files, "both[1].two"), 2.0);
    // Later edits see what earlier ones made.
    let files = extending(
        r#"passes: [
            Change(pass: "both.two", set: {"value": 7}), Change(pass: "both.two", name: "deux"),
            Change(pass: "both.deux", set: {"value": 9}),
        ]"#,
    );
    assert_eq!(value(&files, "both.deux"), 9.0);
}

/// One without a place.
#[test]
fn an_entry_stands_behind_the_new_one_above_it() {
    let clear = |name: &str, place: &str| {
        let place = match place {
            "" => String::new(),
            place => format!("{place}, "),
        };
        format!(r#"Clear(name: "{name}", {place}target: "second")"#)
    };
    for (edits, expected) in [
        (
            [
                clear("a", r#"before: "both.two""#),
                clear("b", ""),
                clear("c", ""),
                clear("d", r#"before: "both.two""#),
            ]
            .join(", "),
            "both.one both.a both.b both.c both.d both.two over",
        ),
        (
            [
                clear("a", r#"after: "both.one""#),
                clear("b", ""),
                clear("c", r#"after: "both.one""#),
            ]
            .join(", "),
            "both.one both.a both.b both.c both.two over",
        ),
        (
            [clear("a", r#"instead: "both.two""#), clear("b", "")].join(", "),
            "both.one both.a both.b over",
        ),
    ] {
        let files = extending(&format!("passes: [{edits}]"));
        assert_eq!(all(&files).join(" "), expected, "{edits}");
    }
}

#[test]
fn entries_are_put_and_taken_where_a_path_says() {
    let clear =
        |name: &str, place: &str| format!(r#"Clear(name: "{name}", {place}, target: "second")"#);
    for (edits, expected) in [
        (
            clear("new", r#"before: "both.one""#),
            "both.new both.one both.two over",
        ),
        (
            clear("new", r#"after: "both""#),
            "both.one both.two new over",
        ),
        (
            clear("new", r#"instead: "both.two""#),
            "both.one both.new over",
        ),
        // Several after one entry stand in the order in which they are written.
        (
            format!(
                "{}, {}",
                clear("a", r#"after: "both.one""#),
                clear("b", r#"after: "both.one""#)
            ),
            "both.one both.a both.b both.two over",
        ),
        (
            format!(
                "{}, {}",
                clear("a", r#"before: "over""#),
                clear("b", r#"before: "over""#)
            ),
            "both.one both.two a b over",
        ),
        // An added entry is like any other, and may be taken out again.
        (
            [
                clear("a", r#"after: "over""#),
                r#"Remove(pass: "a")"#.to_owned(),
                clear("b", r#"after: "over""#),
            ]
            .join(", "),
            "both.one both.two over b",
        ),
        (
            format!(
                "{}, {}",
                clear("a", r#"after: "over""#),
                clear("b", r#"instead: "a""#)
            ),
            "both.one both.two over b",
        ),
        (r#"Remove(pass: "both.two")"#.to_owned(), "both.one over"),
        (
            format!(
                r#"Remove(pass: "both"), {}"#,
                clear("a", r#"before: "over""#)
            ),
            "a over",
        ),
    ] {
        let files = extending(&format!("passes: [{edits}]"));
        let files = if edits.starts_with(r#"Remove(pass: "both")"#) {
            files.edited(
                "base.ron",
                r#"from: "first", to: "second""#,
                r#"from: "second", to: "first""#,
            )
        } else {
            files
        };
        assert_eq!(all(&files).join(" "), expected, "{edits}");
    }
}

#[test]
fn edits_that_cannot_be_made_are_told_at_their_paths() {
    let clear = |place: &str| format!(r#"Clear(name: "new", {place} target: "second")"#);
    for (edit, message) in [
        (
            r#"Change(pass: "ovr", to: "first")"#.to_owned(),
            "has no entry `ovr`",
        ),
        (
            r#"Change(pass: "both.three")"#.to_owned(),
            "has no entry `both.three`",
        ),
        (
            r#"Change(pass: "over.one")"#.to_owned(),
            "behind the interface of `over`",
        ),
        (
            r#"Change(to: "first")"#.to_owned(),
            "does not say which entry",
        ),
        (r#"Change(pass: over)"#.to_owned(), "named in quotes"),
        (
            r#"Change(pass: "both", passes: [])"#.to_owned(),
            "are changed one by one",
        ),
        (
            r#"Remove(pass: "over", to: "first")"#.to_owned(),
            "`Remove` has no such field",
        ),
        (clear(""), "a new `Clear` needs a place"),
        (
            clear(r#"before: "over", after: "both","#),
            "has several places",
        ),
        (
            clear(r#"after: "over.it","#),
            "behind the interface of `over`",
        ),
    ] {
        let diagnostics = checked(&extending(&format!("passes: [{edit}]")));
        assert_eq!(diagnostics[0].code, Code::Edit, "{edit}: {diagnostics:?}");
        assert!(
            diagnostics[0].message.contains(message),
            "{edit}: {}",
            diagnostics[0].message
        );
        assert_eq!(
            &*diagnostics[0].labels[0].span.file.name, "graph.ron",
            "{edit}"
        );
    }
    let diagnostics = checked(&extending(
        r#"passes: [Change(pass: "over", form: "first")]"#,
    ));
    assert_eq!(codes(&diagnostics), [Code::UnknownField]);
    // Edits are for documents that extend another one.
    for edit in [
        r#"Change(pass: "over", to: "first")"#.to_owned(),
        clear(r#"after: "over","#),
    ] {
        let files = Files::graph(BASE).with("fill.wgsl", FILL);
        let files = files.edited("graph.ron", "Copy(", &format!("{edit}, Copy("));
        let diagnostics = checked(&files);
        assert_eq!(diagnostics[0].code, Code::Edit, "{edit}: {diagnostics:?}");
        assert!(
            diagnostics[0].message.contains("this one extends none"),
            "{}",
            diagnostics[0].message
        );
    }
}

/// Documents extend each other in chains; each file looks for others beside itself.
#[test]
fn chains_of_documents_and_their_folders() {
    let files = Files::graph(
        r#"extends: "there/middle.ron", passes: [Change(pass: "last", set: {"value": 3})]"#,
    )
    .document(
        "there/middle.ron",
        r#"extends: "below/base.ron", passes: [
            Fullscreen(name: "last", after: "over", color: ["second"], shader: "own"),
        ]"#,
    )
    .document("there/below/base.ron", BASE)
    .with("there/own.wgsl", FILL)
    .with("there/below/fill.wgsl", FILL);
    assert_eq!(all(&files), ["both.one", "both.two", "over", "last"]);
    let cycle = files.document("there/below/base.ron", r#"extends: "../../graph.ron""#);
    assert_eq!(codes(&checked(&cycle)), [Code::MissingFile]);
    let cycle = Files::graph(r#"extends: "b.ron""#).document("b.ron", r#"extends: "graph.ron""#);
    let diagnostics = checked(&cycle);
    assert_eq!(codes(&diagnostics), [Code::IncludeCycle]);
    assert!(
        diagnostics[0]
            .help
            .as_deref()
            .unwrap_or_default()
            .contains("graph.ron"),
        "{diagnostics:?}"
    );
}

/// Two documents that extend one, included side by side: each is its own.
#[test]
fn a_diamond_of_documents() {
    let files = Files::graph(
        r#"materials: [Texture(name: "image", format: R32Float, size: 4)],
        passes: [
            Include(graph: "left.ron"), Include(graph: "right.ron"),
            Include(graph: "base.ron", name: "plain"),
            Copy(name: "copy", from: "of_left", to: "image"),
        ],
        outputs: ["image", "of_right", (name: "plain", material: "plain.second")]"#,
    )
    .document("base.ron", BASE)
    .document(
        "left.ron",
        r#"extends: "base.ron", set: {"value": 2},
        outputs: [(name: "of_left", material: "second")]"#,
    )
    .document(
        "right.ron",
        r#"extends: "base.ron", set: {"value": 3}, passes: [Remove(pass: "over")],
        outputs: [(name: "of_right", material: "second")]"#,
    )
    .with("fill.wgsl", FILL);
    assert_eq!(
        all(&files),
        [
            "left.both.one",
            "left.both.two",
            "left.over",
            "right.both.one",
            "right.both.two",
            "plain.both.one",
            "plain.both.two",
            "plain.over",
            "copy",
        ]
    );
}

/// An entry of what is included is out of reach; the whole is exchanged instead.
#[test]
fn behind_an_interface_the_whole_is_exchanged() {
    let files = |edit: &str| {
        Files::graph(&format!(r#"extends: "outer.ron", passes: [{edit}]"#))
            .document(
                "outer.ron",
                r#"materials: [Texture(name: "image", format: R32Float, size: 4)],
                passes: [
                    Include(graph: "base.ron"), Copy(name: "copy", from: "second", to: "image"),
                ],
                outputs: ["image"]"#,
            )
            .document("base.ron", BASE)
            .document(
                "mine.ron",
                r#"extends: "base.ron", passes: [Remove(pass: "both.two")]"#,
            )
            .with("fill.wgsl", FILL)
    };
    let diagnostics = checked(&files(r#"Change(pass: "base.over", to: "first")"#));
    assert_eq!(codes(&diagnostics), [Code::Edit]);
    assert!(
        diagnostics[0]
            .help
            .as_deref()
            .unwrap_or_default()
            .contains("`graph` of `base`")
    );
    let mine = files(r#"Change(pass: "base", graph: "mine.ron", name: "base")"#);
    let mine = mine.edited("outer.ron", r#"from: "second""#, r#"from: "base.second""#);
    let mine = mine.edited(
        "outer.ron",
        r#"graph: "base.ron""#,
        r#"graph: "base.ron", name: "base""#,
    );
    assert_eq!(all(&mine), ["base.both.one", "base.over", "copy"]);
}

/// The output of `show --flat` reads as the document does, and tells where each line comes from.
#[test]
fn the_flat_text_is_the_document() {
    let files = extending(
        r#"set: {"edge": 6}, passes: [
            Change(pass: "both.two", set: {"value": 7}),
            Clear(name: "new", before: "over", target: "second"),
        ]"#,
    );
    let text = right(Graph::flat("graph.ron", &Registry::default(), &files));
    let flat = files.clone().with("graph.ron", text.clone());
    assert_eq!(all(&flat), all(&files));
    assert_eq!(right(plan(&flat)).outputs(), right(plan(&files)).outputs());
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let origin = |part: &str| {
        let line = lines.iter().find(|line| line.contains(part)).expect(part);
        line.rsplit_once("// ")
            .expect("it has an origin")
            .1
            .to_owned()
    };
    assert_eq!(origin(r#"name: "first""#), "base.ron:5");
    assert_eq!(origin(r#"name: "new""#), "graph.ron:3");
    assert_eq!(origin(r#""value": 7"#), "graph.ron:2");
    // A default that an edit gives is told beside where its param is declared.
    assert_eq!(origin(r#"name: "edge""#), "base.ron:3, graph.ron:1");
    let registry = Registry::standard();
    right(Graph::load("graph.ron", &registry, &flat));
}
