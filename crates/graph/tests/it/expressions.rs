//! Expressions, names and references as docs/authoring.md states them: their values, and the
//! messages about those without one.

use crate::support::{Files, Triangle, checked, codes, load, names, right, wrong};
use skiagraph_graph::{Code, Plan, PlanRequest, ResourceKind, Texture};

/// A document with things to ask for, and a buffer of as many items as an expression comes to.
fn asking(expr: &str) -> Files {
    let sections = format!(
        r#"
        params: [
            U32(name: "radius", default: 3), I32(name: "shift", default: -7),
            F32(name: "scale", default: 0.5), Bool(name: "soft", default: true),
            Choice(name: "depth", words: [plane, conservative], default: conservative),
            Choice(name: "other", words: [conservative, exact], default: conservative),
            Vec2(name: "pair", default: (2, 5)),
        ],
        materials: [
            Texture(name: "depth", format: Depth32Float, size: (12, 7), mips: 3, layers: 2),
            Texture(name: "fog", format: R8Unorm, size: (9, 5, 6), mips: All),
            Texture(name: "fine", format: Rgba8Unorm, size: 4, samples: 4),
            Buffer(name: "items", count: 10),
            Buffer(name: "asked", count: "{expr}"),
        ],
        passes: [Compute(name: "number", dispatch: Over("asked.count"))],
        outputs: ["asked"]"#
    );
    let shader = "const FOUR = 4u;
        var<storage, read_write> asked: array<u32>;
        @compute @workgroup_size(1) fn main() { asked[0] = FOUR; }";
    Files::graph(&sections).with("number.wgsl", shader)
}

fn planned(files: &Files) -> Result<Plan, skiagraph_graph::Diagnostics> {
    load(files)?.plan(&PlanRequest::new([20, 11], &Triangle))
}

/// Returns the value of an expression, as a number of items.
#[track_caller]
fn value(expr: &str) -> u32 {
    let plan = planned(&asking(expr));
    let plan = plan.unwrap_or_else(|errors| panic!("{expr}: {errors}"));
    plan.outputs()[0].size[0] / 4
}

/// Returns the message about an expression, and the text that it points at.
#[track_caller]
fn said(expr: &str) -> (Code, String, String) {
    let errors = wrong(planned(&asking(expr)));
    let error = errors.iter().next().expect("there is one");
    let span = &error.labels.first().expect("it has a place").span;
    let at = span.file.text[span.range.clone()].to_owned();
    (error.code, error.message.clone(), at)
}

fn texture<'p>(plan: &'p Plan, name: &str) -> &'p Texture {
    let mut resources = plan.resources().iter();
    let resource = resources.find(|resource| resource.name == name);
    match resource.map(|resource| &resource.kind) {
        Some(ResourceKind::Texture(texture)) => texture,
        _ => panic!("no texture is called {name}"),
    }
}

#[test]
fn operators_bind_as_the_table_says() {
    for (expr, expected) in [
        ("1 + 2 * 3", 7),
        ("(1 + 2) * 3", 9),
        ("20 - 5 - 4", 11),
        ("60 / 5 / 4", 3),
        ("2 * 7 % 4", 2),
        ("- -5", 5),
        ("1 + 1 == 2 ? 3 : 4", 3),
        ("1 < 2 && 3 < 2 || 4 < 5 ? 1 : 2", 1),
        ("true || false && false ? 1 : 2", 1),
        ("!soft || soft ? 1 : 2", 1),
        ("!(1 < 2) ? 1 : 2", 2),
        ("false ? 1 : false ? 2 : 3", 3),
        ("true ? false ? 1 : 2 : 3", 2),
        ("1 != 2 && 2 <= 2 && 2 >= 2 && 3 > 2 ? 1 : 2", 1),
        ("1 << 2 + 1", 8),
        ("1 << 3 > 7 ? 1 : 2", 1),
        ("96 >> 2 >> 1", 12),
        ("10 + (-9 >> 1)", 5),
    ] {
        assert_eq!(value(expr), expected, "{expr}");
    }
}

