//! The layers of the hybrids' maps, texel by texel, against points of the casters; and the casters
//! that break careless layers.

use crate::support::{
    graphs::{plan, provider, run, values},
    meshes,
    random::Random,
};
use glam::{DVec2, DVec3, Vec3};
use skiagraph_gpu::{Content, Provider};
use skiagraph_graph::{Capture, Describe, ParamValue, PlanRequest, Provided};
use skiagraph_passes::{SceneProvider, names::LIGHT, uniforms::LightUniform};
use skiagraph_reference::{Oracle, OracleMode, Progress, Statistics};
use skiagraph_scene::{DirectionalLight, Mesh, Scene, View};
use skiagraph_tests::cpu_reference::LightSpace;
use std::sync::Arc;
use wgpu::util::DeviceExt;

const VIEWPORT: [u32; 2] = [160, 120];
/// Bound on the f32 error of a depth.
const DEPTH_ERROR: f64 = 4e-6;

fn scene(mesh: Mesh, direction: DVec3) -> Arc<Scene> {
    Arc::new(Scene {
        name: "layers".into(),
        mesh,
        views: vec![View {
            eye: DVec3::new(0.3, 9.0, 6.0),
            direction: DVec3::new(0.0, -1.0, -0.7),
            far: 100.0,
            ..View::default()
        }],
        lights: vec![DirectionalLight::new(direction).into()],
    })
}

fn set(request: &mut PlanRequest, params: &[(&str, ParamValue)]) {
    for (name, value) in params {
        request.params.insert((*name).into(), value.clone());
    }
}

fn choice(word: &str) -> ParamValue {
    ParamValue::Choice(word.into())
}

/// The layers `outer` and `inner` of a preset.
fn layers(preset: &str, scene: &Arc<Scene>, params: &[(&str, ParamValue)]) -> [Vec<f32>; 2] {
    let mut provider = provider(scene, &scene.views[0], VIEWPORT);
    let plan = plan(
        &format!("pipelines/{preset}.ron"),
        &provider,
        VIEWPORT,
        |request| {
            set(request, params);
            for layer in ["outer", "inner"] {
                request.captures.push(Capture::new(layer));
            }
        },
    );
    let report = run(plan, &mut provider, &["outer", "inner"]);
    ["outer", "inner"].map(|layer| {
        let readback = report
            .readbacks
            .iter()
            .find(|readback| readback.name == layer);
        match &readback.unwrap().content {
            Content::Texture { bytes, .. } => bytemuck::pod_collect_to_vec(bytes),
            Content::Buffer(_) => panic!("a layer is a texture"),
        }
    })
}

/// Triangles of several makes: large, smaller than a texel, needles, edge-on for the light (which
/// falls along z), without area.
fn soups() -> Vec<(&'static str, Mesh)> {
    let mut random = Random(11);
    let mut flat = |scale: Vec3| {
        let mut mesh = meshes::soup(60, 0.6, 5);
        for corners in mesh.positions.chunks_exact_mut(3) {
            let centre = corners[0];
            let turn = glam::Quat::from_rotation_z(random.unit() * 6.0);
            for corner in corners.iter_mut() {
                *corner = centre + turn * ((*corner - centre) * scale);
            }
        }
        mesh
    };
    vec![
        ("large", meshes::soup(40, 1.0, 1)),
        ("small", meshes::soup(400, 0.02, 2)),
        ("needles", flat(Vec3::new(1.5, 0.002, 1.0))),
        ("edge-on", flat(Vec3::new(1.0, 0.0, 1.0))),
        ("without area", flat(Vec3::new(1.0, 0.0, 0.0))),
        ("potato", meshes::potato(3, 0.2, 9)),
    ]
}

const LIGHT_ALONG_Z: DVec3 = DVec3::NEG_Z;
const MAP: u32 = 64;

