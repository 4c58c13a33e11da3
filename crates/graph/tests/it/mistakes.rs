//! Mistakes of files and requests rather than of a document: missing files, files that are no text,
//! deep nesting, requests for unknown things.

use crate::broken::{folder, request};
use crate::support::{Files, Triangle, checked, load, names, plan, right, wrong};
use skiagraph_graph::{
    Capture, Diagnostics, FolderSources, Graph, Import, ParamValue, PlanRequest, Registry,
};

fn text<T>(result: Result<T, Diagnostics>) -> String {
    wrong(result).to_string()
}

#[test]
fn a_document_that_is_not_there() {
    let message = text(Graph::load(
        "photographs.ron",
        &Registry::standard(),
        &folder(),
    ));
    insta::assert_snapshot!("missing_document", message);
}

#[test]
fn a_file_that_is_no_text() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let write = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.path().join(name), bytes).expect("it can be written");
    };
    write("binary.ron", &[0xff, 0xfe, 0x00, 0x28, 0x80]);
    write("binary.wgsl", &[0xc3, 0x28]);
    let shader = r#"(format: 3, materials: [Texture(name: "image", format: R32Float)],
    passes: [Fullscreen(name: "binary", color: ["image"])], outputs: ["image"])"#;
    write("shader.ron", shader.as_bytes());
    let include = r#"(format: 3, passes: [Include(graph: "binary.ron")], outputs: ["image"])"#;
    write("include.ron", include.as_bytes());
    let import = shader.replace("\"binary\"", "\"import\"");
    write("import.ron", import.as_bytes());
    write("import.wgsl", b"#import \"binary.wgsl\"\n");
    let sources = FolderSources {
        root: folder.path().to_owned(),
    };
    let messages = ["binary.ron", "shader.ron", "include.ron", "import.ron"]
        .map(|path| text(Graph::load(path, &Registry::standard(), &sources)));
    insta::assert_snapshot!("no_text", messages.join("\n"));
}

/// Nested far deeper than any sensible value: an error, and no overflow of the stack.
#[test]
fn values_nested_200_levels_deep() {
    let count = format!("{}1{}", "max(2, ".repeat(200), ")".repeat(200));
    let nested = Files::graph(&format!(
        "materials: [Buffer(name: \"items\", count: \"{count}\")]"
    ));
    let message = text(load(&nested));
    let lines: Vec<&str> = message.lines().take(3).collect();
    insta::assert_snapshot!("nested_200", lines.join("\n"));
    for [open, close] in [
        ["(", ")"],
        ["[", "]"],
        ["{", "}"],
        ["Some(", ")"],
        ["/*", "*/"],
    ] {
        for levels in [100, 200, 10_000] {
            let (open, close) = (open.repeat(levels), close.repeat(levels));
            assert!(load(&Files::graph(&format!("passes: {open}{close}"))).is_err());
        }
    }
}

const ITEMS: &str = r#"materials: [Buffer(name: "items", count: 1)],
    passes: [Compute(name: "index", dispatch: Over(1))], outputs: ["items"]"#;

/// Below the limit everything is read by itself, piece by piece; that must not overflow the stack
/// either.
#[test]
fn values_nested_40_levels_deep() {
    let count = format!("{}1{}", "max(1, ".repeat(40), ")".repeat(40));
    let shader = "var<storage, read_write> items: array<u32>;
        @compute @workgroup_size(1) fn main() { items[0] = 7u; }";
    let files = Files::graph(ITEMS)
        .edited("graph.ron", "count: 1", &format!("count: \"{count}\""))
        .with("index.wgsl", shader);
    assert_eq!(right(plan(&files)).outputs()[0].size, [4, 1]);
}

/// Each entry may name all others, so that time grows with the square.
#[test]
fn lists_too_long() {
    let entries = r#"Buffer(name: "items"), "#.repeat(4097);
    let message = text(load(&Files::graph(&format!("materials: [{entries}]"))));
    assert!(
        message.contains("the list has 4097 entries, 4096 is the most"),
        "{message}"
    );
    assert_eq!(message.matches("error[").count(), 1, "{message}");
}

