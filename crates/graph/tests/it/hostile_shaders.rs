//! Shaders made to break us: each gives a located answer, in bounded time, stack and memory.

use crate::answers::{COMPUTE, answer, assert_said, of_shader};
use crate::support::Files;

#[test]
fn shaders_that_nest_without_end() {
    let r = |text: &str, count: usize| text.repeat(count);
    for count in [1000, 10_000] {
        for body in [
            format!("items[0] = items[1]{};", r(" + items[2]", count)),
            format!("items[0] = items{};", r("[0]", count)),
            format!("items[0] = items{};", r(".x", count)),
            format!(
                "if items[0] == 0u {{}} {}",
                r("else if items[0] == 1u {}", count)
            ),
            format!(
                "if items[0] == 0u {{}} {}",
                r(
                    "else\u{200e}/* } */if items[0] == 1u { items[0] = 1u; }\u{2028}// else\u{85}",
                    count
                )
            ),
            format!("items[0] = {}1u{};", r("(1u+", count), r(")", count)),
        ] {
            let said_of = of_shader("", &body);
            assert_said(&said_of, "index.wgsl:", &["nested too deep", "`let`"]);
        }
        // Naga counts these itself.
        for body in [
            format!("items[0] = u32({}1);", r("-", count)),
            format!("{}{}", r("{", count), r("}", count)),
            format!("var a: {}u32{};", r("array<", count), r(", 2>", count)),
        ] {
            let said_of = of_shader("", &body);
            assert!(
                said_of.contains("index.wgsl:")
                    && (said_of.contains("recursion") || said_of.contains("too deep")),
                "{said_of}"
            );
        }
        let _ = of_shader("", &format!("{}{}", r("/*", count), r("*/", count)));
    }
    // As deep as it may be: the stack of a thread holds it.
    for body in [
        format!("items[0] = items[1]{};", r(" + items[2]", 240)),
        format!(
            "if items[0] == 0u {{}} {}",
            r("else if items[0] == 1u {}", 95)
        ),
        format!("items[0] = {}1u{};", r("(1u+", 150), r(")", 150)),
        format!("{}{}", r("if items[0] == 1u {", 120), r("}", 120)),
    ] {
        let said_of = of_shader("", &body);
        assert!(!said_of.contains("too deep"), "{said_of}");
    }
    // Long is not deep.
    assert_eq!(
        of_shader(
            "",
            &r(
                "items[0] = items[1] + 1u; if items[0] == 1u { items[1] = 2u; }\n",
                2000
            )
        )
        .matches("nested")
        .count(),
        0
    );
    assert_eq!(
        of_shader(
            &format!("const a = array({});", r("vec2(1 + 2, -3), ", 3000)),
            ""
        )
        .matches("nested")
        .count(),
        0
    );
}

#[test]
fn declarations_that_name_the_next() {
    let chain = |count: usize, each: &dyn Fn(usize) -> String, last: &str| {
        (0..count).map(each).collect::<String>() + last
    };
    for (count, refused) in [(1900, false), (2100, true), (100_000, true)] {
        for declarations in [
            chain(
                count,
                &|i| format!("const a{i} = a{};\n", i + 1),
                &format!("const a{count} = 1u;"),
            ),
            chain(
                count,
                &|i| format!("fn f{i}() -> u32 {{ return f{}(); }}\n", i + 1),
                &format!("fn f{count}() -> u32 {{ return 1u; }}"),
            ),
            chain(
                count,
                &|i| format!("struct S{i} {{ a: S{} }}\n", i + 1),
                &format!("struct S{count} {{ a: u32 }}"),
            ),
            chain(count, &|i| format!("var t{i}: texture_2d<f32>;\n"), ""),
        ] {
            let said_of = of_shader(&declarations, "");
            if declarations.len() > 1 << 20 {
                assert_said(
                    &said_of,
                    "index.wgsl:1:1",
                    &["longer than 1024 KiB", "split it"],
                );
            } else if refused {
                assert_said(
                    &said_of,
                    "index.wgsl:",
                    &["more than 2048 declarations", "split it"],
                );
            } else {
                assert!(!said_of.contains("declarations"), "{said_of}");
            }
        }
    }
}