/// Corners in texels and depth.
fn casters(mesh: &Mesh, space: &LightSpace) -> Vec<[DVec3; 3]> {
    (0..mesh.triangles.len() as u32)
        .map(|primitive| mesh.corners(primitive).map(|corner| space.texel(corner)))
        .collect()
}

fn texel(point: DVec2) -> usize {
    point.y as usize * MAP as usize + point.x as usize
}

#[test]
fn nothing_of_a_caster_is_nearer_than_the_outer_depth() {
    for (name, mesh) in soups() {
        for n in [0.5, 1.0] {
            let scene = scene(mesh.clone(), LIGHT_ALONG_Z);
            let params = [
                ("map_size", ParamValue::U32(MAP)),
                ("cull", choice("none")),
                ("n", ParamValue::F32(n)),
            ];
            let [outer, _] = layers("crsm", &scene, &params);
            let space = LightSpace::new(&scene.mesh, &scene.sun().unwrap(), MAP);
            let mut random = Random(3);
            let mut points = 0;
            for [a, b, c] in casters(&scene.mesh, &space) {
                for turn in 0..300 {
                    let (mut u, mut v) = (f64::from(random.unit()), f64::from(random.unit()));
                    // Inside, on an edge, at a corner.
                    match turn % 4 {
                        0 => v = 0.0,
                        1 => (u, v) = (u.round(), 0.0),
                        _ if u + v > 1.0 => (u, v) = (1.0 - u, 1.0 - v),
                        _ => {}
                    }
                    let point = a + (b - a) * u + (c - a) * v;
                    let stored = f64::from(outer[texel(point.truncate())]);
                    assert!(
                        stored <= point.z + DEPTH_ERROR,
                        "{name}, n {n}: {point} before {stored}"
                    );
                    points += 1;
                }
            }
            assert!(points > 10_000);
            // And the layer is not simply full: what touches no texel near it leaves it empty.
            assert!(name == "large" || outer.contains(&1.0), "{name}");
        }
    }
}

#[test]
fn behind_the_inner_depth_with_and_without_one_ring_is_no_hole() {
    let mut covered = 0;
    for (name, mesh) in soups() {
        for (preset, depth) in [("crsm", "conservative"), ("crsma_full", "conservative")] {
            let scene = scene(mesh.clone(), LIGHT_ALONG_Z);
            let params = [
                ("map_size", ParamValue::U32(MAP)),
                ("cull", choice("none")),
                ("depth", choice(depth)),
            ];
            let [_, inner] = layers(preset, &scene, &params);
            let space = LightSpace::new(&scene.mesh, &scene.sun().unwrap(), MAP);
            let casters = casters(&scene.mesh, &space);
            let mut random = Random(4);
            for (index, &stored) in inner.iter().enumerate() {
                if stored == 1.0 {
                    continue;
                }
                covered += 1;
                let corner =
                    DVec2::new((index % MAP as usize) as f64, (index / MAP as usize) as f64);
                for turn in 0..24 {
                    let mut within = DVec2::new(random.unit().into(), random.unit().into());
                    if turn < 8 {
                        within = within.round(); // the texel's own corners
                    }
                    let point = corner + within;
                    let blocked = casters.iter().any(|[a, b, c]| {
                        let side = |p: &DVec3, q: &DVec3| {
                            (*q - *p).truncate().perp_dot(point - p.truncate())
                        };
                        let sides = DVec3::new(side(b, c), side(c, a), side(a, b));
                        let (area, slack) = (sides.element_sum(), 1e-3);
                        let inside = sides.cmpge(DVec3::splat(-slack)).all()
                            || sides.cmple(DVec3::splat(slack)).all();
                        let depth = sides.dot(DVec3::new(a.z, b.z, c.z)) / area;
                        inside && area != 0.0 && depth <= f64::from(stored) + 1e-3
                    });
                    assert!(
                        blocked,
                        "{name}, {preset}: a hole at {point} before {stored}"
                    );
                }
            }
        }
    }
    assert!(covered > 3000, "{covered} texels");
}

