//! Casters and receivers: parts that cast no shadow are in no structure of casters, pixels that
//! receive none are lit and untested, and the oracle agrees, for CPU meshes, glTF and parts.

use crate::{
    host_buffers::contents,
    support::{
        bench::{Answers, Bench},
        graphs::{self, open, plan, provider, run_on, shares, values},
        meshes,
        scenes::load,
    },
};
use glam::{DAffine3, DVec3, Vec3};
use skiagraph_graph::{Capture, Describe, ParamValue};
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{
    Class, GroundTruthPixels, Oracle, OracleMode, Progress, Statistics, statistics::status,
};
use skiagraph_scene::{
    DirectionalLight, LightKind, MaterialUse, Mesh, Movable, PointLight, Scene, Shadows, SpotLight,
    View, gltf::parse_gltf, hand_over,
};
use std::{ops::Range, path::Path, sync::Arc};

const VIEWPORT: [u32; 2] = [128, 96];

type Params<'a> = &'a [(&'a str, ParamValue)];

fn word(text: &str) -> ParamValue {
    ParamValue::Choice(text.into())
}

fn with_roles(name: &str, roles: &[(&str, Shadows)]) -> Arc<Scene> {
    let mut scene = Scene::clone(&load(name));
    for (part, shadows) in roles {
        scene.mesh.set_shadows_of(part, *shadows).unwrap();
    }
    scene.into()
}

/// The park whose flowers, its grass, cast nothing, whose bench receives nothing, and whose lamp
/// does neither.
fn park() -> Arc<Scene> {
    let roles = [
        ("flowers", Shadows::Receives),
        ("bench", Shadows::Casts),
        ("lamp", Shadows::Neither),
    ];
    with_roles("park", &roles)
}

fn grass(mesh: &Mesh) -> Range<u32> {
    let mut groups = mesh.groups.iter();
    let grass = groups.find(|group| group.name == "flowers").unwrap();
    grass.triangles.clone()
}

/// Pixels that receive no shadow are lit and untested; how many they are.
fn unshadowed_are_lit(answers: &Answers) -> usize {
    let pixels = answers.truth.classes.iter().enumerate();
    let pixels = pixels.filter(|(_, class)| **class == Class::Unshadowed);
    let pixels: Vec<usize> = pixels.map(|(pixel, _)| pixel).collect();
    for &pixel in &pixels {
        assert_eq!(answers.status[pixel], status::CERTAIN_LIGHT, "{pixel}");
        assert_eq!(answers.visibility[pixel], 1, "{pixel}");
    }
    pixels.len()
}

#[test]
fn exact_methods_agree_with_the_oracle() {
    let scene = park();
    let mut bench = Bench::new(&scene, VIEWPORT);
    let mut seen = 0;
    for view in ["bench_side", "trees_side", "flowers_side"] {
        bench.look(scene.view(view).unwrap());
        let methods: [(&str, Params<'_>); 6] = [
            ("rt", &[]),
            ("rt", &[("engine", word("light_space"))]),
            ("light_buffer", &[]),
            ("crsm", &[]),
            ("crsma_full", &[]),
            ("crsm_depth", &[]),
        ];
        for (preset, params) in methods {
            let answers = bench.answers(preset, params);
            let (wrong, pixels) = (answers.counts.wrong, answers.counts.pixels);
            assert_eq!(wrong.total, wrong.in_band, "{preset} {view}");
            assert_eq!(answers.counts.facing_mismatch, 0, "{preset} {view}");
            assert!(pixels.shadow > 300 && pixels.lit > 300, "{pixels:?}");
            seen += unshadowed_are_lit(&answers);
        }
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn soft_methods_agree_with_the_exact_ones() {
    let scene = park();
    let mut provider = provider(&scene, scene.view("bench_side").unwrap(), VIEWPORT);
    let (gpu, oracle) = (open(), Oracle::new(&scene.mesh));
    for preset in ["rt_area", "light_buffer_area"] {
        let path = format!("pipelines/{preset}.ron");
        let plan = plan(&path, &provider, VIEWPORT, |request| {
            request.captures.push(Capture::new("primitive"));
        });
        let names = ["visibility", "status", "primitive"];
        let report = run_on(&gpu, plan, &mut provider, &names);
        let shown = shares(&report, "visibility");
        let lit: Vec<u32> = shown.iter().map(|share| u32::from(*share >= 0.5)).collect();
        let truth = truth(&scene, &oracle, "bench_side", &values(&report, "primitive"));
        let counts = Statistics::judged(&lit, &values(&report, "status"), &truth).unwrap();
        assert_eq!(counts.wrong.total, counts.wrong.in_band, "{preset}");
        assert!(counts.pixels.shadow > 300, "{counts:?}");
        let unshadowed = truth.classes.iter().zip(&shown);
        let mut unshadowed = unshadowed.filter(|(class, _)| **class == Class::Unshadowed);
        assert!(unshadowed.clone().count() > 300);
        assert!(unshadowed.all(|(_, share)| *share == 1.0), "{preset}");
    }
}

fn truth(scene: &Scene, oracle: &Oracle<'_>, view: &str, primitives: &[u32]) -> GroundTruthPixels {
    let camera = scene.view(view).unwrap().camera(VIEWPORT);
    let (light, exact) = (scene.light(), OracleMode::Exact);
    let truth = oracle.shade(&camera, light, primitives, exact, Progress::default());
    truth.unwrap()
}

/// Outputs and captures of a preset as words.
fn read(scene: &Arc<Scene>, preset: &str, params: Params<'_>, names: &[&str]) -> Vec<Vec<u32>> {
    let mut provider = provider(scene, scene.view("flowers_side").unwrap(), VIEWPORT);
    let path = format!("pipelines/{preset}.ron");
    let plan = plan(&path, &provider, VIEWPORT, |request| {
        request.captures = names.iter().copied().map(Capture::new).collect();
        let params = params.iter();
        request
            .params
            .extend(params.map(|(name, value)| ((*name).to_owned(), value.clone())));
    });
    let report = run_on(&open(), plan, &mut provider, names);
    names.iter().map(|name| values(&report, name)).collect()
}

#[test]
fn grass_that_casts_nothing_is_in_no_structure() {
    let scene = park();
    let (grass, gpu) = (grass(&scene.mesh), open());
    let casters = scene.mesh.casters();
    assert!(grass.len() > 10_000 && casters.len() + grass.len() < scene.mesh.triangles.len());
    let is_caster = |id: &u32| casters.binary_search(id).is_ok();
    let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
    for name in [
        "scene.casters",
        "scene.bvh_primitives",
        "scene.light_space_primitives",
    ] {
        let items = provider.describe(name).unwrap().items;
        assert_eq!(items, Some(casters.len() as u64), "{name}");
        let mut ids = contents(&gpu, &mut provider, name);
        if name == "scene.casters" {
            ids = ids.into_iter().skip(3).step_by(4).collect();
        }
        ids.sort_unstable();
        assert_eq!(ids, casters, "{name}");
    }
    // The lists of the light buffer: the second word of an entry is its caster.
    let names = ["entry_count", "entries"];
    let [count, entries] = read(&scene, "light_buffer", &[], &names)
        .try_into()
        .unwrap();
    let listed = entries.chunks_exact(4).take(count[0] as usize);
    let listed: Vec<u32> = listed.map(|entry| entry[1]).collect();
    let other = listed.iter().position(|id| !is_caster(id));
    assert_eq!(other, None, "of {} entries", listed.len());
    assert!(listed.len() > 10_000, "{} entries", listed.len());
    // The nearest primitive of each texel of a conservative map.
    let names = ["outer_primitive"];
    let [nearest] = read(&scene, "crsm_single", &[], &names).try_into().unwrap();
    let nearest = nearest.iter().filter(|id| **id != u32::MAX);
    assert!(nearest.clone().count() > 100_000 && nearest.clone().all(is_caster));
    // Without roles there is grass in all of them.
    let plain = load("park");
    let [nearest] = read(&plain, "crsm_single", &[], &names).try_into().unwrap();
    assert!(nearest.iter().any(|id| grass.contains(id)));
}

/// The same scene without its grass.
fn mown(scene: &Scene) -> Arc<Scene> {
    let mut mown = scene.clone();
    let grass = grass(&scene.mesh);
    let grass = grass.start as usize..grass.end as usize;
    let mesh = &mut mown.mesh;
    mesh.triangles.drain(grass.clone());
    mesh.normal_indices.drain(grass.clone());
    mesh.surfaces.of.drain(grass);
    mesh.groups.clear();
    mown.into()
}

/// Maps are those of the scene without what casts nothing, to the bit.
#[test]
fn maps_are_those_of_the_scene_without_its_grass() {
    let scene = with_roles("park", &[("flowers", Shadows::Receives)]);
    let [width, height] = VIEWPORT.map(|edge| edge as usize);
    let grass = grass(&scene.mesh);
    let own = |id: u32| match id {
        u32::MAX => id,
        id if id >= grass.end => id - grass.len() as u32,
        id => id,
    };
    let none = [("cull", word("none"))];
    let methods: [(&str, Params<'_>, &str); 6] = [
        ("nsm", &[], "shadow_maps"),
        ("nsm", &none, "shadow_maps"),
        ("pcf", &[], "shadow_maps"),
        ("hybrid_pcf", &[], "shadow_maps"),
        ("crsm", &[], "inner"),
        ("crsma", &[], "inner"),
    ];
    for (preset, params, map) in methods {
        let names = ["visibility", "primitive", map];
        let outputs = [&scene, &mown(&scene)].map(|scene| {
            let mut provider = provider(scene, scene.view("flowers_side").unwrap(), VIEWPORT);
            let path = format!("pipelines/{preset}.ron");
            let plan = plan(&path, &provider, VIEWPORT, |request| {
                request.captures = names[1..].iter().copied().map(Capture::new).collect();
                let params = params.iter();
                let params = params.map(|(name, value)| ((*name).to_owned(), value.clone()));
                request.params.extend(params);
            });
            let report = run_on(&open(), plan, &mut provider, &names);
            let primitives = values(&report, "primitive");
            (
                shares(&report, "visibility"),
                primitives,
                shares(&report, map),
            )
        });
        let [(with, seen, map), (without, below, bare)] = outputs;
        assert!(map == bare, "{preset} {params:?}");
        assert!(map.iter().any(|depth| *depth < 1.0));
        let same = (0..width * height).filter(|&pixel| own(seen[pixel]) == below[pixel]);
        let same: Vec<usize> = same.filter(|&at| !grass.contains(&seen[at])).collect();
        assert!(same.len() > 1000 && seen.iter().any(|id| grass.contains(id)));
        let differ = same.iter().filter(|&&pixel| with[pixel] != without[pixel]);
        assert_eq!(differ.count(), 0, "{preset} {params:?}");
    }
}

/// A word that is not said changes nothing: neither plans nor what they read.
#[test]
fn without_roles_no_list_is_read() {
    let (plain, roles) = (load("park"), park());
    for preset in [
        "rt",
        "light_buffer",
        "crsm",
        "nsm",
        "pcf",
        "vsm",
        "hybrid_pcf_area",
    ] {
        let path = format!("pipelines/{preset}.ron");
        let lists = [&plain, &roles].map(|scene| {
            let provider = provider(scene, &scene.views[0], VIEWPORT);
            let plan = plan(&path, &provider, VIEWPORT, |_| {});
            let lists =
                ["scene.casters", "scene.shadows"].map(|list| plan.provided().contains(&list));
            lists.into_iter().filter(|is_read| *is_read).count()
        });
        assert_eq!(lists[0], 0, "{preset}");
        assert_eq!(lists[1], if preset == "rt" { 1 } else { 2 }, "{preset}");
    }
}

#[test]
fn where_nothing_casts_everything_is_lit() {
    let position = DVec3::new(10.0, 60.0, 10.0);
    let lamps: [LightKind; 2] = [
        SpotLight {
            position,
            direction: -DVec3::Y,
            cone_degrees: 120.0,
            radius: 0.0,
        }
        .into(),
        PointLight {
            position,
            radius: 0.0,
        }
        .into(),
    ];
    let sun = load("park").light();
    for light in [sun, lamps[0], lamps[1]] {
        let mut scene = Scene::clone(&load("park"));
        scene.mesh.set_shadows(Shadows::Receives);
        scene.lights = vec![skiagraph_scene::Light::only(light)];
        let scene = Arc::new(scene);
        let mut bench = Bench::new(&scene, [64, 48]);
        let methods: [(&str, Params<'_>); 5] = [
            ("rt", &[]),
            ("rt", &[("engine", word("light_space"))]),
            ("light_buffer", &[]),
            ("crsm", &[]),
            ("nsm", &[]),
        ];
        for (preset, params) in methods {
            let is_lamp = light.directional().is_none();
            let is_point = matches!(light, LightKind::Point(_));
            if (is_lamp && !params.is_empty()) || (is_point && preset == "crsm") {
                continue;
            }
            let counts = bench.judge(preset, params);
            assert_eq!(
                (counts.wrong.total, counts.pixels.shadow),
                (0, 0),
                "{preset}"
            );
            assert!(counts.pixels.lit > 100, "{preset}: {counts:?}");
        }
    }
}

/// Squares of one mesh: a ground, a roof, a veil below the roof that casts nothing, and a sign that
/// receives nothing.
fn gltf() -> Arc<Scene> {
    let positions = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0f32]];
    let floats = positions.concat().into_iter().flat_map(f32::to_le_bytes);
    let indices = [0u16, 1, 2, 0, 2, 3].into_iter().flat_map(u16::to_le_bytes);
    hand_over("handed/roofs.bin", floats.chain(indices).collect());
    let node = |name: &str, at: [f32; 3], size: f32, extras: &str| {
        format!(
            r#"{{"name": "{name}", "mesh": 0, "translation": {at:?}, "scale": [{size}, {size}, 1],
            "rotation": [-0.70710678, 0, 0, 0.70710678] {extras}}}"#
        )
    };
    let nodes = [
        node("ground", [-8., 0., 8.], 16., ""),
        node("roof", [-2., 3., 2.], 4., ""),
        node("veil", [-6., 2., 5.], 4., r#", "extras": {"casts": false}"#),
        node(
            "sign",
            [-1., 1., 5.],
            3.,
            r#", "extras": {"receives": 0, "casts": true}"#,
        ),
    ];
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0, 1, 2, 3]}}], "nodes": [{}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
        "accessors": [
          {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0]}},
          {{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}},
          {{"buffer": 0, "byteOffset": 48, "byteLength": 12}}],
        "buffers": [{{"byteLength": 60, "uri": "roofs.bin"}}]}}"#,
        nodes.join(", ")
    );
    let parsed = parse_gltf(
        text.as_bytes(),
        Path::new("handed/roofs.gltf"),
        MaterialUse::All,
    );
    let (mesh, report) = parsed.unwrap();
    assert_eq!(report.remarks, [""; 0]);
    Arc::new(under_a_sun(mesh))
}

