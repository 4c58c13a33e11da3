//! `Trace` by the hierarchy in light space finds what the compute hierarchy finds, to the bit where
//! a driver compiles both alike (where not: compiled_apart.rs), and is refused for rays that
//! nothing says go towards the light.

use crate::support::{
    bench::Bench,
    brute::{Hit, MISS, Ray},
    graphs::{layered, trace_by},
    meshes,
    random::Random,
    scenes::{load, sponza},
};
use glam::{DVec3, Vec3};
use skiagraph_graph::{Graph, ParamValue, PlanRequest, Sources};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry, uniforms::LightUniform};
use skiagraph_scene::{DirectionalLight, Mesh};

#[test]
fn rt_answers_as_by_the_compute_hierarchy() {
    let park = load("park");
    let mut bench = Bench::new(&park, [128, 96]);
    for view in &park.views {
        bench.look(view);
        let [ours, theirs] = ["hierarchy", "light_space"].map(|engine| {
            let engine = ParamValue::Choice(engine.to_owned());
            bench.answers("rt", &[("engine", engine)])
        });
        assert!(ours.counts.pixels.shadow > 0, "{}", view.name);
        assert!(ours.visibility == theirs.visibility, "{}", view.name);
    }
}

#[test]
fn rt_on_sponza_answers_as_by_the_compute_hierarchy() {
    let Some(scene) = sponza() else { return };
    let mut bench = Bench::new(&scene, [512, 512]);
    let [ours, theirs] = ["hierarchy", "light_space"].map(|engine| {
        let engine = ParamValue::Choice(engine.to_owned());
        bench.answers("rt", &[("engine", engine)])
    });
    assert!(ours.counts.pixels.shadow > 10_000);
    assert!(ours.visibility == theirs.visibility);
}

/// The direction that shaders see of a light.
fn to_light(mesh: &Mesh, direction: DVec3) -> Vec3 {
    LightUniform::new(DirectionalLight::new(direction), mesh).to_light
}

fn both(
    mode: &str,
    light: DVec3,
    mesh: &Mesh,
    rays: &[Ray],
    skip: Option<&[u32]>,
) -> [Vec<Hit>; 2] {
    ["Hierarchy", "LightSpace"].map(|engine| {
        let fields = format!("mode: {mode}, engine: {engine}, direction: Light");
        trace_by(&fields, light, mesh, rays, skip, rays.len() as u32)
    })
}

#[test]
fn parallel_rays_hit_the_same() {
    let snapped = |p: Vec3| (p * 8.0).round() / 8.0;
    let mut random = Random(3);
    let mut blocked = 0;
    for (case, (scale, offset, on_a_grid)) in [
        (1.0, Vec3::ZERO, false),
        (1.0, Vec3::ZERO, true),
        (1e-4, Vec3::ZERO, false),
        (1e6, Vec3::ZERO, true),
        (1.0, Vec3::new(1e4, -3e3, 7e3), false),
        (1e3, Vec3::splat(1e7), true),
    ]
    .into_iter()
    .enumerate()
    {
        // Along each axis, too, and between two of them: edges that rays meet exactly.
        let directions = [
            random.vector().as_dvec3(),
            random.vector().as_dvec3(),
            DVec3::NEG_Y,
            DVec3::X,
            DVec3::new(0.0, -1.0, 1.0),
            DVec3::new(-1.0, -1.0, -1.0),
        ];
        for direction in directions {
            let mut mesh = meshes::soup(600, 0.2, case as u64);
            let place = |p: Vec3| {
                if on_a_grid {
                    snapped(p) * scale + offset
                } else {
                    p * scale + offset
                }
            };
            mesh.positions.iter_mut().for_each(|p| *p = place(*p));
            let direction_of_rays = to_light(&mesh, direction);
            let rays: Vec<Ray> = (0..2000)
                .map(|index| Ray {
                    origin: match index % 3 {
                        // From corners, and from outside of the scene.
                        0 => mesh.positions[index % mesh.positions.len()],
                        1 => place(random.vector() * 3.0),
                        _ => place(random.vector()),
                    },
                    t_min: 0.0,
                    direction: direction_of_rays,
                    t_max: match index % 5 {
                        0 => scale * random.unit(),
                        _ => 1e30,
                    },
                })
                .collect();
            let skip: Vec<u32> = (0..rays.len() as u32).map(|ray| ray % 600).collect();
            let [ours, theirs] = both("Closest", direction, &mesh, &rays, Some(&skip));
            let nearest =
                |hits: &[Hit]| -> Vec<u32> { hits.iter().map(|hit| hit.t.to_bits()).collect() };
            assert!(nearest(&ours) == nearest(&theirs), "{case} {direction}");
            let hit_flags = |hits: &[Hit]| -> Vec<bool> {
                hits.iter().map(|hit| hit.primitive != MISS).collect()
            };
            let [any, any_too] = both("Any", direction, &mesh, &rays, Some(&skip));
            assert!(hit_flags(&any) == hit_flags(&ours), "{case} {direction}");
            assert!(
                hit_flags(&any_too) == hit_flags(&ours),
                "{case} {direction}"
            );
            blocked += hit_flags(&any).iter().filter(|is_hit| **is_hit).count();
        }
    }
    assert!(blocked > 10_000, "{blocked}: too few to mean anything");
}

#[test]
fn other_rays_and_empty_scenes_hit_nothing() {
    let mesh = meshes::potato(2, 0.1, 7);
    let up = to_light(&mesh, DVec3::NEG_Y);
    let ray = |direction| Ray {
        origin: Vec3::ZERO,
        t_min: 0.0,
        direction,
        t_max: 10.0,
    };
    let rays = [ray(up), ray(Vec3::X), ray(Vec3::ZERO), ray(up * 2.0)];
    let [_, hits] = both("Any", DVec3::NEG_Y, &mesh, &rays, None);
    assert!(hits[0].primitive != MISS && hits[0].t > 0.5, "{hits:?}");
    for hit in &hits[1..] {
        assert_eq!((hit.primitive, hit.t), (MISS, -1.0));
    }
    let [_, hits] = both("Any", DVec3::NEG_Y, &Mesh::default(), &rays, None);
    assert_eq!((hits[0].primitive, hits[0].t), (MISS, 10.0));
}

#[test]
fn it_is_refused_where_nothing_says_that_rays_go_towards_the_light() {
    let text = EmbeddedSources.read("pipelines/rt.ron");
    let text = text.unwrap().unwrap().to_string();
    let without = text.replace("direction: Light", "");
    assert_ne!(text, without);
    let provider = SceneProvider::new(load("park"));
    for (text, engine, is_refused) in [
        (&without, "light_space", true),
        (&without, "hierarchy", false),
        (&text, "light_space", false),
    ] {
        let sources = layered(&[("pipelines/rt.ron", text)]);
        let graph = Graph::load("pipelines/rt.ron", &registry(), &sources)
            .unwrap_or_else(|errors| panic!("{errors}"));
        let mut request = PlanRequest::new([64, 64], &provider);
        let engine_param = ParamValue::Choice(engine.to_owned());
        request.params.insert("engine".to_owned(), engine_param);
        let planned = graph.plan(&request);
        let error = planned.err().map(|errors| errors.to_string());
        assert_eq!(error.is_some(), is_refused, "{engine}: {error:?}");
        if let Some(error) = error {
            assert!(error.contains("direction: Light"), "{error}");
        }
    }
}
