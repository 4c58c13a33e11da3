//! Values, `expose: All`, `narrow`, `imports`, `Remove`, parts behind conditions; without a GPU.

use crate::support::{Files, Triangle, checked, codes, load, names, plan, right, wrong};
use skiagraph_graph::{
    Code, Describe, Graph, NoProvider, ParamValue, Plan, PlanRequest, Registry, ResourceKind,
    step::Step,
};
use std::collections::BTreeMap;

const FILL: &str = "struct Params { edge: u32, scale: f32 }
    var<uniform> params: Params;
    override tiles: u32 = 1u;
    @fragment fn fragment() -> @location(0) f32 {
        return f32(params.edge) * params.scale * f32(tiles);
    }";

fn width(plan: &Plan, name: &str) -> u32 {
    let mut resources = plan.resources().iter();
    let resource = resources.find(|resource| resource.name == name);
    match resource.map(|resource| &resource.kind) {
        Some(ResourceKind::Texture(texture)) => texture.size[0],
        _ => panic!("no texture is called {name}"),
    }
}

/// Constants and the words of `params` of the first draw.
fn program(plan: &Plan) -> (Vec<(String, f64)>, Vec<u32>) {
    let step = &plan.live().next().expect("a pass").steps[0];
    let program = step.program().expect("a program");
    let words = program.params().unwrap_or_default().chunks_exact(4);
    let words = words.map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
    (program.constants.clone(), words.collect())
}

#[test]
fn a_value_stands_in_expressions_params_and_overrides() {
    let files = Files::graph(
        r#"
        params: [U32(name: "n", default: 3)],
        values: {
            "edge": "2 * half",
            "half": "4 * n",
            "scale": "sqrt(edge + 1) / pow(2, 2)",
            "tiles": "edge / 8",
        },
        materials: [Texture(name: "image", format: R32Float, size: "edge")],
        passes: [Fullscreen(name: "fill", color: ["image"])],
        outputs: ["image"]"#,
    )
    .with("fill.wgsl", FILL);
    let planned = right(plan(&files));
    assert_eq!(width(&planned, "image"), 24);
    let (constants, words) = program(&planned);
    assert_eq!(
        constants
            .iter()
            .map(|(_, value)| *value)
            .collect::<Vec<_>>(),
        [3.0]
    );
    assert_eq!(words, [24, 1.25f32.to_bits()]);
    // A value that reads a param makes that param replan.
    let graph = right(load(&files));
    let mut request = PlanRequest::new([64, 64], &NoProvider);
    request.params.insert("n".to_owned(), ParamValue::U32(2));
    assert_eq!(width(&right(graph.plan(&request)), "image"), 16);
    assert!(!planned.is_same_with("n", ParamValue::U32(2)));
}

/// A document that gives a material and two values, one of which it has from an include.
fn giving() -> Files {
    Files::new([])
        .document(
            "pipelines/shared/inner.ron",
            r#"
            params: [
                U32(name: "edge", default: 8),
                U32(name: "asked"),
                U32(name: "hidden", default: 1),
            ],
            values: {"twice": "2 * edge * hidden", "sum": "asked + 1"},
            materials: [Texture(name: "image", format: R32Float, size: "twice")],
            passes: [Clear(name: "clear", target: "image")],
            outputs: ["image", "twice", (name: "more", material: "sum")]"#,
        )
        .document(
            "pipelines/middle.ron",
            r#"
            values: {"asked": "40 + 1"},
            passes: [Include(graph: "shared/inner.ron", expose: All)],
            outputs: ["image", "twice", "more"]"#,
        )
}

#[test]
fn an_include_gives_values_and_fills_what_it_asks_for() {
    let files = giving().document(
        "pipelines/graph.ron",
        r#"
        materials: [Texture(name: "own", format: R32Float, size: ("twice", "more"))],
        passes: [
            Include(graph: "middle.ron", expose: All),
            Clear(name: "own", target: "own"),
        ],
        outputs: ["own"]"#,
    );
    let graph = right(Graph::load(
        "pipelines/graph.ron",
        &Registry::standard(),
        &files,
    ));
    let names: Vec<&str> = graph
        .params()
        .iter()
        .map(|param| param.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["edge", "hidden"],
        "`asked` is a value of the document between"
    );
    let mut request = PlanRequest::new([64, 64], &NoProvider);
    request.params.insert("edge".to_owned(), ParamValue::U32(5));
    let plan = right(graph.plan(&request));
    let mut resources = plan.resources().iter();
    let own = resources.find(|resource| resource.name == "own");
    let Some(ResourceKind::Texture(own)) = own.map(|own| &own.kind) else {
        panic!("no texture");
    };
    assert_eq!(own.size, [10, 42]);
    // A value is no output of a graph that a host could read.
    let middle = right(Graph::load(
        "pipelines/middle.ron",
        &Registry::standard(),
        &giving(),
    ));
    assert_eq!(middle.outputs(), ["image"]);
}

