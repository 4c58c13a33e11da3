//! Shaders: imports and their line map, binding numbers, derived access, the params block. All
//! without a GPU.

use crate::support::{Files, codes, load, plan, right, wrong};
use skiagraph_graph::{Code, Graph, NoProvider, PlanRequest, Registry};

/// One pass that writes `image` with `main.wgsl`.
fn one_pass(shader: &str) -> Files {
    let sections = r#"
        materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "main", color: ["image"])],
        outputs: ["image"]"#;
    Files::graph(sections).with("main.wgsl", shader)
}

#[track_caller]
fn first_place(files: &Files) -> String {
    let errors = wrong(load(files));
    let label = errors
        .iter()
        .next()
        .and_then(|error| error.labels.first().cloned());
    label.map_or_else(|| errors.to_string(), |label| label.span.to_string())
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
    right(load(&files));
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

/// An import in a comment is none, and a comment that was closed hides none.
#[test]
fn an_import_in_a_comment_is_none() {
    let main = "@fragment fn f() -> @location(0) f32 { return one(); }";
    let one = "fn one() -> f32 { return 1.0; }";
    for (comment, is_imported) in [
        ("/*\n#import \"a.wgsl\"\n*/", false),
        ("/* /* */\n#import \"a.wgsl\"\n*/", false),
        ("/* // */ /*\n  #import \"a.wgsl\"\n*/", false),
        ("// #import \"a.wgsl\"", false),
        ("// /*\n#import \"a.wgsl\"", true),
        ("/* /* */ */\n#import \"a.wgsl\" // /*", true),
    ] {
        let shader = format!("{comment}\n{main}");
        let importing = one_pass(&shader).with("a.wgsl", one);
        assert_eq!(load(&importing).is_ok(), is_imported, "{comment}");
        // The file is not looked for, either.
        let beside = one_pass(&format!("{shader}\n{one}"));
        assert_eq!(load(&beside).is_ok(), !is_imported, "{comment}");
    }
}

/// Shaders stand beside the document, beside its folder in `shaders/`, or in the store's
/// `shaders/`; imports likewise.
#[test]
fn where_shaders_are_looked_for() {
    let files = one_pass("");
    let document = files.texts["graph.ron"].clone();
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
        let sections = format!(
            "materials: [{}], passes: [{}, Compute(name: \"main\", dispatch: Groups(1, 1, 1))], \
             outputs: [\"a\"]",
            materials.join(", "),
            clears.join(", ")
        );
        let files = Files::new([("m.wgsl", module)]).with("main.wgsl", shader);
        plan(&files.document("graph.ron", &sections))
    };
    let body = "a[0] = b[0] + c[0] + d[0];";
    let module = "var<storage, read> b: array<u32>;\nvar<storage, read> c: array<u32>;";
    let own = "var<storage, read_write> a: array<u32>;\nvar<storage, read> d: array<u32>;";
    right(with(module, own, body));
    let numbered = "@group(1) @binding(0) var<storage, read> d: array<u32>;\n@group(0) \
        @binding(1) var<storage, read_write> a: array<u32>;";
    right(with(module, numbered, body));
    let clash = "@group(1) @binding(3) var<storage, read> d: array<u32>;\n@group(1) @binding(3) \
        var<storage, read_write> a: array<u32>;";
    let errors = wrong(with(module, clash, body));
    assert_eq!(codes(errors.iter()), [Code::Binding]);
    // Two that no entry point uses together are fine.
    right(with(module, clash, "a[0] = b[0] + c[0];"));
}

const STORAGE: &str = "var<storage, read_write> items: array<u32>;";
const ATOMIC: &str = "var<storage, read_write> items: array<atomic<u32>>;";
const WRITE_ONLY: &str = "var items: texture_storage_2d<r32uint, write>;";
const READ_WRITE: &str = "var items: texture_storage_2d<r32uint, read_write>;";
const SAMPLED: &str = "var items: texture_2d<u32>;";

