//! How much presets' shaders do in a frame, counted by the shaders themselves: bounds of work, for
//! which no clock is needed.

use crate::support::{
    bench::Bench,
    graphs::{layered, open, provider, run_on},
    meshes,
};
use glam::{DVec3, Vec3};
use skiagraph_gpu::Content;
use skiagraph_graph::{Capture, Graph, ParamValue, PlanRequest, Sources};
use skiagraph_passes::{EmbeddedSources, registry};
use skiagraph_scene::{LightKind, Scene, SceneLibrary, SpotLight, View};
use skiagraph_tests::cpu_reference::LightSpace;
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [64, 64];
const MAP: u32 = 512;

fn params() -> [(&'static str, ParamValue); 2] {
    let none = ParamValue::Choice("none".into());
    [("map_size", ParamValue::U32(MAP)), ("cull", none)]
}

fn level() -> Arc<Scene> {
    Arc::new(SceneLibrary::default().load("level").unwrap().0)
}

/// How often lines of shaders are reached, all together, in one frame of a preset.
fn reached(preset: &str, scene: &Arc<Scene>, lines: &[(&str, &str)]) -> u32 {
    let counting: Vec<(String, String)> = lines
        .iter()
        .map(|(shader, line)| {
            let path = format!("shaders/{shader}.wgsl");
            let text = EmbeddedSources.read(&path).unwrap().unwrap();
            assert_eq!(text.matches(line).count(), 1, "{line}");
            let text = text.replace(line, &format!("{line}\n    atomicAdd(&times, 1u);"));
            let times = "var<storage, read_write> times: atomic<u32>;";
            (path, format!("{text}\n{times}\n"))
        })
        .collect();
    let document = format!(
        r#"(
            format: 3,
            extends: "pipelines/{preset}.ron",
            description: "{preset}, and how often a line is reached",
            materials: [Buffer(name: "times")],
            passes: [
                Clear(
                    before: "create_shadow_map.layer.outer",
                    name: "reset_times",
                    target: "times",
                ),
            ],
            lights: [directional, spot],
        )"#
    );
    let mut files = vec![("test.ron", &*document)];
    files.extend(counting.iter().map(|(path, text)| (&**path, &**text)));
    let graph = Graph::load("test.ron", &registry(), &layered(&files))
        .unwrap_or_else(|error| panic!("{error}"));
    let mut provider = provider(scene, &scene.views[0], VIEWPORT);
    let mut request = PlanRequest::new(VIEWPORT, &provider);
    let params = params().map(|(name, value)| (name.to_owned(), value));
    request.params.extend(params);
    request.captures.push(Capture::new("times"));
    let plan = graph
        .plan(&request)
        .unwrap_or_else(|error| panic!("{error}"));
    let report = run_on(&open(), plan, &mut provider, &["times"]);
    let read = report.readbacks.iter().find(|read| read.name == "times");
    match &read.unwrap().content {
        Content::Buffer(bytes) => bytemuck::pod_read_unaligned(bytes),
        Content::Texture { .. } => panic!("`times` is a buffer"),
    }
}

/// Walks over one-rings grow with the length of the edges in a map, not with the area of its
/// triangles: three fragments for every two texels of edges.
#[test]
fn walks_are_as_many_as_edges_are_long() {
    let scene = level();
    let walk = ("inner_one_ring", "fn patch_depth(vertex: Vertex) -> f32 {");
    let walks = reached("crsma_full", &scene, &[walk]);
    let space = LightSpace::new(&scene.mesh, &scene.sun().unwrap(), MAP);
    let [mut edges, mut area] = [0.0, 0.0];
    for primitive in 0..scene.mesh.triangles.len() as u32 {
        let corners = scene.mesh.corners(primitive);
        let [a, b, c] = corners.map(|corner| space.texel(corner).truncate());
        edges += a.distance(b) + b.distance(c) + c.distance(a);
        area += (b - a).perp_dot(c - a).abs() / 2.0;
    }
    let most = 1.5 * edges;
    println!("{walks} walks, edges of {edges:.0} texels, {area:.0} texels of triangles");
    assert!(f64::from(walks) < most, "{walks} walks, at most {most}");
    // And there was something to bound.
    assert!(
        walks > 10_000 && area > 2.0 * most,
        "{walks}, {area}, {most}"
    );
}

/// On the level, whose parts are all open, with nothing culled.
#[test]
fn what_is_bounded_stays_exact() {
    let scene = level();
    let mut bench = Bench::new(&scene, VIEWPORT);
    for view in &scene.views {
        bench.look(view);
        let [outer, full] = ["crsm", "crsma_full"].map(|preset| {
            let counts = bench.judge(preset, &params());
            assert_eq!(
                counts.wrong.total, counts.wrong.in_band,
                "{preset}: {counts:?}"
            );
            assert!(counts.certain.shadow > 100, "{preset}: {counts:?}");
            counts.uncertain
        });
        assert!(full < outer, "{full} of crsma_full, {outer} of crsm");
    }
}

/// Blades around a lamp, each of which passes it and its plane, or begins at its very place.
fn blades(count: u32) -> Arc<Scene> {
    let lamp = Vec3::new(0.0, 6.0, 0.0);
    let around = |part: f32, radius: f32, y: f32| {
        let (sin, cos) = (part / count as f32 * std::f32::consts::TAU).sin_cos();
        Vec3::new(radius * cos, y, radius * sin)
    };
    let floor = [(-20.0, 20.0), (20.0, 20.0), (20.0, -20.0), (-20.0, -20.0)];
    let mut positions: Vec<Vec3> = floor.map(|(x, z)| Vec3::new(x, 0.0, z)).to_vec();
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    let mut blade = |corners: [Vec3; 3]| {
        let first = positions.len() as u32;
        positions.extend(corners);
        triangles.push([first, first + 1, first + 2]);
    };
    for number in 0..count {
        let at = number as f32;
        let far = |y: f32, radius: f32| [0.0, 0.5].map(|more| around(at + more, radius, y));
        let [left, right] = far(1.5, 12.0);
        blade([around(at, 0.3, 7.0), left, right]);
        let [left, right] = far(5.0, 3.0);
        blade([lamp, left, right]);
    }
    Arc::new(Scene {
        name: "blades".into(),
        mesh: meshes::mesh(positions, triangles),
        views: vec![View {
            eye: DVec3::new(15.0, 4.0, 15.0),
            direction: DVec3::new(-0.6, -0.3, -0.6),
            fov_y_degrees: 70.0,
            far: 100.0,
            ..View::default()
        }],
        lights: vec![
            LightKind::Spot(SpotLight {
                position: lamp.as_dvec3(),
                direction: DVec3::NEG_Y,
                cone_degrees: 150.0,
                radius: 0.0,
            })
            .into(),
        ],
    })
}

/// Triangles without a place in a spot light's map are drawn where they may be, and those that may
/// be anywhere as one: a few maps of fragments, not one for each.
#[test]
fn what_has_no_place_in_a_spot_lights_map_costs_what_it_may_cover() {
    let drawn = [
        ("outer_depth", "fn nearest(vertex: Vertex) -> f32 {"),
        (
            "outer_unplaced",
            "fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {",
        ),
    ];
    let fragments = reached("crsm", &blades(60), &drawn);
    let maps = f64::from(fragments) / f64::from(MAP * MAP);
    println!("{fragments} fragments, {maps:.2} maps, of 120 blades");
    assert!((1.0..6.0).contains(&maps), "{maps} maps");
}