/// A floor of 16 by 16, and what stands above it.
fn above_floor(mut positions: Vec<Vec3>, mut triangles: Vec<[u32; 3]>) -> Mesh {
    let first = positions.len() as u32;
    let corners = [(-8.0, 8.0), (8.0, 8.0), (8.0, -8.0), (-8.0, -8.0)];
    positions.extend(corners.map(|(x, z)| Vec3::new(x, 0.0, z)));
    triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    meshes::mesh(positions, triangles)
}

fn one_above_floor(corners: [[f32; 3]; 3]) -> Mesh {
    above_floor(corners.map(Vec3::from).to_vec(), vec![[0, 1, 2]])
}

fn judge(
    preset: &str,
    scene: &Arc<Scene>,
    provider: &mut dyn Provider,
    params: &[(&str, ParamValue)],
) -> Statistics {
    let path = format!("pipelines/{preset}.ron");
    let graph = skiagraph_graph::Graph::load(
        &path,
        &skiagraph_passes::registry(),
        &skiagraph_passes::EmbeddedSources,
    );
    let mut request = PlanRequest::new(VIEWPORT, provider);
    set(&mut request, params);
    request.captures.push(Capture::new("primitive"));
    let plan = graph
        .and_then(|graph| graph.plan(&request))
        .unwrap_or_else(|errors| panic!("{errors}"));
    let report = run(plan, provider, &["visibility", "status", "primitive"]);
    let camera = scene.views[0].camera(VIEWPORT);
    let primitives = values(&report, "primitive");
    let truth = Oracle::new(&scene.mesh)
        .shade(
            &camera,
            scene.sun().unwrap(),
            &primitives,
            OracleMode::Exact,
            Progress::default(),
        )
        .unwrap();
    let (visibility, status) = (values(&report, "visibility"), values(&report, "status"));
    Statistics::judged(&visibility, &status, &truth).unwrap()
}

const STRAIGHT_DOWN: DVec3 = DVec3::NEG_Y;

