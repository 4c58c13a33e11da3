//! Shaders: imports and their line map, binding numbers, derived access, the params block. All
//! without a GPU, but the last.

mod support;

use skiagraph_graph::{
    Code, Diagnostics, Executor, Frame, Graph, NoProvider, PlanRequest, Registry, gpu,
};
use support::{Files, load, plan};

fn document(materials: &str, passes: &str, outputs: &str) -> String {
    format!("(format: 1, materials: [{materials}], passes: [{passes}], outputs: [{outputs}])")
}

fn errors<T>(result: Result<T, Diagnostics>) -> Diagnostics {
    result
        .err()
        .unwrap_or_else(|| panic!("a mistake was not found"))
}

/// One pass that writes `image` with `main.wgsl`.
fn one_pass(shader: &str) -> Files {
    let document = document(
        "Texture(name: \"image\", format: R32Float, size: Viewport)",
        "Fullscreen(name: \"main\", color: [(target: \"image\")])",
        "(name: \"image\")",
    );
    Files::new([("main.wgsl", shader)]).with("graph.ron", document)
}

#[track_caller]
fn first_place(files: &Files) -> String {
    let found = errors(load(files));
    let label = found
        .iter()
        .next()
        .and_then(|error| error.labels.first().cloned());
    label.map_or_else(|| found.to_string(), |label| label.span.to_string())
}

/// Errors point into the file and line where the author wrote them, wherever imports moved the
/// text.
#[test]
fn errors_are_found_in_their_file() {
    let good = "// ein Kommentar: größer → ∞\nfn one() -> f32 { return 1.0; }\n";
    let table = [
        // In the second import, after a first one.
        (
            "#import \"a.wgsl\"\n#import \"b.wgsl\"\n@fragment fn f() -> @location(0) f32 { \
             return one(); }",
            "\n\nfn two() -> f32 { return nothing; }",
            "b.wgsl:3:26",
        ),
        // In the importing file, between and after imports.
        (
            "#import \"a.wgsl\"\nfn f() -> f32 { return nothing; }\n#import \"b.wgsl\"\n",
            "\n",
            "main.wgsl:2:24",
        ),
        (
            "#import \"a.wgsl\"\n#import \"b.wgsl\"\n\nfn f() -> f32 { return nothing; }",
            "\n",
            "main.wgsl:4:24",
        ),
        // The imported file has no line end of its own.
        (
            "#import \"b.wgsl\"\nfn f() -> f32 { return nothing; }",
            "fn two() -> f32 { return 2.0; }",
            "main.wgsl:2:24",
        ),
        // Windows line ends, and an import that is indented.
        (
            "  #import \"a.wgsl\"\r\n#import \"b.wgsl\"\r\nfn f() -> f32 {\r\n  return \
             nothing;\r\n}\r\n",
            "fn two() -> f32 {\r\n return 2.0;\r\n}\r\n",
            "main.wgsl:4:10",
        ),
        // Columns are counted in characters.
        (
            "/* größer → */ fn f() -> f32 { return nothing; }",
            "",
            "main.wgsl:1:39",
        ),
        // Types that are no layout errors but validation errors.
        (
            "#import \"b.wgsl\"\n@fragment fn f() -> @location(0) f32 { return two(); }",
            "fn two() -> f32 {\n  let x: u32 = 1.0;\n  return 2.0;\n}\n",
            "b.wgsl:2:7",
        ),
        // The same module twice, and a module that imports itself and its importer.
        (
            "#import \"a.wgsl\"\n#import \"a.wgsl\"\nfn f() -> f32 { return nothing; }",
            "",
            "main.wgsl:3:24",
        ),
        (
            "#import \"b.wgsl\"\nfn f() -> f32 { return nothing; }",
            "#import \"b.wgsl\"\n#import \"main.wgsl\"\n#import \"a.wgsl\"\n",
            "main.wgsl:2:24",
        ),
    ];
    for (shader, imported, place) in table {
        let files = one_pass(shader)
            .with("a.wgsl", good)
            .with("b.wgsl", imported);
        assert_eq!(first_place(&files), place, "{shader}");
    }
}

