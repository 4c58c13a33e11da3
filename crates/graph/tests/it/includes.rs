//! `Include`: a document is called as a shader is. Its inputs and outputs, and that nothing else
//! crosses the border.

use crate::support::{Files, Triangle, checked, codes, load, names, plan, right, wrong};
use skiagraph_graph::{Access, Code, Diagnostic, Plan, PlanRequest, SubresourceRange};

const FILL: &str = "struct Params { value: f32 } var<uniform> params: Params;
    @fragment fn fragment() -> @location(0) f32 { return params.value; }";

const LOOK: &str = "struct Params { value: f32 } var<uniform> params: Params;
    var image: texture_2d<f32>;
    @fragment fn fragment() -> @location(0) f32 {
        return params.value * textureLoad(image, vec2(0u), 0).x;
    }";

/// Asks for a texture and a number, gives a texture; keeps a texture and a number for itself.
const INNER: &str = r#"
    params: [F32(name: "value"), U32(name: "edge", default: 4, max: 64)],
    inputs: [Texture(name: "image", format: R32Float)],
    materials: [
        Texture(name: "own", format: R32Float, size: "edge"),
        Texture(name: "result", format: R32Float, size: "own.size"),
    ],
    passes: [
        Fullscreen(name: "look", color: ["own"]),
        Fullscreen(name: "again", shader: "look", color: ["result"], bind: {"image": "own"}),
    ],
    outputs: ["result"]"#;

/// `graph.ron` with a param `value`, a filled `image`, and entries below it.
fn outer(passes: &str, outputs: &str) -> Files {
    let sections = format!(
        r#"params: [F32(name: "value", default: 3)],
        materials: [
            Texture(name: "image", format: R32Float, size: 16),
            Texture(name: "other", format: R32Float, size: 16, layers: 2),
        ],
        passes: [
            Fullscreen(name: "fill", color: ["image"]),
            Clear(name: "clear", target: "other"), {passes}
        ],
        outputs: [{outputs}]"#
    );
    Files::graph(&sections)
        .document("inner.ron", INNER)
        .with("fill.wgsl", FILL)
        .with("look.wgsl", LOOK)
}

/// Returns the materials that a pass uses, by name; true for a write.
#[track_caller]
fn uses<'p>(plan: &'p Plan, name: &str) -> Vec<(&'p str, bool)> {
    let pass = plan.all_passes().iter().find(|pass| *pass.name == *name);
    let accesses = &pass
        .unwrap_or_else(|| panic!("there is no {name}"))
        .accesses;
    let used = |access: &Access| (plan.resource(access.resource).name.as_str(), access.writes);
    accesses.iter().map(used).collect()
}

/// The first number of a pass's params.
fn number(plan: &Plan, name: &str) -> f32 {
    let pass = plan.all_passes().iter().find(|pass| *pass.name == *name);
    let bytes = pass
        .expect("it is there")
        .params()
        .next()
        .flatten()
        .expect("it has params");
    f32::from_le_bytes(bytes[..4].try_into().expect("they are four"))
}

fn help(diagnostic: &Diagnostic) -> &str {
    diagnostic.help.as_deref().unwrap_or_default()
}