/// Degenerate casters over a floor, each with what must come of it.
fn degenerate() -> Vec<(&'static str, Mesh)> {
    vec![
        (
            "edge-on",
            one_above_floor([[-3.0, 1.0, 0.0], [3.0, 1.0, 0.0], [0.0, 3.0, 0.0]]),
        ),
        (
            "zero area",
            one_above_floor([[-3.0, 2.0, -1.0], [0.0, 2.0, 0.0], [3.0, 2.0, 1.0]]),
        ),
        ("a point", one_above_floor([[0.5, 2.0, 0.5]; 3])),
        (
            "shrunk away",
            one_above_floor([[0.0, 2.0, 0.0], [0.1, 2.0, 0.0], [0.0, 2.0, 0.1]]),
        ),
        (
            "needle",
            one_above_floor([[-5.0, 2.0, -3.0], [5.0, 1.0, 3.0], [5.0, 1.0, 3.01]]),
        ),
        // Shrunk by more than its inner radius, the moved edges meet on the wrong sides.
        (
            "inside out",
            one_above_floor([[-4.0, 2.0, 0.0], [4.0, 2.0, 0.3], [4.0, 2.0, -0.3]]),
        ),
        (
            "seen from behind",
            one_above_floor([[-2.0, 2.0, -2.0], [2.0, 2.0, -2.0], [0.0, 2.0, 2.0]]),
        ),
        (
            "steep",
            one_above_floor([[-2.0, 0.1, -2.0], [-1.9, 6.0, 2.0], [2.0, 3.0, -2.0]]),
        ),
        (
            "standing on the floor",
            one_above_floor([[-2.0, 0.0, 0.0], [2.0, 0.0, 0.5], [0.0, 3.0, -2.0]]),
        ),
    ]
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn degenerate_casters_leave_no_certain_pixel_wrong() {
    for (name, mesh) in degenerate() {
        for preset in ["crsm", "crsma_full", "crsma", "crsm_depth"] {
            for map_size in [32, 100] {
                let scene = scene(mesh.clone(), STRAIGHT_DOWN);
                let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
                let params = [
                    ("map_size", ParamValue::U32(map_size)),
                    ("cull", choice("none")),
                ];
                let counts = judge(preset, &scene, &mut provider, &params);
                let determinate = counts.wrong.total - counts.wrong.in_band;
                assert_eq!(
                    determinate, 0,
                    "{name}, {preset}, map {map_size}: {counts:?}"
                );
                assert!(
                    counts.pixels.facing_light > 5000
                        && counts.band * 200 < counts.pixels.facing_light
                );
            }
        }
    }
}

#[test]
fn a_caster_that_vanishes_from_the_inner_depth_stays_in_the_outer() {
    for (name, mesh) in degenerate() {
        let scene = scene(mesh, STRAIGHT_DOWN);
        let params = [("map_size", ParamValue::U32(MAP)), ("cull", choice("none"))];
        let [outer, inner] = layers("crsm", &scene, &params);
        // The floor is the farthest: in `outer` all that is nearer is the caster.
        let (floor, above) = (
            outer.iter().copied().fold(0.0, f32::max),
            |layer: &[f32]| layer.iter().filter(|&&depth| depth < 0.95).count(),
        );
        assert!(floor > 0.99, "{name}: the floor is at {floor}");
        assert!(above(&outer) > 0, "{name} is gone from the outer depth");
        let vanishes = [
            "edge-on",
            "zero area",
            "a point",
            "shrunk away",
            "needle",
            "inside out",
        ];
        assert_eq!(
            above(&inner) == 0,
            vanishes.contains(&name),
            "{name}: {}",
            above(&inner)
        );
    }
}

/// The scene's provider with another light space.
struct OtherLight(SceneProvider, LightUniform);

impl Describe for OtherLight {
    fn names(&self) -> Vec<String> {
        self.0.names()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        self.0.describe(name)
    }
}

impl Provider for OtherLight {
    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, skiagraph_gpu::ProviderError> {
        if name != LIGHT {
            return self.0.build(name, device, queue);
        }
        Ok(
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(name),
                contents: bytemuck::bytes_of(&self.1),
                usage: wgpu::BufferUsages::UNIFORM,
            }),
        )
    }

    fn submit_built(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<(), skiagraph_gpu::ProviderError> {
        self.0.submit_built(device, queue)
    }
}

#[test]
fn what_crosses_the_near_plane_still_casts() {
    let mesh = one_above_floor([[-4.0, 1.0, -4.0], [4.0, 5.0, -4.0], [0.0, 3.0, 4.0]]);
    let scene = scene(mesh, STRAIGHT_DOWN);
    let mut light = LightUniform::new(scene.light(), &scene.mesh);
    // The near plane moves into the caster, from the top of the scene to its middle.
    light.clip_from_relative.w_axis.z -= 0.5;
    for preset in ["crsm", "crsma", "crsma_full", "crsm_depth"] {
        let inner = provider(&scene, &scene.views[0], VIEWPORT);
        let params = [("map_size", ParamValue::U32(MAP)), ("cull", choice("none"))];
        let counts = judge(preset, &scene, &mut OtherLight(inner, light), &params);
        assert_eq!(
            counts.wrong.total - counts.wrong.in_band,
            0,
            "{preset}: {counts:?}"
        );
        assert!(
            counts.certain.shadow > 500 && counts.pixels.shadow > 1000,
            "{preset}: {counts:?}"
        );
    }
}

