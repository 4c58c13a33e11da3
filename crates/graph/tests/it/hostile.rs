//! Files made to break us: each gives a located answer, in bounded time, stack and memory.

use crate::answers::{COMPUTE, answer, assert_said, of_shader};
use crate::bounds::bounded;
use crate::support::Files;
use skiagraph_graph::{FolderSources, Graph, Registry};

/// Returns the messages about a document, beside a shader `index`.
#[track_caller]
fn said(document: &str) -> String {
    let shader = "var<storage, read_write> items: array<u32>;
        @compute @workgroup_size(1) fn main() { items[0] = 1u; }";
    let files = Files::new([("graph.ron", document), ("index.wgsl", shader)]);
    answer(&files)
        .err()
        .map_or("nothing".to_owned(), |errors| errors.to_string())
}

fn many(count: usize, each: impl Fn(usize) -> String) -> String {
    (0..count).map(each).collect::<Vec<_>>().join(",\n")
}

/// A document on lines of their own: params, materials, passes, in this order, beside a buffer
/// `items`.
fn document(params: &str, materials: &str, passes: &str) -> String {
    format!(
        "(format: 3,\nparams: [{params}],\nmaterials: [Buffer(name: \"items\", count: 4), \
         {materials}],\n\
         passes: [Compute(name: \"index\", dispatch: Over(\"items.count\")), {passes}],\n\
         outputs: [\"items\"])"
    )
}

#[test]
fn lists_without_end() {
    let clear = |index: usize| format!("Clear(name: \"p{index}\", target: \"items\")");
    let said_of = said(&document("", "", &many(5000, clear)));
    assert_said(
        &said_of,
        "graph.ron:4099:1",
        &[
            "the list has 5001 entries, 4096 is the most",
            "`repeat`",
            "`Include`",
        ],
    );
    let param = |index: usize| format!("U32(name: \"p{index}\", default: 1)");
    let said_of = said(&document(&many(5000, param), "", ""));
    assert_said(&said_of, "graph.ron:4098:1", &["the list has 5000 entries"]);
    // As many as there may be.
    let said_of = said(&document(&many(4096, param), "", ""));
    assert!(!said_of.contains("entries"), "{said_of}");
    // Each as slow to look at as it can be.
    let buffer = |index: usize| {
        format!(
            "Buffer(name: \"m{index}\", count: \"m{}.count\")",
            index + 1
        )
    };
    let said_of = said(&document("", &many(2000, buffer), ""));
    assert_said(&said_of, "graph.ron:2002", &["unknown material `m2000`"]);
}