#[test]
fn a_named_include_keeps_its_values_behind_its_name() {
    let files = giving().document(
        "pipelines/graph.ron",
        r#"
        values: {"asked": "1"},
        materials: [Texture(name: "own", format: R32Float, size: "left.twice + right.twice")],
        passes: [
            Include(graph: "shared/inner.ron", name: "left", set: {"edge": 3}, expose: All),
            Include(graph: "shared/inner.ron", name: "right", set: {"edge": 4}),
            Clear(name: "own", target: "own"),
        ],
        outputs: ["own"]"#,
    );
    let graph = right(Graph::load(
        "pipelines/graph.ron",
        &Registry::standard(),
        &files,
    ));
    let names: Vec<&str> = graph
        .params()
        .iter()
        .map(|param| param.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["left.hidden"],
        "what is set, or filled by a value, is no param"
    );
    let plan = right(graph.plan(&PlanRequest::new([64, 64], &NoProvider)));
    assert_eq!(width(&plan, "own"), 14);
}

#[test]
fn values_of_an_include_that_is_off_are_none() {
    let files = giving().document(
        "pipelines/graph.ron",
        r#"
        values: {"asked": "1"},
        materials: [Texture(name: "own", format: R32Float, size: "twice")],
        passes: [
            Include(graph: "shared/inner.ron", if: "viewport.width > 100"),
            Clear(name: "own", target: "own"),
        ],
        outputs: ["own"]"#,
    );
    let graph = right(Graph::load(
        "pipelines/graph.ron",
        &Registry::standard(),
        &files,
    ));
    let off = wrong(graph.plan(&PlanRequest::new([64, 64], &NoProvider)));
    assert_eq!(codes(off.iter()), [Code::UnknownParam]);
    right(graph.plan(&PlanRequest::new([128, 64], &NoProvider)));
}

#[test]
fn a_child_redefines_a_value_that_the_parent_uses() {
    let files = Files::new([("shaders/fill.wgsl", FILL)])
        .document(
            "pipelines/parent.ron",
            r#"
            values: {"edge": "8", "scale": "1.0"},
            materials: [Texture(name: "image", format: R32Float, size: "edge")],
            passes: [Fullscreen(name: "fill", color: ["image"])],
            outputs: ["image"]"#,
        )
        .document(
            "pipelines/graph.ron",
            r#"extends: "parent.ron", values: {"edge": "32"}"#,
        );
    let graph = right(Graph::load(
        "pipelines/graph.ron",
        &Registry::standard(),
        &files,
    ));
    let plan = right(graph.plan(&PlanRequest::new([64, 64], &NoProvider)));
    assert_eq!(width(&plan, "image"), 32);
    let flat = right(Graph::flat(
        "pipelines/graph.ron",
        &Registry::default(),
        &files,
    ));
    assert!(
        flat.contains(r#""edge": "32", // pipelines/graph.ron:1"#),
        "{flat}"
    );
    assert!(
        flat.contains(r#""scale": "1.0", // pipelines/parent.ron:"#),
        "{flat}"
    );
}

/// One choice that an include declares, narrowed by the document and again by its child.
#[test]
fn narrow_only_shrinks_and_tells_why() {
    let files = Files::new([(
        "shaders/fill.wgsl",
        "struct Params { fit: u32 } var<uniform> params: Params;
         @fragment fn fragment() -> @location(0) f32 {
             return select(0.0, 1.0, params.fit == FIT_TSM);
         }",
    )])
    .document(
        "pipelines/fits.ron",
        r#"
        params: [Choice(name: "fit", words: [scene, camera, pssm, tsm], default: scene)],
        materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "fill", color: ["image"])],
        outputs: ["image"]"#,
    )
    .document(
        "pipelines/graph.ron",
        r#"
        set: {"fit": tsm},
        narrow: {"fit": (words: [scene, tsm, camera], because: "no splits here")},
        passes: [Include(graph: "fits.ron", expose: All)],
        outputs: ["image"]"#,
    )
    .document(
        "pipelines/child.ron",
        r#"extends: "graph.ron", narrow: {"fit": (words: [tsm], because: "a trapezoid alone")}"#,
    );
    let graph = right(Graph::load(
        "pipelines/graph.ron",
        &Registry::standard(),
        &files,
    ));
    let words = |graph: &Graph| -> Vec<String> {
        graph.params()[0].words().map(ToString::to_string).collect()
    };
    assert_eq!(
        words(&graph),
        ["scene", "camera", "tsm"],
        "in the declaration's order"
    );
    // Numbers of words stay.
    let plan = right(graph.plan(&PlanRequest::new([8, 8], &NoProvider)));
    assert_eq!(program(&plan).1, [3]);
    let refused = graph.parse_param("fit", "pssm").unwrap_err().to_string();
    assert!(refused.contains("no splits here"), "{refused}");
    let child = right(Graph::load(
        "pipelines/child.ron",
        &Registry::standard(),
        &files,
    ));
    assert_eq!(words(&child), ["tsm"]);
    let refused = child.parse_param("fit", "scene").unwrap_err().to_string();
    assert!(refused.contains("a trapezoid alone"), "{refused}");
}

