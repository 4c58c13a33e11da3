//! Documents made of documents: names, params, repeats and features, without a GPU; then on the
//! device.

mod support;

use skiagraph_graph::{
    Capture, Code, Content, Diagnostics, Executor, Frame, Graph, NoProvider, ParamValue, Plan,
    PlanRequest, Registry, gpu,
};
use std::{collections::BTreeMap, sync::LazyLock};
use support::{Files, Triangle, load};

/// Writes `value`, a param, into a texture of `edge`² texels; `smooth` reads the nearest of its
/// scope's `image`.
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
         @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) f32 { return textureLoad(image, vec2<u32>(at.xy), 0).x; }",
    ),
    (
        "shaders/number.wgsl",
        "override index: u32;
         @fragment fn fragment() -> @location(0) f32 { return 10.0 + f32(index); }",
    ),
];

/// Two materials, two passes, three params.
const INNER: &str = r#"(
    format: 1,
    params: [
        (name: "value", type: F32, default: 1, min: 0, max: 100),
        (name: "edge", type: U32, default: 4),
        (name: "kept", type: Bool, default: true),
    ],
    materials: [
        Texture(name: "image", format: R32Float, size: Square(Param("edge"))),
        Texture(name: "result", format: R32Float, size: Like("image")),
    ],
    passes: [
        Fullscreen(name: "fill", color: [(target: "image")]),
        Fullscreen(name: "smooth", color: [(target: "result")]),
    ],
    outputs: [(name: "result")],
)"#;

fn files(materials: &str, passes: &str, outputs: &str) -> Files {
    let document = format!(
        "(format: 1, params: [(name: \"n\", type: U32, default: 2), (name: \"value\", type: F32, \
         default: 7)], \
         materials: [{materials}], passes: [{passes}], outputs: [{outputs}])"
    );
    Files::new(SHADERS)
        .with("pipelines/graph.ron", document)
        .with("pipelines/shared/inner.ron", INNER)
}

fn graph(files: &Files) -> Result<Graph, Diagnostics> {
    Graph::load("pipelines/graph.ron", &Registry::standard(), files)
}

fn plan_with(files: &Files, n: Option<u32>) -> Result<Plan, Diagnostics> {
    let mut request = PlanRequest::new([8, 8], &NoProvider);
    if let Some(n) = n {
        request.params.insert("n".to_owned(), ParamValue::U32(n));
    }
    graph(files)?.plan(&request)
}

fn names(plan: &Plan) -> Vec<String> {
    plan.passes().into_iter().map(|pass| pass.name).collect()
}

const TEXTURE: &str = "format: R32Float, size: Viewport";

