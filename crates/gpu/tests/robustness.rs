//! Whatever stands in a file: an answer, never a panic.

mod support;

use proptest::{
    prelude::*,
    test_runner::{RngAlgorithm, TestRng, TestRunner},
};
use skiagraph_graph::{Executor, Frame, Graph, PlanRequest, Registry, gpu};
use support::{Files, Triangle};

/// A document with some of everything, right as it stands.
const DOCUMENT: &str = r#"(
    format: 1,
    description: "größer → ∞",
    params: [
        (name: "edge", type: U32, default: 16, min: 1, max: 64, description: "texels"),
        (name: "bias", type: F32, default: -0.5),
        (name: "cull", type: Choice(["none", "front", "back"]), default: "front"),
        (name: "sun", type: Vec3, default: (0, 1, 0)),
    ],
    materials: [
        Texture(name: "depth", format: Depth32Float, size: Square(Param("edge"))),
        Texture(name: "image", format: R32Float, size: Viewport, mips: 2, layers: 1, views: [(name: "top", mip: 0, mips: 1)]),
        Texture(name: "small", format: R32Float, size: ViewportTimes(0.5)),
        Texture(name: "same", format: R32Float, size: Like("small")),
        Buffer(name: "items", count: Times(2, PixelsOf("small"))),
        Buffer(name: "kept", count: CountOf("items")),
        Buffer(name: "total"),
        Sampler(name: "nearest", filter: Nearest, address: Repeat),
    ],
    passes: [
        Raster(name: "occlude", draw: CountOf("scene.indices"), depth: (target: "depth", load: Clear(1.0), compare: Less, bias: (constant: 1)), cull: Param("cull")),
        Clear(name: "reset", target: "total"),
        Compute(name: "number", dispatch: Over("items")),
        Copy(name: "keep", from: "items", to: "kept"),
        Compute(name: "again", shader: "number", bind: {"items": "kept"}, dispatch: Groups(1, 2, 3)),
        Fullscreen(name: "shade", color: [(target: "top", load: Clear(0, 0, 0, 0))]),
        Fullscreen(name: "reduce", bind: {"fine": "top"}, color: [(target: "small")]),
        Copy(name: "copy", from: "small", to: "same"),
    ],
    outputs: [(name: "result", material: "same"), (name: "top"), (name: "kept"), (name: "total")],
)
"#;

const OCCLUDE: &str = "#import \"shared/scene.wgsl\"
override bias: f32 = 0.0;
@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return scene_positions[scene_indices[index]] + vec4<f32>(0.0, 0.0, bias, 0.0);
}
";

const SCENE: &str = "// Ein Modul: größer → ∞
var<storage, read> scene_positions: array<vec4<f32>>;
var<storage, read> scene_indices: array<u32>;
";

const NUMBER: &str = "var<storage, read_write> items: array<u32>;
var<storage, read_write> total: atomic<u32>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&items) { items[id.x] = id.x; atomicAdd(&total, 1u); }
}
";

const SHADE: &str = "struct Params { sun: vec3<f32>, bias: f32, cull: u32, edge: u32 }
var<uniform> params: Params;
var depth: texture_2d<f32>;
var nearest: sampler;
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureSampleLevel(depth, nearest, position.xy, 0.0).x + params.sun.y + params.bias + f32(params.cull + params.edge);
}
";

const REDUCE: &str = "var fine: texture_2d<f32>;
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureLoad(fine, 2u * vec2<u32>(position.xy), 0).x;
}
";

fn files() -> Files {
    Files::new([
        ("graph.ron", DOCUMENT),
        ("occlude.wgsl", OCCLUDE),
        ("shared/scene.wgsl", SCENE),
        ("number.wgsl", NUMBER),
        ("shade.wgsl", SHADE),
        ("reduce.wgsl", REDUCE),
    ])
}

/// Loads, plans and renders whatever is said; what counts is that it comes back.
fn judge(files: &Files) -> Result<usize, String> {
    let graph = Graph::load("graph.ron", &Registry::standard(), files)
        .map_err(|errors| errors.to_string())?;
    let plan = graph
        .plan(&PlanRequest::new([33, 17], &Triangle))
        .map_err(|errors| errors.to_string())?;
    assert!(plan.memory_bytes() >= plan.saved_bytes());
    Ok(plan.passes().len() + plan.culled().len())
}

#[test]
fn the_document_is_right_as_it_stands() {
    assert_eq!(judge(&files()), Ok(8));
}