fn under_a_sun(mesh: Mesh) -> Scene {
    let eye = DVec3::new(3.0, 14.0, 16.0);
    let sun = DirectionalLight::new(DVec3::new(-0.3, -1.0, 0.2));
    Scene {
        name: "roles".into(),
        mesh,
        views: vec![View {
            eye,
            direction: -eye,
            fov_y_degrees: 50.0,
            far: 60.0,
            ..View::default()
        }],
        lights: vec![LightKind::from(sun).into()],
    }
}

#[test]
fn extras_of_gltf_nodes_are_followed() {
    let scene = gltf();
    assert_eq!(scene.mesh.casters(), [0, 1, 2, 3, 6, 7]);
    let roles = [0, 4, 6].map(|primitive| scene.mesh.surfaces.shadows(primitive));
    assert_eq!(roles, [Shadows::Both, Shadows::Receives, Shadows::Casts]);
    let mut bench = Bench::new(&scene, VIEWPORT);
    for (preset, cull) in [("rt", false), ("light_buffer", false), ("crsm", true)] {
        let none = [("cull", word("none"))];
        let answers = bench.answers(preset, if cull { &none } else { &[] });
        let (wrong, pixels) = (answers.counts.wrong, answers.counts.pixels);
        assert_eq!(wrong.total, wrong.in_band, "{preset}");
        assert!(pixels.shadow > 200 && unshadowed_are_lit(&answers) > 200);
        // The veil shows the roof's shadow.
        let seen = answers.truth.classes.iter().zip(&answers.primitives);
        let mut veil = seen.filter(|(_, primitive)| [4, 5].contains(*primitive));
        assert!(veil.any(|(class, _)| *class == Class::Shadow), "{preset}");
    }
}

