//! Documents made of documents: names, params, repeats and features, without a GPU. (What comes out
//! on a device: `crates/gpu/tests/it/compose.rs`.)

use crate::support::{self, Files, Triangle, codes, load, names, right, wrong};
use skiagraph_graph::{
    Code, Diagnostics, Graph, NoProvider, ParamValue, Plan, PlanRequest, Registry,
};

/// Writes `value`, a param; `smooth` reads the `image` of its document.
const SHADERS: [(&str, &str); 4] = [
    (
        "shaders/fill.wgsl",
        "struct Params { value: f32 } var<uniform> params: Params;
         @fragment fn fragment() -> @location(0) f32 { return params.value; }",
    ),
    (
        "shaders/one.wgsl",
        "@fragment fn fragment() -> @location(0) f32 { return 1.0; }",
    ),
    (
        "shaders/smooth.wgsl",
        "var image: texture_2d<f32>;
         @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) f32 {
             return textureLoad(image, vec2<u32>(at.xy), 0).x;
         }",
    ),
    (
        "shaders/number.wgsl",
        "override index: u32;
         @fragment fn fragment() -> @location(0) f32 { return 10.0 + f32(index); }",
    ),
];

/// Two materials, two passes, two params.
const INNER: &str = r#"
    params: [
        F32(name: "value", default: 1, min: 0, max: 100),
        U32(name: "edge", default: 4),
    ],
    materials: [
        Texture(name: "image", format: R32Float, size: "edge"),
        Texture(name: "result", format: R32Float, size: "image.size"),
    ],
    passes: [
        Fullscreen(name: "fill", color: ["image"]),
        Fullscreen(name: "smooth", color: ["result"]),
    ],
    outputs: ["result", "image"],
"#;

/// Document that reads the `image` that it is given.
const SMOOTHER: &str = r#"
    inputs: [Texture(name: "image")],
    materials: [Texture(name: "copy", format: "image.format", size: "image.size")],
    passes: [Fullscreen(name: "smooth", color: ["copy"])],
    outputs: ["copy"],
"#;

fn files(materials: &str, passes: &str, outputs: &str) -> Files {
    let sections = format!(
        "params: [U32(name: \"n\", default: 2), F32(name: \"value\", default: 7)],
         materials: [{materials}], passes: [{passes}], outputs: [{outputs}]"
    );
    Files::new(SHADERS)
        .document("pipelines/graph.ron", &sections)
        .document("pipelines/shared/inner.ron", INNER)
        .document("pipelines/shared/smoother.ron", SMOOTHER)
}

fn graph(files: &Files) -> Result<Graph, Diagnostics> {
    Graph::load("pipelines/graph.ron", &Registry::standard(), files)
}

fn plan_with(files: &Files, n: Option<u32>) -> Result<Plan, Diagnostics> {
    let mut request = PlanRequest::new([8, 8], &NoProvider);
    let n = n.map(|n| ("n".to_owned(), ParamValue::U32(n)));
    request.params.extend(n);
    graph(files)?.plan(&request)
}

fn plan(files: &Files) -> Plan {
    right(plan_with(files, None))
}

/// Name and width of each output.
fn widths(plan: &Plan) -> Vec<(String, u32)> {
    let outputs = plan.outputs().into_iter();
    outputs
        .map(|output| (output.name, output.size[0]))
        .collect()
}

/// A document of the viewport's size.
const OWN: &str = r#"Texture(name: "own", format: R32Float)"#;