/// What an include makes of names: passes in order, and the edge of the output.
#[test]
fn names_and_sizes_of_includes() {
    /// What it shows, materials, passes, outputs; then the live passes and the edge of the first
    /// output.
    type Case<'a> = (&'a str, &'a str, &'a str, &'a str, &'a [&'a str], u32);
    let cases: &[Case<'_>] = &[
        (
            "joined",
            "",
            r#"Include(graph: "shared/inner.ron")"#,
            r#"(name: "result")"#,
            &["fill", "smooth"],
            4,
        ),
        (
            "below a prefix",
            "",
            r#"Include(graph: "shared/inner.ron", prefix: "eye", params: {"edge": 16})"#,
            r#"(name: "out", material: "eye.result")"#,
            &["eye.fill", "eye.smooth"],
            16,
        ),
        (
            "found in the store's pipelines, dots in the path",
            "",
            r#"Include(graph: "./shared/./inner.ron", prefix: "eye", params: {"edge": Param("n")})"#,
            r#"(name: "out", material: "eye.result")"#,
            &["eye.fill", "eye.smooth"],
            2,
        ),
        (
            "renamed: the inner declaration under the outer name",
            "",
            r#"Include(graph: "shared/inner.ron", prefix: "eye", materials: {"result": "light"})"#,
            r#"(name: "light")"#,
            &["eye.fill", "eye.smooth"],
            4,
        ),
        (
            "connected: the outer declaration counts",
            "Texture(name: \"light\", format: R32Float, size: Viewport)",
            r#"Include(graph: "shared/inner.ron", prefix: "eye", materials: {"result": "light"})"#,
            r#"(name: "light")"#,
            &["eye.fill", "eye.smooth"],
            8,
        ),
        (
            "one feeds the other",
            "",
            r#"Include(graph: "shared/inner.ron", prefix: "a"),
               Include(graph: "shared/inner.ron", prefix: "b", materials: {"image": "a.result"})"#,
            r#"(name: "b", material: "b.result")"#,
            // b.fill overwrites what a made, so nothing of a is needed.
            &["b.fill", "b.smooth"],
            4,
        ),
        (
            "a pass of one's own between",
            "Texture(name: \"own\", format: R32Float, size: Viewport)",
            r#"Include(graph: "shared/inner.ron", prefix: "a"),
               Fullscreen(name: "read", shader: "smooth", bind: {"image": "a.result"}, color: [(target: "own")])"#,
            r#"(name: "own")"#,
            &["a.fill", "a.smooth", "read"],
            8,
        ),
        (
            "a global found by its spelling",
            "Texture(name: \"own\", format: R32Float, size: Viewport)",
            r#"Include(graph: "shared/inner.ron", prefix: "a"),
               Fullscreen(name: "spelt", color: [(target: "own")])"#,
            r#"(name: "own")"#,
            &["a.fill", "a.smooth", "spelt"],
            8,
        ),
        (
            "in a group",
            "",
            r#"Group(name: "g", passes: [Include(graph: "shared/inner.ron"),
               Fullscreen(name: "again", shader: "smooth", color: [(target: "result")])])"#,
            r#"(name: "out", material: "g.result")"#,
            &["g.fill", "g.again"],
            4,
        ),
        (
            "repeated",
            "Texture(name: \"own\", format: R32Float, size: Viewport)",
            r#"Include(graph: "shared/inner.ron", prefix: "a", repeat: Param("n")),
               Fullscreen(name: "read", shader: "smooth", bind: {"image": "a[1].result"}, color: [(target: "own")])"#,
            r#"(name: "own")"#,
            &["a[1].fill", "a[1].smooth", "read"],
            8,
        ),
    ];
    for (what, materials, passes, outputs, expected, edge) in cases {
        let files = files(materials, passes, outputs).with(
            "shaders/spelt.wgsl",
            "var a_result: texture_2d<f32>;
             @fragment fn fragment() -> @location(0) f32 { return textureLoad(a_result, vec2(0u), 0).x; }",
        );
        let plan = plan_with(&files, None).unwrap_or_else(|errors| panic!("{what}:\n{errors}"));
        assert_eq!(names(&plan), *expected, "{what}");
        assert_eq!(plan.outputs()[0].size, [*edge; 2], "{what}");
        let graph = graph(&files).unwrap_or_else(|errors| panic!("{what}:\n{errors}"));
        assert!(
            graph.warnings().is_empty(),
            "{what}: {:?}",
            graph.warnings()
        );
    }
}

/// ```text
/// outer.ron ─ a ▶ middle.ron ─ joined ▶ deep.ron: `image` is renamed by the middle, taken from the outermost
/// ```
#[test]
fn renames_go_through_every_level() {
    let middle = r#"(format: 1,
        passes: [Include(graph: "inner.ron", materials: {"image": "picture", "result": "light"}), Include(graph: "inner.ron", prefix: "b")])"#;
    let outer = r#"Include(graph: "shared/middle.ron", prefix: "a", materials: {"picture": "mine", "b.image": "mine"}),
        Include(graph: "shared/middle.ron", prefix: "c")"#;
    let files = files(
        &format!("Texture(name: \"mine\", {TEXTURE})"),
        outer,
        r#"(name: "mine"), (name: "light", material: "a.light"), (name: "b", material: "a.b.result"), (name: "c", material: "c.picture")"#,
    )
    .with("pipelines/shared/middle.ron", middle);
    // Names of nested includes are not those of the middle's own materials.
    let errors = plan_with(&files, None)
        .err()
        .map(|errors| errors.to_string());
    assert_eq!(errors, None);
    let plan = plan_with(&files, None).unwrap_or_else(|errors| panic!("{errors}"));
    let sizes: Vec<(String, u32)> = plan
        .outputs()
        .into_iter()
        .map(|output| (output.name, output.size[0]))
        .collect();
    let expected = [("mine", 8), ("light", 8), ("b", 8), ("c", 4)];
    assert_eq!(
        sizes,
        expected.map(|(name, edge)| (name.to_owned(), edge)),
        "a.light and a.b.result are as large as the images that they are like"
    );
}

