//! The presets as documents: what they declare, and what a plan makes of them. No GPU.

use glam::{DVec3, Vec3};
use skiagraph_graph::{Graph, MemorySources, Plan, PlanRequest, Sources};
use skiagraph_passes::{EmbeddedSources, SceneProvider, presets, registry};
use skiagraph_scene::{DirectionalLight, Mesh, Scene};
use std::sync::Arc;

fn load(path: &str) -> Graph {
    Graph::load(path, &registry(), &EmbeddedSources).unwrap_or_else(|errors| panic!("{errors}"))
}

/// Plans for a scene of one triangle; all declared outputs, or those given.
fn plan(path: &str, outputs: Option<&[&str]>) -> Plan {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        normals: vec![Vec3::Z],
        normal_indices: vec![[0; 3]],
        ..Mesh::default()
    };
    let light = DirectionalLight::new(DVec3::NEG_Z);
    let provider = SceneProvider::new(Arc::new(Scene {
        name: "one".into(),
        mesh,
        views: vec![],
        lights: vec![light.into()],
    }));
    let mut request = PlanRequest::new([640, 480], &provider);
    request.features = wgpu::Features::all();
    request.outputs = outputs.map(|names| names.iter().map(|&name| name.to_owned()).collect());
    load(path)
        .plan(&request)
        .unwrap_or_else(|errors| panic!("{errors}"))
}

fn live(plan: &Plan) -> Vec<String> {
    plan.passes().into_iter().map(|pass| pass.name).collect()
}

#[test]
fn presets_are_listed_by_name() {
    let names: Vec<String> = presets().into_iter().map(|preset| preset.name).collect();
    assert_eq!(
        names,
        [
            "contact",
            "crsm",
            "crsm_d",
            "crsm_depth",
            "crsm_hw",
            "crsm_single",
            "crsma",
            "crsma_d",
            "crsma_full",
            "esm",
            "evsm",
            "hybrid_pcf",
            "hybrid_pcf_area",
            "hybrid_pcf_d",
            "light_buffer",
            "light_buffer_area",
            "msm",
            "nsm",
            "nsm_d",
            "pcf",
            "pcss",
            "pssm",
            "rt",
            "rt_area",
            "sdsm",
            "tsm",
            "vsm"
        ]
    );
}

#[test]
fn presets_keep_the_contract() {
    for preset in presets() {
        let graph = load(&preset.path);
        assert!(!graph.description().is_empty(), "{}", preset.name);
        let outputs = graph.outputs();
        assert!(
            outputs.contains(&"visibility"),
            "{}: {outputs:?}",
            preset.name
        );
        assert!(
            graph.warnings().is_empty(),
            "{}: {:?}",
            preset.name,
            graph.warnings()
        );
        let plan = plan(&preset.path, None);
        let culled = plan.culled().iter().map(|pass| &pass.name);
        let culled: Vec<_> = culled
            .filter(|name| {
                let on_request = ["fit_map.texel_density", "visibility_buffer.shading_normal"];
                !on_request.iter().any(|pass| name.ends_with(pass))
            })
            .collect();
        // `position` is not kept where passes find receivers anew; rays are written on request.
        let is_needed = |name: &&&String| {
            let left_out = ["gbuffer.surface", ".write_rays"];
            !left_out.iter().any(|pass| name.ends_with(pass))
        };
        let culled: Vec<_> = culled.iter().filter(is_needed).collect();
        assert!(
            plan.warnings().is_empty() && culled.is_empty(),
            "{}: {:?}, {culled:?}",
            preset.name,
            plan.warnings()
        );
        // Counts are buffers.
        let pictures = plan.outputs().into_iter().filter(|o| o.format.is_some());
        for output in pictures {
            assert_eq!(output.size, [640, 480], "{} {}", preset.name, output.name);
        }
    }
}