/// Answers of a preset for parts, held against the oracle over the mesh as it is now.
fn parts_are_right(provider: &mut SceneProvider, scene: &Scene, preset: &str) -> Statistics {
    let (preset, engine) = preset.split_once(' ').unwrap_or((preset, ""));
    let path = format!("pipelines/{preset}.ron");
    let camera = scene.views[0].camera(VIEWPORT);
    provider.set_camera(&camera);
    let plan = graphs::plan(&path, provider, VIEWPORT, |request| {
        request.captures.push(Capture::new("primitive"));
        if !engine.is_empty() {
            request.params.insert("engine".into(), word(engine));
        }
    });
    let names = ["visibility", "status", "primitive"];
    let report = run_on(&open(), plan, provider, &names);
    let mesh = provider.scene().mesh.clone();
    let oracle = Oracle::new(&mesh);
    let truth = oracle.shade(
        &camera,
        scene.light(),
        &values(&report, "primitive"),
        OracleMode::Exact,
        Progress::default(),
    );
    let [visibility, status] = ["visibility", "status"].map(|name| values(&report, name));
    let counts = Statistics::judged(&visibility, &status, &truth.unwrap()).unwrap();
    assert_eq!(
        counts.wrong.total, counts.wrong.in_band,
        "{preset}: {counts:?}"
    );
    assert_eq!(counts.facing_mismatch, 0, "{preset}");
    counts
}