/// A sub-graph may use what stands around it; what it declares itself comes first.
#[test]
fn scopes_reach_outwards() {
    let user = r#"(format: 1, materials: [Texture(name: "copy", format: R32Float, size: Like("image"))],
        passes: [Fullscreen(name: "smooth", color: [(target: "copy")])])"#;
    let shadowing = r#"(format: 1, materials: [Texture(name: "image", format: R32Float, size: Square(2))],
        passes: [Fullscreen(name: "one", color: [(target: "image")]), Include(graph: "user.ron", prefix: "user")])"#;
    let files = files(
        &format!("Texture(name: \"image\", {TEXTURE})"),
        r#"Fullscreen(name: "fill", color: [(target: "image")]),
           Include(graph: "user.ron", prefix: "near"), Include(graph: "shadowing.ron", prefix: "far")"#,
        r#"(name: "near", material: "near.copy"), (name: "far", material: "far.user.copy")"#,
    )
    .with("pipelines/user.ron", user)
    .with("pipelines/shadowing.ron", shadowing);
    let plan = plan_with(&files, None).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(
        names(&plan),
        ["fill", "near.smooth", "far.one", "far.user.smooth"]
    );
    let sizes: Vec<u32> = plan.outputs().iter().map(|output| output.size[0]).collect();
    assert_eq!(sizes, [8, 2]);
}

/// `Previous` and run conditions mean what they mean where they are written.
#[test]
fn history_and_conditions_in_an_include() {
    let inner = r#"(format: 1, params: [(name: "on", type: Bool, default: true)],
        materials: [Texture(name: "image", format: R32Float, size: Viewport), Texture(name: "result", format: R32Float, size: Viewport)],
        passes: [
            Fullscreen(name: "smooth", bind: {"image": Previous("result")}, color: [(target: "image")], run: When("on")),
            Copy(name: "keep", from: "image", to: "result", run: When("on")),
        ])"#;
    let plan = |condition: &str| {
        let outer = format!(
            r#"(format: 1, params: [(name: "outer", type: Bool, default: true), (name: "on", type: Bool, default: true)],
            passes: [Include(graph: "shared/inner.ron", prefix: "it", params: {{"on": Param("outer")}}),
                Fullscreen(name: "one", color: [(target: "it.image", load: Load)], run: When("{condition}"))],
            outputs: [(name: "image", material: "it.image")])"#
        );
        let files = Files::new(SHADERS)
            .with("pipelines/graph.ron", outer)
            .with("pipelines/shared/inner.ron", inner);
        plan_with(&files, None)
    };
    let right = plan("outer").unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(names(&right), ["it.smooth", "it.keep", "one"]);
    // The inner `on` is not the outer one: two writers of one material would run apart.
    assert!(codes(plan("on")).contains(&Code::RunCondition));
}