/// The map over the middle of the scene only, then beside it: what lies outside is left to rays,
/// and `nsm`, which has none, calls it lit.
#[test]
fn receivers_outside_the_map_are_uncertain() {
    let mesh = one_above_floor([[-2.0, 2.0, -2.0], [2.0, 2.0, -2.0], [0.0, 2.0, 2.0]]);
    let scene = scene(mesh, STRAIGHT_DOWN);
    let judge_under = |preset: &str, zoom: f32, aside: f32| {
        let mut light = LightUniform::new(scene.light(), &scene.mesh);
        let zoomed = glam::Mat4::from_scale(Vec3::new(zoom, zoom, 1.0));
        let moved = glam::Mat4::from_translation(Vec3::new(aside, 0.0, 0.0));
        light.clip_from_relative = moved * zoomed * light.clip_from_relative;
        light.corner_across *= zoom;
        let inner = provider(&scene, &scene.views[0], VIEWPORT);
        let params = [("map_size", ParamValue::U32(MAP)), ("cull", choice("none"))];
        judge(preset, &scene, &mut OtherLight(inner, light), &params)
    };
    for preset in ["hybrid_pcf", "crsm", "crsm_depth", "crsma", "crsma_full"] {
        let [middle, beside] =
            [(4.0, 0.0), (1.0, 3.0)].map(|(zoom, aside)| judge_under(preset, zoom, aside));
        let facing = middle.pixels.facing_light;
        assert!(
            (facing / 2..facing).contains(&middle.uncertain) && middle.certain.shadow > 100,
            "{preset}: {middle:?}"
        );
        assert_eq!(beside.uncertain, facing, "{preset}");
        for counts in [middle, beside] {
            assert_eq!(
                counts.wrong.total, counts.wrong.in_band,
                "{preset}: {counts:?}"
            );
        }
    }
    let lit = judge_under("nsm", 1.0, 3.0);
    assert_eq!((lit.wrong.lit, lit.wrong.shadow), (lit.pixels.shadow, 0));
}

/// Why `crsma` proves nothing: a kept edge promises that the surface goes on, but not how far. Here
/// the neighbour is thinner than what the texel hangs over, and its outer edge is free.
#[test]
fn a_thin_neighbour_deceives_crsma_and_not_the_one_ring() {
    let y = 2.0;
    let edge = 0.15; // of a texel of 0.25 that begins at 0
    let positions = [[edge, -5.0], [edge, 5.0], [-6.0, 0.0], [edge + 0.02, 0.0]];
    let mesh = above_floor(
        positions.map(|[x, z]| Vec3::new(x, y, z)).to_vec(),
        vec![[0, 2, 1], [0, 1, 3]],
    );
    let scene = scene(mesh, STRAIGHT_DOWN);
    let count = |preset| {
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let params = [("map_size", ParamValue::U32(MAP)), ("cull", choice("none"))];
        judge(preset, &scene, &mut provider, &params).wrong
    };
    let [crsm, crsma, full] = ["crsm", "crsma", "crsma_full"].map(count);
    assert_eq!((crsm.certain, full.certain), (0, 0));
    assert!(
        crsma.certain > 10 && crsma.shadow == crsma.certain + crsma.in_band,
        "{crsma:?}"
    );
}

#[test]
fn no_uncertain_pixel_is_no_ray_and_no_workgroup() {
    // A floor alone, its underside left out: nothing is uncertain.
    let scene = scene(above_floor(vec![], vec![]), STRAIGHT_DOWN);
    for preset in [
        "hybrid_pcf",
        "crsm",
        "crsm_single",
        "crsm_depth",
        "crsma",
        "crsma_full",
    ] {
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let plan = plan(
            &format!("pipelines/{preset}.ron"),
            &provider,
            VIEWPORT,
            |request| {
                // Arguments of the indirect dispatch of fix_pixels and trace_rays.
                request.captures.push(Capture::new("ray_groups"));
            },
        );
        let report = run(plan, &mut provider, &["ray_count", "status", "ray_groups"]);
        assert_eq!(values(&report, "ray_count"), [0], "{preset}");
        assert_eq!(values(&report, "ray_groups"), [0, 0, 1], "{preset}");
        assert!(values(&report, "status").contains(&2), "{preset}");
    }
}
