//! Pictures of plans: what they say, that they are well-formed whatever names say, and that their
//! size is bounded.

use crate::generated;
use crate::support::{Files, Triangle, load, right};
use skiagraph_draw::{Drawing, Hazard, Origin, from_plan, to_dot, to_svg};
use skiagraph_graph::{Capture, PlanRequest};

/// The drawing of a plan at 64×32.
fn drawing(files: &Files, outputs: Option<&[&str]>) -> Drawing {
    let mut request = PlanRequest::new([64, 32], &Triangle);
    request.outputs = outputs.map(|names| names.iter().map(|name| (*name).to_owned()).collect());
    from_plan(&right(right(load(files)).plan(&request))).titled("graph.ron")
}

fn generated(passes: usize) -> Drawing {
    let texts = generated::graph(passes).into_iter().collect();
    let files = Files {
        texts,
        ..Files::default()
    };
    drawing(&files, None)
}

/// ```text
/// scene.positions ─▶ eye.draw ─▶ image ─▶ shrink ─▶ image (mip 1) ─▶ smooth ─▶ [result]
///                                image ─▶ show ─▶ shown              (culled)
/// ```
/// `image` comes out of `eye.ron` as `eye.image`.
fn small() -> Files {
    let read = "var image: texture_2d<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
            return textureLoad(image, vec2<u32>(centre.xy), 0);
        }";
    let draw = "var<storage, read> scene_positions: array<vec4<f32>>;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
            return scene_positions[index];
        }
        @fragment fn fragment() -> @location(0) vec4<f32> { return vec4(1.0); }";
    let eye = r#"
    materials: [Texture(name: "image", format: Rgba8Unorm, mips: 2)],
    passes: [Raster(name: "draw", draw: "scene.indices.count", color: ["image.mip[0]"])],
    outputs: ["image"],
"#;
    let document = r#"
    materials: [
        Texture(name: "shown", format: Rgba8Unorm),
        Texture(name: "filtered", format: Rgba8Unorm),
    ],
    passes: [
        Include(graph: "eye.ron", name: "eye"),
        Fullscreen(name: "show", shader: "read", color: ["shown"],
            bind: {"image": "eye.image.mip[0]"}),
        Fullscreen(name: "shrink", shader: "read", color: ["eye.image.mip[1]"],
            bind: {"image": "eye.image.mip[0]"}),
        Fullscreen(name: "smooth", shader: "read", color: ["filtered"],
            bind: {"image": "eye.image.mip[1]"}),
    ],
    outputs: [(name: "result", material: "filtered"), "shown"],
"#;
    Files::graph(document)
        .document("eye.ron", eye)
        .with("read.wgsl", read)
        .with("draw.wgsl", draw)
}

#[test]
fn the_data_of_a_small_graph() {
    let drawing = drawing(&small(), Some(&["result"]));
    insta::assert_snapshot!(serde_json::to_string_pretty(&drawing).expect("plain data serialises"));
}

#[test]
fn the_nodes_and_links_of_a_small_graph() {
    insta::assert_snapshot!(to_dot(&drawing(&small(), Some(&["result"]))));
}

/// A copy that a capture asked for is a pass of its own, and keeps alive what would else be culled.
#[test]
fn a_capture_is_seen_too() {
    let mut request = PlanRequest::new([64, 32], &Triangle);
    request.outputs = Some(vec!["result".to_owned()]);
    request.captures = vec![Capture::new("shown").with_after("show")];
    let drawing = from_plan(&right(right(load(&small())).plan(&request)));
    assert!(drawing.passes.iter().all(|pass| pass.culled.is_none()));
    let copy = drawing.passes.iter().find(|pass| pass.kind == "Capture");
    let copied = drawing
        .materials
        .iter()
        .find(|material| material.origin == Origin::Capture);
    let (copy, copied) = copy
        .zip(copied)
        .expect("the capture makes a pass and a material");
    assert_eq!((&*copy.name, &*copied.name), ("shown@show", "shown@show"));
    assert_eq!(copied.outputs, ["shown@show"]);
}