/// Kind of access, declaration of `items`, body of the shader; true if a write must come before.
const ACCESSES: &[(&str, &str, &str, bool)] = &[
    ("a read", STORAGE, "total = items[0];", true),
    (
        "a read of a read-only buffer",
        "var<storage, read> items: array<u32>;",
        "total = items[0];",
        true,
    ),
    ("a write", STORAGE, "items[0] = 1u;", false),
    ("a read and a write", STORAGE, "items[0] += 1u;", true),
    (
        "a write through a pointer",
        STORAGE,
        "let p = &items[1]; *p = 2u;",
        false,
    ),
    (
        "an atomic addition",
        ATOMIC,
        "atomicAdd(&items[0], 1u);",
        true,
    ),
    (
        "an atomic load",
        ATOMIC,
        "total = atomicLoad(&items[0]);",
        true,
    ),
    (
        "an atomic store",
        ATOMIC,
        "atomicStore(&items[0], 1u);",
        false,
    ),
    ("its length", STORAGE, "total = arrayLength(&items);", false),
    (
        "a texture store",
        WRITE_ONLY,
        "textureStore(items, vec2<u32>(0u), vec4<u32>(1u));",
        false,
    ),
    (
        "a texture load and store",
        READ_WRITE,
        "textureStore(items, vec2<u32>(0u), textureLoad(items, vec2<u32>(0u)));",
        true,
    ),
    (
        "a texture load",
        SAMPLED,
        "total = textureLoad(items, vec2<u32>(0u), 0).x;",
        true,
    ),
    (
        "a texture's size",
        SAMPLED,
        "total = textureDimensions(items).x;",
        false,
    ),
    ("a global without a use", SAMPLED, "", false),
];