#[test]
fn an_import_is_there_once() {
    let once = "fn one() -> f32 { return 1.0; }";
    let files = one_pass(
        "#import \"a.wgsl\" // one()\n#import \"b.wgsl\"\n#import \
        \"a.wgsl\"\n@fragment fn f() -> @location(0) f32 { return one() + two(); }",
    )
    .with("a.wgsl", once)
    .with(
        "b.wgsl",
        "#import \"a.wgsl\"\n#import \"main.wgsl\"\nfn two() -> f32 { return 2.0 \
            * one(); }",
    );
    load(&files).unwrap_or_else(|errors| panic!("{errors}"));
    // A comment ends at any of WGSL's line breaks, and code behind it would be lost.
    for after in [
        " one",
        ";",
        " // one()\r fn f() {}",
        " // \u{2028} fn f() {}",
    ] {
        let files = one_pass(&format!("#import \"a.wgsl\"{after}\n")).with("a.wgsl", once);
        let text = load(&files).expect_err(after).to_string();
        assert!(text.contains("an import names a file in quotes"), "{text}");
    }
}

/// Shaders stand beside the document, beside its folder in `shaders/`, or in the store's
/// `shaders/`; imports likewise.
#[test]
fn where_shaders_are_looked_for() {
    let files = one_pass("");
    let document = files.0["graph.ron"].clone();
    let shader =
        "#import \"shared/one.wgsl\"\n@fragment fn f() -> @location(0) f32 { return one(); }";
    let module = "fn one() -> f32 { return 1.0; }";
    for (path, main, one) in [
        (
            "house/pipelines/graph.ron",
            "house/pipelines/main.wgsl",
            "house/pipelines/shared/one.wgsl",
        ),
        (
            "house/pipelines/graph.ron",
            "house/shaders/main.wgsl",
            "house/shaders/shared/one.wgsl",
        ),
        (
            "house/pipelines/shared/graph.ron",
            "house/shaders/main.wgsl",
            "house/shaders/shared/one.wgsl",
        ),
        (
            "house/pipelines/graph.ron",
            "shaders/main.wgsl",
            "shaders/shared/one.wgsl",
        ),
        (
            "house/pipelines/graph.ron",
            "house/pipelines/main.wgsl",
            "shaders/shared/one.wgsl",
        ),
        ("/abs/graph.ron", "/abs/main.wgsl", "/abs/shared/one.wgsl"),
    ] {
        let files = Files::new([(path, document.as_str()), (main, shader), (one, module)]);
        Graph::load(path, &Registry::standard(), &files)
            .unwrap_or_else(|errors| panic!("{path}, {main}, {one}: {errors}"));
    }
}

/// Numbers that are written stay, free ones are given, and one number for two globals of an entry
/// point is a mistake.
#[test]
fn binding_numbers() {
    let with = |module: &str, own: &str, body: &str| {
        let shader = format!(
            "#import \"m.wgsl\"\n{own}\n@compute @workgroup_size(1) fn main() {{ {body} }}"
        );
        let names = ["a", "b", "c", "d"];
        let materials: Vec<String> = names
            .map(|name| format!("Buffer(name: \"{name}\", count: 4)"))
            .to_vec();
        let clears: Vec<String> = names
            .map(|name| format!("Clear(name: \"clear_{name}\", target: \"{name}\")"))
            .to_vec();
        let passes = format!(
            "{}, Compute(name: \"main\", dispatch: Groups(1, 1, 1))",
            clears.join(", ")
        );
        let files = Files::new([("m.wgsl", module)]).with("main.wgsl", shader);
        plan(&files.with(
            "graph.ron",
            document(&materials.join(", "), &passes, "(name: \"a\")"),
        ))
    };
    let all = "a[0] = b[0] + c[0] + d[0];";
    let module = "var<storage, read> b: array<u32>;\nvar<storage, read> c: array<u32>;";
    let own = "var<storage, read_write> a: array<u32>;\nvar<storage, read> d: array<u32>;";
    with(module, own, all).unwrap_or_else(|errors| panic!("{errors}"));
    let numbered = "@group(1) @binding(0) var<storage, read> d: array<u32>;\n@group(0) \
        @binding(1) var<storage, read_write> a: array<u32>;";
    with(module, numbered, all).unwrap_or_else(|errors| panic!("{errors}"));
    let clash = "@group(1) @binding(3) var<storage, read> d: array<u32>;\n@group(1) @binding(3) \
        var<storage, read_write> a: array<u32>;";
    let found = errors(with(module, clash, all));
    assert_eq!(
        found.iter().map(|error| error.code).collect::<Vec<_>>(),
        [Code::Binding]
    );
    // Two that no entry point uses together are fine.
    with(module, clash, "a[0] = b[0] + c[0];").unwrap_or_else(|errors| panic!("{errors}"));
}