#[test]
fn whole_numbers_divide_towards_zero_and_become_numbers_where_needed() {
    for (expr, expected) in [
        ("7 / 2", 3),
        ("0 - shift / 2", 3),
        ("10 + -7 / 2", 7),
        ("10 + -7 % 4", 7),
        ("floor(7 / 2.0)", 3),
        ("ceil(7 / 2.0)", 4),
        ("10 + floor(-3.5)", 6),
        ("10 + ceil(-3.5)", 7),
        ("ceil_div(7, 2)", 4),
        ("ceil_div(8, 2)", 4),
        ("10 + ceil_div(-7, 2)", 7),
        ("floor(scale * 9)", 4),
        ("min(3, 2) + 10 * max(3, 2)", 32),
        ("floor(10 * max(0.5, scale * 3))", 15),
        ("floor(log2(32))", 5),
        ("pow(3, 4) / 2", 40),
        ("floor(100 * pow(2, -1))", 50),
        ("floor(pow(2.5, 2))", 6),
        ("floor(1e2)", 100),
        ("1_000", 1000),
        ("9007199254740993 > 9007199254740992 ? 1 : 2", 1),
        ("9007199254740993 == 9007199254740992 ? 1 : 2", 2),
    ] {
        assert_eq!(value(expr), expected, "{expr}");
    }
}

#[test]
fn attributes_of_materials_parts_and_the_viewport() {
    for (expr, expected) in [
        ("viewport.width * 100 + viewport.height", 2011),
        ("viewport.count", 220),
        ("depth.width * 100 + depth.height", 1207),
        ("depth.layers * 10 + depth.mips", 23),
        ("depth.count", 84),
        ("depth[1].layers * 10 + depth[1].mips", 13),
        ("depth.mip[1].width * 100 + depth.mip[1].height", 603),
        ("depth.mip[1..3].mips", 2),
        ("depth[0..2].mip[2].count", 3),
        ("fog.mips", 4),
        ("fog.count", 270),
        ("fog.mip[1].count", 24),
        ("fine.samples", 4),
        ("items.count", 10),
        ("items[2..5].count", 3),
        ("scene.indices.count", 3),
        ("depth.size == depth[1].size ? 1 : 2", 1),
        ("fog.size == fog.size - 1 ? 1 : 2", 2),
        ("fog.format == fine.format ? 1 : 2", 2),
        ("fog.format == fog.mip[1].format ? 1 : 2", 1),
        ("depth.size.x * 100 + depth.size.y", 1207),
        ("depth.mip[1].size.y", 3),
        ("fog.size.z", 6),
        ("viewport.size.x * 100 + viewport.size.y", 2011),
        ("max(fog.size, 6).y", 6),
        ("(viewport.size / 2).x", 10),
        ("floor(pair.x) * 10 + floor(pair.y)", 25),
    ] {
        assert_eq!(value(expr), expected, "{expr}");
    }
}

/// A name without an attribute is a param, with one a material; a word stands bare.
#[test]
fn params_words_and_features() {
    for (expr, expected) in [
        ("radius", 3),
        ("depth == plane ? 1 : 2", 2),
        ("depth != plane ? 1 : 2", 1),
        ("depth == conservative && depth.width == 12 ? 1 : 2", 1),
        ("depth == other ? 1 : 2", 1),
        ("soft ? 1 : 2", 1),
        ("pair == pair + 0 ? 1 : 2", 1),
        ("pair == 2 * pair ? 1 : 2", 2),
        ("has(SUBGROUP) ? 1 : 2", 2),
    ] {
        assert_eq!(value(expr), expected, "{expr}");
    }
    let graph = right(load(&asking("has(SUBGROUP) ? 1 : 2")));
    let subgroup = graph.features();
    assert_eq!(
        subgroup.iter_names().map(|(name, _)| name).next(),
        Some("SUBGROUP")
    );
    let mut request = PlanRequest::new([8, 8], &Triangle);
    request.features = subgroup;
    assert_eq!(right(graph.plan(&request)).outputs()[0].size[0], 4);
}