#[test]
fn shaders_that_claim_without_end() {
    for (declarations, body) in [
        ("const a = array<u32, 4294967295>()[3];", "items[0] = a;"),
        (
            "const a = array<array<array<u32, 65536>, 65536>, 65536>()[0][0][0];",
            "items[0] = a;",
        ),
        (
            "var<workgroup> w: array<array<u32, 65535>, 65535>;",
            "items[0] = w[1][2];",
        ),
        (
            "var<private> p: array<u32, 4294967295>;",
            "items[0] = p[3];",
        ),
        (
            "override n: u32 = 4000000000u; var<workgroup> w: array<u32, n>;",
            "items[0] = w[1];",
        ),
        (
            "struct S { @size(4294967292) a: u32, b: u32 } var<private> s: S;",
            "items[0] = s.b;",
        ),
        ("const a = 1u << 99u;", "items[0] = a;"),
        ("const a = 1u / 0u;", "items[0] = a;"),
        ("const a = -2147483648 / -1;", "items[0] = u32(a);"),
    ] {
        let said_of = of_shader(declarations, body);
        assert!(
            said_of == "nothing" || said_of.contains("index.wgsl:"),
            "{declarations}: {said_of}"
        );
    }
    let files = Files::new([
        ("graph.ron", COMPUTE),
        (
            "index.wgsl",
            "var<storage, read_write> items: array<u32, 4294967295>; @compute @workgroup_size(1) \
             fn main() { items[0] = 1u; }",
        ),
    ]);
    let said_of = answer(&files)
        .expect_err("no buffer has 16 GiB")
        .to_string();
    assert_said(&said_of, "index.wgsl:1:", &["`index.wgsl`"]);
    let files = Files::new([
        ("graph.ron", COMPUTE),
        (
            "index.wgsl",
            "var<storage, read_write> items: array<u32>; @compute @workgroup_size(4294967295, \
             4294967295, 4294967295) fn main() { items[0] = 1u; }",
        ),
    ]);
    answer(&files).expect_err("no workgroup is as large");
}

/// Returns the messages about a shader `index` alone, and about one that imports `module`.
fn of_files(index: &str, module: &str) -> String {
    let files = Files::new([
        ("graph.ron", COMPUTE),
        ("index.wgsl", index),
        ("module.wgsl", module),
    ]);
    answer(&files)
        .err()
        .map_or("nothing".to_owned(), |errors| errors.to_string())
}

/// naga panics on these: an error at the line that brings it about, be it parsed, validated,
/// specialised or written.
#[test]
fn shaders_that_the_library_panics_on() {
    let main = "var<storage, read_write> items: array<u32>;
@compute @workgroup_size(1) fn main() { items[0] = u32(BIG); }";
    for number in [
        "i32(HALF)",
        "u32(HALF)",
        "vec2<i32>(vec2<f16>(HALF, 1.0h)).x",
    ] {
        let index =
            format!("enable f16;\n{main}\nconst BIG = {number};\nconst HALF: f16 = f16(65530i);");
        assert_said(
            &of_files(&index, ""),
            "index.wgsl:4:1",
            &["library-panic", "naga-"],
        );
    }
    let module = "const ONE = 1;\nconst HALF = f16(65530i);\nconst BIG = i32(HALF);";
    let index = format!("enable f16;\n#import \"module.wgsl\"\n{main}");
    assert_said(
        &of_files(&index, module),
        "module.wgsl:3:1",
        &["library-panic", "`index.wgsl`"],
    );
    // In a function, at its statement.
    let index = format!(
        "enable f16;\n{main}\nconst BIG = 1;\nfn f(i: u32) -> i32 {{\n    let a = i;\n    \
         if a > 1u {{\n        let b = i32(f16(65530i));\n        return b;\n    }}\n    \
         return 1;\n}}"
    );
    assert_said(&of_files(&index, ""), "index.wgsl:8:9", &["library-panic"]);
    // When its overrides get their values.
    let index =
        format!("enable f16;\n{main}\noverride o: i32 = 65530;\noverride BIG: i32 = i32(f16(o));");
    assert_said(&of_files(&index, ""), "index.wgsl:", &["library-panic"]);
    // When it is written: a pointer to a part, with an index that is not known. (naga takes some.)
    let mut refused = 0;
    for (space, ty, part) in [
        ("function", "array<array<i32, 4>, 4>", "[i][1]"),
        ("function", "array<array<array<i32, 4>, 4>, 4>", "[i][0][i]"),
        ("private", "array<array<i32, 4>, 4>", "[1][i]"),
        ("function", "array<i32, 4>", "[i]"),
    ] {
        let (global, local) = match space {
            "private" => (format!("var<private> a: {ty};"), String::new()),
            _ => (String::new(), format!("var a: {ty};")),
        };
        let index = format!(
            "var<storage, read_write> items: array<u32>; {global}
fn inner(p: ptr<{space}, i32>) -> i32 {{ return *p; }}
fn pick(v: ptr<{space}, {ty}>, i: u32) -> i32 {{
    return inner(&(*v){part});
}}
@compute @workgroup_size(1) fn main() {{ {local} items[0] = u32(pick(&a, items[1])); }}"
        );
        let said_of = of_files(&index, "");
        if said_of != "nothing" {
            refused += 1;
            assert_said(&said_of, "index.wgsl:4:5", &["library-panic", "SPIR-V"]);
        }
    }
    assert!(refused > 0, "naga writes all of them: take the test out");
    // Behind as many declarations as there may be, each of which names the next.
    let chain: String = (0..1900)
        .map(|i| format!("const a{i} = a{};\n", i + 1))
        .collect();
    let index =
        format!("enable f16;\n{main}\nconst BIG = a0;\n{chain}const a1900 = i32(f16(65530i));");
    assert_said(
        &of_files(&index, ""),
        "index.wgsl:1905:1",
        &["library-panic"],
    );
}