/// What a pass does to `items`, told by what the graph demands: a read or a change needs a write
/// before.
#[test]
fn access_is_derived_from_the_shader() {
    let needs_clear = |declaration: &str, body: &str, clear: bool| {
        let clear = if clear {
            "Clear(name: \"reset\", target: \"items\"),"
        } else {
            ""
        };
        let document = document(
            "Texture(name: \"items\", format: R32Uint, size: Viewport), Buffer(name: \"total\")",
            &format!("{clear} Compute(name: \"main\", dispatch: Groups(1, 1, 1))"),
            "(name: \"total\")",
        );
        let document = match declaration.contains("storage,") || declaration.contains("storage>") {
            true => document.replace(
                "Texture(name: \"items\", format: R32Uint, size: Viewport)",
                "Buffer(name: \"items\", count: 4)",
            ),
            false => document,
        };
        let shader = format!(
            "{declaration}\nvar<storage, read_write> total: u32;\nfn touch(x: u32) {{ \
             }}\n@compute @workgroup_size(1) fn main() {{ total = 1u; {body} }}"
        );
        plan(&Files::new([("main.wgsl", shader.as_str())]).with("graph.ron", document))
    };
    let storage = "var<storage, read_write> items: array<u32>;";
    let atomic = "var<storage, read_write> items: array<atomic<u32>>;";
    let write_only = "var items: texture_storage_2d<r32uint, write>;";
    let read_write = "var items: texture_storage_2d<r32uint, read_write>;";
    let sampled = "var items: texture_2d<u32>;";
    let table = [
        ("a read", storage, "total = items[0];", true),
        (
            "a read of a read-only buffer",
            "var<storage, read> items: array<u32>;",
            "total = items[0];",
            true,
        ),
        ("a write", storage, "items[0] = 1u;", false),
        ("a read and a write", storage, "items[0] += 1u;", true),
        (
            "a write through a pointer",
            storage,
            "let p = &items[1]; *p = 2u;",
            false,
        ),
        (
            "an atomic addition",
            atomic,
            "atomicAdd(&items[0], 1u);",
            true,
        ),
        (
            "an atomic load",
            atomic,
            "total = atomicLoad(&items[0]);",
            true,
        ),
        (
            "an atomic store",
            atomic,
            "atomicStore(&items[0], 1u);",
            false,
        ),
        ("its length", storage, "total = arrayLength(&items);", false),
        (
            "a texture store",
            write_only,
            "textureStore(items, vec2<u32>(0u), vec4<u32>(1u));",
            false,
        ),
        (
            "a texture load and store",
            read_write,
            "textureStore(items, vec2<u32>(0u), textureLoad(items, vec2<u32>(0u)));",
            true,
        ),
        (
            "a texture load",
            sampled,
            "total = textureLoad(items, vec2<u32>(0u), 0).x;",
            true,
        ),
        (
            "a texture's size",
            sampled,
            "total = textureDimensions(items).x;",
            false,
        ),
        ("a global that nobody uses", sampled, "", false),
    ];
    for (what, declaration, body, reads) in table {
        let without = needs_clear(declaration, body, false);
        match (without, reads) {
            (Ok(_), false) => {}
            (Err(found), true) => {
                assert_eq!(
                    found.iter().map(|error| error.code).collect::<Vec<_>>(),
                    [Code::ReadBeforeWrite],
                    "{what}: {found}"
                );
            }
            (Ok(_), true) => panic!("{what} is taken for no read"),
            (Err(found), false) => panic!("{what} is taken for a read: {found}"),
        }
        needs_clear(declaration, body, true).unwrap_or_else(|errors| panic!("{what}: {errors}"));
    }
}