/// Expressions without a value: the message, and its place.
const MISTAKES: &[(&str, Code, &str, &str)] = {
    use Code::{Expression, Feature, Range, Size, UnknownParam, UnknownResource};
    &[
        (
            "1 + radius / 0",
            Expression,
            "divides by zero",
            "radius / 0",
        ),
        (
            "1 + radius % 0",
            Expression,
            "divides by zero",
            "radius % 0",
        ),
        (
            "2 * (9223372036854775807 + 1)",
            Expression,
            "larger than",
            "(9223372036854775807 + 1)",
        ),
        ("1 - 2", Expression, "`1 - 2` is -1, below 0", "1 - 2"),
        (
            "1 + scale",
            Expression,
            "a whole number is needed",
            "1 + scale",
        ),
        ("1 + soft", Expression, "a number is needed", "1 + soft"),
        (
            "radius ? 1 : 2",
            Expression,
            "true or false is needed",
            "radius",
        ),
        ("depth == 1 ? 1 : 2", Expression, "a word is needed", "1"),
        (
            "depth == plan ? 1 : 2",
            Expression,
            "`plan` is not one of the words",
            "plan",
        ),
        ("raduis", UnknownParam, "unknown param `raduis`", "raduis"),
        (
            "depth.size.z",
            Expression,
            "`depth.size` has no component `z`",
            "depth.size.z",
        ),
        (
            "radius.x",
            Expression,
            "`radius` has no component `x`",
            "radius.x",
        ),
        ("(1 + radius).v", Expression, "`x`, `y`, `z` or `w`", "v"),
        ("pow(10, 19)", Expression, "larger than", "pow(10, 19)"),
        ("1 << 63", Expression, "larger than", "1 << 63"),
        ("1 >> 64", Expression, "larger than", "1 >> 64"),
        (
            "1 << scale",
            Expression,
            "a whole number is needed",
            "scale",
        ),
        ("items", UnknownParam, "`items` is a material", "items"),
        (
            "imgae.width",
            UnknownResource,
            "unknown material `imgae`",
            "imgae",
        ),
        (
            "items.width",
            Expression,
            "no such attribute",
            "items.width",
        ),
        (
            "asked.count",
            Size,
            "its size is that of itself",
            "\"asked\"",
        ),
        ("depth[2].width", Range, "`depth[2]` does not exist", "2"),
        (
            "depth[1..3].width",
            Range,
            "`depth[1..3]` does not exist",
            "3",
        ),
        (
            "depth.mip[3].width",
            Range,
            "`depth.mip[3]` does not exist",
            "3",
        ),
        ("index", Expression, "nothing is repeated here", "index"),
        (
            "FOUR",
            Expression,
            "no shader's constant can stand here",
            "FOUR",
        ),
        (
            "has(SUBGRUOP) ? 1 : 2",
            Feature,
            "no feature `SUBGRUOP`",
            "SUBGRUOP",
        ),
        ("cell(1)", Expression, "unknown function `cell`", "cell"),
        ("min(1)", Expression, "takes 2 arguments, not 1", "min(1)"),
        ("1 +", Expression, "is expected, not the end", ""),
        ("1 $ 2", Expression, "`$` has no meaning", "$"),
        ("items[2]", Expression, "does not stand here", "items"),
    ]
};

#[test]
fn mistakes_are_told_at_the_operator() {
    // The condition is true, so the other branch needs no value.
    assert_eq!(value("soft ? 1 : radius && soft"), 1);
    for &(expr, code, message, at) in MISTAKES {
        let (actual_code, text, place) = said(expr);
        assert_eq!((actual_code, &*place), (code, at), "{expr}: {text}");
        assert!(text.contains(message), "{expr}: {text}");
    }
}

