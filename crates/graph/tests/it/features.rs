//! Features that a pass can ask of the device, as they stand in the plan: stencil, areas, masks,
//! samples.

use crate::support::{Files, Triangle, checked, codes, load, names, right};
use skiagraph_graph::{
    Code, Graph, Ids, ParamValue, PartialBackend, Plan, PlanRequest, Registry,
    step::{Draw, DrawCall, Step},
};
use wgt::{ColorWrites, TextureAspect};

/// Draws a triangle in whatever colour.
const DRAW: &str = "@vertex fn vertex(@builtin(vertex_index) index: u32)
        -> @builtin(position) vec4<f32> { return vec4(f32(index)); }
    @fragment fn fragment() -> @location(0) vec4<f32> { return vec4(1.0); }
    @fragment fn depth_only() {}";

/// One pass over these materials, which are its outputs.
fn files(materials: &str, passes: &str, outputs: &str) -> Files {
    let sections = format!("materials: [{materials}], passes: [{passes}], outputs: [{outputs}]");
    Files::graph(&sections).with("draw.wgsl", DRAW)
}

#[track_caller]
fn planned(files: &Files) -> Plan {
    let graph = right(load(files));
    let mut request = PlanRequest::new([8, 8], &Triangle);
    request.features = graph.features();
    right(graph.plan(&request))
}

/// The draw of the first pass.
#[track_caller]
fn draw(plan: &Plan) -> &Draw<Ids> {
    match &plan.all_passes()[0].steps[0] {
        Step::Draw(draw) => draw,
        other => panic!("no draw: {other:?}"),
    }
}

const BOTH: &str = r#"Texture(name: "both", format: Depth24PlusStencil8)"#;

#[test]
fn tests_and_operations_of_a_stencil() {
    let plan = planned(&files(
        &format!("{BOTH}, Texture(name: \"image\", format: Rgba8Unorm)"),
        r#"Raster(name: "draw", draw: 24, instances: 2, fragment: "fragment", color: ["image"],
            depth: (target: "both", write: false, compare: Greater,
                bias: (constant: 2, slope_scale: 1.5, clamp: 0.25)),
            stencil: (target: "both", load: Clear(7), reference: 3, read_mask: 15, write_mask: 240,
                front: (depth_fail: DecrementWrap, compare: Equal),
                back: (depth_fail: IncrementWrap, fail: Zero, pass: Replace)))"#,
        r#""image""#,
    ));
    let draw = draw(&plan);
    let depth = draw.depth.as_ref().expect("it has one");
    assert_eq!((depth.clear, depth.write), (Some(1.0), false));
    assert_eq!(depth.compare, wgt::CompareFunction::Greater);
    assert_eq!(
        (
            depth.bias.constant,
            depth.bias.slope_scale,
            depth.bias.clamp
        ),
        (2, 1.5, 0.25)
    );
    let stencil = draw.stencil.as_ref().expect("it has one");
    assert_eq!((stencil.clear, stencil.reference), (Some(7), 3));
    assert_eq!(
        (stencil.state.read_mask, stencil.state.write_mask),
        (15, 240)
    );
    let face = |compare, fail_op, depth_fail_op, pass_op| wgt::StencilFaceState {
        compare,
        fail_op,
        depth_fail_op,
        pass_op,
    };
    use wgt::StencilOperation::{DecrementWrap, IncrementWrap, Keep, Replace, Zero};
    let front = face(wgt::CompareFunction::Equal, Keep, DecrementWrap, Keep);
    let back = face(wgt::CompareFunction::Always, Zero, IncrementWrap, Replace);
    assert_eq!((stencil.state.front, stencil.state.back), (front, back));
    let call = DrawCall::Direct {
        vertices: 0..24,
        instances: 0..2,
    };
    assert_eq!(draw.call, call);
}