/// The access of a pass to `items`, told by the demands of the graph: a read or a change needs a
/// write before.
#[test]
fn access_is_derived_from_the_shader() {
    let needs_clear = |declaration: &str, body: &str, clear: bool| {
        let clear = if clear {
            "Clear(name: \"reset\", target: \"items\"),"
        } else {
            ""
        };
        let items = if declaration.contains("storage,") {
            "Buffer(name: \"items\", count: 4)"
        } else {
            "Texture(name: \"items\", format: R32Uint)"
        };
        let sections = format!(
            "materials: [{items}, Buffer(name: \"total\")],
            passes: [{clear} Compute(name: \"main\", dispatch: Groups(1, 1, 1))],
            outputs: [\"total\"]"
        );
        let shader = format!(
            "{declaration}\nvar<storage, read_write> total: u32;\nfn touch(x: u32) {{ \
             }}\n@compute @workgroup_size(1) fn main() {{ total = 1u; {body} }}"
        );
        plan(&Files::graph(&sections).with("main.wgsl", shader))
    };
    for &(what, declaration, body, reads) in ACCESSES {
        let without = needs_clear(declaration, body, false);
        match (without, reads) {
            (Ok(_), false) => {}
            (Err(errors), true) => {
                let codes = codes(errors.iter());
                assert_eq!(codes, [Code::ReadBeforeWrite], "{what}: {errors}");
            }
            (Ok(_), true) => panic!("{what} is taken for no read"),
            (Err(errors), false) => panic!("{what} is taken for a read: {errors}"),
        }
        needs_clear(declaration, body, true).expect(what);
    }
}

/// Params reach the shader bit for bit, whatever the layout rules put between them, and overrides
/// are filled.
#[test]
fn params_and_overrides_are_laid_out() {
    let sections = r#"
        params: [
            F32(name: "scale", default: 0.5), I32(name: "offset", default: -7),
            U32(name: "edge", default: 4294967295), Bool(name: "soft", default: true),
            Choice(name: "cull", words: [none, front, back], default: back),
            Vec2(name: "pair", default: (1, 2)), Vec3(name: "sun", default: (3, 4, 5)),
            Vec4(name: "tint", default: (6, 7, 8, 9)), U32(name: "steps", default: 12),
            F32(name: "bend", default: 0.25), Bool(name: "hard", default: false),
            I32(name: "shift", default: -3),
        ],
        materials: [Buffer(name: "words")],
        passes: [Compute(name: "main", dispatch: Groups(1, 1, 1))],
        outputs: ["words"]"#;
    let shader = "struct Params { scale: f32, sun: vec3<f32>, soft: u32, pair: vec2<f32>, \
            offset: i32, tint: vec4<f32>, cull: u32, edge: u32 }
        var<uniform> params: Params;
        var<storage, read_write> words: array<f32, 8>;
        override steps: u32 = 1;
        @id(7) override bend: f32;
        override hard: bool = true;
        override shift: i32;
        override own: u32 = 77;
        @compute @workgroup_size(1) fn main() {
            words[0] = params.scale + params.sun.x + params.tint.y + bend;
            words[1] = f32(steps + own + params.cull + u32(shift));
            words[2] = select(0.0, 1.0, hard);
        }";
    let graph = right(load(&Files::graph(sections).with("main.wgsl", shader)));
    // The words of the uniform, and the overrides that have a value of the document.
    let filled = |request: &PlanRequest<'_>| {
        let plan = right(graph.plan(request));
        let program = plan.all_passes()[0].steps[0].program().expect("it has one");
        let bytes = program.params().expect("the shader has params");
        let words = bytes.chunks(4);
        let words = words.map(|word| u32::from_le_bytes(word.try_into().expect("it has four")));
        let mut constants = program.constants.clone();
        constants.sort_by(|a, b| a.0.cmp(&b.0));
        (words.collect::<Vec<u32>>(), constants)
    };
    let mut request = PlanRequest::new([8, 8], &NoProvider);
    let f = f32::to_bits;
    let negative = |number: i32| number.cast_unsigned();
    let overrides = |bend, hard| {
        let constants = [
            ("7", bend),
            ("hard", hard),
            ("shift", -3.0),
            ("steps", 12.0),
        ];
        constants
            .map(|(name, value)| (name.to_owned(), value))
            .to_vec()
    };
    let (words, constants) = filled(&request);
    // A vector of three begins at a multiple of 16 bytes, and leaves its fourth word to the next.
    let expected = [
        [f(0.5), 0, 0, 0],
        [f(3.0), f(4.0), f(5.0), 1],
        [f(1.0), f(2.0), negative(-7), 0],
        [f(6.0), f(7.0), f(8.0), f(9.0)],
        [2, u32::MAX, 0, 0],
    ];
    assert_eq!(words, expected.concat());
    assert_eq!(constants, overrides(0.25, 0.0));
    for (name, value) in [
        ("scale", "-1.5"),
        ("cull", "front"),
        ("soft", "false"),
        ("hard", "true"),
        ("sun", "1,2,-3"),
        ("bend", "8"),
    ] {
        let value = graph.parse_param(name, value).expect(name);
        request.params.insert(name.to_owned(), value);
    }
    let (words, constants) = filled(&request);
    assert_eq!(
        [words[0], words[6], words[7], words[16]],
        [f(-1.5), f(-3.0), 0, 1]
    );
    assert_eq!(constants, overrides(8.0, 1.0));
}

/// Number and time of the uniform `frame` are a reason to run for `OnChange`; its flags are none.
/// That holds for each member, and for every name under which it is bound.
#[test]
fn flags_of_the_frame_trigger_nothing() {
    let frame = "struct Frame { index: u32, seconds: f32, changed_scene: u32, changed_light: u32 }
        var<uniform> FRAME: Frame;
        fn flag() -> u32 { return FRAME.changed_light; }
        fn time() -> f32 { return FRAME.seconds; }";
    for (value, triggers) in [
        ("f32(FRAME.changed_scene)", false),
        ("f32(flag())", false),
        ("time()", true),
        ("f32(FRAME.index + flag())", true),
        ("f32(copy().changed_scene)", true),
    ] {
        for name in ["frame", "other"] {
            let shader = format!(
                "{frame} fn copy() -> Frame {{ return FRAME; }}
                 @fragment fn fragment() -> @location(0) f32 {{ return {value}; }}"
            );
            let files = one_pass(&shader.replace("FRAME", name));
            let bind = [
                r#"color: ["image"]"#,
                r#"color: ["image"], bind: {"other": "frame"}"#,
            ];
            let files = match name {
                "frame" => files,
                _ => files.edited("graph.ron", bind[0], bind[1]),
            };
            let plan = right(plan(&files));
            let pass = &plan.all_passes()[0];
            let mut accesses = pass.accesses.iter();
            let access = accesses.find(|it| plan.resource(it.resource).name == "frame");
            let access = access.expect("it is bound");
            assert!(access.reads);
            assert_eq!(access.triggers, triggers, "{value}");
        }
    }
}
