//! Entries that exist or do not: `if`, groups, their settings of names, and the cases that `check`
//! looks at.

use crate::support::{Files, Triangle, checked, codes, load, names, plan, right};
use skiagraph_graph::{AdapterFacts, Code, Diagnostic, PlanRequest, Run, Severity};

const FILL: &str = "struct Params { value: f32 } var<uniform> params: Params;
    @fragment fn fragment() -> @location(0) f32 { return params.value; }";

const BLUR: &str = "var image: texture_2d<f32>;
    @fragment fn fragment() -> @location(0) f32 { return textureLoad(image, vec2(0u), 0).x; }";

/// Three textures, params of each type, and these passes.
fn files(passes: &str, outputs: &str) -> Files {
    let sections = format!(
        r#"params: [
            F32(name: "value", default: 1), U32(name: "radius", default: 2, max: 8),
            Bool(name: "soft", default: true),
            Choice(name: "engine", words: [plain, fancy], default: plain),
        ],
        materials: [
            Texture(name: "image", format: R32Float), Texture(name: "blurred", format: R32Float),
            Texture(name: "maps", format: R32Float, layers: 2),
        ],
        passes: [{passes}], outputs: [{outputs}]"#
    );
    Files::graph(&sections)
        .with("fill.wgsl", FILL)
        .with("blur.wgsl", BLUR)
}

const FIRST: &str = r#"Fullscreen(name: "fill", color: ["image"]),"#;