/// What the host provides can stand for a material of an included document.
#[test]
fn a_material_is_connected_with_a_provided_resource() {
    let inner = r#"(format: 1, materials: [Buffer(name: "indices", count: 3), Buffer(name: "sum", count: 1)],
        passes: [Clear(name: "reset", target: "indices"), Compute(name: "add", dispatch: Groups(1, 1, 1))])"#;
    let outer = |materials: &str| {
        format!(
            "(format: 1, passes: [Include(graph: \"inner.ron\", prefix: \"it\"{materials})], \
             outputs: [(name: \"sum\", material: \"it.sum\")])"
        )
    };
    let add = "var<storage, read> indices: array<u32>; var<storage, read_write> sum: array<u32>;
        @compute @workgroup_size(1) fn main() { sum[0] = indices[1]; }";
    let files = Files::new([("inner.ron", inner), ("add.wgsl", add)]);
    let provided = |files: Files| {
        let graph = load(&files)?;
        let plan = graph.plan(&PlanRequest::new([8, 8], &Triangle))?;
        Ok::<_, Diagnostics>(plan.provided().join(" "))
    };
    let own = provided(files.clone().with("graph.ron", outer("")));
    assert_eq!(own.unwrap_or_else(|errors| panic!("{errors}")), "");
    let connect = outer(", materials: {\"indices\": \"scene.indices\"}");
    // The host's buffer is only there to be read, so the included document must not clear it.
    let cleared = provided(files.clone().with("graph.ron", connect.clone()));
    let text = cleared.err().map(|errors| errors.to_string());
    assert!(text.is_some_and(|text| text.contains("`scene.indices`")));
    let reader = inner.replace("Clear(name: \"reset\", target: \"indices\"), ", "");
    let connected = provided(files.with("inner.ron", reader).with("graph.ron", connect));
    assert_eq!(
        connected.unwrap_or_else(|errors| panic!("{errors}")),
        "scene.indices"
    );
}

/// Shaders are looked for beside the document that names them.
#[test]
fn two_documents_have_shaders_of_one_name() {
    let inner = r#"(format: 1, materials: [Buffer(name: "items", count: 2)],
        passes: [Compute(name: "work", dispatch: Over("items"))])"#;
    let shader = |items: &str| {
        format!(
            "var<storage, read_write> items: array<{items}>; @compute @workgroup_size(1) fn \
             main() {{ items[0] = {items}(1); }}"
        )
    };
    let files = Files::new([])
        .with(
            "graph.ron",
            r#"(format: 1, passes: [Include(graph: "a/inner.ron", prefix: "a"), Include(graph: "b/inner.ron", prefix: "b")],
                outputs: [(name: "a", material: "a.items"), (name: "b", material: "b.items")])"#,
        )
        .with("a/inner.ron", inner)
        .with("b/inner.ron", inner)
        .with("a/work.wgsl", shader("u32"))
        .with("b/work.wgsl", shader("vec4<u32>"));
    // Layouts come from the shaders, so the sizes say which one was found.
    let plan = support::plan(&files).unwrap_or_else(|errors| panic!("{errors}"));
    let sizes: Vec<u32> = plan.outputs().iter().map(|output| output.size[0]).collect();
    assert_eq!(sizes, [8, 32]);
}

#[test]
fn repeats_follow_their_param() {
    let files = files(
        "Texture(name: \"maps\", format: R32Float, size: Square(4), layers: 4), Texture(name: \
         \"last\", format: R32Float, size: Square(4))",
        r#"Clear(name: "reset", target: "maps"),
           Group(name: "cascade", repeat: Param("n"), passes: [
               Fullscreen(name: "number", color: [(target: "maps[index]")]),
               Include(graph: "shared/inner.ron", materials: {"image": "maps[index]"}),
               Fullscreen(name: "twice", shader: "number", color: [(target: "maps[0]", load: Load)], repeat: 2),
           ]),
           Fullscreen(name: "smooth", bind: {"image": "maps[3]"}, color: [(target: "last")])"#,
        r#"(name: "maps"), (name: "last"), (name: "layer", material: "maps[2]")"#,
    );
    let live = |n| {
        let plan = plan_with(&files, Some(n)).unwrap_or_else(|errors| panic!("{errors}"));
        let mut all = names(&plan);
        all.extend(plan.culled().iter().map(|pass| pass.name.clone()));
        all.len()
    };
    assert_eq!([0, 1, 4].map(live), [2, 7, 22]);
    let plan = plan_with(&files, Some(2)).unwrap_or_else(|errors| panic!("{errors}"));
    let twice: Vec<String> = names(&plan)
        .into_iter()
        .filter(|name| name.contains("twice"))
        .collect();
    assert_eq!(
        twice,
        [
            "cascade[0].twice[0]",
            "cascade[0].twice[1]",
            "cascade[1].twice[0]",
            "cascade[1].twice[1]"
        ]
    );
    let errors = plan_with(&files, Some(5))
        .err()
        .map(|errors| errors.to_string());
    assert!(errors.is_some_and(|errors| errors.contains("there is no `maps[4]`")));
    // A material that is called just so comes before the layer.
    assert_eq!(plan.outputs()[2].size, [4, 4]);
}