/// In go inputs and params without a default, by name; out come the outputs.
#[test]
fn by_name_go_inputs_and_params_and_come_outputs() {
    let files = outer(r#"Include(graph: "inner.ron")"#, r#""result""#);
    let plan = right(plan(&files));
    assert_eq!(names(&plan), ["fill", "inner.look", "inner.again"]);
    assert_eq!(
        uses(&plan, "inner.look"),
        [("image", false), ("inner.own", true)]
    );
    assert_eq!(
        uses(&plan, "inner.again"),
        [("inner.own", false), ("result", true)]
    );
    assert_eq!(number(&plan, "inner.look"), 3.0);
    assert_eq!(plan.outputs()[0].size, [4, 4]);
}

#[test]
fn bind_and_set_say_otherwise() {
    let include = r#"Include(
        graph: "inner.ron", bind: {"image": "other[1]"}, set: {"value": "value + 1", "edge": 8},
    )"#;
    let plan = right(plan(&outer(include, r#""result""#)));
    assert_eq!(
        uses(&plan, "inner.look"),
        [("other", false), ("inner.own", true)]
    );
    let look = plan
        .all_passes()
        .iter()
        .find(|pass| *pass.name == "inner.look");
    assert_eq!(look.expect("it is there").accesses[0].part.layers, 1..2);
    assert_eq!(number(&plan, "inner.look"), 4.0);
    assert_eq!(plan.outputs()[0].size, [8, 8]);
}

/// A name that is also a param with a default stays another param, until it is exposed or set.
#[test]
fn a_param_with_a_default_is_the_included_documents_own() {
    let with_edge = |include: &str| {
        outer(include, r#""result""#).edited(
            "graph.ron",
            "default: 3)",
            "default: 3), U32(name: \"width\", default: 9)",
        )
    };
    let own = with_edge(r#"Include(graph: "inner.ron")"#);
    let graph = right(load(&own));
    let params = |graph: &skiagraph_graph::Graph| {
        let names = graph.params().iter().map(|param| param.name.value.clone());
        names.collect::<Vec<_>>()
    };
    assert_eq!(params(&graph), ["value", "width"]);
    let same = own.edited("graph.ron", "width", "edge");
    assert_eq!(right(plan(&same)).outputs()[0].size, [4, 4]);
    // Exposed, it is a param here; of a named include with a dot.
    let exposed = with_edge(r#"Include(graph: "inner.ron", expose: ["edge"])"#);
    let graph = right(load(&exposed));
    assert_eq!(params(&graph), ["value", "width", "edge"]);
    let mut request = PlanRequest::new([8, 8], &Triangle);
    let value = graph.parse_param("edge", "5").expect("it is a number");
    request.params.insert("edge".to_owned(), value);
    assert_eq!(right(graph.plan(&request)).outputs()[0].size, [5, 5]);
    graph.parse_param("edge", "65").expect_err("64 is the most");
    let named = exposed
        .clone()
        .edited("graph.ron", "expose", "name: \"left\", expose");
    let named = named.edited(
        "graph.ron",
        "outputs: [\"result\"]",
        "outputs: [(name: \"result\", material: \"left.result\")]",
    );
    assert_eq!(
        params(&right(load(&named))),
        ["value", "width", "left.edge"]
    );
    // A name that is there already is told at both places.
    let twice = exposed.clone().edited("graph.ron", "width", "edge");
    let diagnostics = checked(&twice);
    assert_eq!(codes(&diagnostics), [Code::ParamValue]);
    assert_eq!(diagnostics[0].labels.len(), 2);
    let unknown = exposed.edited("graph.ron", "\"edge\"]", "\"egde\"]");
    assert_eq!(codes(&checked(&unknown)), [Code::UnknownParam]);
}

/// Settings of an include, edits (of `inner.ron` or `graph.ron`), and the code and message that
/// follow.
type Wrong<'t> = (&'t str, &'t [[&'t str; 3]], Code, &'t str);

#[track_caller]
fn assert_wrong(rows: &[Wrong<'_>]) {
    for (fields, edits, code, message) in rows {
        let include = format!(r#"Include(graph: "inner.ron"{fields})"#);
        let files = edits
            .iter()
            .fold(outer(&include, r#""result""#), |files, edit| {
                let [file, from, to] = *edit;
                files.edited(file, from, to)
            });
        let diagnostics = checked(&files);
        assert_eq!(diagnostics[0].code, *code, "{message}: {diagnostics:?}");
        assert_eq!(diagnostics[0].message, *message);
    }
}

const INNER_IMAGE: &str = r#"inputs: [Texture(name: "image", format: R32Float)"#;
const INNER_VALUE: &str = r#"F32(name: "value")"#;
const OUTER_OUTPUTS: &str = r#"outputs: ["result"]"#;

#[test]
fn an_input_is_of_the_kind_and_format_that_is_asked_for() {
    assert_wrong(&[
        (
            "",
            &[
                ["graph.ron", r#"name: "image""#, r#"name: "picture""#],
                ["graph.ron", r#"color: ["image"]"#, r#"color: ["picture"]"#],
            ],
            Code::Input,
            "`inner.ron` asks for `image`, a texture R32Float",
        ),
        (
            "",
            &[[
                "inner.ron",
                INNER_IMAGE,
                r#"inputs: [Texture(name: "image", format: R32Uint)"#,
            ]],
            Code::Input,
            "`inner.ron` asks for `image`, a texture R32Uint; here it is a texture R32Float",
        ),
        (
            "",
            &[[
                "inner.ron",
                INNER_IMAGE,
                r#"inputs: [Buffer(name: "image")"#,
            ]],
            Code::Input,
            "`inner.ron` asks for `image`, a buffer; here it is a texture R32Float",
        ),
        (
            "",
            &[
                ["inner.ron", r#"color: ["own"]"#, r#"color: ["image"]"#],
                ["inner.ron", r#"bind: {"image": "own"}"#, r#"bind: {}"#],
                ["inner.ron", r#"shader: "look""#, r#"shader: "fill""#],
                [
                    "inner.ron",
                    r#"name: "look""#,
                    r#"name: "look", shader: "fill""#,
                ],
            ],
            Code::Input,
            "the input `image` is written, but is not an output",
        ),
    ]);
}

#[test]
fn a_param_goes_where_all_of_its_values_may() {
    assert_wrong(&[
        (
            "",
            &[[
                "inner.ron",
                INNER_VALUE,
                r#"F32(name: "weight"), F32(name: "value", default: 1)"#,
            ]],
            Code::ParamValue,
            "`inner.ron` asks for the param `weight`",
        ),
        (
            "",
            &[["inner.ron", INNER_VALUE, r#"F32(name: "value", max: 2)"#]],
            Code::ParamValue,
            "`value` (f32) is handed to `value` (f32, 2 at most)",
        ),
        (
            "",
            &[
                ["graph.ron", r#"F32(name: "value""#, r#"U32(name: "value""#],
                [
                    "graph.ron",
                    r#"Fullscreen(name: "fill", color: ["image"])"#,
                    FILLED,
                ],
            ],
            Code::ParamValue,
            "`value` (u32) is handed to `value` (f32)",
        ),
        (
            r#", set: {"edge": 65}"#,
            &[],
            Code::ParamValue,
            "the value for param `edge` does not fit",
        ),
    ]);
}

const FILLED: &str = r#"Clear(name: "fill", target: "image")"#;

#[test]
fn nothing_else_crosses_the_border() {
    let output = |material: &'static str| ["graph.ron", OUTER_OUTPUTS, material];
    assert_wrong(&[
        (
            r#", bind: {"own": "image"}"#,
            &[],
            Code::Unused,
            "`inner.ron` has no input, output or param `own`",
        ),
        (
            r#", set: {"vlaue": 1}"#,
            &[],
            Code::Unused,
            "`inner.ron` has no input, output or param `vlaue`",
        ),
        (
            "",
            &[output(r#"outputs: ["own"]"#)],
            Code::UnknownResource,
            "unknown material `own`",
        ),
        (
            r#", name: "left""#,
            &[output(r#"outputs: [(name: "own", material: "left.own")]"#)],
            Code::UnknownResource,
            "`left` gives no `own`",
        ),
        (
            "",
            &[[
                "inner.ron",
                r#"{"image": "own"}"#,
                r#"{"image": "other[0]"}"#,
            ]],
            Code::UnknownResource,
            "unknown material `other`",
        ),
    ]);
}

/// An included document is judged by its outputs as any other is.
#[test]
fn outputs_of_an_included_document_are_real() {
    let files = outer(r#"Include(graph: "inner.ron")"#, r#""image""#);
    for (outputs, code) in [
        (r#"["nothing"]"#, Code::UnknownResource),
        (
            r#"["result", (name: "more", material: "nothing")]"#,
            Code::UnknownResource,
        ),
        (r#"["result", "own.mip[3]"]"#, Code::Range),
        (r#"["result", "unwritten"]"#, Code::Output),
        (r#"[4]"#, Code::Syntax),
        (r#""result""#, Code::Syntax),
        (r#"["result", "result"]"#, Code::DuplicateName),
        (r#"["result", "value"]"#, Code::UnknownResource),
    ] {
        let files = files
            .clone()
            .edited(
                "inner.ron",
                r#"outputs: ["result"]"#,
                &format!("outputs: {outputs}"),
            )
            .edited(
                "inner.ron",
                "materials: [",
                r#"materials: [Texture(name: "unwritten", format: R32Float),"#,
            );
        let diagnostics = checked(&files);
        assert!(!diagnostics.is_empty(), "{outputs}");
        assert_eq!(diagnostics[0].code, code, "{outputs}: {diagnostics:?}");
        assert_eq!(
            &*diagnostics[0].labels[0].span.file.name, "inner.ron",
            "{outputs}"
        );
    }
}

/// An output that is bound is written into that material instead of its own.
#[test]
fn a_bound_output_is_written_into_what_it_is_bound_to() {
    let include = r#"Include(graph: "inner.ron", bind: {"result": "other[1]"}, set: {"edge": 16})"#;
    let files = outer(include, r#""other""#);
    let plan = right(plan(&files));
    assert_eq!(names(&plan), ["fill", "clear", "inner.look", "inner.again"]);
    assert_eq!(
        uses(&plan, "inner.again"),
        [("inner.own", false), ("other", true)]
    );
    let expected = SubresourceRange {
        mips: 0..1,
        layers: 1..2,
        aspect: Default::default(),
    };
    let again = plan
        .all_passes()
        .iter()
        .find(|pass| *pass.name == "inner.again");
    assert_eq!(again.expect("it is there").accesses[1].part, expected);
    assert!(
        !plan
            .resources()
            .iter()
            .any(|resource| resource.name == "result")
    );
    let wrong_kind = files
        .edited("graph.ron", "other[1]\"}", "buffer\"}")
        .edited(
            "graph.ron",
            "materials: [",
            "materials: [Buffer(name: \"buffer\"),",
        );
    assert_eq!(codes(&checked(&wrong_kind))[0], Code::Output);
}

/// One document several times, each under a name of its own; each repetition under its number.
#[test]
fn a_name_for_each() {
    let left = r#"Include(graph: "inner.ron", name: "left", set: {"value": 1}),
        Include(
            graph: "inner.ron", name: "right", bind: {"image": "left.result"}, set: {"value": 2},
        ),
        Include(
            graph: "inner.ron", name: "lamp", repeat: 2,
            set: {"value": "index", "edge": "index + 1"},
        ),"#;
    let outputs =
        r#"(name: "end", material: "right.result"), (name: "lamp", material: "lamp[1].result")"#;
    let named_plan = right(plan(&outer(left, outputs)));
    assert_eq!(
        uses(&named_plan, "right.look"),
        [("left.result", false), ("right.own", true)]
    );
    assert_eq!(
        uses(&named_plan, "lamp[1].again"),
        [("lamp[1].own", false), ("lamp[1].result", true)]
    );
    assert_eq!(number(&named_plan, "left.look"), 1.0);
    assert_eq!(number(&named_plan, "lamp[1].look"), 1.0);
    assert_eq!(named_plan.outputs()[1].size, [2, 2]);
    assert!(
        !names(&named_plan).contains(&"lamp[0].look".to_owned()),
        "no output needs it"
    );
    // Twice without names gives one name twice.
    let twice = outer(
        r#"Include(graph: "inner.ron"), Include(graph: "inner.ron")"#,
        r#""result""#,
    );
    let errors = wrong(plan(&twice));
    assert!(
        codes(errors.iter())
            .iter()
            .all(|code| *code == Code::DuplicateName),
        "{errors}"
    );
    let out = outer(left, &outputs.replace("lamp[1]", "lamp[2]"));
    assert_eq!(codes(&checked(&out)), [Code::Range]);
    let whole = outer(left, &outputs.replace("lamp[1].result", "lamp"));
    assert_eq!(codes(&checked(&whole)), [Code::ResourceKind]);
}

/// Names of the scene are known in every document, and may be replaced there and below.
#[test]
fn what_the_scene_gives_is_known_everywhere_and_may_be_replaced() {
    let shader = "struct Light { @size(256) bits: vec4<u32> } var<uniform> light: Light;
        @fragment fn fragment() -> @location(0) f32 { return f32(light.bits.x); }";
    let files = |bind: &str| {
        let sections =
            format!(r#"passes: [Include(graph: "middle.ron"{bind})], outputs: ["image"]"#);
        Files::graph(&sections)
            .document(
                "middle.ron",
                r#"passes: [Include(graph: "lit.ron")], outputs: ["image"]"#,
            )
            .document(
                "lit.ron",
                r#"materials: [Texture(name: "image", format: R32Float)],
                passes: [Fullscreen(name: "shine", color: ["image"])], outputs: ["image"]"#,
            )
            .with("shine.wgsl", shader)
    };
    let bound = |files: &Files| {
        let graph = right(load(files));
        let plan = right(graph.plan(&PlanRequest::new([8, 8], &Triangle)));
        let access = plan.all_passes()[0]
            .accesses
            .iter()
            .find(|access| access.reads && !access.writes)
            .expect("it reads a light")
            .clone();
        let name = plan.resource(access.resource).name.clone();
        (
            plan.all_passes()[0].name.value.clone(),
            name,
            access.part.items(),
        )
    };
    let shine = "middle.lit.shine".to_owned();
    assert_eq!(bound(&files("")), (shine.clone(), "light".to_owned(), None));
    let other = bound(&files(r#", bind: {"light": "lights[2]"}"#));
    assert_eq!(other, (shine, "lights".to_owned(), Some(2..3)));
    let unknown = checked(&files(r#", bind: {"lihgt": "lights[2]"}"#));
    assert_eq!(codes(&unknown), [Code::Unused]);
    assert_eq!(
        codes(&checked(&files(r#", bind: {"light": "lights[3]"}"#))),
        [Code::Range]
    );
}

/// A document that is included passes `check` by itself: no includer is there to answer, so inputs
/// are as it declares them, and params as they may be.
#[test]
fn an_included_document_is_checked_alone() {
    let alone = |sections: &str| Files::graph(sections).with("look.wgsl", LOOK);
    assert_eq!(checked(&alone(INNER)).len(), 0);
    // To be run it needs the host's image.
    let errors = wrong(plan(&alone(INNER)));
    assert_eq!(codes(errors.iter()), [Code::Input]);
    assert!(help(errors.iter().next().expect("there is one")).contains("let the host import it"));
    let any = INNER.replace(r#""image", format: R32Float"#, r#""image""#);
    assert_eq!(checked(&alone(&any)).len(), 0);
}

/// The path is looked for beside the document, then in `pipelines/`, and leads out of neither.
#[test]
fn where_documents_are_looked_for() {
    let include = |path: &str| outer(&format!(r#"Include(graph: "{path}")"#), r#""result""#);
    let beside = include("below/inner.ron").document("below/inner.ron", INNER);
    let beside = beside.with("below/look.wgsl", LOOK);
    assert_eq!(checked(&beside).len(), 1, "`clear` is needed by nothing");
    let built_in = include("far.ron").document("pipelines/far.ron", INNER);
    assert_eq!(checked(&built_in.with("shaders/look.wgsl", LOOK)).len(), 1);
    for path in ["../inner.ron", "/inner.ron", "below/../inner.ron", "inner"] {
        let diagnostics = checked(&include(path));
        assert_eq!(
            diagnostics[0].code,
            Code::MissingFile,
            "{path}: {diagnostics:?}"
        );
    }
    let unnamed = include("My-Graph.ron").document("My-Graph.ron", INNER);
    assert_eq!(codes(&checked(&unnamed)), [Code::Name]);
    let circle = include("inner.ron").document(
        "inner.ron",
        r#"passes: [Include(graph: "graph.ron")], outputs: ["result"]"#,
    );
    assert_eq!(codes(&checked(&circle)), [Code::IncludeCycle]);
}