/// Depth and stencil have versions of their own: a reader of the one does not wait for the other,
/// and a part that no field names is left alone.
#[test]
fn depth_and_stencil_are_versions_of_their_own() {
    let read = "var both: texture_2d<u32>;
        @fragment fn fragment() -> @location(0) vec4<u32> {
            return textureLoad(both, vec2(0u), 0);
        }";
    let depth = "var both: texture_depth_2d;
        @fragment fn fragment() -> @location(0) f32 { return textureLoad(both, vec2(0u), 0); }";
    let passes = r#"
        Raster(name: "depths", shader: "draw", fragment: "depth_only", draw: 3, depth: "both"),
        Raster(name: "counts", shader: "draw", fragment: "depth_only", draw: 3,
            stencil: (target: "both", front: (pass: IncrementWrap))),
        Fullscreen(name: "count", color: ["counted"]),
        Fullscreen(name: "depth", color: ["deep"]),"#;
    let materials = format!(
        r#"{BOTH}, Texture(name: "counted", format: Rgba8Uint),
        Texture(name: "deep", format: R32Float)"#
    );
    let plan_for = |output: &str| {
        let files = files(&materials, passes, output);
        planned(&files.with("count.wgsl", read).with("depth.wgsl", depth))
    };
    assert_eq!(names(&plan_for(r#""counted""#)), ["counts", "count"]);
    let plan = plan_for(r#""deep""#);
    assert_eq!(names(&plan), ["depths", "depth"]);
    let aspects = |pass: usize| plan.all_passes()[pass].accesses[0].part.aspect;
    let expected = [TextureAspect::DepthOnly, TextureAspect::StencilOnly];
    assert_eq!([aspects(0), aspects(1)], expected);
    assert_eq!([aspects(3), aspects(2)], expected);
}

#[test]
fn a_stencil_that_cannot_be() {
    for (stencil, code) in [
        (r#"(target: "flat")"#, Code::FormatMismatch),
        (r#"(target: "other")"#, Code::ResourceKind),
        (
            r#"(target: "both", load: Clear(256))"#,
            Code::FormatMismatch,
        ),
        (r#"(target: "both", load: Clear(0.5))"#, Code::Expression),
        (
            r#"(target: "both", front: (pass: Increment))"#,
            Code::UnknownVariant,
        ),
        (r#"(target: "both", reference: -1)"#, Code::Expression),
    ] {
        let pass = format!(
            r#"Raster(name: "draw", draw: 3, fragment: "depth_only", depth: "both",
                stencil: {stencil})"#
        );
        let materials = format!(
            r#"{BOTH}, Texture(name: "flat", format: Depth32Float),
            Texture(name: "other", format: Depth24PlusStencil8)"#
        );
        let diagnostics = checked(&files(&materials, &pass, r#""both""#));
        assert_eq!(
            diagnostics.first().map(|diagnostic| diagnostic.code),
            Some(code),
            "{stencil}: {diagnostics:?}"
        );
    }
}

/// An area is viewport and scissor; the texels outside stay, so nothing is cleared.
#[test]
fn an_area_of_an_atlas_for_each_repetition() {
    let tiles = |area: &str, load: &str| {
        files(
            r#"Texture(name: "atlas", format: Rgba8Unorm, size: (6, 4)),
            Texture(name: "depth", format: Depth32Float, size: (6, 4))"#,
            &format!(
                r#"Clear(name: "reset", target: "atlas"),
                Clear(name: "far", target: "depth", value: 1),
                Raster(name: "tile", shader: "draw", repeat: 6, draw: 3, area: {area},
                    fragment: "fragment",
                    color: [(target: "atlas"{load})], depth: "depth")"#
            ),
            r#""atlas""#,
        )
    };
    let plan = planned(&tiles(r#"("index % 3 * 2", "index / 3 * 2", 2, 2)"#, ""));
    let areas = plan.all_passes()[2..]
        .iter()
        .map(|pass| match &pass.steps[0] {
            Step::Draw(draw) => {
                let depth = draw.depth.as_ref().expect("it has one");
                let color = draw.colors[0].as_ref().expect("it is there");
                assert_eq!((color.clear, depth.clear), (None, None));
                draw.area.expect("it has one")
            }
            other => panic!("no draw: {other:?}"),
        });
    let expected = [[0, 0], [2, 0], [4, 0], [0, 2], [2, 2], [4, 2]].map(|[x, y]| [x, y, 2, 2]);
    assert_eq!(areas.collect::<Vec<_>>(), expected);
    for (area, load, code) in [
        ("(0, 0, 2, 2)", ", load: Clear(0)", Code::Syntax),
        ("(5, 0, 2, 2)", "", Code::Size),
        ("(0, 0, 0, 2)", "", Code::Size),
        ("(0, 0, 2)", "", Code::Syntax),
        (r#"(0, 0, "0 - 1", 2)"#, "", Code::Syntax),
        (r#"(0, 0, 4294967295, 2)"#, "", Code::Size),
    ] {
        let diagnostics = checked(&tiles(area, load));
        assert_eq!(
            diagnostics.first().map(|diagnostic| diagnostic.code),
            Some(code),
            "{area}{load}: {diagnostics:?}"
        );
    }
}

#[test]
fn loads_blends_and_channels_of_a_target() {
    let target = |rest: &str| {
        let files = files(
            r#"Texture(name: "image", format: Rgba8Unorm)"#,
            &format!(
                r#"Raster(name: "draw", draw: 3, fragment: "fragment",
                    color: [(target: "image"{rest})]),
                Clear(name: "reset", target: "image")"#
            ),
            r#""image""#,
        );
        // The content that it loads is another matter.
        let swapped = files.texts["graph.ron"].clone();
        let (first, second) = swapped.split_once("passes: [").expect("it has passes");
        let (pass, rest) = second.split_once("]),").expect("it has two");
        let (clear, rest) = rest.split_once("], outputs").expect("it has outputs");
        files.with(
            "graph.ron",
            format!("{first}passes: [{clear}, {pass}])], outputs{rest}"),
        )
    };
    let color = |rest: &str| {
        let plan = planned(&target(rest));
        let pass = plan.all_passes().last().expect("there are two").clone();
        match &pass.steps[0] {
            Step::Draw(draw) => draw.colors[0].clone().expect("it is there"),
            other => panic!("no draw: {other:?}"),
        }
    };
    let plain = color("");
    assert_eq!(
        (plain.clear, plain.blend, plain.write),
        (Some([0.0; 4]), None, ColorWrites::ALL)
    );
    assert_eq!(color(", load: Clear(0.5)").clear, Some([0.5; 4]));
    assert_eq!(
        color(", load: Clear(0.5, 0, 1, 0.25)").clear,
        Some([0.5, 0.0, 1.0, 0.25])
    );
    assert_eq!(color(", load: Load").clear, None);
    let channels = ColorWrites::RED | ColorWrites::GREEN;
    assert_eq!(color(", write: rg").write, channels);
    assert_eq!(color(", write: false").write, ColorWrites::empty());
    let blends = ["Alpha", "Premultiplied", "Additive", "Min", "Max"];
    let blends = blends.map(|blend| color(&format!(", load: Load, blend: {blend}")).blend);
    assert_eq!(blends[0], Some(wgt::BlendState::ALPHA_BLENDING));
    assert_eq!(
        blends[1],
        Some(wgt::BlendState::PREMULTIPLIED_ALPHA_BLENDING)
    );
    let operations = blends.map(|blend| blend.expect("it blends").color.operation);
    use wgt::BlendOperation::{Add, Max, Min};
    assert_eq!(operations, [Add, Add, Add, Min, Max]);
    for (rest, code) in [
        (", write: rgx", Code::Syntax),
        (", load: Clear(1, 2)", Code::Syntax),
        (", load: Keep", Code::Syntax),
        (", blend: Multiply", Code::UnknownVariant),
        (", load: Clear(\"NOTHING\")", Code::Expression),
    ] {
        let diagnostics = checked(&target(rest));
        assert_eq!(
            diagnostics.first().map(|diagnostic| diagnostic.code),
            Some(code),
            "{rest}: {diagnostics:?}"
        );
    }
}

/// A target of several samples that is resolved, and its rest.
fn fine(fine: &str, image: &str, rest: &str) -> Files {
    files(
        &format!(
            r#"Texture(name: "fine", format: {fine}), Texture(name: "image", format: {image})"#
        ),
        &format!(
            r#"Raster(name: "draw", draw: 3, fragment: "fragment",
                    color: [(target: "fine", resolve: "image"{rest})])"#
        ),
        r#""image""#,
    )
}

/// Each target of several samples ends in a texture of one, and the pass has covered that.
#[test]
fn samples_are_resolved() {
    let plan = planned(&fine("Rgba8Unorm, samples: 4", "Rgba8Unorm", ""));
    let color = draw(&plan).colors[0].as_ref().expect("it is there");
    let resolve = color.resolve.as_ref().expect("it is resolved");
    assert_eq!((color.target.samples, resolve.samples), (4, 1));
    assert_eq!(plan.resource(resolve.target.id).name, "image");
    let accesses = &plan.all_passes()[0].accesses;
    assert!(
        accesses
            .iter()
            .all(|access| access.writes && access.fully_overwrites && !access.reads)
    );
    for (format, to, rest, code) in [
        ("Rgba8Unorm", "Rgba8Unorm", "", Code::ResourceKind),
        (
            "Rgba8Unorm, samples: 4",
            "Rgba8Unorm, samples: 4",
            "",
            Code::ResourceKind,
        ),
        (
            "Rgba8Unorm, samples: 4",
            "Rgba16Float",
            "",
            Code::ResourceKind,
        ),
        (
            "Rgba8Unorm, samples: 4",
            "Rgba8Unorm, size: 4",
            "",
            Code::Size,
        ),
        (
            "Rgba8Unorm, samples: 3",
            "Rgba8Unorm",
            "",
            Code::FormatMismatch,
        ),
        (
            "Rgba8Unorm, samples: 4, mips: 2",
            "Rgba8Unorm",
            "",
            Code::Size,
        ),
        (
            "Rgba8Unorm, samples: 4, layers: 2",
            "Rgba8Unorm",
            "",
            Code::Size,
        ),
        (
            "Rgba8Unorm, samples: 4",
            "Rgba8Unorm",
            ", load: Load",
            Code::ReadBeforeWrite,
        ),
    ] {
        let diagnostics = checked(&fine(format, to, rest));
        assert_eq!(
            diagnostics.first().map(|diagnostic| diagnostic.code),
            Some(code),
            "{format}, {to}{rest}: {diagnostics:?}"
        );
    }
}

#[test]
fn all_targets_of_a_pass_have_as_many_samples() {
    let mixed = fine("Rgba8Unorm, samples: 4", "Rgba8Unorm", "");
    let mixed = mixed.edited(
        "graph.ron",
        "materials: [",
        r#"materials: [Texture(name: "depth", format: Depth32Float),"#,
    );
    let mixed = mixed.edited("graph.ron", "color: [", r#"depth: "depth", color: ["#);
    assert_eq!(codes(&checked(&mixed)), [Code::Size]);
}

/// One draw, with this section besides.
fn backend_sections(section: &str) -> String {
    let image = r#"Texture(name: "image", format: Rgba8Unorm)"#;
    let draw = r#"Raster(name: "draw", draw: 3, fragment: "fragment", color: ["image"])"#;
    format!(r#"materials: [{image}], passes: [{draw}], outputs: ["image"], {section}"#)
}

fn backend_files(section: &str) -> Files {
    Files::graph(&backend_sections(section)).with("draw.wgsl", DRAW)
}

#[test]
fn a_backend_that_gives_less_runs_what_is_proven_on_it() {
    let lesser = PartialBackend {
        name: "gl".to_owned(),
        lacks: "no depth to load".to_owned(),
    };
    let mut request = PlanRequest::new([8, 8], &Triangle);
    request.partial_backend = Some(lesser.clone());
    for section in ["", "proven_on: [other]"] {
        let graph = right(load(&backend_files(section)));
        let refused = graph.plan(&request).expect_err("it is not proven there");
        assert_eq!(codes(refused.iter()), [Code::Feature]);
        let text = refused.to_string();
        assert!(
            text.contains("is not proven on the backend gl, which has no depth to load")
                && text.contains("proven_on: [gl]"),
            "{text}"
        );
        // A plan that was made for another backend is refused by the executor.
        let plan = right(graph.plan(&PlanRequest::new([8, 8], &Triangle)));
        assert!(plan.check_backend(&lesser).is_err());
    }
    let graph = right(load(&backend_files("proven_on: [other, gl]")));
    let plan = right(graph.plan(&request));
    assert!(plan.check_backend(&lesser).is_ok());
    // A plan that is made again is made for the same backend.
    assert!(plan.with_viewport([9, 9]).is_ok());
    // It is said of the document alone, not of what others make of it.
    let extended = Files::graph(r#"extends: "base.ron""#)
        .document("base.ron", &backend_sections("proven_on: [gl]"))
        .with("draw.wgsl", DRAW);
    assert!(right(load(&extended)).plan(&request).is_err());
}

/// Counts the texels of a triangle, which no pass draws to.
const TOUCH: &str = "var<storage, read_write> total: atomic<u32>;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
        return vec4(f32(index));
    }
    @fragment fn count() { atomicAdd(&total, 1u); }
    @fragment fn nothing() { }";

#[test]
fn a_pass_without_targets_has_memory_of_its_size() {
    let files = Files::graph(
        r#"
        params: [U32(name: "edge", default: 16)],
        materials: [Buffer(name: "total")],
        passes: [
            Clear(name: "reset", target: "total"),
            Raster(name: "first", fragment: "count", draw: 3, size: ("edge", 4)),
            Raster(name: "second", fragment: "count", draw: 3, size: ("edge", 4)),
            Raster(name: "third", fragment: "count", draw: 3, size: "viewport.size"),
            Raster(name: "idle", fragment: "nothing", draw: 3, size: 8),
        ],
        outputs: ["total"],
        "#,
    );
    let files = ["first", "second", "third", "idle"]
        .iter()
        .fold(files, |files, name| {
            files.with(&format!("{name}.wgsl"), TOUCH)
        });
    let plan = planned(&files);
    assert_eq!(names(&plan), ["reset", "first", "second", "third"]);
    let culled = plan.culled();
    assert_eq!(culled[0].reason, "it writes nothing");
    // The first and second take turns in one byte per texel; four bytes are the counter's.
    assert_eq!((plan.memory_bytes(), plan.saved_bytes()), (64 + 64 + 4, 64));
    let memory = plan.memory();
    let canvas = memory.iter().find(|entry| entry.name == "first/canvas");
    let canvas = canvas.expect("it takes memory");
    assert_eq!((canvas.size, canvas.bytes), ([16, 4], 64));
    assert_eq!(canvas.shared_with, ["second/canvas"]);
    let wider = right(plan.with_param("edge", ParamValue::U32(32)));
    assert_eq!(wider.memory_bytes(), 128 + 64 + 4);
    let tight = wider.with(|request| request.memory_limit = Some(195));
    let message = tight.expect_err("it is too much").to_string();
    assert!(message.contains("first/canvas"), "{message}");
}

/// `check`, which knows no device, refuses what no device can run.
#[test]
fn storage_that_no_device_has_is_refused_without_one() {
    let outcome = |format: &str| {
        let files = Files::graph(&format!(
            r#"materials: [Texture(name: "image", format: {format})],
            passes: [Compute(name: "write", dispatch: Over("image.size"))],
            outputs: ["image"]"#
        ));
        let (format, zero) = match format {
            "Bgra8Unorm" => ("bgra8unorm", "vec4(0.0)"),
            "R32Uint" => ("r32uint", "vec4(0u)"),
            _ => ("r8uint", "vec4(0u)"),
        };
        let shader = format!(
            "var image: texture_storage_2d<{format}, write>;
            @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) at: vec3<u32>) {{
                textureStore(image, at.xy, {zero});
            }}"
        );
        let request = PlanRequest::new([8, 8], &Triangle).with_any_adapter(true);
        let files = files.with("write.wgsl", shader);
        let checked = Graph::check("graph.ron", &Registry::standard(), &files, &request);
        checked.map(drop).map_err(|errors| errors.to_string())
    };
    let refused = outcome("R8Uint").expect_err("it has no storage access");
    assert!(
        refused.contains("no storage access of this kind"),
        "{refused}"
    );
    assert_eq!(outcome("R32Uint"), Ok(()));
    // With a feature that a device may have.
    assert_eq!(outcome("Bgra8Unorm"), Ok(()));
}