/// docs/authoring.md says so under *Order*: in the presets each reader stands below its writer.
#[test]
fn passes_keep_the_order_of_the_file() {
    for preset in presets() {
        let plan = plan(&preset.path, None);
        let edges = plan.dependences(|_| true);
        let is_forward = edges.keys().all(|(earlier, later, _)| earlier < later);
        assert!(!edges.is_empty() && is_forward, "{}", preset.name);
        // Passes of a document that is extended stand in another file.
        let text = EmbeddedSources.read(&preset.path).unwrap().unwrap();
        let passes = plan.all_passes().iter().filter(|pass| {
            let again = ["[1]", "[2]", "[3]", "[4]", "[5]", "[6]", "[7]"];
            let is_first = !again.iter().any(|index| pass.name.contains(index));
            is_first && *pass.name.span.file.name == *preset.path && !text.contains("extends:")
        });
        let places: Vec<usize> = passes.map(|pass| pass.name.span.range.start).collect();
        assert!(places.is_sorted(), "{}: {places:?}", preset.name);
    }
    let guide = include_str!("../../docs/authoring.md");
    let guide: Vec<&str> = guide.split_whitespace().collect();
    let says = "if each reader stands below its writer, no pass is moved.";
    assert!(guide.join(" ").contains(says), "{says}");
}

#[test]
fn the_steps_of_a_frame_are_passes() {
    let rt = [
        "gbuffer.visibility_buffer.primitive",
        "detect_facing",
        "turn[0].fill_rays.compact",
        "turn[0].fill_rays.dispatch_arguments",
        "turn[0].trace_rays",
        "turn[0].fix_pixels",
    ];
    assert_eq!(live(&plan("pipelines/rt.ron", None)), rt);
    let nsm = [
        "gbuffer.visibility_buffer.primitive",
        "gbuffer.surface",
        "create_shadow_map.fit_map.over_scene",
        "create_shadow_map.draw[0]",
        "shadow_lookup",
    ];
    assert_eq!(live(&plan("pipelines/nsm.ron", None)), nsm);
    assert_eq!(
        live(&plan("pipelines/shared/gbuffer.ron", Some(&["primitive"]))),
        ["visibility_buffer.primitive"]
    );
    let crsma = [
        "gbuffer.visibility_buffer.primitive",
        "fit_map.over_scene",
        "create_shadow_map.layer[0].outer",
        "create_shadow_map.layer[0].turn[0].select",
        "create_shadow_map.layer[0].turn[0].inner",
        "detect_uncertain",
        "turn[0].fill_rays.compact",
        "turn[0].fill_rays.dispatch_arguments",
        "turn[0].trace_rays",
        "turn[0].fix_pixels",
    ];
    assert_eq!(live(&plan("pipelines/crsma.ron", None)), crsma);
}

#[test]
fn only_what_asks_for_neighbours_needs_adjacency() {
    for preset in presets() {
        let needs = plan(&preset.path, None)
            .provided()
            .contains(&"scene.adjacency");
        let asks = ["crsma", "crsma_d", "crsma_full"].contains(&preset.name.as_str());
        assert_eq!(needs, asks, "{}", preset.name);
    }
}

#[test]
fn hardware_that_is_not_there_is_one_diagnostic() {
    let errors = load("pipelines/crsm_hw.ron")
        .plan(&PlanRequest::new(
            [64, 64],
            &SceneProvider::new(Arc::new(empty())),
        ))
        .expect_err("wgpu's default features have no conservative rasterisation");
    assert_eq!(errors.iter().count(), 1, "{errors}");
    let text = errors.to_string();
    assert!(text.contains("CONSERVATIVE_RASTERIZATION"), "{text}");
}

fn empty() -> Scene {
    Scene {
        name: "none".into(),
        mesh: Mesh::default(),
        views: vec![],
        lights: vec![DirectionalLight::new(DVec3::NEG_Z).into()],
    }
}

#[test]
fn only_a_traced_graph_needs_a_hierarchy() {
    let needs = |path, outputs| {
        plan(path, outputs)
            .provided()
            .iter()
            .any(|name| name.contains("bvh"))
    };
    assert!(needs("pipelines/rt.ron", None));
    assert!(!needs("pipelines/nsm.ron", None));
    assert!(!needs("pipelines/rt.ron", Some(&["ray_count"])));
}