/// Point of the case, materials, passes, outputs; then the live passes and the width of the output.
type Case<'a> = (&'a str, &'a str, &'a str, &'a str, &'a [&'a str], u32);

const CASES: &[Case<'_>] = &[
    (
        "what an include without a name gives is known as it is",
        "",
        r#"Include(graph: "shared/inner.ron")"#,
        r#""result""#,
        &["inner.fill", "inner.smooth"],
        4,
    ),
    (
        "behind its name",
        "",
        r#"Include(graph: "shared/inner.ron", name: "eye", set: {"edge": 16})"#,
        r#"(name: "out", material: "eye.result")"#,
        &["eye.fill", "eye.smooth"],
        16,
    ),
    (
        "found in the store's pipelines, dots in the path",
        "",
        r#"Include(graph: "./shared/./inner.ron", name: "eye", set: {"edge": "n"})"#,
        r#"(name: "out", material: "eye.result")"#,
        &["eye.fill", "eye.smooth"],
        2,
    ),
    (
        "an output that is bound: the outer declaration counts",
        OWN,
        r#"Include(graph: "shared/inner.ron", name: "eye", bind: {"result": "own"})"#,
        r#""own""#,
        &["eye.fill", "eye.smooth"],
        8,
    ),
    (
        "one feeds the other, with an output that it was not said which to give",
        "",
        r#"Include(graph: "shared/inner.ron", name: "a"),
           Include(graph: "shared/smoother.ron", name: "b", bind: {"image": "a.result"})"#,
        r#"(name: "b", material: "b.copy")"#,
        &["a.fill", "a.smooth", "b.smooth"],
        4,
    ),
    (
        "an input found by its name, and what is not needed of the other",
        "",
        r#"Include(graph: "shared/inner.ron"), Include(graph: "shared/smoother.ron")"#,
        r#""copy""#,
        &["inner.fill", "smoother.smooth"],
        4,
    ),
    (
        "a pass of one's own between",
        OWN,
        r#"Include(graph: "shared/inner.ron", name: "a"), Fullscreen(name: "read",
           shader: "smooth", bind: {"image": "a.result"}, color: ["own"])"#,
        r#""own""#,
        &["a.fill", "a.smooth", "read"],
        8,
    ),
    (
        "a global found by its spelling",
        OWN,
        r#"Include(graph: "shared/inner.ron", name: "a"),
           Fullscreen(name: "spelt", color: ["own"])"#,
        r#""own""#,
        &["a.fill", "a.smooth", "spelt"],
        8,
    ),
    (
        "in a group",
        "",
        r#"Group(name: "g", passes: [Include(graph: "shared/inner.ron"),
           Fullscreen(name: "again", shader: "smooth", color: ["result"])])"#,
        r#""result""#,
        &["g.inner.fill", "g.again"],
        4,
    ),
    (
        "repeated",
        OWN,
        r#"Include(graph: "shared/inner.ron", name: "a", repeat: "n"), Fullscreen(name: "read",
           shader: "smooth", bind: {"image": "a[1].result"}, color: ["own"])"#,
        r#""own""#,
        &["a[1].fill", "a[1].smooth", "read"],
        8,
    ),
    (
        "a document whose output is called as its file is",
        "",
        r#"Include(graph: "shared/copy.ron")"#,
        r#""copy""#,
        &["copy.one"],
        8,
    ),
];

/// Names that an include makes: passes in order, and the width of the output.
#[test]
fn names_and_sizes_of_includes() {
    let copy = r#"materials: [Texture(name: "copy", format: R32Float)],
        passes: [Fullscreen(name: "one", color: ["copy"])], outputs: ["copy"]"#;
    for (what, materials, passes, outputs, expected, width) in CASES {
        let files = files(materials, passes, outputs)
            .document("pipelines/shared/copy.ron", copy)
            .with(
                "shaders/spelt.wgsl",
                "var a_result: texture_2d<f32>;
                 @fragment fn fragment() -> @location(0) f32 {
                     return textureLoad(a_result, vec2(0u), 0).x;
                 }",
            );
        let plan = plan_with(&files, None).unwrap_or_else(|errors| panic!("{what}:\n{errors}"));
        assert_eq!(names(&plan), *expected, "{what}");
        assert_eq!(plan.outputs()[0].size, [*width, *width], "{what}");
        let warnings = right(graph(&files)).warnings().len();
        let unused = usize::from(!passes.contains("\"n\"")) + 1;
        assert_eq!(
            warnings, unused,
            "{what}: params of this document that nothing uses"
        );
    }
}

/// ```text
/// graph.ron ─ a ▶ middle.ron ─▶ inner.ron: what is `image` in both is `mine` outside
/// ```
#[test]
fn what_is_bound_goes_through_every_level() {
    let middle = r#"
        passes: [Include(graph: "inner.ron"), Include(graph: "inner.ron", name: "b")],
        outputs: ["result", "image", (name: "b", material: "b.result")]"#;
    let outer = r#"
        Include(graph: "shared/middle.ron", name: "a", bind: {"image": "mine", "b": "other"}),
        Include(graph: "shared/middle.ron", name: "c")"#;
    let outputs = r#""mine", "other", (name: "light", material: "a.result"),
        (name: "b", material: "c.b"), (name: "c", material: "c.image")"#;
    let materials = r#"Texture(name: "mine", format: R32Float, size: 16),
        Texture(name: "other", format: R32Float)"#;
    let files = files(materials, outer, outputs).document("pipelines/shared/middle.ron", middle);
    let plan = plan(&files);
    let expected = [
        ("mine", 16),
        ("other", 8),
        ("light", 16),
        ("b", 4),
        ("c", 4),
    ];
    assert_eq!(
        widths(&plan),
        expected.map(|(name, width)| (name.to_owned(), width)),
        "a.result is as large as the image that it is like"
    );
    let of_a = names(&plan)
        .into_iter()
        .filter(|name| name.starts_with("a."));
    let expected = ["a.inner.fill", "a.inner.smooth", "a.b.fill", "a.b.smooth"];
    assert_eq!(of_a.collect::<Vec<_>>(), expected);
}