/// Cut off anywhere, in a character or not, it is wrong and says so.
#[test]
fn cut_off_anywhere() {
    for end in (0..DOCUMENT.trim_end().len()).filter(|&end| DOCUMENT.is_char_boundary(end)) {
        let text = judge(&files().with("graph.ron", &DOCUMENT[..end])).expect_err("it is cut off");
        assert!(!text.is_empty());
    }
}

/// Words that a file may hold in the place of any other.
const WORDS: &[&str] = &[
    "",
    "0",
    "-1",
    "4294967295",
    "4294967296",
    "18446744073709551616",
    "1e38",
    "1e39",
    "NaN",
    "inf",
    "-inf",
    "0.5",
    "\"",
    "\"image\"",
    "\"image[0]\"",
    "\"image[index]\"",
    "Include(graph: \"graph.ron\", prefix: \"a\")",
    "Group(name: \"g\", repeat: 2, passes: [])",
    "\"small\"",
    "\"total\"",
    "\"nearest\"",
    "\"scene.positions\"",
    "\"camera\"",
    "\"params\"",
    "\"ö\"",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    "()",
    "[]",
    "{}",
    "Param(\"edge\")",
    "Param(\"sun\")",
    "Viewport",
    "Pixels",
    "Load",
    "None",
    "Some(1)",
    "true",
    "'x'",
    "r#\"raw\"#",
    "/*",
    "//",
    "#import \"graph.ron\"\n",
    "#import \"shared/scene.wgsl\"\n",
    "#import",
    "@group(4294967295)",
    "@binding(1000000)",
    "array<u32, 1000000000>",
    "texture_3d<f32>",
    "vec4<f32>",
    "ptr<function, u32>",
    "f16",
    "1u << 99u",
    "🙂",
    "\u{feff}",
    "\u{0}",
    "\r\n",
    "\\",
];

prop_compose! {
    /// A file, a place in it (as a share of its words), how many words go, and what comes instead.
    fn any_change()(file in 0..6usize, at in 0.0..1.0f64, gone in 0..4usize, word in 0..WORDS.len()) -> (usize, f64, usize, usize) {
        (file, at, gone, word)
    }
}

/// Replaces some words of a text: runs of letters and digits, or single characters.
fn change(text: &str, at: f64, gone: usize, word: &str) -> String {
    let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let mut borders = vec![0];
    let mut before = None;
    for (index, c) in text.char_indices() {
        if index > 0 && !(is_word(c) && before.is_some_and(is_word)) {
            borders.push(index);
        }
        before = Some(c);
    }
    borders.push(text.len());
    let first = ((borders.len() - 1) as f64 * at) as usize;
    let last = (first + gone).min(borders.len() - 1);
    format!(
        "{}{word}{}",
        &text[..borders[first]],
        &text[borders[last]..]
    )
}

/// The files with some words replaced.
fn changed(changes: Vec<(usize, f64, usize, usize)>) -> Files {
    let mut files = files();
    let names: Vec<String> = files.0.keys().cloned().collect();
    for (file, at, gone, word) in changes {
        let name = &names[file];
        let text = change(&files.0[name], at, gone, WORDS[word]);
        files.0.insert(name.clone(), text);
    }
    files
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    /// Words are lost, added and swapped anywhere in the document and its shaders.
    #[test]
    fn changed_anywhere(changes in prop::collection::vec(any_change(), 1..4)) {
        let files = changed(changes);
        // Right or wrong, it is an answer.
        if let Err(text) = judge(&files) {
            prop_assert!(!text.is_empty());
        }
    }

    /// Anything at all.
    #[test]
    fn no_document_at_all(text in "\\PC{0,200}", shader in "\\PC{0,200}") {
        prop_assert!(judge(&files().with("graph.ron", text)).is_err());
        let _ = judge(&files().with("shade.wgsl", shader));
    }

    /// Sizes and counts up to where numbers end, on viewports up to where they end.
    #[test]
    fn any_size(width in any::<u32>(), height in any::<u32>(), count in any::<u32>(), factor in any::<f32>(), mips in any::<u32>(), layers in any::<u32>()) {
        let document = DOCUMENT
            .replace("ViewportTimes(0.5)", &format!("ViewportTimes({factor:e})"))
            .replace("Times(2,", &format!("Times({count},"))
            .replace("mips: 2, layers: 1", &format!("mips: {}, layers: {}", mips % 40, layers % 3000))
            .replace("mips: 1)]", &format!("mips: {})]", mips % 3));
        let files = files().with("graph.ron", document);
        let graph = Graph::load("graph.ron", &Registry::standard(), &files);
        let graph = graph.unwrap_or_else(|errors| panic!("sizes are not known yet: {errors}"));
        {
            for viewport in [[width, height], [width % 8193, height % 8193], [1, 1]] {
                let mut request = PlanRequest::new(viewport, &Triangle);
                for limits in [wgpu::Limits::default(), wgpu::Limits { max_texture_dimension_2d: u32::MAX, max_texture_array_layers: u32::MAX, max_buffer_size: u64::MAX, max_storage_buffer_binding_size: u64::MAX, max_compute_workgroups_per_dimension: u32::MAX, ..wgpu::Limits::default() }] {
                    request.limits = limits;
                    if let Ok(plan) = graph.plan(&request) {
                        let _ = (plan.memory_bytes(), plan.outputs());
                    }
                }
            }
        }
    }
}