fn codes(result: Result<Plan, Diagnostics>) -> Vec<Code> {
    let errors = result.err();
    errors
        .iter()
        .flat_map(Diagnostics::iter)
        .map(|error| error.code)
        .collect()
}

const SUBGROUP: wgpu::Features = wgpu::Features::SUBGROUP;

/// A param with a fallback, here and in an included document.
#[test]
fn a_missing_feature_changes_params() {
    let inner = r#"(format: 1, requires: [(feature: "SUBGROUP", fallback: {"edge": 2})],
        params: [(name: "edge", type: U32, default: 8)],
        materials: [Texture(name: "image", format: R32Float, size: Square(Param("edge")))],
        passes: [Fullscreen(name: "one", color: [(target: "image")])],
        outputs: [(name: "image")])"#;
    let files = Files::new(SHADERS)
        .with("inner.ron", inner)
        .with(
            "graph.ron",
            r#"(format: 1, params: [(name: "edge", type: U32, default: 16)],
                passes: [Include(graph: "inner.ron", prefix: "own"), Include(graph: "inner.ron", prefix: "given", params: {"edge": Param("edge")})],
                outputs: [(name: "own", material: "own.image"), (name: "given", material: "given.image")])"#,
        );
    let graph = load(&files).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(graph.features(), SUBGROUP);
    let plan = |features, edge: Option<u32>| {
        let mut request = PlanRequest::new([8, 8], &NoProvider);
        request.features = features;
        let edge = edge.map(|edge| ("edge".to_owned(), ParamValue::U32(edge)));
        request.params.extend(edge);
        graph.plan(&request)
    };
    let edges =
        |plan: &Plan| -> Vec<u32> { plan.outputs().iter().map(|output| output.size[0]).collect() };
    let with = plan(SUBGROUP, None).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!((edges(&with), with.fallbacks()), (vec![8, 16], &[][..]));
    let without = plan(wgpu::Features::empty(), None).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(edges(&without), [2, 2]);
    let replaced: Vec<(&str, &str, String, String)> = without
        .fallbacks()
        .iter()
        .map(|fallback| {
            let (old, new) = (fallback.instead_of.to_string(), fallback.value.to_string());
            (fallback.feature.as_str(), fallback.param.as_str(), old, new)
        })
        .collect();
    let expected = [("own.edge", "8"), ("given.edge", "16")];
    assert_eq!(
        replaced,
        expected.map(|(param, old)| ("SUBGROUP", param, old.to_owned(), "2".to_owned()))
    );
    // What was asked for by name is not replaced in silence.
    assert_eq!(
        codes(plan(wgpu::Features::empty(), Some(4))),
        [Code::Feature]
    );
    assert_eq!(codes(plan(wgpu::Features::empty(), Some(2))), []);
    assert_eq!(codes(plan(SUBGROUP, Some(4))), []);
}