#[test]
fn what_no_output_needs_is_culled() {
    let plan = plan("pipelines/rt.ron", Some(&["ray_count"]));
    assert_eq!(
        live(&plan),
        [
            "gbuffer.visibility_buffer.primitive",
            "detect_facing",
            "turn[0].fill_rays.compact"
        ]
    );
    let culled: Vec<String> = plan.culled().iter().map(|pass| pass.name.clone()).collect();
    assert_eq!(
        culled,
        [
            "gbuffer.visibility_buffer.shading_normal",
            "gbuffer.surface",
            "turn[0].fill_rays.dispatch_arguments",
            "turn[0].write_rays",
            "turn[0].trace_rays",
            "turn[0].fix_pixels"
        ]
    );
}

#[test]
fn more_rays_than_every_device_binds_are_traced_in_turns() {
    let provider = SceneProvider::new(Arc::new(empty()));
    let rt = load("pipelines/rt.ron");
    // 4 bytes a ray; the request's default limits bind 128 MiB, which 33,554,432 have.
    for (viewport, turns) in [([7680, 4320], 1), ([8192, 4096], 1), ([8192, 4097], 2)] {
        let plan = rt.plan(&PlanRequest::new(viewport, &provider));
        let plan = plan.unwrap_or_else(|errors| panic!("{viewport:?}: {errors}"));
        let traces = plan
            .passes()
            .iter()
            .filter(|pass| pass.kind == "Trace")
            .count();
        assert_eq!(traces, turns, "{viewport:?}");
    }
}

/// Mebibytes at 1024² pixels, with maps of 1024² texels, without what the scene takes.
#[test]
fn methods_take_the_memory_that_they_need() {
    let bytes = |name: &str| {
        let provider = SceneProvider::new(Arc::new(empty()));
        let plan =
            load(&format!("pipelines/{name}.ron")).plan(&PlanRequest::new([1024; 2], &provider));
        plan.unwrap_or_else(|errors| panic!("{errors}"))
            .memory_bytes()
    };
    for (name, most) in [
        ("nsm", 30),
        ("rt", 20),
        ("hybrid_pcf", 24),
        ("crsm", 28),
        ("light_buffer", 40),
        ("rt_area", 40),
        ("hybrid_pcf_area", 72),
    ] {
        let mebibytes = bytes(name) as f64 / f64::from(1 << 20);
        let most = f64::from(most);
        assert!(
            (most - 0.5..most + 0.05).contains(&mebibytes),
            "{name}: {mebibytes}"
        );
    }
}

#[test]
fn primitives_are_drawn_once_for_all_lights() {
    let document = r#"(
        format: 3,
        description: "two lights",
        materials: [Texture(name: "visibility", format: R32Uint, layers: "lights.count"),
            Texture(name: "status", format: R32Uint, layers: "lights.count")],
        passes: [Include(graph: "METHOD", name: "lit", repeat: "lights.count", bind: {
            "light": "lights[index]", "visibility": "visibility[index]",
            "status": "status[index]"})],
        outputs: ["visibility", "status"],
        lights: [directional, spot, point],
    )"#;
    let mut scene = empty();
    scene
        .lights
        .push(DirectionalLight::new(DVec3::NEG_Y).into());
    let provider = SceneProvider::new(Arc::new(scene));
    for (method, primitives, surfaces) in [("rt.ron", 1, 0), ("light_buffer.ron", 1, 2)] {
        let document = document.replace("METHOD", method);
        let files = MemorySources::new([("pipelines/two.ron", &*document)]).over(EmbeddedSources);
        let graph = Graph::load("pipelines/two.ron", &registry(), &files);
        let graph = graph.unwrap_or_else(|errors| panic!("{errors}"));
        let plan = graph.plan(&PlanRequest::new([64, 64], &provider));
        let passes = live(&plan.unwrap_or_else(|errors| panic!("{errors}")));
        let count = |ending| passes.iter().filter(|name| name.ends_with(ending)).count();
        assert_eq!(count("buffer.primitive"), primitives, "{passes:?}");
        assert_eq!(count("gbuffer.surface"), surfaces, "{passes:?}");
    }
}