/// The words that a reader sees, hover titles not among them.
fn words(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap_or_else(|error| panic!("{error}\n{svg}"));
    let words = |node: &roxmltree::Node<'_, '_>| node.has_tag_name("text");
    document
        .descendants()
        .filter(words)
        .map(|node| {
            node.descendants()
                .filter_map(|inner| inner.is_text().then(|| inner.text())?)
                .collect()
        })
        .collect()
}

#[test]
fn the_chart_names_passes_materials_outputs_and_why_a_pass_is_culled() {
    let shown = words(&to_svg(&drawing(&small(), Some(&["result"]))));
    for word in [
        "graph.ron",
        "eye.draw",
        "shrink",
        "eye.image",
        "scene.positions",
        "result",
        "m0→m1",
    ] {
        assert!(
            shown.iter().any(|text| text == word),
            "no {word:?} in {shown:?}"
        );
    }
    assert!(
        shown.contains(&"nothing that an output needs reads what it writes (`shown`)".to_owned()),
        "{shown:?}"
    );
    assert!(
        shown.iter().any(|text| text.ends_with("not made")),
        "{shown:?}"
    );
}

#[test]
fn names_cannot_break_out_of_the_picture() {
    let nasty = r#"</text><script>&"'\n"#;
    let mut drawing = drawing(&small(), None).titled(nasty);
    let (old, new) = ("shown", nasty);
    drawing
        .materials
        .iter_mut()
        .filter(|material| material.name == old)
        .for_each(|material| material.name = new.into());
    drawing
        .accesses
        .iter_mut()
        .filter(|access| access.material == old)
        .for_each(|access| access.material = new.into());
    let svg = to_svg(&drawing);
    assert!(!svg.contains("<script"), "{svg}");
    assert_eq!(
        words(&svg).iter().filter(|text| *text == nasty).count(),
        2,
        "heading and column"
    );
    let dot = to_dot(&drawing);
    assert!(dot.contains(r#"\"'\\n"#), "{dot}");
}

#[test]
fn every_hazard_of_a_long_graph_is_derived_and_most_edges_are_not_implied() {
    let drawing = generated(40);
    for hazard in [
        Hazard::ReadAfterWrite,
        Hazard::WriteAfterRead,
        Hazard::WriteAfterWrite,
    ] {
        assert!(
            drawing
                .edges
                .iter()
                .flat_map(|edge| &edge.because)
                .any(|reason| reason.hazard == hazard),
            "{hazard:?}"
        );
    }
    // `sum_0` is read by the second light's sum, then overwritten by the third's, which reads the
    // second's.
    let through = |from: &str, to: &str| {
        drawing
            .edges
            .iter()
            .find(|edge| edge.from == from && edge.to == to)
            .unwrap_or_else(|| panic!("{from} → {to}"))
    };
    assert!(!through("light0.add", "light1.add").implied);
    assert!(through("light0.add", "light2.add").implied);
    assert_eq!(
        through("light0.add", "light2.add").because[0].hazard,
        Hazard::WriteAfterWrite
    );
    assert!(
        drawing.edges.iter().any(|edge| edge.to == "light0.debug"),
        "what a culled pass would read"
    );
}

#[test]
fn from_one_pass_to_a_thousand() {
    for passes in [1, 7, 40, 1000] {
        let drawing = generated(passes);
        assert_eq!(drawing.passes.len(), passes);
        let svg = to_svg(&drawing);
        let shown = words(&svg);
        let names = drawing
            .passes
            .iter()
            .filter(|pass| shown.contains(&pass.name))
            .count();
        assert_eq!(names, passes, "each pass has its row");
        // Linear in passes: a mark, a bar or an edge is a few hundred bytes.
        assert!(
            svg.len() < 6000 * (passes + 2),
            "{passes} passes: {} bytes",
            svg.len()
        );
        assert!(to_dot(&drawing).len() < 2000 * (passes + 2));
    }
}

#[test]
fn nothing_at_all_is_a_picture_too() {
    let empty = Drawing::default();
    assert!(words(&to_svg(&empty))[1].starts_with("0 passes"));
    assert!(to_dot(&empty).starts_with("digraph \"\" {"));
}