/// Marks for a search go where the param goes, until a document decides about it.
#[test]
fn what_a_document_decides_is_not_tuned() {
    let files = Files::new([(
        "shaders/fill.wgsl",
        "struct Params { cull: u32, bias: f32 } var<uniform> params: Params;
         @fragment fn fragment() -> @location(0) f32 {
             return select(0.0, params.bias, params.cull == CULL_FRONT);
         }",
    )])
    .document(
        "pipelines/map.ron",
        r#"
        params: [
            Choice(name: "cull", words: [none, front, back], default: front, tune: [none, front]),
            F32(name: "bias", default: 0, tune: [-0.5, 0, 1e-3]),
        ],
        materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "fill", color: ["image"])],
        outputs: ["image"]"#,
    )
    .document(
        "pipelines/graph.ron",
        r#"passes: [Include(graph: "map.ron", expose: All)], outputs: ["image"]"#,
    )
    .document(
        "pipelines/narrow.ron",
        r#"extends: "map.ron", narrow: {"cull": (words: [front, back], because: "open parts")}"#,
    )
    .document(
        "pipelines/child.ron",
        r#"extends: "map.ron", set: {"cull": none}"#,
    )
    .document(
        "pipelines/set.ron",
        r#"extends: "graph.ron", set: {"cull": none}"#,
    )
    .document(
        "pipelines/inner.ron",
        r#"passes: [Include(graph: "map.ron", set: {"cull": none}, expose: All)],
           outputs: ["image"]"#,
    );
    let tuned = |path: &str| {
        let graph = right(Graph::load(path, &Registry::standard(), &files));
        let params = graph.params().iter().filter(|param| !param.tune.is_empty());
        let text = params.map(|param| {
            let values: Vec<String> = param.tune.iter().map(ToString::to_string).collect();
            format!("{}: {}", param.name.value, values.join(", "))
        });
        text.collect::<Vec<String>>().join("; ")
    };
    let both = "cull: none, front; bias: -0.5, 0, 0.001";
    assert_eq!(tuned("pipelines/map.ron"), both);
    assert_eq!(tuned("pipelines/graph.ron"), both);
    let bias = "bias: -0.5, 0, 0.001";
    for path in ["narrow", "child", "set", "inner"] {
        assert_eq!(tuned(&format!("pipelines/{path}.ron")), bias, "{path}");
    }
    let flat = right(Graph::flat(
        "pipelines/child.ron",
        &Registry::standard(),
        &files,
    ));
    assert!(
        flat.contains("tune: [-0.5, 0, 1e-3]") && !flat.contains("[none, front],"),
        "{flat}"
    );
}

#[test]
fn what_a_child_does_not_use_goes() {
    let files = Files::new([(
        "shaders/one.wgsl",
        "@fragment fn fragment() -> @location(0) f32 { return 1.0; }",
    )])
    .document(
        "pipelines/parent.ron",
        r#"
        params: [U32(name: "edge", default: 8), F32(name: "bias", default: 0)],
        materials: [
            Texture(name: "image", format: R32Float, size: "edge"),
            Texture(name: "scratch", format: R32Float),
        ],
        passes: [
            Clear(name: "clear", target: "scratch", value: "bias"),
            Fullscreen(name: "one", color: ["image"]),
        ],
        outputs: ["image", "scratch"]"#,
    )
    .document(
        "pipelines/graph.ron",
        r#"
        extends: "parent.ron",
        set: {"bias": 1},
        passes: [Remove(pass: "clear")],
        outputs: ["image"]"#,
    )
    .document(
        "pipelines/around.ron",
        r#"passes: [Include(graph: "graph.ron", expose: All)], outputs: ["image"]"#,
    )
    .document(
        "pipelines/flat.ron",
        r#"extends: "graph.ron", set: {"edge": 4}"#,
    );
    let load = |path: &str| right(Graph::load(path, &Registry::standard(), &files));
    for path in ["pipelines/graph.ron", "pipelines/around.ron"] {
        let graph = load(path);
        let params = graph.params().iter();
        let names: Vec<&str> = params.map(|param| param.name.as_str()).collect();
        assert_eq!(names, ["edge"], "{path}");
        right(graph.plan(&PlanRequest::new([8, 8], &NoProvider)));
    }
    let graph = load("pipelines/graph.ron");
    let warnings: Vec<&str> = graph.warnings().iter().map(|it| &*it.message).collect();
    assert_eq!(warnings, ["nothing uses the param `bias`"]);
    let flat = Graph::flat("pipelines/flat.ron", &Registry::standard(), &files);
    let flat = right(flat);
    assert!(
        !flat.contains("bias") && !flat.contains("scratch"),
        "{flat}"
    );
}