fn with(condition: &str) -> Files {
    let blur = format!(r#"Fullscreen(name: "blur", if: {condition}, color: ["blurred"]),"#);
    let outputs = format!(r#""image", (name: "soft_image", material: "blurred", if: {condition})"#);
    files(&format!("{FIRST} {blur}"), &outputs)
}

/// Documents choose by what they run on.
#[test]
fn facts_about_the_adapter_decide_what_is_there() {
    let passes = |condition: &str, adapter: AdapterFacts, storage_binding| {
        let graph = right(load(&with(condition)));
        let mut request = PlanRequest::new([8, 8], &Triangle);
        request.adapter = adapter;
        request.limits.max_storage_buffer_binding_size = storage_binding;
        names(&right(graph.plan(&request))).len()
    };
    let gpu = AdapterFacts::default();
    let software = AdapterFacts {
        is_software: true,
        subgroup_size: 4,
    };
    let ample = 1 << 31;
    for (condition, adapter, storage_binding, expected) in [
        (r#""adapter.software""#, gpu, ample, 1),
        (r#""adapter.software""#, software, ample, 2),
        (r#""adapter.subgroup_size >= 4""#, gpu, ample, 1),
        (r#""adapter.subgroup_size >= 4""#, software, ample, 2),
        (r#""adapter.storage_binding >= 2147483648""#, gpu, ample, 2),
        (
            r#""adapter.storage_binding >= 2147483648""#,
            gpu,
            1 << 27,
            1,
        ),
    ] {
        assert_eq!(
            passes(condition, adapter, storage_binding),
            expected,
            "{condition}"
        );
    }
}

/// An entry or output whose `if` is false is not there; params, sizes and the device may decide.
#[test]
fn a_condition_decides_what_is_there() {
    let outputs = |condition: &str, width, features| {
        let graph = right(load(&with(condition)));
        let mut request = PlanRequest::new([width, 8], &Triangle);
        request.features = features;
        let plan = right(graph.plan(&request));
        assert_eq!(
            graph.outputs(),
            ["image", "soft_image"],
            "declared all the same"
        );
        (names(&plan).len(), plan.outputs().len())
    };
    let (there, gone) = ((2, 2), (1, 1));
    let none = wgt::Features::empty();
    for (condition, expected) in [
        ("true", there),
        ("false", gone),
        (r#""soft""#, there),
        (r#""!soft""#, gone),
        (r#""radius > 2""#, gone),
        (r#""engine == plain && radius > 0""#, there),
        (r#""engine == fancy""#, gone),
        (r#""viewport.width >= 16""#, gone),
        (r#""image.mips == 1""#, there),
        (r#""has(SUBGROUP)""#, gone),
    ] {
        assert_eq!(outputs(condition, 8, none), expected, "{condition}");
    }
    assert_eq!(outputs(r#""viewport.width >= 16""#, 16, none), there);
    assert_eq!(
        outputs(r#""has(SUBGROUP)""#, 8, wgt::Features::SUBGROUP),
        there
    );
    for (condition, code) in [
        ("2", Code::Expression),
        (r#""radius""#, Code::Expression),
        (r#""radios > 1""#, Code::UnknownParam),
        (r#""LIMIT > 1""#, Code::Expression),
    ] {
        let diagnostics = checked(&with(condition));
        assert_eq!(
            diagnostics.first().map(|diagnostic| diagnostic.code),
            Some(code),
            "{condition}: {diagnostics:?}"
        );
    }
}

/// `check` looks at each value that an `if` names: every word, true and false, the ends of the
/// range, each feature.
#[test]
fn check_looks_at_every_value_of_a_condition() {
    let cases = |condition: &str| -> Vec<String> {
        let blur = format!(r#"Fullscreen(name: "blur", if: {condition}, color: ["blurred"]),"#);
        let passes = format!(
            r#"{FIRST} {blur} Fullscreen(name: "last", shader: "blur",
            bind: {{"image": "blurred"}}, color: ["image"]),"#
        );
        let diagnostics = checked(&files(&passes, r#""image""#));
        let condition = |diagnostic: &Diagnostic| {
            assert_eq!(diagnostic.code, Code::Condition, "{diagnostic:?}");
            diagnostic
                .message
                .split_once(": ")
                .expect("it says when")
                .0
                .to_owned()
        };
        let errors = diagnostics
            .iter()
            .filter(|diagnostic| diagnostic.severity == Severity::Error);
        errors.map(condition).collect()
    };
    assert_eq!(cases(r#""soft""#), ["with `soft` = false"]);
    assert_eq!(cases(r#""engine == plain""#), ["with `engine` = fancy"]);
    assert_eq!(cases(r#""radius < 8""#), ["with `radius` = 8"]);
    assert_eq!(cases(r#""!has(SUBGROUP)""#), ["with the feature SUBGROUP"]);
    // In a range without an end no value is tried.
    assert_eq!(cases(r#""value < 2.0""#), [""; 0]);
    assert_eq!(cases(r#""soft || radius < 9""#), [""; 0]);
    // The condition of an output, whose material no pass writes.
    let output = r#""image", (name: "late", material: "blurred", if: "!soft")"#;
    let diagnostics = checked(&files(FIRST, output));
    let has_case =
        |diagnostic: &Diagnostic| diagnostic.message.starts_with("with `soft` = false: ");
    assert!(diagnostics.iter().any(has_case), "{diagnostics:?}");
}

/// A group's `if`, `repeat` and `run` are for all of its entries, its `bind` and `set` for each
/// that asks for such a name.
#[test]
fn what_a_group_says() {
    let passes = |group: &str, inside: &str| {
        let passes = format!(
            r#"Clear(name: "reset", target: "maps"), {FIRST} Group(name: "all", {group} passes: [
                Fullscreen(name: "one", shader: "blur", color: ["blurred"]{inside}),
                Fullscreen(name: "two", shader: "fill", color: ["spare"]),
            ])"#
        );
        let files = files(&passes, r#""image", "blurred", "maps", "spare""#);
        let spare = r#"materials: [Texture(name: "spare", format: R32Float),"#;
        files.edited("graph.ron", "materials: [", spare)
    };
    let plan_of = |group: &str| right(plan(&passes(group, "")));
    assert_eq!(names(&plan_of("")), ["reset", "fill", "all.one", "all.two"]);
    let twice = plan_of("repeat: 2,");
    let pass_names: Vec<&str> = twice
        .all_passes()
        .iter()
        .map(|pass| pass.name.as_str())
        .collect();
    let each = ["all[0].one", "all[0].two", "all[1].one", "all[1].two"];
    assert_eq!(pass_names[2..], each);
    let none = passes("if: false,", "").edited(
        "graph.ron",
        r#", "blurred", "maps", "spare"]"#,
        r#", "maps"]"#,
    );
    assert_eq!(names(&right(plan(&none))), ["reset", "fill"]);
    let run = |group: &str, pass: usize| plan_of(group).all_passes()[pass].run.clone();
    assert_eq!(
        (run("", 2), run("run: Once,", 2), run("run: Once,", 1)),
        (Run::Always, Run::Once, Run::Always)
    );
    let own = right(plan(&passes("run: Once,", ", run: OnChange")));
    assert_eq!(
        (&own.all_passes()[2].run, &own.all_passes()[3].run),
        (&Run::OnChange, &Run::Once)
    );
    let bound = plan_of(r#"bind: {"image": "maps[1]"}, set: {"value": 5},"#);
    let read = &bound.all_passes()[2].accesses[0];
    assert_eq!(bound.resource(read.resource).name, "maps");
    assert_eq!(read.part.layers, 1..2);
    assert_eq!(
        bound.all_passes()[3]
            .params()
            .next()
            .flatten()
            .map(|b| b[..4].to_vec()),
        Some(5f32.to_le_bytes().to_vec())
    );
    // The entry's own setting stands, and then nothing asks the group.
    let own = passes(
        r#"bind: {"image": "maps[1]"},"#,
        r#", bind: {"image": "image"}"#,
    );
    assert_eq!(codes(&checked(&own)), [Code::Unused]);
    for (group, code) in [
        (r#"bind: {"picture": "image"},"#, Code::Unused),
        (r#"set: {"vlaue": 1},"#, Code::Unused),
        (r#"shader: "blur","#, Code::UnknownField),
        ("repeat: -1,", Code::Expression),
    ] {
        let diagnostics = checked(&passes(group, ""));
        assert_eq!(
            diagnostics.first().map(|diagnostic| diagnostic.code),
            Some(code),
            "{group}: {diagnostics:?}"
        );
    }
}

/// A repeat of 0 is no entry at all; outside, materials of a repetition are called by their number.
#[test]
fn repetitions_and_their_names() {
    let take = |reference: &str, repeat: &str| {
        let passes = format!(
            r#"Group(name: "each", repeat: {repeat}, passes: [
                Include(graph: "inner.ron"),
                Copy(name: "keep", from: "made", to: "maps[index]"),
            ]),
            Copy(name: "take", from: "{reference}", to: "image")"#
        );
        files(&passes, r#""image""#).document(
            "inner.ron",
            r#"materials: [Texture(name: "made", format: R32Float)],
            passes: [Clear(name: "make", target: "made")], outputs: ["made"]"#,
        )
    };
    let take_plan = right(plan(&take("each[1].made", "2")));
    assert_eq!(names(&take_plan), ["each[1].inner.make", "take"]);
    let by_param = take("each[radius - 1].made", r#""radius""#);
    assert_eq!(
        names(&right(plan(&by_param))),
        ["each[1].inner.make", "take"]
    );
    for (reference, repeat, code) in [
        ("each[2].made", "2", Code::Range),
        ("each[0].made", "0", Code::Range),
        ("made", "2", Code::UnknownResource),
        ("each.made", "2", Code::ResourceKind),
    ] {
        let diagnostics = checked(&take(reference, repeat));
        let first = diagnostics
            .iter()
            .find(|diagnostic| diagnostic.code == code);
        assert!(first.is_some(), "{reference}: {diagnostics:?}");
    }
    assert_eq!(
        codes(&checked(&take("image", "2"))).len(),
        1,
        "a copy onto itself"
    );
}