/// WGSL nested deeper than a stack; more of it stands in `hostile.rs`.
#[test]
fn shaders_nested_deep() {
    let files = Files::graph(ITEMS);
    let (open, close) = ("(".repeat(5000), ")".repeat(5000));
    let brackets = format!("fn deep() -> u32 {{ return {open}1u{close}; }}");
    let message = text(load(&files.clone().with("index.wgsl", brackets)));
    assert!(message.contains("nested too deep"), "{message}");
    let mut chain = files.clone().with("index.wgsl", "#import \"m0.wgsl\"\n");
    for index in 0..100 {
        let import = format!("#import \"m{}.wgsl\"\n", index + 1);
        chain = chain.with(&format!("m{index}.wgsl"), import);
    }
    let message = text(load(&chain));
    assert!(message.contains("imports are nested too deep"), "{message}");
    // Types that double with every level: their layout is spelt out only so far.
    let mut bomb = "struct S0 { a: u32, b: u32 }\n".to_owned();
    for level in 1..24 {
        let below = level - 1;
        bomb += &format!("struct S{level} {{ a: S{below}, b: S{below} }}\n");
    }
    let (first, second) = (".a".repeat(24), ".b".repeat(24));
    bomb += &format!(
        "var<storage, read_write> items: S23;
        @compute @workgroup_size(1) fn main() {{ items{first} = items{second}; }}"
    );
    let files = files.edited("graph.ron", ", count: 1", "");
    let graph = right(load(&files.with("index.wgsl", bomb)));
    let message = text(graph.plan(&PlanRequest::new([8, 8], &Triangle)));
    assert!(message.contains("that no pass has written"), "{message}");
}

/// A graph with a param for its size, and materials that can and cannot be read back.
const ASKED: &str = r#"
    params: [U32(name: "edge", default: 4, max: 8), Choice(name: "cull", words: [none, front])],
    inputs: [Texture(name: "given", format: R32Float)],
    materials: [
        Texture(name: "image", format: R32Float, size: "edge"),
        Texture(name: "depth", format: Depth24Plus, size: "edge"),
        Texture(name: "late", format: R32Float, size: "edge"),
        Texture(name: "never", format: R32Float, size: "edge"),
        Sampler(name: "nearest"),
    ],
    passes: [
        Clear(name: "reset", target: "image"),
        Clear(name: "far", target: "depth"),
        Fullscreen(name: "read", color: ["late"]),
    ],
    outputs: ["image", "late"],
"#;

const READ: &str = "var<storage, read> scene_stream: array<u32>;
    var given: texture_2d<f32>;
    @fragment fn fragment() -> @location(0) f32 {
        return f32(scene_stream[1]) + textureLoad(given, vec2(0u), 0).x;
    }";

fn asked() -> Files {
    Files::graph(ASKED).with("read.wgsl", READ)
}

/// Imports of the host.
fn given() -> Import {
    let usage = wgt::TextureUsages::TEXTURE_BINDING;
    Import::plain_texture(wgt::TextureFormat::R32Float, [1, 1], usage)
}

fn capture(material: &str, after: Option<&str>) -> Capture {
    let capture = Capture::new(material);
    match after {
        Some(pass) => capture.with_after(pass),
        None => capture,
    }
}

/// Mistakes of a request rather than of the document.
#[test]
fn requests_that_cannot_be_met() {
    let graph = right(load(&asked()));
    let mut texts = Vec::new();
    let mut add = |what: &str, change: &dyn Fn(&mut PlanRequest<'_>)| {
        let mut request = PlanRequest::new([8, 8], &Triangle);
        let cull = ParamValue::Choice("none".to_owned());
        request.params.insert("cull".to_owned(), cull);
        request.imports.insert("given".to_owned(), given());
        change(&mut request);
        texts.push(format!("--- {what}\n{}", text(graph.plan(&request))));
    };
    add("no pixels", &|request| request.viewport = [0, 8]);
    for (what, name, value) in [
        ("an unknown param", "egde", ParamValue::U32(1)),
        ("a value out of range", "edge", ParamValue::U32(9)),
        ("a value of the wrong type", "edge", ParamValue::F32(1.0)),
        ("a size of nothing", "edge", ParamValue::U32(0)),
    ] {
        add(what, &|request| {
            request.params.insert(name.to_owned(), value.clone());
        });
    }
    add("no import", &|request| request.imports.clear());
    add("an unknown output", &|request| {
        request.outputs = Some(vec!["imgae".to_owned()]);
    });
    for (what, material, after) in [
        ("an unknown capture", "imgae", None),
        ("a capture after an unknown pass", "image", Some("rest")),
        ("an unknown capture after a pass", "imgae", Some("reset")),
        ("a capture of a sampler", "nearest", None),
        (
            "a capture of a sampler after a pass",
            "nearest",
            Some("reset"),
        ),
        ("a capture of what is never written", "never", None),
        ("a capture before it is written", "late", Some("reset")),
        ("a capture of a format of the driver's own", "depth", None),
        ("a capture of what the scene gives", "scene.stream", None),
        (
            "a capture of items that were not counted",
            "scene.stream",
            Some("read"),
        ),
    ] {
        add(what, &|request| {
            request.captures = vec![capture(material, after)]
        });
    }
    insta::assert_snapshot!("requests", texts.join(""));
}