#[test]
fn a_material_takes_the_place_of_an_input_and_an_exposed_param_that_of_a_param() {
    let files = Files::new([
        (
            "shaders/one.wgsl",
            "struct Params { level: f32 }
             var<uniform> params: Params;
             @fragment fn fragment() -> @location(0) f32 { return params.level; }",
        ),
        (
            "shaders/double.wgsl",
            "var image: texture_2d<f32>;
             @fragment fn fragment() -> @location(0) f32 {
                 return 2.0 * textureLoad(image, vec2(0u), 0).x;
             }",
        ),
    ])
    .document(
        "pipelines/one.ron",
        r#"
        params: [F32(name: "level", default: 3)],
        inputs: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "one", color: ["image"])],
        outputs: ["image"]"#,
    )
    .document(
        "pipelines/parent.ron",
        r#"
        params: [F32(name: "level", default: 1)],
        inputs: [Texture(name: "image", format: R32Float)],
        materials: [Texture(name: "answer", format: R32Float)],
        passes: [
            Clear(name: "clear", target: "answer", value: "level"),
            Fullscreen(name: "double", color: ["answer"]),
        ],
        outputs: ["answer"]"#,
    )
    .document(
        "pipelines/graph.ron",
        r#"
        extends: "parent.ron",
        materials: [Texture(name: "image", format: R32Float)],
        passes: [
            Include(before: "double", graph: "one.ron", expose: All),
            Remove(pass: "clear"),
        ]"#,
    );
    let path = "pipelines/graph.ron";
    let graph = right(Graph::load(path, &Registry::standard(), &files));
    assert_eq!(graph.inputs(), [""; 0]);
    let request = PlanRequest::new([8, 8], &NoProvider);
    let values = graph.values(&request.params, [8, 8], request.features);
    assert_eq!(right(values)["level"], ParamValue::F32(3.0));
    right(graph.plan(&request));
}

#[test]
fn a_pass_clears_materials_before_it_runs() {
    let files = Files::new([(
        "shaders/count.wgsl",
        "var<storage, read_write> counter: atomic<u32>;
         @compute @workgroup_size(1) fn main() { atomicAdd(&counter, 1u); }",
    )])
    .document(
        "pipelines/graph.ron",
        r#"
        materials: [Buffer(name: "counter")],
        passes: [Compute(name: "count", clear: ["counter"], dispatch: Groups(1, 1, 1))],
        outputs: ["counter"]"#,
    );
    let path = "pipelines/graph.ron";
    let graph = right(Graph::load(path, &Registry::standard(), &files));
    let plan = right(graph.plan(&PlanRequest::new([8, 8], &NoProvider)));
    let steps = &plan.all_passes()[0].steps;
    assert!(
        matches!(steps[..], [Step::Clear { .. }, Step::Dispatch(_)]),
        "{steps:?}"
    );
}

/// `solid` and `masked`, of which `masked` has a binding more; `fill` imports the former, and a
/// wrapper of it imports what it stands in for.
fn modules(imports: &str) -> Files {
    Files::new([
        (
            "shaders/shared/solid.wgsl",
            "fn brightness(at: f32) -> f32 { return at; }",
        ),
        (
            "shaders/shared/masked.wgsl",
            "var mask: texture_2d<f32>;
             fn brightness(
                 at: f32,
             ) -> f32 {
                 return textureLoad(mask, vec2(0u), 0).x * at;
             }",
        ),
        (
            "shaders/fill.wgsl",
            "#import \"shared/solid.wgsl\"
             @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) f32 {
                 return brightness(at.x);
             }",
        ),
    ])
    .document(
        "pipelines/inner.ron",
        r#"
        inputs: [Texture(name: "mask")],
        materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "fill", color: ["image"])],
        outputs: ["image"]"#,
    )
    .document(
        "pipelines/graph.ron",
        &format!(
            r#"
            {imports}
            materials: [Texture(name: "mask", format: R32Float)],
            passes: [
                Clear(name: "clear", target: "mask"),
                Include(graph: "inner.ron"),
            ],
            outputs: ["image"]"#
        ),
    )
}

fn planned(files: &Files, width: u32) -> Plan {
    let graph = right(Graph::load(
        "pipelines/graph.ron",
        &Registry::standard(),
        files,
    ));
    right(graph.plan(&PlanRequest::new([width, 8], &NoProvider)))
}

#[test]
fn imports_hold_for_includes_under_their_condition() {
    let files = modules(
        r#"imports: [
            (of: "shared/solid.wgsl", is: "shared/masked.wgsl", if: "viewport.width > 16"),
        ],"#,
    );
    // Without the mask nothing reads it, and the pass that writes it is culled.
    assert_eq!(names(&planned(&files, 8)), ["inner.fill"]);
    assert_eq!(names(&planned(&files, 32)), ["clear", "inner.fill"]);
}

