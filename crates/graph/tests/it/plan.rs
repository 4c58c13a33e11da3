//! Statements of a plan about a document: the passes that run and their order, the culled ones and
//! why, and the resources that are built for them.

use crate::support::{Files, Triangle, load, names, right};
use skiagraph_graph::{Capture, Plan, PlanRequest};

const SHADERS: [(&str, &str); 4] = [
    (
        "fill.wgsl",
        "@fragment fn fragment() -> @location(0) f32 { return 1.0; }",
    ),
    (
        "blur.wgsl",
        "var image: texture_2d<f32>;
         @fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
             return textureLoad(image, vec2<u32>(position.xy), 0).x;
         }",
    ),
    (
        "draw.wgsl",
        "var<storage, read> scene_positions: array<vec4<f32>>;
         @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
             return scene_positions[index];
         }
         @fragment fn fragment() -> @location(0) f32 { return 1.0; }",
    ),
    (
        "look.wgsl",
        "struct Camera { view: mat4x4<f32> }
         var<uniform> camera: Camera;
         @fragment fn fragment() -> @location(0) f32 { return camera.view[0].x; }",
    ),
];

fn texture(name: &str) -> String {
    format!("Texture(name: \"{name}\", format: R32Float)")
}

fn plan(
    materials: &[String],
    passes: &[&str],
    outputs: &str,
    captures: &[(&str, Option<&str>)],
) -> Plan {
    let sections = format!(
        "materials: [{}], passes: [{}], outputs: [{outputs}]",
        materials.join(", "),
        passes.join(", ")
    );
    let graph = right(load(&Files::new(SHADERS).document("graph.ron", &sections)));
    let mut request = PlanRequest::new([8, 4], &Triangle);
    let capture = |(material, after): &(&str, Option<&str>)| {
        let capture = Capture::new(*material);
        match after {
            Some(pass) => capture.with_after(*pass),
            None => capture,
        }
    };
    request.captures = captures.iter().map(capture).collect();
    right(graph.plan(&request))
}

fn fill(name: &str, target: &str) -> String {
    format!("Fullscreen(name: \"{name}\", shader: \"fill\", color: [\"{target}\"])")
}

fn blur(name: &str, from: &str, to: &str) -> String {
    format!(
        "Fullscreen(name: \"{name}\", shader: \"blur\", bind: {{\"image\": \"{from}\"}}, color: \
         [\"{to}\"])"
    )
}