#[test]
fn parts_cast_and_receive_as_their_meshes_say_while_they_come_move_and_go() {
    let floor = meshes::box_over_floor(8.0, Vec3::splat(0.5));
    let stone = meshes::potato(3, 0.2, 1);
    let mut ghost = stone.clone();
    ghost.set_shadows(Shadows::Receives);
    let scene = under_a_sun(Mesh::default());
    let at = |x: f64, y: f64| DAffine3::from_translation(DVec3::new(x, y, 1.0));
    let parts = Movable::joined(&[&floor, &stone, &ghost, &ghost]);
    let mut provider = SceneProvider::from_parts(parts, scene.light());
    let mut maps = [
        DAffine3::IDENTITY,
        at(-3.0, 2.0),
        at(3.0, 2.0),
        at(-3.0, 0.0),
    ];
    let mut shadows = Vec::new();
    for turn in 0..3 {
        maps[2] = at(3.0 - f64::from(turn), 2.0);
        provider.set_transforms(&maps).unwrap();
        for preset in ["rt", "rt light_space", "light_buffer", "crsm"] {
            shadows.push(parts_are_right(&mut provider, &scene, preset).pixels.shadow);
        }
    }
    let casters = |provider: &SceneProvider| provider.describe("scene.casters").unwrap().items;
    let [solid, each] = [&floor, &stone].map(|mesh| mesh.triangles.len() as u64);
    assert_eq!(casters(&provider), Some(solid + each));
    // One of them goes: its triangles have no area, whatever they cast.
    let last = provider.parts().last().unwrap();
    provider.remove_part(last).unwrap();
    assert_eq!(casters(&provider), Some(solid + 2 * each));
    parts_are_right(&mut provider, &scene, "rt");
    // A stone that casts takes its place, and one that does not a new one.
    provider.add_part(&stone, &at(0.0, 3.0)).unwrap();
    let seen = parts_are_right(&mut provider, &scene, "rt").pixels.shadow;
    assert!(seen > shadows[0], "{seen} {shadows:?}");
    provider.add_part(&ghost, &at(0.0, 5.0)).unwrap();
    for preset in ["rt", "rt light_space", "light_buffer", "crsm"] {
        let counts = parts_are_right(&mut provider, &scene, preset);
        assert!(counts.pixels.shadow > 100, "{counts:?}");
    }
}

/// Ray queries meet casters alone; a suite of its own, as those of `ray_query`.
#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn by_ray_query_roles_agree_with_the_oracle() {
    let scene = park();
    let mut bench = Bench::new(&scene, VIEWPORT);
    let counts = bench.judge("rt", &[("engine", word("ray_query"))]);
    assert!(counts.wrong.total == counts.wrong.in_band && counts.pixels.shadow > 300);
}
