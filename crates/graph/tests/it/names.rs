//! Names: their grammar, their meaning in each place, and how shaders find materials, params and
//! the words of choices by them.

use crate::support::{Files, Triangle, checked, codes, load, plan, right};
use skiagraph_graph::{BindTarget, Code, LinkedPass, Plan, PlanRequest, Severity};

const FILL: &str = "@fragment fn fragment() -> @location(0) f32 { return 1.0; }";

/// A texture that one pass fills, whatever they are called.
fn called(material: &str, pass: &str) -> Files {
    let sections = format!(
        r#"materials: [Texture(name: "{material}", format: R32Float)],
        passes: [Fullscreen(name: "{pass}", shader: "fill", color: ["{material}"])],
        outputs: ["{material}"]"#
    );
    Files::graph(&sections).with("fill.wgsl", FILL)
}

#[test]
fn names_follow_their_grammar() {
    let long = "a".repeat(64);
    for name in ["a", "a1", "shadow_map_2", "a_", &long] {
        assert_eq!(checked(&called(name, "fill")).len(), 0, "{name}");
        assert_eq!(checked(&called("image", name)).len(), 0, "{name}");
    }
    let longer = "a".repeat(65);
    for name in [
        "", "A", "1a", "_a", "a__b", "a-b", "aB", "é", "a.b", "a[0]", "a b", &longer,
    ] {
        for files in [called(name, "fill"), called("image", name)] {
            let diagnostics = checked(&files);
            assert_eq!(diagnostics[0].code, Code::Name, "{name}: {diagnostics:?}");
        }
    }
}

/// Words with a meaning of their own are free for passes and params, which no dot follows.
#[test]
fn words_of_the_language_name_no_material_group_or_include() {
    for word in [
        "size", "count", "index", "previous", "mip", "viewport", "format",
    ] {
        assert_eq!(
            codes(&checked(&called(word, "fill"))),
            [Code::Name],
            "{word}"
        );
        assert_eq!(checked(&called("image", word)).len(), 0, "{word}");
        let sections = format!(
            r#"materials: [Texture(name: "image", format: R32Float)],
            passes: [Group(name: "{word}", passes: [Clear(name: "a", target: "image")])],
            outputs: ["image"]"#
        );
        assert_eq!(
            codes(&checked(&Files::graph(&sections))),
            [Code::Name],
            "{word}"
        );
    }
}