#[test]
fn includes_that_go_wild_are_stopped() {
    // Each includes the next one twice: 2^64 in all.
    let mut doubling = Files::new(SHADERS);
    let mut chain = Files::new(SHADERS);
    for level in 0..80 {
        let next = level + 1;
        let double = format!(
            r#"(format: 1, passes: [Include(graph: "d{next}.ron", prefix: "a"), Include(graph: "d{next}.ron", prefix: "b")])"#
        );
        let path = |name: String| {
            if level == 0 {
                "graph.ron".to_owned()
            } else {
                name
            }
        };
        if level < 60 {
            doubling = doubling.with(&path(format!("d{level}.ron")), double);
        }
        let one = format!(r#"(format: 1, passes: [Include(graph: "d{next}.ron")])"#);
        chain = chain.with(&path(format!("d{level}.ron")), one);
    }
    doubling = doubling.with("d60.ron", "(format: 1)");
    let text = |files: &Files| {
        load(files)
            .err()
            .map(|errors| errors.to_string())
            .unwrap_or_default()
    };
    assert!(
        text(&doubling).contains("more than 16,384 passes"),
        "{}",
        text(&doubling)
    );
    assert!(
        text(&chain).contains("more than 64 deep"),
        "{}",
        text(&chain)
    );
    // Read from the innermost outwards, none of them is deep when it is read.
    let mut backwards = Files::new(SHADERS);
    let mut all = String::new();
    for level in (0..80).rev() {
        all.push_str(&format!(
            r#"Include(graph: "d{level}.ron", prefix: "p{level}"), "#
        ));
        let one = match level {
            79 => "(format: 1)".to_owned(),
            _ => format!(
                r#"(format: 1, passes: [Include(graph: "d{}.ron")])"#,
                level + 1
            ),
        };
        backwards = backwards.with(&format!("d{level}.ron"), one);
    }
    backwards = backwards.with("graph.ron", format!("(format: 1, passes: [{all}])"));
    assert!(
        text(&backwards).contains("more than 64 deep"),
        "{}",
        text(&backwards)
    );
}

static GPU: LazyLock<gpu::Gpu> =
    LazyLock::new(|| gpu::open(None).unwrap_or_else(|error| panic!("{error}")));

/// One frame on the device: the first channel of each texture that is read.
fn run(files: &Files, captures: &[&str]) -> BTreeMap<String, Vec<f32>> {
    let graph = graph(files).unwrap_or_else(|errors| panic!("{errors}"));
    let mut request = PlanRequest::new([8, 8], &Triangle);
    request.limits = GPU.device.limits();
    request.features = GPU.device.features();
    request.captures = captures
        .iter()
        .map(|material| Capture {
            material: (*material).to_owned(),
            after: None,
        })
        .collect();
    let plan = graph
        .plan(&request)
        .unwrap_or_else(|errors| panic!("{errors}"));
    let names: Vec<String> = plan
        .outputs()
        .into_iter()
        .map(|output| output.name)
        .collect();
    let read: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut Triangle)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut encoder = GPU
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    executor
        .encode(
            &mut encoder,
            &Frame {
                timing: false,
                read: &read,
                ..Frame::default()
            },
        )
        .unwrap_or_else(|error| panic!("{error}"));
    GPU.queue.submit([encoder.finish()]);
    executor
        .submitted(&GPU.queue)
        .unwrap_or_else(|error| panic!("{error}"));
    let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
    let values = |content: &Content| content.as_f32().expect("they hold floats");
    report
        .readbacks
        .iter()
        .map(|readback| (readback.name.clone(), values(&readback.content)))
        .collect()
}

#[test]
fn one_document_twice_on_the_device() {
    let files = files(
        "",
        r#"Include(graph: "shared/inner.ron", prefix: "left", params: {"value": Param("value")}),
           Include(graph: "shared/inner.ron", prefix: "right", params: {"value": 3.5, "edge": 2})"#,
        r#"(name: "left", material: "left.result"), (name: "right", material: "right.result")"#,
    );
    let values = run(&files, &["left.image"]);
    assert_eq!(values["left"], [7.0; 16]);
    assert_eq!(values["right"], [3.5; 4]);
    assert_eq!(values["left.image"], [7.0; 16]);
}

#[test]
fn layers_of_an_array_on_the_device() {
    let files = files(
        "Texture(name: \"maps\", format: R32Float, size: Square(2), layers: 3)",
        r#"Fullscreen(name: "number", color: [(target: "maps[index]")], repeat: 3)"#,
        r#"(name: "maps[0]"), (name: "last", material: "maps[2]")"#,
    );
    let values = run(&files, &["maps[1]"]);
    assert_eq!(values["maps[0]"], [10.0; 4]);
    assert_eq!(values["maps[1]"], [11.0; 4]);
    assert_eq!(values["last"], [12.0; 4]);
}