#[test]
fn sizes_go_by_component_and_with_a_number() {
    for (size, expected, layers) in [
        (r#""viewport.size / 2""#, [10, 5], 1),
        (r#""ceil_div(viewport.size, 2)""#, [10, 6], 1),
        (r#""viewport.size + other.size""#, [23, 15], 1),
        (r#""max(viewport.size, 15)""#, [20, 15], 1),
        (r#""floor(viewport.size * 0.5)""#, [10, 5], 1),
        (r#""1 + 2 * other.size""#, [7, 9], 1),
        (r#"("radius", 5)"#, [9, 5], 1),
        (r#"("radius", "viewport.height", 4)"#, [9, 11], 4),
        (r#""radius""#, [9, 9], 1),
        ("6", [6, 6], 1),
        ("(6, 7)", [6, 7], 1),
        (
            r#""other.width > 2 ? other.size : viewport.size""#,
            [3, 4],
            1,
        ),
    ] {
        let sections = format!(
            r#"params: [U32(name: "radius", default: 9)],
            materials: [
                Texture(name: "other", format: R32Float, size: (3, 4)),
                Texture(name: "image", format: R32Float, size: {size}),
            ],
            passes: [Clear(name: "clear", target: "image")], outputs: ["image"]"#
        );
        let plan = right(planned(&Files::graph(&sections)));
        let image = texture(&plan, "image");
        assert_eq!((image.size, image.layers), (expected, layers), "{size}");
        assert_eq!(image.is_3d, layers > 1, "{size}");
    }
}

/// Without a size a texture is as large as the viewport; its chain of mips ends at one texel.
#[test]
fn what_a_texture_is_where_nothing_is_said() {
    let materials = r#"
        materials: [
            Texture(name: "plain", format: R32Float),
            Texture(name: "chain", format: "plain.format", mips: All),
            Texture(name: "solid", format: R32Float, size: (2, 3, 9), mips: All),
            Texture(name: "some", format: R32Float, mips: "plain.mips + 1", layers: 3),
        ],
        passes: [
            Clear(name: "a", target: "plain"), Clear(name: "b", target: "chain"),
            Clear(name: "c", target: "solid"), Clear(name: "d", target: "some"),
        ],
        outputs: ["plain", "chain", "solid", "some"]"#;
    let plan = right(planned(&Files::graph(materials)));
    let shapes = ["plain", "chain", "solid", "some"].map(|name| {
        let texture = texture(&plan, name);
        (texture.size, texture.mips, texture.layers, texture.samples)
    });
    let expected = [
        ([20, 11], 1, 1, 1),
        ([20, 11], 5, 1, 1),
        ([2, 3], 4, 9, 1),
        ([20, 11], 2, 3, 1),
    ];
    assert_eq!(shapes, expected);
    assert_eq!(
        texture(&plan, "chain").format,
        texture(&plan, "plain").format
    );
}

const FILL: &str = "@fragment fn fragment() -> @location(0) f32 { return 1.0; }";

const HALVE: &str = "var source: texture_2d<f32>;
    @fragment fn fragment() -> @location(0) f32 { return textureLoad(source, vec2(0u), 0).x; }";

/// `index` counts the innermost repetition; one more than it is the next mip.
#[test]
fn a_chain_of_mips_by_index_plus_one() {
    let sections = r#"
        materials: [Texture(name: "image", format: R32Float, size: 9, mips: All)],
        passes: [
            Fullscreen(name: "fill", color: ["image.mip[0]"]),
            Fullscreen(
                name: "halve", repeat: "image.mips - 1",
                color: ["image.mip[index + 1]"], bind: {"source": "image.mip[index]"},
            ),
        ],
        outputs: [(name: "last", material: "image.mip[image.mips - 1]")]"#;
    let files = Files::graph(sections)
        .with("fill.wgsl", FILL)
        .with("halve.wgsl", HALVE);
    let plan = right(planned(&files));
    assert_eq!(names(&plan), ["fill", "halve[0]", "halve[1]", "halve[2]"]);
    let mips: Vec<Vec<_>> = plan
        .live()
        .map(|pass| {
            let mips = pass.accesses.iter();
            mips.map(|access| (access.writes, access.part.mips.start))
                .collect()
        })
        .collect();
    let step = |mip| vec![(false, mip), (true, mip + 1)];
    assert_eq!(mips, [vec![(true, 0)], step(0), step(1), step(2)]);
    assert_eq!(plan.outputs()[0].size, [1, 1]);
    // Nothing comes of a repetition of none, so the last mip is the first.
    let plan = right(planned(&files.edited("graph.ron", "size: 9", "size: 1")));
    assert_eq!(names(&plan), ["fill"]);
}

/// The index of an outer repetition has the name of its group before it.
#[test]
fn indices_of_repetitions_in_each_other() {
    let sections = r#"
        materials: [Texture(name: "maps", format: R32Float, size: 4, layers: 6)],
        passes: [Group(name: "outer", repeat: 2, passes: [
            Fullscreen(name: "inner", shader: "fill", repeat: 3,
                color: ["maps[3 * outer.index + index]"]),
            Group(name: "once", passes: [
                Fullscreen(name: "again", shader: "fill", color: ["maps[5 - index]"]),
            ]),
        ])],
        outputs: ["maps"]"#;
    let files = Files::graph(sections).with("fill.wgsl", FILL);
    let plan = right(planned(&files));
    let written: Vec<(&str, u32)> = plan
        .all_passes()
        .iter()
        .map(|pass| (pass.name.as_str(), pass.accesses[0].part.layers.start))
        .collect();
    let expected = [
        ("outer[0].inner[0]", 0),
        ("outer[0].inner[1]", 1),
        ("outer[0].inner[2]", 2),
        ("outer[0].once.again", 5),
        ("outer[1].inner[0]", 3),
        ("outer[1].inner[1]", 4),
        ("outer[1].inner[2]", 5),
        ("outer[1].once.again", 4),
    ];
    assert_eq!(written, expected);
    let diagnostics = checked(&files.edited("graph.ron", "outer.index", "outre.index"));
    assert_eq!(codes(&diagnostics), [Code::Expression]);
    assert!(
        diagnostics[0].labels[0].text.contains("called `outre`"),
        "{diagnostics:?}"
    );
}