/// Only a host's texture can be compressed, and only a copy can write it.
#[test]
fn a_compressed_texture_is_not_read_back() {
    let files = Files::graph(
        r#"inputs: [Texture(name: "from"), Texture(name: "to")],
        passes: [Copy(name: "copy", from: "from", to: "to")], outputs: ["to"]"#,
    );
    let usage = wgt::TextureUsages::COPY_SRC | wgt::TextureUsages::COPY_DST;
    let texture = Import::plain_texture(wgt::TextureFormat::Bc1RgbaUnorm, [8, 8], usage);
    let mut request = PlanRequest::new([8, 8], &Triangle);
    for name in ["from", "to"] {
        request.imports.insert(name.to_owned(), texture);
    }
    let message = text(right(load(&files)).plan(&request));
    insta::assert_snapshot!("compressed", message);
    request.outputs = Some(Vec::new());
    assert_eq!(names(&right(right(load(&files)).plan(&request))), ["copy"]);
}

#[test]
fn values_of_params_from_text() {
    let graph = right(load(&asked()));
    let read = |(name, value): (&str, &str)| {
        let parsed = graph.parse_param(name, value);
        let outcome = parsed.map_or_else(|error| error.to_string(), |value| value.to_string());
        format!("{name}={value}: {outcome}")
    };
    let texts = [
        ("egde", "1"),
        ("edge", "nine"),
        ("edge", "9"),
        ("edge", "-1"),
        ("edge", "1.5"),
        ("cull", "back"),
        ("cull", "front"),
        ("edge", "8"),
    ];
    insta::assert_snapshot!("params", texts.map(read).join("\n"));
}

/// Comments may stand wherever white space may, and a byte order mark before everything.
#[test]
fn comments_and_a_byte_order_mark_are_no_mistakes() {
    let document = "\u{feff}// a title
(
    format: 3, // the only one
    /* materials */ materials: [
        Texture(name: /* its */ \"image\", format: R32Float /* one channel */, size: 8 // all of it
        ), // the only one
    ],
    passes: [
        Fullscreen(
            name: \"fill\", // named like its shader
            color: [(target: \"image\" // whole
            )] // the last field, without a comma
        ) // the last pass
    ],
    outputs: [(name: \"image\" /* as it is */)] // the last section
) // the end";
    let files = Files::new([
        ("graph.ron", document),
        ("fill.wgsl", include_str!("../broken/fill.wgsl")),
    ]);
    right(Graph::check(
        "graph.ron",
        &Registry::standard(),
        &files,
        &request(),
    ));
}

/// Editors begin any text with a byte order mark: documents that are included or extended, shaders,
/// and modules, those that stand in for others as well.
#[test]
fn byte_order_marks_are_passed_over_in_every_file() {
    let files = Files::graph(
        r#"extends: "base.ron",
        imports: [(of: "two.wgsl", is: "three.wgsl")],
        passes: [Include(graph: "inner.ron", after: "fill")], outputs: ["image", "inner"]"#,
    )
    .document(
        "base.ron",
        r#"materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "fill", color: ["image"])], outputs: ["image"]"#,
    )
    .document(
        "inner.ron",
        r#"materials: [Texture(name: "inner", format: R32Float)],
        passes: [Fullscreen(name: "fill", color: ["inner"])], outputs: ["inner"]"#,
    )
    .with(
        "fill.wgsl",
        "#import \"one.wgsl\"\n#import \"two.wgsl\"
         @fragment fn fragment() -> @location(0) f32 { return one() + two(); }",
    )
    .with("one.wgsl", "fn one() -> f32 { return 1.0; }")
    .with("two.wgsl", "fn two() -> f32 { return 2.0; }")
    .with("three.wgsl", "fn two() -> f32 { return 3.0; }");
    let right_with = |files: &Files| {
        let diagnostics = checked(files);
        assert!(diagnostics.is_empty(), "{diagnostics:?}");
    };
    right_with(&files);
    for path in files.texts.keys() {
        let marked = format!("\u{feff}{}", files.texts[path]);
        right_with(&files.clone().with(path, marked));
    }
    // A place is counted as an editor counts it, which does not show the mark.
    let wrong = "\u{feff}fn one() -> f32 { return one; }";
    let diagnostics = checked(&files.with("one.wgsl", wrong));
    assert_eq!(diagnostics[0].labels[0].span.to_string(), "one.wgsl:1:4");
}