/// Materials, groups and includes share one namespace; passes and params have one each.
#[test]
fn one_namespace_for_materials_groups_and_includes() {
    let document = |param: &str, passes: &str| {
        let sections = format!(
            r#"params: [U32(name: "{param}", default: 1)],
            materials: [Texture(name: "image", format: R32Float, size: "{param}")],
            passes: [{passes}], outputs: ["image"]"#
        );
        let files = Files::graph(&sections).document(
            "other.ron",
            r#"materials: [Texture(name: "there", format: R32Float)],
            passes: [Clear(name: "clear", target: "there")], outputs: ["there"]"#,
        );
        codes(&checked(&files))
    };
    let clear = |name: &str| format!(r#"Clear(name: "{name}", target: "image")"#);
    assert_eq!(document("image", &clear("image")), []);
    let group = format!(r#"Group(name: "image", passes: [{}])"#, clear("a"));
    assert_eq!(document("edge", &group), [Code::DuplicateName]);
    let include = format!(
        r#"{}, Include(name: "image", graph: "other.ron")"#,
        clear("a")
    );
    assert_eq!(document("edge", &include), [Code::DuplicateName]);
    let twice = format!("{}, {}", clear("a"), clear("a"));
    assert_eq!(document("edge", &twice), [Code::DuplicateName]);
    assert_eq!(document("index", &clear("a")), [Code::ParamValue]);
}

/// Two materials that WGSL spells alike are an error at the second.
#[test]
fn two_spellings_that_shaders_cannot_tell_apart() {
    let files = Files::graph(
        r#"materials: [Texture(name: "left_image", format: R32Float)],
        passes: [
            Include(graph: "other.ron", name: "left"), Clear(name: "clear", target: "left_image"),
        ],
        outputs: ["left_image", "left.image"]"#,
    )
    .document(
        "other.ron",
        r#"materials: [Texture(name: "image", format: R32Float)],
        passes: [Clear(name: "clear", target: "image")], outputs: ["image"]"#,
    );
    let diagnostics = checked(&files);
    assert_eq!(codes(&diagnostics), [Code::Name], "{diagnostics:?}");
}

/// The resource that a pass binds as each global.
fn bound<'p>(plan: &'p Plan, name: &str) -> Vec<(String, &'p str)> {
    let pass = plan.all_passes().iter().find(|pass| *pass.name == *name);
    let program = pass.and_then(|pass| pass.steps[0].program());
    let program = program.expect("the pass has a shader");
    let bindings = program.bindings.iter().filter_map(|binding| {
        let (BindTarget::Buffer(target) | BindTarget::Texture { target, .. }) = &binding.target
        else {
            return None;
        };
        let part = format!("{:?}", target.part.mips);
        Some((part, plan.resource(target.id).name.as_str()))
    });
    bindings.collect()
}

/// Dots are underscores in a shader: outputs of includes, names of the scene, the frame before.
#[test]
fn dots_are_underscores_in_shaders() {
    let shader = "var left_image: texture_2d<f32>;
        var<storage, read> scene_positions: array<vec4<f32>>;
        var image_previous: texture_2d<f32>;
        @fragment fn fragment() -> @location(0) f32 {
            return textureLoad(left_image, vec2(0u), 0).x + scene_positions[0].x
                + textureLoad(image_previous, vec2(0u), 0).x;
        }";
    let files = Files::graph(
        r#"materials: [Texture(name: "image", format: R32Float)],
        passes: [
            Include(graph: "other.ron", name: "left"),
            Fullscreen(name: "look", color: ["image"]),
        ],
        outputs: ["image"]"#,
    )
    .document(
        "other.ron",
        r#"materials: [Texture(name: "image", format: R32Float)],
        passes: [Clear(name: "clear", target: "image")], outputs: ["image"]"#,
    )
    .with("look.wgsl", shader);
    let graph = right(load(&files));
    let plan = right(graph.plan(&PlanRequest::new([8, 8], &Triangle)));
    let names: Vec<&str> = bound(&plan, "look").iter().map(|(_, name)| *name).collect();
    assert_eq!(names, ["left.image", "scene.positions", "image.previous"]);
}

/// The suggestion for a misspelt global can be written there as it stands.
#[test]
fn a_suggestion_is_what_may_stand_there() {
    let shader = |global: &str| {
        format!(
            "var<storage, read> {global}: array<vec4<f32>>;
            @fragment fn fragment() -> @location(0) f32 {{ return {global}[0].x; }}"
        )
    };
    let files = called("image", "fill");
    for (global, suggested) in [
        ("scene_position", "`scene_positions`"),
        ("sceneIndices", "`scene_indices`"),
    ] {
        let diagnostics = checked(&files.clone().with("fill.wgsl", shader(global)));
        assert_eq!(codes(&diagnostics), [Code::UnknownResource]);
        let help = diagnostics[0].help.as_deref().unwrap_or_default();
        assert!(help.contains(suggested), "{help}");
        assert!(!help.contains("scene."), "{help}");
    }
}

/// The first step's params of a pass, as words.
fn params(pass: &LinkedPass) -> Vec<u32> {
    let bytes = pass
        .params()
        .next()
        .flatten()
        .expect("its shader has params");
    let word = |word: &[u8]| u32::from_le_bytes(word.try_into().expect("it has four bytes"));
    bytes.chunks(4).map(word).collect()
}

/// A document whose shader knows the words of a choice.
fn choosing(document: &str, shader: &str) -> Files {
    let sections = format!(
        r#"params: [Choice(name: "cull", words: [none, front, back], default: front)],
        materials: [Texture(name: "image", format: R32Uint)],
        passes: [Fullscreen(name: "choose", color: ["image"]{document})], outputs: ["image"]"#
    );
    Files::graph(&sections).with("choose.wgsl", shader)
}

#[test]
fn each_word_of_a_choice_is_a_constant_of_the_shaders() {
    let shader = "struct Params { cull: u32 } var<uniform> params: Params;
        @fragment fn fragment() -> @location(0) u32 {
            return select(CULL_NONE, CULL_BACK, params.cull == CULL_FRONT);
        }";
    let plan_of = |document: &str| right(plan(&choosing(document, shader)));
    assert_eq!(params(&plan_of("").all_passes()[0])[0], 1);
    let set = plan_of(r#", set: {"cull": back}"#);
    assert_eq!(params(&set.all_passes()[0])[0], 2);
    // A shader's own constant must be the number of the word.
    let own = |number: u32| choosing("", &format!("const CULL_BACK = {number}u; {shader}"));
    assert_eq!(checked(&own(2)).len(), 0);
    let diagnostics = checked(&own(1));
    assert_eq!(codes(&diagnostics), [Code::ChoiceConstant]);
    let message = "`CULL_BACK` is 1 in the shader, and `back` of `cull` is 2";
    assert_eq!(diagnostics[0].message, message);
    let diagnostics = checked(&choosing(r#", set: {"cull": side}"#, shader));
    assert_eq!(codes(&diagnostics), [Code::ParamValue]);
}

#[test]
fn two_words_of_one_constant_are_refused() {
    let choices = r#"params: [
            Choice(name: "cull", words: [front_face, back]),
            Choice(name: "cull_front", words: [face, other]),
        ],"#;
    let files =
        called("image", "fill").edited("graph.ron", "materials:", &format!("{choices} materials:"));
    let diagnostics = checked(&files);
    assert_eq!(diagnostics[0].code, Code::ChoiceConstant, "{diagnostics:?}");
    assert_eq!(
        diagnostics[0].message,
        "two words give the constant `CULL_FRONT_FACE`"
    );
}

/// Names in capitals are scalar constants of the pass's shader, its imports included.
#[test]
fn constants_of_the_shader_stand_in_its_pass() {
    let shader = "#import \"ids.wgsl\"
        @fragment fn fragment() -> @location(0) u32 { return NOTHING; }";
    let clear = |constant: &str| {
        let sections = format!(
            r#"materials: [Texture(name: "image", format: R32Uint)],
            passes: [Fullscreen(
                name: "choose", color: [(target: "image", load: Clear("{constant}"))],
            )],
            outputs: ["image"]"#
        );
        let files = Files::graph(&sections).with("choose.wgsl", shader);
        files.with(
            "ids.wgsl",
            "const NOTHING: u32 = 4294967295u; const PAIR = vec2(1u);",
        )
    };
    let plan = right(plan(&clear("NOTHING")));
    let skiagraph_graph::step::Step::Draw(draw) = &plan.all_passes()[0].steps[0] else {
        panic!("it draws");
    };
    let color = draw.colors[0].as_ref().expect("it is there");
    assert_eq!(color.clear, Some([4_294_967_295.0; 4]));
    for constant in ["NOTHIGN", "PAIR"] {
        let diagnostics = checked(&clear(constant));
        assert_eq!(codes(&diagnostics), [Code::Expression], "{constant}");
    }
}

/// A value need not be declared to be set: the type is the shader's. A value that the shader does
/// not ask for is refused, and so is one of another type.
#[test]
fn constants_for_each_pass() {
    let shader = "struct Params { direction: vec2<i32>, weight: f32, radius: u32, index: u32 }
        var<uniform> params: Params;
        override soft: bool = false;
        override steps: u32;
        @fragment fn fragment() -> @location(0) u32 {
            return params.radius + u32(params.direction.x) + u32(params.weight) + params.index
                + steps + u32(soft);
        }";
    let set = |set: &str| {
        let document = format!(", repeat: 2, set: {{{set}}}");
        choosing(&document, shader).edited(
            "graph.ron",
            "Choice(name: \"cull\", words: [none, front, back], default: front)",
            "U32(name: \"radius\", default: 7)",
        )
    };
    let values = r#""direction": (1, -2), "weight": "0.5 * index", "steps": "radius + 1""#;
    let plan = right(plan(&set(values)));
    let words = |pass: usize| params(&plan.all_passes()[pass])[..5].to_vec();
    let weight = 0.5f32.to_bits();
    assert_eq!(words(0), [1, (-2i32).cast_unsigned(), 0, 7, 0]);
    assert_eq!(words(1), [1, (-2i32).cast_unsigned(), weight, 7, 1]);
    let program = plan.all_passes()[0].steps[0].program().expect("it has one");
    assert_eq!(program.constants, [("steps".to_owned(), 8.0)]);
    for (change, code) in [
        (format!("{values}, \"direktion\": 1"), Code::Unused),
        (values.replace("direction", "direktion"), Code::UnknownParam),
        (values.replace("(1, -2)", "(1, -2, 3)"), Code::ParamValue),
        (values.replace("(1, -2)", "(1, 0.5)"), Code::ParamValue),
        (values.replace("radius + 1", "0 - 1"), Code::ParamValue),
        (values.replace("radius + 1", "0.5"), Code::ParamValue),
        (values.replace("\"0.5 * index\"", "front"), Code::ParamValue),
        (values.replace("0.5 * index", "raduis"), Code::UnknownParam),
    ] {
        let diagnostics = checked(&set(&change));
        assert_eq!(diagnostics[0].code, code, "{change}: {diagnostics:?}");
        assert_eq!(diagnostics[0].severity, Severity::Error);
    }
}