/// As many bytes as 64 bits cannot count, where a host's limits allow for them.
#[test]
fn more_bytes_than_can_be_counted() {
    let document = "(format: 1,
        materials: [Texture(name: \"image\", format: Rgba32Float, size: Texels(4294967295, \
            4294967295), mips: 32, layers: 64),
            Buffer(name: \"items\", count: Times(4294967295, 1073741823))],
        passes: [Clear(name: \"reset\", target: \"image\"), Compute(name: \"number\", dispatch: \
            Groups(1, 1, 1))],
        outputs: [(name: \"image\"), (name: \"items\")])";
    let shader = "var<storage, read_write> items: array<u32>; @compute @workgroup_size(1) fn \
        main() { items[0] = 1u; }";
    let files = Files::new([("graph.ron", document), ("number.wgsl", shader)]);
    let graph = Graph::load("graph.ron", &Registry::standard(), &files)
        .unwrap_or_else(|errors| panic!("{errors}"));
    let mut request = PlanRequest::new([1, 1], &Triangle);
    request.limits = wgpu::Limits {
        max_texture_dimension_2d: u32::MAX,
        max_buffer_size: u64::MAX,
        max_storage_buffer_binding_size: u64::MAX,
        ..wgpu::Limits::default()
    };
    let plan = graph
        .plan(&request)
        .unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(plan.memory_bytes(), u64::MAX);
    assert_eq!(plan.outputs()[1].size, [u32::MAX, 1]);
}

/// What may stand in the place of something in the document or its shaders, and often still plans.
const OTHERS: &[(&str, &[&str])] = &[
    (
        "R32Float",
        &[
            "R16Float",
            "Rgba32Float",
            "R8Unorm",
            "Rg32Float",
            "Rgba8UnormSrgb",
            "Rg11b10Ufloat",
        ],
    ),
    ("Depth32Float", &["Depth16Unorm", "Depth24Plus"]),
    (
        "Square(Param(\"edge\"))",
        &[
            "Texels(1, 1)",
            "Texels(8192, 1)",
            "Like(\"small\")",
            "Texels(5, 300)",
        ],
    ),
    (
        "ViewportTimes(0.5)",
        &[
            "ViewportTimes(2)",
            "ViewportTimes(0.0001)",
            "Square(1)",
            "Viewport",
        ],
    ),
    (
        "Times(2, PixelsOf(\"small\"))",
        &[
            "1",
            "65",
            "Pixels",
            "CountOf(\"scene.indices\")",
            "Times(64, 2048)",
        ],
    ),
    (
        "Groups(1, 2, 3)",
        &[
            "Groups(0, 1, 1)",
            "Over(\"small\")",
            "Over(\"kept\")",
            "Indirect(\"items\")",
            "Over(\"scene.positions\")",
        ],
    ),
    (
        "compare: Less",
        &[
            "compare: Always, write: false",
            "compare: Never",
            "compare: GreaterEqual",
        ],
    ),
    (
        "load: Clear(1.0)",
        &["load: Clear(0)", "load: Clear(Param(\"bias\"))"],
    ),
    (
        "load: Clear(0, 0, 0, 0)",
        &[
            "load: Clear(0.5, 1e30, -1, 0)",
            "blend: Additive",
            "blend: Alpha",
            "blend: Min",
        ],
    ),
    ("mips: 2", &["mips: 1", "mips: 5"]),
    ("layers: 1", &["layers: 2"]),
    (
        "bias: (constant: 1)",
        &[
            "bias: (slope_scale: 1e30, clamp: -1)",
            "bias: (constant: -2147483648)",
        ],
    ),
    ("default: 16", &["default: 1", "default: 64"]),
    ("default: -0.5", &["default: 1e30", "default: 0"]),
    (
        "default: \"front\"",
        &["default: \"none\"", "default: \"back\""],
    ),
    ("filter: Nearest", &["filter: Linear", "compare: Less"]),
    (
        "draw: CountOf(\"scene.indices\")",
        &[
            "draw: 0",
            "draw: 7",
            "draw: 3, instances: 0",
            "draw: 3, topology: LineList",
            "draw: 3, topology: PointList",
            "draw: 3, topology: TriangleStrip",
            "draw: Indirect(\"items\")",
        ],
    ),
    (
        "@workgroup_size(64)",
        &[
            "@workgroup_size(1)",
            "@workgroup_size(16, 16)",
            "@workgroup_size(1, 1, 64)",
            "@workgroup_size(256)",
        ],
    ),
    (
        "Over(\"items\")",
        &[
            "Over(\"kept\")",
            "Over(\"depth\")",
            "Over(\"scene.indices\")",
            "Groups(65535, 1, 1)",
        ],
    ),
    (
        "items[id.x] = id.x;",
        &[
            "items[id.x] = items[id.x / 0u];",
            "items[9999999u] = 1u;",
            "var x: f16 = 1.0h;",
            "workgroupBarrier();",
        ],
    ),
    (
        "var<uniform> params",
        &[
            "@group(3) @binding(9) var<uniform> params",
            "@group(1) @binding(999) var<uniform> params",
        ],
    ),
    (
        "from: \"small\", to: \"same\"",
        &[
            "from: \"same\", to: \"small\"",
            "from: \"top\", to: \"same\"",
        ],
    ),
    (
        "name: \"top\", mip: 0, mips: 1",
        &["name: \"top\", mip: 1, mips: 1", "name: \"top\", mip: 1"],
    ),
];

/// The files with some things replaced by others of their kind.
fn varied(choices: &[(usize, usize)]) -> Files {
    let mut files = files();
    for (which, other) in choices {
        let (from, to) = OTHERS[which % OTHERS.len()];
        for text in files.0.values_mut() {
            *text = text.replacen(from, to[other % to.len()], 1);
        }
    }
    files
}

/// What plans must also run, or be refused with an error: wgpu's own answer to an error that nobody
/// catches is a panic.
#[test]
fn what_plans_runs_or_is_refused() {
    let gpu = gpu::open(None).unwrap_or_else(|error| panic!("{error}"));
    let ran = std::cell::Cell::new(0);
    let mut runner = TestRunner::new_with_rng(
        ProptestConfig {
            cases: 300,
            failure_persistence: None,
            ..ProptestConfig::default()
        },
        TestRng::deterministic_rng(RngAlgorithm::ChaCha),
    );
    let outcome = runner.run(
        &prop::collection::vec(any::<(usize, usize)>(), 1..3),
        |choices| {
            let files = varied(&choices);
            let Ok(graph) = Graph::load("graph.ron", &Registry::standard(), &files) else {
                return Ok(());
            };
            let mut request = PlanRequest::new([33, 17], &Triangle);
            request.limits = gpu.device.limits();
            request.features = gpu.device.features();
            let Ok(plan) = graph.plan(&request) else {
                return Ok(());
            };
            let outputs: Vec<String> = plan
                .outputs()
                .into_iter()
                .map(|output| output.name)
                .collect();
            let read: Vec<&str> = outputs.iter().map(String::as_str).collect();
            match Executor::new(&gpu.device, &gpu.queue, plan, &mut Triangle) {
                Err(error) => prop_assert!(!error.to_string().is_empty()),
                Ok(mut executor) => {
                    let mut encoder = gpu
                        .device
                        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                    executor
                        .encode(
                            &mut encoder,
                            &Frame {
                                timing: true,
                                read: &read,
                                ..Frame::default()
                            },
                        )
                        .map_err(|error| TestCaseError::fail(error.to_string()))?;
                    gpu.queue.submit([encoder.finish()]);
                    executor
                        .submitted(&gpu.queue)
                        .map_err(|error| TestCaseError::fail(error.to_string()))?;
                    let report = executor
                        .finish()
                        .map_err(|error| TestCaseError::fail(error.to_string()))?;
                    prop_assert_eq!(report.readbacks.len(), read.len());
                    ran.set(ran.get() + 1);
                }
            }
            Ok(())
        },
    );
    outcome.unwrap_or_else(|failure| panic!("{failure}"));
    let ran = ran.get();
    assert!(
        ran > 50,
        "only {ran} of the changed documents ran: the test says little"
    );
}