/// Memory that each thread or workgroup would need is summed up before a device is asked; unused
/// variables do not count.
#[test]
fn memory_that_no_device_has() {
    for (declarations, body, part) in [
        (
            "var<workgroup> w: array<u32, 4097>;",
            "items[0] = w[1];",
            "share 16400 bytes",
        ),
        (
            "var<workgroup> v: array<vec3f, 512>; var<workgroup> w: array<vec3f, 513>;",
            "items[0] = u32(v[1].x + w[1].x);",
            "share 16400 bytes",
        ),
        (
            "struct S { a: array<array<u32, 50>, 50>, b: atomic<u32> }
            var<workgroup> w: array<S, 10>; fn f() { atomicStore(&w[1].b, 1u); } fn g() { f(); }",
            "if items[1] == 1u { loop { g(); break; } }",
            "share 100048 bytes",
        ),
        (
            "override n: u32 = 5000; var<workgroup> w: array<u32, n * 2>;",
            "items[0] = w[1];",
            "share 40000 bytes",
        ),
        (
            "var<private> p: array<u32, 2049>;",
            "items[0] = p[1];",
            "take 8196 bytes",
        ),
        (
            "var<private> p: array<u32, 2000>; var<private> q: array<u32, 100>;
            fn f() { p[1] = q[2]; }",
            "switch items[1] { case 1u: { f(); } default: {} }",
            "take 8400 bytes",
        ),
        (
            "",
            "var a: array<u32, 2000>; { var b: array<u32, 49>; items[0] = a[1] + b[2]; }",
            "take 8196 bytes",
        ),
        (
            "fn f() -> u32 { var a: array<vec4f, 1000>; return u32(a[items[1]].x); }",
            "items[0] = f();",
            "take 16000 bytes",
        ),
        (
            "const table = array<u32, 9000>();",
            "items[0] = table[items[1]];",
            "36000 bytes",
        ),
        (
            "struct S { a: array<u32, 9000> } var<storage, read_write> big: S;",
            "let copy = big; items[0] = copy.a[items[1]];",
            "36000 bytes",
        ),
    ] {
        let said_of = of_shader(declarations, body);
        assert_said(
            &said_of,
            "index.wgsl:",
            &["error[limit]", part, "`index.wgsl`"],
        );
    }
    for (declarations, body) in [
        ("var<workgroup> w: array<u32, 4096>;", "items[0] = w[1];"),
        (
            "var<workgroup> w: array<u32, 5000>; fn f() { w[1] = 1u; }",
            "",
        ),
        (
            "var<private> p: array<u32, 2048>;",
            "var a: array<u32, 2048>; items[0] = p[1] + a[2];",
        ),
        ("const table = array<u32, 9000>();", "items[0] = table[5];"),
    ] {
        assert_eq!(of_shader(declarations, body), "nothing", "{declarations}");
    }
}
