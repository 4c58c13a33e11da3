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
        // What naga itself counts.
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