/// An included document sees only the names that it asks for. Its own declarations stay its own,
/// even if their names are used outside.
#[test]
fn nothing_else_crosses_the_border() {
    let user = r#"materials: [Texture(name: "copy", format: R32Float)],
        passes: [Fullscreen(name: "smooth", color: ["copy"])], outputs: ["copy"]"#;
    let image = r#"Texture(name: "image", format: R32Float)"#;
    let user_in = |user: &str| {
        let passes = r#"Fullscreen(name: "fill", color: ["image"]),
            Include(graph: "user.ron", name: "near")"#;
        let outputs = r#"(name: "near", material: "near.copy")"#;
        files(image, passes, outputs).document("pipelines/user.ron", user)
    };
    let errors = wrong(plan_with(&user_in(user), None));
    assert_eq!(codes(errors.iter()), [Code::UnknownResource], "{errors}");
    let asking = format!(r#"inputs: [Texture(name: "image")], {user}"#);
    let asking = plan(&user_in(&asking));
    assert_eq!(names(&asking), ["fill", "near.smooth"]);
    let shadowing = r#"
        materials: [
            Texture(name: "image", format: R32Float, size: 2),
            Texture(name: "copy", format: R32Float, size: "image.size"),
        ],
        passes: [
            Fullscreen(name: "one", color: ["image"]),
            Fullscreen(name: "smooth", color: ["copy"]),
        ],
        outputs: ["copy"]"#;
    let shadowing = plan(&user_in(shadowing));
    assert_eq!(names(&shadowing), ["near.one", "near.smooth"]);
    assert_eq!(shadowing.outputs()[0].size, [2, 2]);
}

/// `.previous` and run conditions mean what they mean where they are written.
#[test]
fn history_and_conditions_in_an_include() {
    let inner = r#"
        params: [Bool(name: "on", default: true)],
        materials: [
            Texture(name: "image", format: R32Float),
            Texture(name: "result", format: R32Float),
        ],
        passes: [
            Fullscreen(name: "smooth", bind: {"image": "result.previous"}, color: ["image"],
                run: When("on")),
            Copy(name: "keep", from: "image", to: "result", run: When("on")),
        ],
        outputs: ["image", "result"]"#;
    let plan = |condition: &str| {
        let outer = format!(
            r#"params: [Bool(name: "outer", default: true), Bool(name: "on", default: true)],
            passes: [
                Include(graph: "shared/inner.ron", name: "it", set: {{"on": "outer"}}),
                Fullscreen(name: "one", color: [(target: "it.image", load: Load)],
                    run: When("{condition}")),
            ],
            outputs: [(name: "image", material: "it.image")]"#
        );
        let files = Files::new(SHADERS)
            .document("pipelines/graph.ron", &outer)
            .document("pipelines/shared/inner.ron", inner);
        plan_with(&files, None)
    };
    assert_eq!(
        names(&right(plan("outer"))),
        ["it.smooth", "it.keep", "one"]
    );
    // The inner `on` is not the outer one: two writers of one material would run apart.
    let errors = wrong(plan("on"));
    assert!(
        codes(errors.iter()).contains(&Code::RunCondition),
        "{errors}"
    );
}

/// A name of the scene can stand for an input of an included document.
#[test]
fn an_input_is_bound_to_what_the_scene_gives() {
    let inner = r#"
        inputs: [Buffer(name: "indices")],
        materials: [Buffer(name: "sum", count: 1)],
        passes: [
            Clear(name: "reset", target: "indices"),
            Compute(name: "add", dispatch: Groups(1, 1, 1)),
        ],
        outputs: ["indices", "sum"]"#;
    let outer = r#"
        materials: [Buffer(name: "own", count: 3)],
        passes: [Include(graph: "inner.ron", name: "it", bind: {"indices": "own"})],
        outputs: [(name: "sum", material: "it.sum")]"#;
    let add = "var<storage, read> indices: array<u32>;
        var<storage, read_write> sum: array<u32>;
        @compute @workgroup_size(1) fn main() { sum[0] = indices[1]; }";
    let own = Files::graph(outer)
        .document("inner.ron", inner)
        .with("add.wgsl", add);
    let provided = |files: &Files| {
        let plan = load(files)?.plan(&PlanRequest::new([8, 8], &Triangle))?;
        Ok::<_, Diagnostics>(plan.provided().join(" "))
    };
    assert_eq!(right(provided(&own)), "");
    let bound = own
        .edited(
            "graph.ron",
            r#""indices": "own""#,
            r#""indices": "scene.indices""#,
        )
        .edited("graph.ron", r#"Buffer(name: "own", count: 3)"#, "");
    // The host's buffer is only there to be read, so the included document must not clear it.
    let errors = wrong(provided(&bound)).to_string();
    assert!(errors.contains("`indices` cannot be cleared"), "{errors}");
    let clear = r#"Clear(name: "reset", target: "indices"),"#;
    let reading = bound.edited("inner.ron", clear, "").edited(
        "inner.ron",
        r#"["indices", "sum"]"#,
        r#"["sum"]"#,
    );
    assert_eq!(right(provided(&reading)), "scene.indices");
}

/// Shaders are looked for beside the document that names them.
#[test]
fn two_documents_have_shaders_of_one_name() {
    let inner = r#"materials: [Buffer(name: "items", count: 2)],
        passes: [Compute(name: "work", dispatch: Over("items.count"))], outputs: ["items"]"#;
    let outer = r#"
        passes: [
            Include(graph: "a/inner.ron", name: "a"),
            Include(graph: "b/inner.ron", name: "b"),
        ],
        outputs: [(name: "a", material: "a.items"), (name: "b", material: "b.items")]"#;
    let shader = |item: &str| {
        format!(
            "var<storage, read_write> items: array<{item}>;
             @compute @workgroup_size(1) fn main() {{ items[0] = {item}(1); }}"
        )
    };
    let files = Files::graph(outer)
        .document("a/inner.ron", inner)
        .document("b/inner.ron", inner)
        .with("a/work.wgsl", shader("u32"))
        .with("b/work.wgsl", shader("vec4<u32>"));
    // Layouts come from the shaders, so the sizes say which one was found.
    let plan = right(support::plan(&files));
    let sizes: Vec<u32> = plan.outputs().iter().map(|output| output.size[0]).collect();
    assert_eq!(sizes, [8, 32]);
}

#[test]
fn repeats_follow_their_param() {
    let files = files(
        r#"Texture(name: "maps", format: R32Float, size: 4, layers: 4),
           Texture(name: "last", format: R32Float, size: 4)"#,
        r#"Clear(name: "reset", target: "maps"),
           Group(name: "cascade", repeat: "n", passes: [
               Fullscreen(name: "number", color: ["maps[index]"]),
               Include(graph: "shared/inner.ron", bind: {"image": "maps[index]"}),
               Fullscreen(name: "twice", shader: "number", repeat: 2,
                   color: [(target: "maps[0]", load: Load)]),
           ]),
           Fullscreen(name: "smooth", bind: {"image": "maps[3]"}, color: ["last"])"#,
        r#""maps", "last", (name: "layer", material: "maps[2]")"#,
    );
    let passes = |n| {
        let plan = right(plan_with(&files, Some(n)));
        names(&plan).len() + plan.culled().len()
    };
    assert_eq!([0, 1, 4].map(passes), [2, 7, 22]);
    let plan = right(plan_with(&files, Some(2)));
    let mut twice = names(&plan);
    twice.retain(|name| name.contains("twice"));
    assert_eq!(
        twice,
        [
            "cascade[0].twice[0]",
            "cascade[0].twice[1]",
            "cascade[1].twice[0]",
            "cascade[1].twice[1]"
        ]
    );
    let errors = wrong(plan_with(&files, Some(5))).to_string();
    assert!(
        errors.contains("its layers are [0] to [3], this is [4]"),
        "{errors}"
    );
    assert_eq!(plan.outputs()[2].size, [4, 4]);
}

const SUBGROUP: wgt::Features = wgt::Features::SUBGROUP;

/// A param whose default asks for a feature, here and in an included document.
#[test]
fn a_missing_feature_changes_defaults() {
    let inner = r#"
        params: [U32(name: "edge", default: "has(SUBGROUP) ? 8 : 2")],
        materials: [Texture(name: "image", format: R32Float, size: "edge")],
        passes: [Fullscreen(name: "one", color: ["image"])],
        outputs: ["image"]"#;
    let outer = r#"
        params: [U32(name: "edge", default: "has(SUBGROUP) ? 16 : 4")],
        passes: [
            Include(graph: "inner.ron", name: "own"),
            Include(graph: "inner.ron", name: "given", set: {"edge": "edge"}),
        ],
        outputs: [(name: "own", material: "own.image"), (name: "given", material: "given.image")]"#;
    let files = Files::new(SHADERS)
        .document("inner.ron", inner)
        .document("graph.ron", outer);
    let graph = right(load(&files));
    assert_eq!(graph.features(), SUBGROUP);
    let edges = |features, edge: Option<u32>| {
        let mut request = PlanRequest::new([8, 8], &NoProvider);
        request.features = features;
        let edge = edge.map(|edge| ("edge".to_owned(), ParamValue::U32(edge)));
        request.params.extend(edge);
        let plan = right(graph.plan(&request));
        plan.outputs()
            .iter()
            .map(|output| output.size[0])
            .collect::<Vec<_>>()
    };
    let none = wgt::Features::empty();
    assert_eq!(edges(SUBGROUP, None), [8, 16]);
    assert_eq!(edges(none, None), [2, 4]);
    // A value that is asked for by name is not replaced in silence.
    assert_eq!(edges(none, Some(6)), [2, 6]);
    assert_eq!(edges(SUBGROUP, Some(6)), [8, 6]);
}

/// A feature that a document cannot do without is required of its includer, too.
#[test]
fn a_required_feature_is_required_of_the_whole() {
    let needs = r#"requires: ["SUBGROUP"], materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "one", color: ["image"])], outputs: ["image"]"#;
    let outer = |condition: &str| {
        let sections = format!(
            r#"materials: [Texture(name: "own", format: R32Float)],
            passes: [
                Fullscreen(name: "one", color: ["own"]),
                Include(graph: "needs.ron", if: "{condition}"),
            ],
            outputs: ["own"]"#
        );
        let files = Files::new(SHADERS).document("needs.ron", needs);
        right(load(&files.document("graph.ron", &sections)))
    };
    let request = PlanRequest::new([8, 8], &NoProvider);
    let always = outer("true");
    assert_eq!(always.features(), SUBGROUP);
    assert_eq!(codes(wrong(always.plan(&request)).iter()), [Code::Feature]);
    // Where it is not there, it needs nothing.
    right(outer("has(SUBGROUP)").plan(&request));
}

/// The root of documents `d1.ron` and on.
fn root(passes: &str) -> Files {
    Files::new(SHADERS).document(
        "graph.ron",
        &format!(
            r#"materials: [Texture(name: "image", format: R32Float)],
            passes: [Fullscreen(name: "one", color: ["image"]), {passes}], outputs: ["image"]"#
        ),
    )
}

#[test]
fn includes_that_go_wild_are_stopped() {
    // Each includes the next one twice: 2^60 in all.
    let twice = |next: u32| {
        format!(
            r#"Include(graph: "d{next}.ron", name: "a"), Include(graph: "d{next}.ron", name: "b")"#
        )
    };
    let mut doubling = root(&twice(1)).document("d60.ron", "");
    for level in 1..60 {
        let passes = format!("passes: [{}]", twice(level + 1));
        doubling = doubling.document(&format!("d{level}.ron"), &passes);
    }
    let text = wrong(support::plan(&doubling)).to_string();
    assert!(text.contains("more than 16384 passes"), "{text}");
    // A chain, read from the outermost inwards, and from the innermost outwards, so that none of
    // them is deep when it is read.
    let mut includes = String::new();
    let mut backwards = Files::default();
    for level in (1..80).rev() {
        includes += &format!(r#"Include(graph: "d{level}.ron", name: "p{level}"), "#);
        let passes = match level {
            79 => String::new(),
            _ => format!(r#"passes: [Include(graph: "d{}.ron")]"#, level + 1),
        };
        backwards = backwards.document(&format!("d{level}.ron"), &passes);
    }
    for start in [r#"Include(graph: "d1.ron")"#, &includes] {
        let mut chain = root(start);
        chain.texts.extend(backwards.texts.clone());
        let text = wrong(load(&chain)).to_string();
        assert!(text.contains("more than 64 deep"), "{text}");
        assert_eq!(text.matches("error[").count(), 1, "{text}");
    }
}