/// For each name that nothing has, all names are searched for what was meant: not for as many as
/// there may be of both.
#[test]
fn as_many_misspelt_names_as_names() {
    let bare =
        |word: &str, index: usize| format!("{word}_{}_{index}", "of_the_shadow_map".repeat(3));
    let long = |word: &str, index: usize| format!("\"{}\"", bare(word, index));
    let params = many(4000, |index| {
        format!("U32(name: {}, default: 1)", long("edge", index))
    });
    let sized = many(4000, |index| {
        format!("Buffer(name: \"b{index}\", count: {})", long("egde", index))
    });
    let buffers = many(4000, |index| {
        format!("Buffer(name: {}, count: 4)", long("buffer", index))
    });
    let clears = many(4000, |index| {
        format!(
            "Clear(name: \"p{index}\", target: {})",
            long("bufer", index)
        )
    });
    let bound = |count| {
        let entries = many(count, |index| format!("{}: \"items\"", long("egde", index)));
        document("", "", "").replace(
            "Over(\"items.count\")",
            &format!("Over(\"items.count\"), bind: {{{entries}}}"),
        )
    };
    let given = |word: &str, count: usize, value: &dyn Fn(usize) -> String| {
        let entries = many(count, |index| {
            format!("{}: {}", long(word, index), value(index))
        });
        let include = format!("Include(graph: \"inner.ron\", set: {{{entries}}})");
        document(&params, "", &include)
    };
    let unknown = |index| long("egde", index);
    let endless = |letter: &str| format!("\"{}\"", letter.repeat(1 << 17));
    let inner = format!(
        "(format: 3, params: [{params}], materials: [Buffer(name: \"inside\", count: 4)],
        passes: [Clear(name: \"c\", target: \"inside\")], outputs: [\"inside\"])"
    );
    let shader = "var<storage, read_write> items: array<u32>;
        @compute @workgroup_size(1) fn main() { items[0] = 1u; }";
    for (document, part) in [
        (document(&params, &sized, ""), "unknown param `egde_of"),
        (
            document("", &buffers, &clears),
            "unknown material `bufer_of",
        ),
        (bound(4000), "`index.wgsl` has no global `egde_of"),
        (bound(40_000), "the map has 40000 entries, 4096 is the most"),
        (
            given("egde", 4000, &|_| "1".to_owned()),
            "`inner.ron` has no input, output or param `egde_of",
        ),
        (
            given("egde", 40_000, &|_| "1".to_owned()),
            "the map has 40000 entries",
        ),
        (given("edge", 4000, &unknown), "unknown param `egde_of"),
        (
            document(
                &format!("U32(name: {}, default: 1)", endless("ab")),
                &format!("Buffer(name: \"b\", count: {})", endless("ba")),
                "",
            ),
            "more than 64 characters",
        ),
    ] {
        let files = [
            ("graph.ron", &*document),
            ("index.wgsl", shader),
            ("inner.ron", &inner),
        ];
        let said_of = answer(&Files::new(files)).expect_err("no material has this name");
        assert_said(&said_of.to_string(), "graph.ron:", &[part]);
    }
}

/// A million passes in one file are refused by its length, before any of them is read.
#[test]
fn a_million_passes() {
    let said_of = said(&document(
        "",
        "",
        &many(1_000_000, |_| {
            "Clear(name: \"p\", target: \"items\")".to_owned()
        }),
    ));
    assert_said(
        &said_of,
        "graph.ron",
        &["it has 34 MiB, a document or shader 8 at most", "`repeat`"],
    );
}

#[test]
fn more_mistakes_than_anybody_reads() {
    let said_of = said(&document(
        "",
        "",
        &many(3000, |index| {
            format!("Clear(name: \"p{index}\", target: \"no{index}\")")
        }),
    ));
    assert_said(
        &said_of,
        "graph.ron:4",
        &[
            "unknown material `no0`",
            "mistakes more",
            "mend those above first",
        ],
    );
    assert!(!said_of.contains("`no400`"), "all are printed");
}

/// Only the number of passes counts, however it comes about.
#[test]
fn repeats_without_end() {
    let one = "Clear(name: \"p\", target: \"items\")";
    for (passes, place) in [
        (one.replace(")", ", repeat: 4294967295)"), "graph.ron:4:"),
        (
            format!(
                "Group(name: \"a\", repeat: 1000, passes: [Group(name: \"b\", repeat: 1000, \
                 passes: [Group(name: \"c\", repeat: 1000, passes: [{one}])])])"
            ),
            "graph.ron:4:",
        ),
        (
            "Group(name: \"a\", repeat: 4294967295, passes: [])".to_owned(),
            "graph.ron:4:",
        ),
        (
            "Include(graph: \"graph.ron\", name: \"a\", repeat: 4294967295)".to_owned(),
            "graph.ron:4:",
        ),
    ] {
        let said_of = said(&document("", "", &passes));
        let itself = passes.starts_with("Include");
        assert_said(
            &said_of,
            place,
            &[if itself {
                "includes itself"
            } else {
                "more than 16384 passes"
            }],
        );
    }
}

#[test]
fn groups_in_groups() {
    let nested = |depth: usize| {
        format!(
            "{}Clear(name: \"p\", target: \"items\"){}",
            "Group(name: \"g\", passes: [".repeat(depth),
            "])".repeat(depth)
        )
    };
    for depth in [200, 10_000] {
        assert_said(
            &said(&document("", "", &nested(depth))),
            "graph.ron:",
            &["nested too deep"],
        );
    }
    // As deep as it is read; the clear comes after what it would spoil, so nothing is wrong but
    // that.
    assert!(!said(&document("", "", &nested(20))).contains("nested"));
}

#[test]
fn sizes_without_end() {
    let texture = |size: &str| format!("Texture(name: \"t\", format: Rgba32Float, size: {size}), ");
    let uses = "Clear(name: \"p\", target: \"t\")";
    for (material, part) in [
        (
            texture("4294967295"),
            "4294967295×4294967295 texels are more than the adapter can hold",
        ),
        (
            texture(r#""ceil(1e30 * viewport.size)""#),
            "the result is larger than a number can be",
        ),
        (
            texture(r#""floor(1e15 * viewport.size)""#),
            "no texture has so many texels",
        ),
        (
            texture(r#""9223372036854775807 + 1""#),
            "the result is larger than a number can be",
        ),
        (
            texture(r#""1e308 * 10.0""#),
            "the result is larger than a number can be",
        ),
        (
            texture(r#""log2(0)""#),
            "the result is larger than a number can be",
        ),
        (texture(r#""viewport.size / 0""#), "this divides by zero"),
        (texture(r#""viewport.size % 0""#), "this divides by zero"),
        (texture(r#""viewport.size * 0""#), "a texture of no texels"),
        (
            texture(r#""-viewport.size""#),
            "`-viewport.size` is -64, below 0",
        ),
        (texture("NaN"), "`NaN` has no value"),
        (texture("inf"), "a size is needed here"),
        (texture("-inf"), "a whole number is needed"),
        (texture("-1"), "-1"),
        (texture("(1, 0)"), "a texture of no texels"),
        (
            texture("1").replace("size:", "layers: 4294967295, size:"),
            "slices are more than the adapter can hold",
        ),
        (
            texture("1").replace("size:", "mips: 4294967295, size:"),
            "mips are too many",
        ),
        ("Buffer(name: \"t\", count: -1), ".to_owned(), "-1"),
    ] {
        assert_said(
            &said(&document("", &material, uses)),
            "graph.ron:3:",
            &[part],
        );
    }
    // 4 GiB: more than a buffer may have.
    let said_of = said(&document("", "", "").replace("count: 4)", "count: 1073741824)"));
    assert_said(&said_of, "graph.ron:3:", &["4294967296"]);
    let said_of =
        said(&document("", "", "").replace("Over(\"items.count\")", "Groups(4000000000, 1, 1)"));
    assert_said(&said_of, "graph.ron:4:", &["4000000000"]);
}

#[test]
fn params_that_are_no_numbers() {
    const NONE: &str = "the default of param `p` does not fit";
    for (ty, value, parts) in [
        ("F32", "NaN", ["`NaN` has no value", ""]),
        ("F32", "inf", [NONE, ""]),
        ("F32", "-inf", [NONE, "finite"]),
        ("F32", "1e39", [NONE, "finite"]),
        (
            "F32",
            r#""1e308 * 10.0""#,
            ["larger than a number can be", ""],
        ),
        ("U32", "-1", [NONE, ""]),
        ("U32", "4294967296", [NONE, ""]),
        ("U32", "1.5", [NONE, ""]),
        ("U32", "NaN", ["`NaN` has no value", ""]),
        ("I32", "2147483648", [NONE, ""]),
        (
            "I32",
            r#""-9223372036854775807 - 2""#,
            ["larger than a number can be", ""],
        ),
    ] {
        let param = format!("{ty}(name: \"p\", default: {value})");
        assert_said(&said(&document(&param, "", "")), "graph.ron:2:", &parts);
    }
}

/// An expression in an expression, as deep as its length allows; sizes that are made of each other,
/// by thousands, with a beginning and without; conditions between them.
#[test]
fn expressions_without_end() {
    let count = |text: &str| {
        let buffer = format!("Buffer(name: \"t\", count: \"{text}\"), ");
        said(&document("", &buffer, "Clear(name: \"p\", target: \"t\")"))
    };
    let r = |text: &str, count: usize| text.repeat(count);
    for deep in [
        format!("{}1{}", r("(", 120), r(")", 120)),
        format!("{}1{}", r("min(1, ", 40), r(")", 40)),
        format!("{}1", r("true ? 1 : ", 50)),
        format!("{}1", r("- -", 100)),
        format!("1{}", r(" + 1", 120)),
    ] {
        assert_eq!(count(&deep), "nothing", "{deep}");
    }
    for long in [
        r("(", 100_000),
        r("1 + ", 100_000),
        r("-", 100_000),
        r("t[", 100_000),
    ] {
        assert_said(
            &count(&long),
            "graph.ron:3:",
            &["the expression is too long"],
        );
    }
    let circle = |length: usize, formula: &dyn Fn(usize) -> String| {
        let buffer = |index: usize| {
            let next = (index + 1) % length;
            format!("Buffer(name: \"m{index}\", count: \"{}\")", formula(next))
        };
        said(&document("", &many(length, buffer), ""))
    };
    let nested = format!("{}m", r("(1 + ", 60));
    let plain = |next: usize| format!("m{next}.count");
    let deep = |next: usize| format!("{nested}{next}.count{}", r(")", 60));
    let decided = |next: usize| format!("m{next}.count > 0 ? m{next}.count : 1");
    for formula in [&plain as &dyn Fn(usize) -> String, &deep, &decided] {
        assert_said(
            &circle(3000, formula),
            "graph.ron:",
            &["its size is that of itself"],
        );
    }
    // A circle that a condition breaks is none.
    let broken = |next: usize| match next {
        0 => format!("viewport.width > 0 ? 4 : m{next}.count"),
        _ => format!("m{next}.count"),
    };
    let said_of = circle(5, &broken);
    assert!(!said_of.contains("itself"), "{said_of}");
}

#[test]
fn files_of_nothing() {
    for text in [
        "",
        " \n\t ",
        "\u{feff}",
        "\u{feff} \n",
        "\0",
        "\0\0\0(",
        "(",
    ] {
        assert_ne!(said(text), "nothing", "{text:?}");
        assert!(said(text).contains("graph.ron"), "{text:?}: {}", said(text));
        let files = Files::new([("graph.ron", COMPUTE), ("index.wgsl", text)]);
        let said_of = answer(&files).expect_err("there is no shader").to_string();
        assert!(said_of.contains("index.wgsl"), "{text:?}: {said_of}");
    }
}

/// A place on a line that no terminal shows is given in words.
#[test]
fn a_line_of_ten_thousand_columns() {
    let said_of = said(
        &document(
            "",
            &many(4000, |index| {
                format!("Buffer(name: \"m{index}\", count: 4)")
            }),
            "Clear(name: \"p\", target: \"no\")",
        )
        .replace('\n', " "),
    );
    assert_said(
        &said_of,
        "graph.ron:1:1",
        &[
            "unknown material `no`",
            "declares no material or input of this name",
        ],
    );
    assert!(said_of.len() < 2000, "the line is printed");
    let said_of = of_shader(&format!("const a = {};", "1 ".repeat(100_000)), "");
    assert_said(&said_of, "index.wgsl:2:1", &["does not compile"]);
}

/// Files that lie on disk: no text, too long, a folder.
#[test]
fn files_on_disk() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let write = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.path().join(name), bytes).expect("it can be written")
    };
    let sources = FolderSources {
        root: folder.path().to_owned(),
    };
    let load =
        |path: &str| match bounded(path, || Graph::load(path, &Registry::standard(), &sources)) {
            Ok(_) => "nothing".to_owned(),
            Err(errors) => errors.to_string(),
        };
    write("graph.ron", COMPUTE.as_bytes());
    // 4 GiB that take no room: never read.
    let huge = std::fs::File::create(folder.path().join("index.wgsl")).expect("it can be made");
    huge.set_len(4 << 30).expect("a file may have holes");
    assert_said(
        &load("graph.ron"),
        "graph.ron:2:",
        &["the shader `index.wgsl` cannot be read", "it has 4096 MiB"],
    );
    write("index.wgsl", b"\xff\xfe\0(");
    assert_said(
        &load("graph.ron"),
        "graph.ron:2:",
        &[
            "the shader `index.wgsl` cannot be read",
            "not text in UTF-8",
        ],
    );
    write("binary.ron", b"(format: 3, description: \"\xc3\x28\")");
    assert_said(&load("binary.ron"), "binary.ron", &["not text in UTF-8"]);
    std::fs::create_dir(folder.path().join("folder.ron")).expect("it can be made");
    assert_said(
        &load("folder.ron"),
        "folder.ron",
        &["document `folder.ron` not found"],
    );
}
