//! Every mistake that a document can hold gives one clear, located diagnostic: the rendered texts
//! are pinned.
//!
//! `tests/broken/NAME.ron` is a document with one mistake (or several, where the name says so); the
//! snapshot of that name is what its author reads. `INSTA_UPDATE=always cargo test` writes them
//! anew; read what changed.

mod support;

use skiagraph_graph::{
    Code, Diagnostic, Diagnostics, FolderSources, Graph, Import, PlanRequest, Registry, Sources,
    diagnostics,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use support::{Files, Triangle, load};

fn folder() -> FolderSources {
    FolderSources {
        root: Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken"),
    }
}

/// Errors of loading or planning, or the warnings where there are no errors.
fn diagnose(path: &str, sources: &FolderSources) -> Vec<Diagnostic> {
    let mut request = PlanRequest::new([64, 48], &Triangle);
    request.memory_limit = Some(4 << 30);
    // What a host might hand over, made for too little.
    request.imports = BTreeMap::from([
        (
            "host.image".to_owned(),
            Import::Texture {
                format: wgpu::TextureFormat::R32Float,
                size: [64, 48],
                mips: 1,
                layers: 1,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
            },
        ),
        (
            "host.items".to_owned(),
            Import::Buffer {
                bytes: 12,
                items: Some(3),
                usage: wgpu::BufferUsages::COPY_SRC,
            },
        ),
    ]);
    match Graph::check(path, &Registry::standard(), sources, &request) {
        Err(diagnostics) => diagnostics.iter().cloned().collect(),
        Ok((graph, plan)) => graph
            .warnings()
            .iter()
            .chain(plan.warnings())
            .cloned()
            .collect(),
    }
}

fn documents() -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder().root)
        .expect("the folder is part of the repository")
        .map(|entry| {
            entry
                .expect("it is readable")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .filter_map(|name| name.strip_suffix(".ron").map(str::to_owned))
        .collect();
    names.sort();
    names
}

#[test]
fn every_mistake_has_its_text() {
    let sources = folder();
    let mut right = Vec::new();
    for name in documents() {
        let found = diagnose(&format!("{name}.ron"), &sources);
        if found.is_empty() {
            right.push(name);
            continue;
        }
        insta::with_settings!({ prepend_module_to_snapshot => false, snapshot_path => "broken/snapshots", omit_expression => true }, {
            insta::assert_snapshot!(name.as_str(), diagnostics::render(&found, false));
        });
    }
    assert!(
        right.is_empty(),
        "these broken documents are thought to be right: {right:?}"
    );
}

/// Each kind of mistake is shown by one snapshot at least.
#[test]
fn every_code_has_a_text() {
    let sources = folder();
    let shown: BTreeSet<Code> = documents()
        .iter()
        .flat_map(|name| diagnose(&format!("{name}.ron"), &sources))
        .map(|found| found.code)
        .collect();
    let missing: Vec<&Code> = Code::ALL
        .iter()
        .filter(|code| !shown.contains(code))
        .collect();
    assert!(
        missing.is_empty(),
        "no document in tests/broken shows {missing:?}"
    );
}

/// `docs/diagnostics.md` lists every kind of mistake with its shortest example, and every broken
/// document. `INSTA_UPDATE=always` writes it anew.
#[test]
fn the_catalogue_is_current() {
    let sources = folder();
    let mut found: BTreeMap<Code, Vec<(String, Vec<Diagnostic>)>> = BTreeMap::new();
    for name in documents() {
        let diagnostics = diagnose(&format!("{name}.ron"), &sources);
        let codes: BTreeSet<Code> = diagnostics.iter().map(|found| found.code).collect();
        for code in codes {
            found
                .entry(code)
                .or_default()
                .push((name.clone(), diagnostics.clone()));
        }
    }
    let text = |path: &str| {
        let text = sources.read(path).expect("it is readable");
        text.expect("it is there").trim_end().to_owned()
    };
    let mut catalogue = "# Diagnostics\n\n\
        Every kind of mistake that `skiagraph check` finds, with an example, what is printed, and the way out. The examples are documents of \
        [tests/broken](../crates/graph/tests/broken); this page is written by their test. `check --format json` prints the same with \
        the codes as they stand here.\n"
        .to_owned();
    for &code in Code::ALL {
        let of_code = &found[&code];
        // The plainest: one mistake, and little around it.
        let (example, diagnostics) = of_code
            .iter()
            .min_by_key(|(name, all)| (all.len(), text(&format!("{name}.ron")).len()))
            .expect("another test says that there is one");
        let document = text(&format!("{example}.ron"));
        catalogue += &format!(
            "\n## {}\n\n{} **Way out:** {}\n\n```ron\n{document}\n```\n\n```text\n{}\n```\n\n| \
             document | says |\n|---|---|\n",
            code.as_str(),
            code.description(),
            code.remedy(),
            diagnostics::render(diagnostics, false).trim_end(),
        );
        for (name, all) in of_code {
            let says: BTreeSet<String> = all
                .iter()
                .filter(|found| found.code == code)
                .map(|found| found.message.replace('|', "\\|").replace('\n', " "))
                .collect();
            let says: Vec<String> = says.into_iter().collect();
            catalogue += &format!(
                "| [{name}](../crates/graph/tests/broken/{name}.ron) | {} |\n",
                says.join("; ")
            );
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/diagnostics.md");
    if std::env::var("INSTA_UPDATE").is_ok_and(|mode| mode == "always") {
        std::fs::write(&path, &catalogue).expect("it can be written");
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        written == catalogue,
        "docs/diagnostics.md is not what the documents give: run this test with INSTA_UPDATE=always"
    );
}

/// A snapshot without its document would be checked by nothing.
#[test]
fn every_text_has_its_document() {
    let documents = documents();
    for entry in std::fs::read_dir(folder().root.join("snapshots"))
        .expect("the folder is part of the repository")
    {
        let name = entry
            .expect("it is readable")
            .file_name()
            .to_string_lossy()
            .into_owned();
        let document = name.strip_suffix(".snap").unwrap_or(&name).to_owned();
        assert!(
            documents.contains(&document),
            "{name} belongs to no document"
        );
    }
}

/// Every error has a place, or its message names the file.
#[test]
fn every_error_has_its_place() {
    let sources = folder();
    for name in documents() {
        for found in diagnose(&format!("{name}.ron"), &sources) {
            let label = found
                .labels
                .first()
                .unwrap_or_else(|| panic!("{name}: `{}` has no place", found.message));
            assert!(
                label.span.range.end <= label.span.file.text.len(),
                "{name}: the place lies outside the file"
            );
        }
    }
}

fn text(result: Result<Graph, Diagnostics>) -> String {
    result
        .err()
        .map(|errors| errors.to_string())
        .unwrap_or_else(|| "it loads".to_owned())
}

#[test]
fn a_document_that_is_not_there() {
    let found = text(Graph::load("nowhere.ron", &Registry::standard(), &folder()));
    insta::assert_snapshot!("missing_document", found);
}

#[test]
fn a_file_that_is_no_text() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    std::fs::write(
        folder.path().join("binary.ron"),
        [0xffu8, 0xfe, 0x00, 0x28, 0x80],
    )
    .expect("it can be written");
    let document = "(format: 1, materials: [Texture(name: \"image\", format: R32Float, size: \
        Viewport)], \
        passes: [Fullscreen(name: \"binary\", color: [(target: \"image\")])], outputs: [(name: \
            \"image\")])";
    std::fs::write(folder.path().join("shader.ron"), document).expect("it can be written");
    std::fs::write(folder.path().join("binary.wgsl"), [0xc3u8, 0x28]).expect("it can be written");
    let sources = FolderSources {
        root: folder.path().to_owned(),
    };
    let found: Vec<String> = ["binary.ron", "shader.ron"]
        .map(|path| text(Graph::load(path, &Registry::standard(), &sources)))
        .to_vec();
    insta::assert_snapshot!("no_text", found.join("\n"));
}

/// Nested far deeper than any sensible value: an error, and no overflow of the stack.
#[test]
fn values_nested_200_levels_deep() {
    let count = format!("{}1{}", "Times(2, ".repeat(200), ")".repeat(200));
    let nested = Files::new([]).with(
        "graph.ron",
        format!("(format: 1, materials: [Buffer(name: \"items\", count: {count})])"),
    );
    insta::assert_snapshot!(
        "nested_200",
        text(load(&nested))
            .lines()
            .take(3)
            .collect::<Vec<_>>()
            .join("\n")
    );
    for (open, close) in [
        ("(", ")"),
        ("[", "]"),
        ("{", "}"),
        ("Some(", ")"),
        ("/*", "*/"),
    ] {
        for levels in [100, 200, 10_000] {
            let document = format!(
                "(format: 1, passes: {}{})",
                open.repeat(levels),
                close.repeat(levels)
            );
            assert!(load(&Files::new([]).with("graph.ron", document)).is_err());
        }
    }
}

/// Below ron's own limit everything is read by itself, piece by piece; that must not overflow the
/// stack either.
#[test]
fn values_nested_40_levels_deep() {
    let count = format!("{}1{}", "Times(1, ".repeat(40), ")".repeat(40));
    let document = format!(
        "(format: 1, materials: [Buffer(name: \"items\", count: {count})], \
         passes: [Compute(name: \"index\", dispatch: Over(\"items\"))], outputs: [(name: \
             \"items\")])"
    );
    let shader = "var<storage, read_write> items: array<u32>;
        @compute @workgroup_size(1) fn main() { items[0] = 7u; }";
    let files = Files::new([("index.wgsl", shader)]).with("graph.ron", document);
    let plan = support::plan(&files).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(plan.outputs()[0].size, [4, 1]);
}

/// WGSL nested deeper than a stack; more of it stands in `hostile.rs`.
#[test]
fn shaders_nested_deep() {
    let document = "(format: 1, materials: [Buffer(name: \"items\", count: 1)], \
         passes: [Compute(name: \"index\", dispatch: Over(\"items\"))], outputs: [(name: \
             \"items\")])";
    let brackets = format!(
        "fn deep() -> u32 {{ return {}1u{}; }}",
        "(".repeat(5000),
        ")".repeat(5000)
    );
    assert!(
        text(load(&Files::new([
            ("graph.ron", document),
            ("index.wgsl", &brackets)
        ])))
        .contains("nested too deep")
    );
    let mut files = Files::new([
        ("graph.ron", document),
        ("index.wgsl", "#import \"m0.wgsl\"\n"),
    ]);
    for index in 0..100 {
        files = files.with(
            &format!("m{index}.wgsl"),
            format!("#import \"m{}.wgsl\"\n", index + 1),
        );
    }
    assert!(text(load(&files)).contains("imports are nested too deep"));
    // Types that double with every level: their layout is spelt out only so far.
    let mut bomb = "struct S0 { a: u32, b: u32 }\n".to_owned();
    for level in 1..24 {
        bomb.push_str(&format!(
            "struct S{level} {{ a: S{}, b: S{} }}\n",
            level - 1,
            level - 1
        ));
    }
    bomb.push_str(
        "var<storage, read_write> items: S23;\n@compute @workgroup_size(1) fn main() { \
        items.a.a.a.b = items.a.a.a.a; }",
    );
    let graph = load(&Files::new([
        ("graph.ron", document),
        ("index.wgsl", &bomb),
    ]))
    .unwrap_or_else(|errors| panic!("{errors}"));
    assert!(
        graph.plan(&PlanRequest::new([8, 8], &Triangle)).is_err(),
        "it reads what nobody wrote"
    );
}

/// Mistakes of a request rather than of the document.
#[test]
fn requests_that_cannot_be_met() {
    let files = Files::new([(
        "graph.ron",
        "(format: 1, params: [(name: \"edge\", type: U32, default: 4, max: 8), (name: \
             \"cull\", type: Choice([\"none\", \"front\"]), default: \"none\")],
             materials: [Texture(name: \"image\", format: R32Float, size: \
                 Square(Param(\"edge\"))), Sampler(name: \"nearest\")],
             passes: [Clear(name: \"reset\", target: \"image\")], outputs: [(name: \"image\")])",
    )]);
    let graph = load(&files).unwrap_or_else(|errors| panic!("{errors}"));
    let capture = |material: &str, after: Option<&str>| skiagraph_graph::Capture {
        material: material.to_owned(),
        after: after.map(str::to_owned),
    };
    let mut requests: Vec<(&str, PlanRequest<'_>)> = Vec::new();
    let mut add = |what, change: &dyn Fn(&mut PlanRequest<'_>)| {
        let mut request = PlanRequest::new([8, 8], &Triangle);
        change(&mut request);
        requests.push((what, request));
    };
    add("no pixels", &|request| request.viewport = [0, 8]);
    add("an unknown param", &|request| {
        drop(
            request
                .params
                .insert("egde".to_owned(), skiagraph_graph::ParamValue::U32(1)),
        )
    });
    add("a value out of range", &|request| {
        drop(
            request
                .params
                .insert("edge".to_owned(), skiagraph_graph::ParamValue::U32(9)),
        )
    });
    add("a value of the wrong type", &|request| {
        drop(
            request
                .params
                .insert("edge".to_owned(), skiagraph_graph::ParamValue::F32(1.0)),
        )
    });
    add("a value that makes a size of nothing", &|request| {
        drop(
            request
                .params
                .insert("edge".to_owned(), skiagraph_graph::ParamValue::U32(0)),
        )
    });
    add("an unknown output", &|request| {
        request.outputs = Some(vec!["imgae".to_owned()])
    });
    add("an unknown capture", &|request| {
        request.captures = vec![capture("imgae", None)]
    });
    add("a capture after an unknown pass", &|request| {
        request.captures = vec![capture("image", Some("rest"))]
    });
    add("an unknown capture after a pass", &|request| {
        request.captures = vec![capture("imgae", Some("reset"))]
    });
    add("a capture of a sampler", &|request| {
        request.captures = vec![capture("nearest", None), capture("nearest", Some("reset"))]
    });
    let texts: Vec<String> = requests
        .iter()
        .map(|(what, request)| match graph.plan(request) {
            Err(errors) => format!("--- {what}\n{errors}"),
            Ok(_) => panic!("{what}: it plans"),
        })
        .collect();
    insta::assert_snapshot!("requests", texts.join(""));
    let known = |name: &str, value: &str| {
        graph
            .parse_param(name, value)
            .map_or_else(|error| error.to_string(), |value| value.to_string())
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
    insta::assert_snapshot!(
        "params",
        texts
            .map(|(name, value)| format!("{name}={value}: {}", known(name, value)))
            .join("\n")
    );
}

/// Comments may stand wherever white space may, and a byte order mark before everything.
#[test]
fn comments_and_a_byte_order_mark_are_no_mistakes() {
    let document = "\u{feff}// a title
(
    format: 1, // the only one
    /* materials */ materials: [
        Texture(name: /* its */ \"image\", format: R32Float /* one channel */, size: Viewport // \
            all of it
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
    let fill = include_str!("broken/fill.wgsl");
    let files = Files::new([("graph.ron", document), ("fill.wgsl", fill)]);
    let mut request = PlanRequest::new([64, 48], &Triangle);
    request.memory_limit = Some(4 << 30);
    // What a host might hand over, made for too little.
    request.imports = BTreeMap::from([
        (
            "host.image".to_owned(),
            Import::Texture {
                format: wgpu::TextureFormat::R32Float,
                size: [64, 48],
                mips: 1,
                layers: 1,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
            },
        ),
        (
            "host.items".to_owned(),
            Import::Buffer {
                bytes: 12,
                items: Some(3),
                usage: wgpu::BufferUsages::COPY_SRC,
            },
        ),
    ]);
    let checked = Graph::check("graph.ron", &Registry::standard(), &files, &request);
    assert_eq!(text(checked.map(|(graph, _)| graph)), "it loads");
}