/// Params reach the shader bit for bit, whatever the layout rules put between them, and overrides
/// are filled.
#[test]
fn params_and_overrides_arrive() {
    let gpu = gpu::open(None).unwrap_or_else(|error| panic!("{error}"));
    let document = "(format: 1,
        params: [
            (name: \"scale\", type: F32, default: 0.5), (name: \"offset\", type: I32, default: -7),
            (name: \"edge\", type: U32, default: 4294967295), (name: \"soft\", type: Bool, \
                default: true),
            (name: \"cull\", type: Choice([\"none\", \"front\", \"back\"]), default: \"back\"),
            (name: \"pair\", type: Vec2, default: (1, 2)), (name: \"sun\", type: Vec3, default: \
                (3, 4, 5)),
            (name: \"tint\", type: Vec4, default: (6, 7, 8, 9)), (name: \"steps\", type: U32, \
                default: 12),
            (name: \"bend\", type: F32, default: 0.25), (name: \"hard\", type: Bool, default: \
                false),
            (name: \"shift\", type: I32, default: -3),
        ],
        materials: [Buffer(name: \"words\")],
        passes: [Compute(name: \"main\", dispatch: Groups(1, 1, 1))],
        outputs: [(name: \"words\")])";
    let shader = "struct Params { scale: f32, sun: vec3<f32>, soft: u32, pair: vec2<f32>, offset: \
        i32, tint: vec4<f32>, cull: u32, edge: u32 }
        var<uniform> params: Params;
        var<storage, read_write> words: array<u32, 18>;
        override steps: u32 = 1;
        @id(7) override bend: f32;
        override hard: bool = true;
        override shift: i32;
        override own: u32 = 77;
        @compute @workgroup_size(1) fn main() {
            words[0] = bitcast<u32>(params.scale);
            words[1] = bitcast<u32>(params.sun.x); words[2] = bitcast<u32>(params.sun.y); words[3] = bitcast<u32>(params.sun.z);
            words[4] = params.soft;
            words[5] = bitcast<u32>(params.pair.x); words[6] = bitcast<u32>(params.pair.y);
            words[7] = bitcast<u32>(params.offset);
            words[8] = bitcast<u32>(params.tint.x); words[9] = bitcast<u32>(params.tint.w);
            words[10] = params.cull;
            words[11] = params.edge;
            words[12] = steps; words[13] = bitcast<u32>(bend); words[14] = select(0u, 1u, hard);
            words[15] = bitcast<u32>(shift); words[16] = own;
        }";
    let files = Files::new([("graph.ron", document), ("main.wgsl", shader)]);
    let graph = load(&files).unwrap_or_else(|errors| panic!("{errors}"));
    let words = |request: &PlanRequest<'_>| {
        let plan = graph
            .plan(request)
            .unwrap_or_else(|errors| panic!("{errors}"));
        let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut NoProvider)
            .unwrap_or_else(|error| panic!("{error}"));
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        executor
            .encode(
                &mut encoder,
                &Frame {
                    timing: false,
                    read: &["words"],
                    ..Frame::default()
                },
            )
            .unwrap_or_else(|error| panic!("{error}"));
        gpu.queue.submit([encoder.finish()]);
        executor
            .submitted(&gpu.queue)
            .unwrap_or_else(|error| panic!("{error}"));
        let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
        report.readbacks[0]
            .content
            .as_u32()
            .expect("it holds words")
    };
    let mut request = PlanRequest::new([8, 8], &NoProvider);
    let f = f32::to_bits;
    let expected = [
        f(0.5),
        f(3.0),
        f(4.0),
        f(5.0),
        1,
        f(1.0),
        f(2.0),
        (-7i32).cast_unsigned(),
        f(6.0),
        f(9.0),
        2,
        u32::MAX,
        12,
        f(0.25),
        0,
        (-3i32).cast_unsigned(),
        77,
        0,
    ];
    assert_eq!(words(&request), expected);
    for (name, value) in [
        ("scale", "-1.5"),
        ("cull", "front"),
        ("soft", "false"),
        ("hard", "true"),
        ("sun", "1,2,-3"),
        ("bend", "8"),
    ] {
        let value = graph
            .parse_param(name, value)
            .unwrap_or_else(|error| panic!("{error}"));
        request.params.insert(name.to_owned(), value);
    }
    let changed = words(&request);
    assert_eq!(
        [
            changed[0],
            changed[3],
            changed[4],
            changed[10],
            changed[13],
            changed[14]
        ],
        [f(-1.5), f(-3.0), 0, 1, f(8.0), 1]
    );
}