#[test]
fn the_nearest_import_wins() {
    let files = modules(r#"imports: [(of: "shared/solid.wgsl", is: "shared/masked.wgsl")],"#);
    assert_eq!(names(&planned(&files, 8)), ["clear", "inner.fill"]);
    let inner = r#"imports: [(of: "shared/solid.wgsl", is: "shared/solid.wgsl")], inputs"#;
    let files = files.edited("pipelines/inner.ron", "inputs", inner);
    assert_eq!(names(&planned(&files, 8)), ["inner.fill"]);
}

/// The include stands below; what it says of itself decides which module the passes behind it get.
#[test]
fn a_condition_of_imports_may_name_a_value_of_an_include() {
    let files = |says: &str| {
        let imports = r#"
            imports: [(of: "shared/solid.wgsl", is: "shared/masked.wgsl", if: "needs")],
            values: {"needs": "is_masked && viewport.width > 4"},"#;
        let files = modules(imports).document(
            "pipelines/says.ron",
            &format!(
                r#"values: {{"is_masked": "{says}"}},
                materials: [Buffer(name: "one", data: [1])],
                passes: [], outputs: ["one", "is_masked"]"#
            ),
        );
        let include = r#"Include(graph: "says.ron"), Include(graph: "inner.ron"),"#;
        files.edited(
            "pipelines/graph.ron",
            r#"Include(graph: "inner.ron"),"#,
            include,
        )
    };
    assert_eq!(names(&planned(&files("false"), 8)), ["inner.fill"]);
    assert_eq!(names(&planned(&files("true"), 8)), ["clear", "inner.fill"]);
    assert_eq!(names(&planned(&files("true"), 4)), ["inner.fill"]);
    // Without the include nothing has the value.
    let lacking = files("true").edited("pipelines/graph.ron", r#"Include(graph: "says.ron"),"#, "");
    let graph = Graph::load("pipelines/graph.ron", &Registry::standard(), &lacking);
    let plan = graph.and_then(|graph| graph.plan(&PlanRequest::new([8, 8], &NoProvider)));
    assert!(wrong(plan).to_string().contains("`is_masked`"));
}

/// `scene.indices` has items in the provider `Triangle`, and `NoProvider` does not know it.
#[test]
fn a_registry_has_a_module_stand_in_where_the_provider_has_items() {
    let mut registry = Registry::standard();
    registry.stand_in("shared/solid.wgsl", "shared/masked.wgsl", "scene.indices");
    registry.stand_in("shared/solid.wgsl", "shared/lacking.wgsl", "scene.indices");
    let files = modules("");
    let graph = right(Graph::load("pipelines/graph.ron", &registry, &files));
    assert!(graph.warnings().is_empty());
    let passes =
        |provider: &dyn Describe| names(&right(graph.plan(&PlanRequest::new([8, 8], provider))));
    assert_eq!(passes(&Triangle), ["clear", "inner.fill"]);
    assert_eq!(passes(&NoProvider), ["inner.fill"]);
    // A document's own word counts more.
    let imports = r#"imports: [(of: "shared/solid.wgsl", is: "shared/solid.wgsl")],"#;
    let graph = right(Graph::load(
        "pipelines/graph.ron",
        &registry,
        &modules(imports),
    ));
    let plan = right(graph.plan(&PlanRequest::new([8, 8], &Triangle)));
    assert_eq!(names(&plan), ["inner.fill"]);
}

/// A module that stands in for another one imports it: then it is the module itself.
#[test]
fn a_replacement_may_import_what_it_replaces() {
    let files = modules(r#"imports: [(of: "shared/solid.wgsl", is: "shared/noted.wgsl")],"#).with(
        "shaders/shared/noted.wgsl",
        "#import \"shared/solid.wgsl\"
         fn doubled(at: f32) -> f32 { return 2.0 * brightness(at); }",
    );
    assert_eq!(names(&planned(&files, 8)), ["inner.fill"]);
}

/// A shader's own `instead` leaves out the module that the document has imported in its place.
#[test]
fn a_line_with_instead_also_leaves_out_a_replacement() {
    let files = modules(r#"imports: [(of: "shared/solid.wgsl", is: "shared/masked.wgsl")],"#).with(
        "shaders/shared/own.wgsl",
        "fn brightness(at: f32) -> f32 { return at; }",
    );
    let line =
        "#import \"shared/own.wgsl\" instead \"shared/solid.wgsl\"\n#import \"shared/solid.wgsl\"";
    let files = files.edited("shaders/fill.wgsl", "#import \"shared/solid.wgsl\"", line);
    assert_eq!(names(&planned(&files, 8)), ["inner.fill"]);
    // Which may itself be what the line brings.
    let files = files.edited("shaders/fill.wgsl", line, &line.replace("own", "masked"));
    assert_eq!(names(&planned(&files, 8)), ["clear", "inner.fill"]);
}

/// A mistake in the module that does not stand in today is told all the same.
#[test]
fn both_sides_of_an_import_are_checked() {
    let files = modules(
        r#"imports: [
            (of: "shared/solid.wgsl", is: "shared/masked.wgsl", if: "viewport.width > 16"),
        ],"#,
    )
    .edited("shaders/shared/masked.wgsl", "* at", "* att");
    let errors = wrong(Graph::load(
        "pipelines/graph.ron",
        &Registry::standard(),
        &files,
    ));
    assert_eq!(codes(errors.iter()), [Code::Shader]);
    assert!(
        errors.to_string().contains("shared/masked.wgsl"),
        "{errors}"
    );
}

#[test]
fn entry_points_faces_and_references_stand_behind_conditions() {
    let files = Files::graph(
        r#"
        values: {"wide": "viewport.width > 16"},
        materials: [
            Texture(name: "depth", format: Depth32Float),
            Texture(name: "small", format: R32Float, size: 4),
            Texture(name: "large", format: R32Float, size: 8),
            Texture(name: "image", format: R32Float),
        ],
        passes: [
            Clear(name: "small", target: "small"),
            Clear(name: "large", target: "large"),
            Raster(
                name: "draw",
                vertex: "wide ? vertex_wide : vertex",
                fragment: "wide ? fragment_wide : none",
                cull: "wide ? none : back",
                front_face: "wide ? cw : ccw",
                draw: 3,
                depth: (target: "depth", load: LoadIf("wide")),
                overwrites: ["depth"],
            ),
            Fullscreen(name: "read", color: ["image"], bind: {"source": "wide ? large : small"}),
        ],
        outputs: ["image", "depth"]"#,
    )
    .with(
        "draw.wgsl",
        "@vertex fn vertex() -> @builtin(position) vec4<f32> { return vec4(0.0); }
         @vertex fn vertex_wide() -> @builtin(position) vec4<f32> { return vec4(1.0); }
         @fragment fn fragment_wide() {}",
    )
    .with(
        "read.wgsl",
        "var source: texture_2d<f32>;
         @fragment fn fragment() -> @location(0) f32 {
             return textureLoad(source, vec2(0u), 0).x;
         }",
    );
    let files = files.edited(
        "graph.ron",
        "load: LoadIf(\"wide\")",
        "load: LoadIf(\"!wide && wide\")",
    );
    let graph = right(load(&files));
    let drawn = |width| {
        let plan = right(graph.plan(&PlanRequest::new([width, 8], &NoProvider)));
        let draw = plan.live().find(|pass| *pass.name == "draw").expect("it");
        let Step::Draw(draw) = &draw.steps[0] else {
            panic!("no draw");
        };
        let shader = &draw.program.shader;
        let entries = draw.program.entries.iter();
        let entries: Vec<String> = entries
            .map(|&at| shader.entry_name(at).to_owned())
            .collect();
        let primitive = draw.primitive;
        (
            names(&plan),
            entries,
            primitive.cull_mode,
            primitive.front_face,
        )
    };
    let (passes, entries, cull, face) = drawn(8);
    assert_eq!(passes, ["small", "draw", "read"]);
    assert_eq!(
        entries,
        ["vertex"],
        "no fragment stage, although the file has one"
    );
    assert!(cull.is_some() && format!("{face:?}") == "Ccw");
    let (passes, entries, cull, face) = drawn(32);
    assert_eq!(passes, ["large", "draw", "read"]);
    assert_eq!(entries, ["vertex_wide", "fragment_wide"]);
    assert!(cull.is_none() && format!("{face:?}") == "Cw");
}

/// `check` finds what depends on a condition for each value of the params in it.
#[test]
fn what_nothing_uses_is_told() {
    let files = Files::graph(
        r#"
        values: {"used": "8", "unused": "9"},
        materials: [Texture(name: "image", format: R32Float, size: "used")],
        passes: [Fullscreen(name: "one", color: ["image"])],
        outputs: ["image"]"#,
    )
    .with(
        "one.wgsl",
        "@fragment fn fragment() -> @location(0) f32 { return 1.0; }",
    );
    let messages: BTreeMap<String, Code> = checked(&files)
        .into_iter()
        .map(|diagnostic| (diagnostic.message, diagnostic.code))
        .collect();
    assert_eq!(
        messages,
        BTreeMap::from([("nothing uses the value `unused`".to_owned(), Code::Unused)])
    );
}

/// A picture and a method that includes it, for a step over both.
fn method() -> Files {
    let shader = "var picture: texture_2d<f32>;
        @fragment fn fragment() -> @location(0) f32 {
            return textureLoad(picture, vec2(0u), 0).x;
        }";
    Files::new([
        (
            "shaders/draw.wgsl",
            "@fragment fn fragment() -> @location(0) f32 { return 1.0; }",
        ),
        ("shaders/judge.wgsl", shader),
        (
            "shaders/step.wgsl",
            "var picture: texture_2d<f32>; var visibility: texture_2d<f32>;
             @fragment fn fragment() -> @location(0) f32 {
                 return textureLoad(picture, vec2(0u), 0).x
                     + textureLoad(visibility, vec2(0u), 0).x;
             }",
        ),
    ])
    .document(
        "pipelines/shared/picture.ron",
        r#"
        params: [U32(name: "edge", default: 8)],
        materials: [Texture(name: "picture", format: R32Float, size: "edge")],
        passes: [Fullscreen(name: "draw", color: ["picture"])],
        outputs: ["picture"]"#,
    )
    .document(
        "pipelines/method.ron",
        r#"
        materials: [Texture(name: "visibility", format: R32Float)],
        passes: [
            Include(graph: "shared/picture.ron"),
            Fullscreen(name: "judge", color: ["visibility"]),
        ],
        outputs: ["visibility"]"#,
    )
}

fn step_over(passes: &str) -> (Vec<String>, Vec<Code>) {
    let files = method().document(
        "pipelines/graph.ron",
        &format!(
            r#"
            materials: [Texture(name: "image", format: R32Float)],
            passes: [{passes} Fullscreen(name: "step", color: ["image"])],
            outputs: ["image"]"#
        ),
    );
    let plan = planned(&files, 8);
    let warnings = codes(plan.warnings());
    (names(&plan), warnings)
}

#[test]
fn includes_of_one_content_are_one() {
    let twice = r#"Include(graph: "method.ron"), Include(graph: "shared/picture.ron"),"#;
    let (passes, warnings) = step_over(twice);
    assert_eq!(passes, ["method.picture.draw", "method.judge", "step"]);
    assert_eq!(warnings, []);
    let other_order = r#"Include(graph: "shared/picture.ron"), Include(graph: "method.ron"),"#;
    let (passes, _) = step_over(other_order);
    assert_eq!(passes, ["picture.draw", "method.judge", "step"]);
    // Another value of a param is another content.
    let other =
        r#"Include(graph: "method.ron"), Include(graph: "shared/picture.ron", set: {"edge": 4}),"#;
    let (passes, _) = step_over(other);
    assert_eq!(
        passes,
        [
            "method.picture.draw",
            "method.judge",
            "picture.draw",
            "step"
        ]
    );
    // A name says that a copy is meant.
    let named = r#"Include(graph: "method.ron"),
        Include(graph: "shared/picture.ron", name: "own"),
        Copy(name: "take", from: "own.picture", to: "held"),"#;
    let files = method().document(
        "pipelines/graph.ron",
        &format!(
            r#"
            materials: [Texture(name: "held", format: R32Float, size: 8)],
            passes: [{named}],
            outputs: ["visibility", "held"]"#
        ),
    );
    let plan = planned(&files, 8);
    assert!(
        names(&plan).contains(&"own.draw".to_owned()),
        "{:?}",
        names(&plan)
    );
}

/// A pass in between writes a product of the first of two: two copies, and told.
#[test]
fn includes_are_two_where_something_is_written_in_between() {
    let passes = r#"
        Include(graph: "shared/picture.ron"),
        Clear(name: "wipe", target: "picture"),
        Include(graph: "method.ron"),"#;
    let (passes, warnings) = step_over(passes);
    assert_eq!(
        passes,
        ["wipe", "method.picture.draw", "method.judge", "step"]
    );
    assert_eq!(warnings, [Code::TwoCopies]);
}

#[test]
fn formats_of_16_bits_need_their_feature() {
    let files = Files::graph(
        r#"
        requires: ["TEXTURE_FORMAT_16BIT_NORM"],
        materials: [Texture(name: "image", format: R16Unorm)],
        passes: [Compute(name: "two", dispatch: Over("image.size"))],
        outputs: ["image"]"#,
    )
    .with(
        "two.wgsl",
        "var image: texture_storage_2d<r16unorm, write>;
         @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
             textureStore(image, at.xy, vec4(0.5));
         }",
    );
    let graph = right(load(&files));
    let mut request = PlanRequest::new([8, 8], &NoProvider);
    assert_eq!(codes(wrong(graph.plan(&request)).iter()), [Code::Feature]);
    request.features = graph.features();
    assert_eq!(names(&right(graph.plan(&request))), ["two"]);
}