/// ```text
/// scene.positions ─▶ draw ─▶ image ─▶ smooth ─▶ [result]
/// camera ─▶ look ─▶ other ─▶ late              (no output needs them)
/// ```
#[test]
fn what_nobody_needs_neither_runs_nor_is_provided() {
    let materials = ["image", "result", "other", "rest"].map(texture);
    let passes = [
        "Fullscreen(name: \"look\", color: [\"other\"])",
        "Raster(name: \"draw\", draw: \"scene.indices.count\", color: [\"image\"])",
        &blur("smooth", "image", "result"),
        &blur("late", "other", "rest"),
    ];
    let culled_plan = plan(&materials, &passes, r#""result""#, &[]);
    assert_eq!(names(&culled_plan), ["draw", "smooth"]);
    let kinds: Vec<String> = culled_plan
        .passes()
        .into_iter()
        .map(|pass| pass.kind)
        .collect();
    assert_eq!(kinds, ["Raster", "Fullscreen"]);
    let culled: Vec<(&str, &str)> = culled_plan
        .culled()
        .iter()
        .map(|pass| (pass.name.as_str(), pass.reason.as_str()))
        .collect();
    assert_eq!(
        culled,
        [
            (
                "look",
                "nothing that an output needs reads what it writes (`other`)"
            ),
            (
                "late",
                "nothing that an output needs reads what it writes (`rest`)"
            ),
        ]
    );
    // `scene.indices` only counts; no pass binds it, so it is not built.
    assert_eq!(culled_plan.provided(), ["scene.positions"]);
    let relied_on = culled_plan.relies_on();
    assert_eq!(relied_on.keys().collect::<Vec<_>>(), ["scene.indices"]);
    assert_eq!(relied_on["scene.indices"].unwrap().items, Some(3));
    assert_eq!(culled_plan.memory_bytes(), 2 * 8 * 4 * 4);

    let captured = plan(&materials, &passes, r#""result""#, &[("rest", None)]);
    assert_eq!(names(&captured), ["look", "draw", "smooth", "late"]);
    let mut provided = captured.provided();
    provided.sort_unstable();
    assert_eq!(provided, ["camera", "scene.positions"]);
    assert!(captured.culled().is_empty());
}

/// A kind that decides something counts though nothing binds the resource.
#[test]
fn a_plan_relies_on_kinds_that_were_asked_for() {
    let pass = fill("fill", "image").replace("color", "if: \"lights.lamp.kind == spot\", color");
    let plan = plan(&[texture("image")], &[&pass], r#""image""#, &[]);
    assert!(plan.provided().is_empty());
    let kind = plan.relies_on()["lights.lamp"].unwrap().kind.unwrap();
    assert_eq!(kind.words[kind.number as usize], "spot");
}

/// The items of the frame before are as many as the provider's resource has; no other is known.
#[test]
fn a_plan_relies_on_the_resource_whose_last_frame_is_counted() {
    let condition = "if: \"scene.indices.previous.count > 2\", color";
    let pass = fill("fill", "image").replace("color", condition);
    let plan = plan(&[texture("image")], &[&pass], r#""image""#, &[]);
    let relied_on: Vec<&String> = plan.relies_on().keys().collect();
    assert_eq!(relied_on, ["scene.indices"]);
}

/// Only the outputs that are asked for keep their passes.
#[test]
fn outputs_by_choice() {
    let sections = format!(
        "materials: [{}, {}], passes: [{}, {}], outputs: [\"a\", (name: \"second\", material: \
         \"b\")]",
        texture("a"),
        texture("b"),
        fill("fill_a", "a"),
        fill("fill_b", "b")
    );
    let graph = right(load(&Files::new(SHADERS).document("graph.ron", &sections)));
    assert_eq!(graph.outputs(), ["a", "second"]);
    let mut request = PlanRequest::new([8, 4], &Triangle);
    for (wanted, expected) in [
        (None, vec!["fill_a", "fill_b"]),
        (Some(vec!["second".to_owned()]), vec!["fill_b"]),
        (Some(Vec::new()), vec![]),
    ] {
        request.outputs = wanted.clone();
        let plan = right(graph.plan(&request));
        assert_eq!(names(&plan), expected, "{wanted:?}");
        assert_eq!(plan.outputs().len(), expected.len());
    }
}

/// ```text
/// fill_a ─▶ a ─▶ [a]      fill_b ─▶ b ─▶ [second, on request]
/// ```
/// A diagnostic runs for those alone that name it, as an output or as a capture.
#[test]
fn an_output_on_request_costs_only_those_that_name_it() {
    let outputs = r#""a", (name: "second", material: "b", on_request: true)"#;
    let sections = format!(
        "materials: [{}, {}], passes: [{}, {}], outputs: [{outputs}]",
        texture("a"),
        texture("b"),
        fill("fill_a", "a"),
        fill("fill_b", "b")
    );
    let graph = right(load(&Files::new(SHADERS).document("graph.ron", &sections)));
    assert_eq!(graph.outputs(), ["a", "second"]);
    assert_eq!(graph.default_outputs(), ["a"]);
    let mut request = PlanRequest::new([8, 4], &Triangle);
    assert_eq!(names(&right(graph.plan(&request))), ["fill_a"]);
    request.captures = vec![Capture::new("second")];
    let captured = right(graph.plan(&request));
    assert_eq!(names(&captured), ["fill_a", "fill_b"]);
    assert_eq!(captured.outputs().len(), 2);
    request.captures.clear();
    request.outputs = Some(vec!["second".to_owned()]);
    let named = right(graph.plan(&request));
    assert_eq!(names(&named), ["fill_b"]);
}

/// ```text
/// fill ─▶ image ─▶ keep ─▶ kept      fill2 ─▶ image ─▶ [image]
///         └─ image@fill
/// ```
/// A capture of an earlier version keeps alive who wrote it, and is taken before it is overwritten.
#[test]
fn a_capture_keeps_its_version_alive() {
    let materials = ["image", "kept"].map(texture);
    let passes = [
        &*fill("first", "image"),
        "Copy(name: \"keep\", from: \"image\", to: \"kept\")",
        &*fill("second", "image"),
    ];
    assert_eq!(
        names(&plan(&materials, &passes, r#""image""#, &[])),
        ["second"]
    );
    let captured = plan(
        &materials,
        &passes,
        r#""image""#,
        &[("image", Some("first"))],
    );
    assert_eq!(names(&captured), ["first", "image@first", "second"]);
    let outputs: Vec<String> = captured
        .outputs()
        .into_iter()
        .map(|output| output.name)
        .collect();
    assert_eq!(outputs, ["image", "image@first"]);
}

/// ```text
/// draw1 ─▶ depth (cleared) ─▶ draw2 (loads, tests, writes) ─▶ draw3 (loads, tests only)
/// ```
#[test]
fn depth_that_is_loaded_orders_its_passes() {
    let materials = [
        texture("a"),
        texture("b"),
        texture("c"),
        "Texture(name: \"depth\", format: Depth32Float)".to_owned(),
    ];
    let draw = |name: &str, target: &str, rest: &str| {
        format!(
            "Raster(name: \"{name}\", shader: \"draw\", draw: 3, color: [(target: \
             \"{target}\")], depth: (target: \"depth\"{rest}))"
        )
    };
    let passes = [
        draw("draw1", "a", ""),
        draw("draw2", "b", ", load: Load"),
        draw("draw3", "c", ", load: Load, write: false"),
    ];
    let passes: Vec<&str> = passes.iter().map(String::as_str).collect();
    assert_eq!(
        names(&plan(&materials, &passes, r#""c""#, &[])),
        ["draw1", "draw2", "draw3"]
    );
    assert_eq!(
        names(&plan(&materials, &passes, r#""b""#, &[])),
        ["draw1", "draw2"]
    );
    assert_eq!(names(&plan(&materials, &passes, r#""a""#, &[])), ["draw1"]);
}

/// A target that is cleared needs nothing of what it held; one that is loaded does.
#[test]
fn load_and_clear_of_a_target() {
    let materials = ["image"].map(texture);
    let second =
        "Fullscreen(name: \"second\", shader: \"fill\", color: [(target: \"image\", load: Load)])";
    assert_eq!(
        names(&plan(
            &materials,
            &[&fill("first", "image"), second],
            r#""image""#,
            &[]
        )),
        ["first", "second"]
    );
    let second = "Fullscreen(name: \"second\", shader: \"fill\", color: [(target: \"image\", \
        load: Clear(0, 0, 0, 0))])";
    assert_eq!(
        names(&plan(
            &materials,
            &[&fill("first", "image"), second],
            r#""image""#,
            &[]
        )),
        ["second"]
    );
}

/// ```text
/// first ─▶ image ◀─overwrites all─ copy ◀─ other
/// ```
/// A copy and a clear overwrite everything, so no pass needs the old content; a clear of one part
/// leaves the rest.
#[test]
fn copies_and_clears_cover() {
    let materials = ["image", "other"].map(texture);
    let (first, other) = (fill("first", "image"), fill("fill_other", "other"));
    let copy = "Copy(name: \"copy\", from: \"other\", to: \"image\")";
    let copy_plan = plan(&materials, &[&first, &other, copy], r#""image""#, &[]);
    assert_eq!(names(&copy_plan), ["fill_other", "copy"]);
    let clear = "Clear(name: \"clear\", target: \"image\")";
    let clear_plan = plan(
        &materials,
        &[&first, &other, copy, clear],
        r#""image""#,
        &[],
    );
    assert_eq!(names(&clear_plan), ["clear"]);
    let materials = ["Texture(name: \"image\", format: R32Float, size: 4, layers: 2)".to_owned()];
    let clear_all = "Clear(name: \"all\", target: \"image\")";
    let clear = "Clear(name: \"clear\", target: \"image[0]\")";
    let layer_plan = plan(&materials, &[clear_all, clear], r#""image""#, &[]);
    assert_eq!(names(&layer_plan), ["all", "clear"]);
    let front_plan = plan(
        &materials,
        &[clear_all, clear],
        r#"(name: "front", material: "image[0]")"#,
        &[],
    );
    assert_eq!(names(&front_plan), ["clear"]);
}

/// Layers and mips: only the writers of the part that is read are needed.
#[test]
fn parts_are_independent() {
    let materials = [
        "Texture(name: \"stack\", format: R32Float, size: 4, mips: 2, layers: 2)".to_owned(),
        texture("image"),
    ];
    let passes = [
        fill("t0", "stack[0].mip[0]"),
        fill("l0", "stack[0].mip[1]"),
        fill("t1", "stack[1].mip[0]"),
        blur("read", "stack[0].mip[1]", "image"),
        blur("again", "stack[0].mip[0]", "image"),
    ];
    let passes: Vec<&str> = passes.iter().map(String::as_str).collect();
    assert_eq!(
        names(&plan(&materials, &passes[..4], r#""image""#, &[])),
        ["l0", "read"]
    );
    assert_eq!(
        names(&plan(&materials, &passes, r#""image""#, &[])),
        ["t0", "again"]
    );
    let plan = plan(
        &materials,
        &passes,
        r#"(name: "low", material: "stack[0].mip[1]")"#,
        &[],
    );
    assert_eq!(names(&plan), ["l0"]);
    assert_eq!(plan.outputs()[0].size, [2, 2]);
}

/// Counts and sizes may be taken from materials further down.
#[test]
fn sizes_in_any_order() {
    let materials = [
        r#"Buffer(name: "c", count: "2 * b.count")"#,
        r#"Buffer(name: "b", count: "a.count")"#,
        r#"Buffer(name: "a", count: "half.count")"#,
        r#"Texture(name: "half", format: R32Float, size: "middle.size")"#,
        r#"Texture(name: "middle", format: R32Float, size: "ceil(viewport.size * 0.3)")"#,
    ];
    let sections = format!(
        "materials: [{}], passes: [Compute(name: \"number\", dispatch: Over(\"c.count\"))], \
         outputs: [\"c\"]",
        materials.join(", ")
    );
    let shader = "var<storage, read_write> c: array<vec2<u32>>; @compute @workgroup_size(1) fn \
        main() { c[0] = vec2<u32>(1u); }";
    let files = Files::new([("number.wgsl", shader)]).document("graph.ron", &sections);
    let graph = right(load(&files));
    assert!(
        graph.warnings().is_empty(),
        "what sizes others is used: {:?}",
        graph.warnings()
    );
    let plan = right(graph.plan(&PlanRequest::new([8, 4], &Triangle)));
    // 8 × 0.3 and 4 × 0.3 are rounded up to 3 and 2.
    assert_eq!(plan.outputs()[0].size, [3 * 2 * 2 * 8, 1]);
}