/// `overwrites` is an author's word that a pass reads only what it has written itself.
#[test]
fn what_a_pass_writes_first_it_may_read() {
    let sections = |overwrites: &str| {
        Files::graph(&format!(
            r#"
            materials: [Buffer(name: "sums", count: 8)],
            passes: [Compute(name: "sum", dispatch: Groups(1, 1, 1){overwrites})],
            outputs: ["sums"]"#
        ))
        .with(
            "sum.wgsl",
            "var<storage, read_write> sums: array<u32>;
             @compute @workgroup_size(1) fn main() {
                 for (var i = 0u; i < 8u; i++) { sums[i] = i; }
                 for (var i = 1u; i < 8u; i++) { sums[i] += sums[i - 1u]; }
             }",
        )
    };
    let errors = wrong(plan(&sections("")));
    assert_eq!(codes(errors.iter()), [Code::ReadBeforeWrite]);
    let text = errors.to_string();
    for way_out in ["Clear(name:", "sums.previous", "overwrites: [\"sums\"]"] {
        assert!(text.contains(way_out), "no {way_out} in {text}");
    }
    right(plan(&sections(r#", overwrites: ["sums"]"#)));
}

/// A step over a method, which stays open: it gives the method's format and twice its edge.
fn over() -> Files {
    Files::graph(
        r#"
        lights: [sun, lamp],
        values: {"is_hard": "image.format == R8Uint"},
        materials: [
            Texture(name: "over", format: "image.format", size: "2 * image.width"),
            Texture(name: "hard", format: R8Uint, size: "is_hard ? 3 : 5"),
        ],
        passes: [
            Include(graph: "method.ron", open: "method", expose: All),
            Clear(name: "clear", target: "over"),
            Clear(name: "clear_hard", target: "hard"),
        ],
        outputs: ["over", "hard"]"#,
    )
    .document(
        "pipelines/method.ron",
        r#"
        lights: [lamp, sky],
        params: [U32(name: "edge", default: 4)],
        materials: [Texture(name: "image", format: R8Uint, size: "edge")],
        passes: [Clear(name: "clear", target: "image")],
        outputs: ["image"],
        claims: {"exact": "true"}"#,
    )
    .document(
        "pipelines/soft.ron",
        r#"
        lights: [sun],
        params: [U32(name: "map", default: 7)],
        materials: [Texture(name: "image", format: R32Float, size: "map")],
        passes: [Clear(name: "clear", target: "image")],
        outputs: ["image"]"#,
    )
    .document(
        "pipelines/sky.ron",
        r#"
        lights: [sky],
        materials: [Texture(name: "image", format: R8Uint, size: 1)],
        passes: [Clear(name: "clear", target: "image")],
        outputs: ["image"]"#,
    )
}

fn load_over(name: &str, path: &str) -> Result<Graph, skiagraph_graph::Diagnostics> {
    let chosen = BTreeMap::from([(name.to_owned(), path.to_owned())]);
    Graph::load_over("graph.ron", &Registry::standard(), &over(), &chosen)
}

#[test]
fn another_document_stands_in_an_open_include() {
    let own = right(load(&over()));
    let chosen = right(load_over("method", "pipelines/soft.ron"));
    let summary = |graph: &Graph| {
        let planned = right(graph.plan(&PlanRequest::new([64, 64], &NoProvider)));
        let lights: Vec<String> = graph.lights().map(|light| light.to_string()).collect();
        let params: Vec<String> = graph
            .params()
            .iter()
            .map(|it| it.name.to_string())
            .collect();
        let sizes = [width(&planned, "over"), width(&planned, "hard")];
        (sizes, lights.join(" "), params.join(" "))
    };
    assert_eq!(summary(&own), ([8, 3], "lamp".into(), "edge".into()));
    assert_eq!(summary(&chosen), ([14, 5], "sun".into(), "map".into()));
    let openings: Vec<_> = chosen.openings().collect();
    assert_eq!(openings, [("method", "pipelines/soft.ron")]);
    // A promise of one of its parts is no promise of the whole.
    let claims = own.claims(&BTreeMap::new(), [64, 64], wgt::Features::empty());
    assert!(right(claims).is_empty());
}

#[test]
fn an_open_include_refuses_what_cannot_stand_there() {
    let mistakes = |name, path| {
        let errors = load_over(name, path).expect_err("a mistake");
        errors
            .iter()
            .map(|it| (it.code, it.message.clone()))
            .collect::<Vec<_>>()
    };
    let [(code, message)] = &mistakes("methd", "pipelines/soft.ron")[..] else {
        panic!("one mistake")
    };
    assert_eq!(*code, Code::UnknownParam);
    assert!(message.contains("has no open include `methd`"), "{message}");
    let [(code, message)] = &mistakes("method", "pipelines/sky.ron")[..] else {
        panic!("one mistake")
    };
    assert_eq!(*code, Code::Light);
    assert!(
        message.contains("no light is taken both here and by"),
        "{message}"
    );
    let cycle = mistakes("method", "graph.ron");
    assert_eq!(cycle[0].0, Code::IncludeCycle);
    let missing = mistakes("method", "pipelines/none.ron");
    assert_eq!(missing[0].0, Code::MissingFile);
}
