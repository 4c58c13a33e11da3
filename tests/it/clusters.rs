//! Clusters of casters: what is left out as a whole is in no list.

use crate::support::{
    graphs::{layered, open, plan, plan_with, provider, run_on, values},
    meshes::{joined, mesh, soup},
    random::Random,
    scenes::load,
};
use glam::{DVec3, Vec3};
use skiagraph_graph::{Capture, ParamValue, Sources as _};
use skiagraph_passes::EmbeddedSources;
use skiagraph_scene::{DirectionalLight, LightKind, Mesh, PointLight, Scene, SpotLight, View};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [64, 48];

/// Clusters of 64 triangles each over a floor, from specks to some that are as wide as all of it.
fn clustered(random: &mut Random, far: Vec3) -> Mesh {
    let floor = [(-9.0, 9.0), (9.0, 9.0), (9.0, -9.0), (-9.0, -9.0)];
    let floor = floor.map(|(x, z)| far + Vec3::new(x, -2.0, z));
    let mut scene = mesh(floor.to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    for seed in 0..60 {
        let size = 6.0 * random.unit().powi(4);
        let place = far + 8.0 * random.vector() * Vec3::new(1.0, 0.5, 1.0);
        let mut part = soup(64, 0.2 + random.unit(), seed);
        for position in &mut part.positions {
            *position = place + *position * size;
        }
        scene = joined(scene, &part);
    }
    scene
}

fn scene(random: &mut Random, far: Vec3, light: LightKind) -> Arc<Scene> {
    let eye = far.as_dvec3() + DVec3::new(4.0 * f64::from(random.signed()), 6.0, 7.0);
    let view = View {
        eye,
        direction: far.as_dvec3() - eye,
        fov_y_degrees: 6.0 + 24.0 * f64::from(random.unit()),
        ..View::default()
    };
    Arc::new(Scene {
        name: "clusters".into(),
        mesh: clustered(random, far),
        views: vec![view],
        lights: vec![skiagraph_scene::Light {
            name: "light".into(),
            kind: light,
        }],
    })
}

/// Casters in the list of each texel, and clusters that are live in the last layer. Covers list by
/// chance what lies behind them, and receivers without a list take the lists' place: there are
/// none of either.
fn listed(scene: &Arc<Scene>, preset: &str, fit: &str, culls: bool) -> (Vec<u32>, u32) {
    let text = |path: &str| EmbeddedSources.read(path).unwrap().unwrap().to_string();
    let bin = "shaders/shared/bin_texels.wgsl";
    let choose = "shaders/choose_lists.wgsl";
    let cull = "shaders/cull_clusters.wgsl";
    let changed = [
        (bin, text(bin).replace("has_covers && covers", "false")),
        (
            choose,
            text(choose).replace("if lists >", "if false && lists >"),
        ),
        (
            cull,
            text(cull).replace("is_live(cluster_boxes[cluster])", "true"),
        ),
    ];
    for (path, changed) in &changed {
        assert!(*changed != text(path), "{path}");
    }
    let files: Vec<(&str, &str)> = changed[..if culls { 2 } else { 3 }]
        .iter()
        .map(|(path, text)| (*path, text.as_str()))
        .collect();
    let mut provider = provider(scene, &scene.views[0], VIEWPORT);
    let path = format!("pipelines/{preset}.ron");
    let plan = plan_with(&layered(&files), &path, &provider, VIEWPORT, |request| {
        let fit = ParamValue::Choice(fit.to_owned());
        request.params.insert("fit".to_owned(), fit);
        let rays = ParamValue::Choice("rays".to_owned());
        request.params.insert("unlisted".to_owned(), rays);
        let captured = ["texels", "live_clusters"].map(Capture::new);
        request.captures.extend(captured);
    });
    let report = run_on(&open(), plan, &mut provider, &["texels", "live_clusters"]);
    let texels = values(&report, "texels");
    let lengths = texels.chunks(4).map(|texel| texel[1]).collect();
    (lengths, values(&report, "live_clusters")[3])
}

#[test]
fn clusters_that_are_left_out_are_in_no_list() {
    let mut random = Random(5);
    let (mut left_out, mut with_lists) = ([0; 3], 0);
    for round in 0..9 {
        let far = if round % 4 == 3 {
            Vec3::new(3e4, -2e4, 5e3)
        } else {
            Vec3::ZERO
        };
        let position = (far + 5.0 * random.vector() + 3.0 * Vec3::Y).as_dvec3();
        let radius = 0.3 * f64::from(random.unit());
        let kind = match round % 3 {
            0 => {
                let direction = random.vector() - 1.2 * Vec3::Y;
                let mut light = DirectionalLight::new(direction.as_dvec3());
                light.angle_degrees = 6.0 * f64::from(random.unit());
                light.into()
            }
            1 => LightKind::Spot(SpotLight {
                position,
                direction: far.as_dvec3() - position,
                cone_degrees: 20.0 + 100.0 * f64::from(random.unit()),
                radius,
            }),
            _ => LightKind::Point(PointLight { position, radius }),
        };
        let scene = scene(&mut random, far, kind);
        let fits = ["receivers", "camera", "pssm"];
        let fit = fits[(round / 3) % if round % 3 == 0 { 3 } else { 1 }];
        for preset in ["light_buffer", "light_buffer_area"] {
            let (lengths, live) = listed(&scene, preset, fit, true);
            let (expected, clusters) = listed(&scene, preset, fit, false);
            println!("{round}, {preset}, {fit}: {live} of {clusters} clusters");
            with_lists += usize::from(expected.iter().any(|length| *length != 0));
            let differ = lengths
                .iter()
                .zip(&expected)
                .filter(|(a, b)| a != b)
                .count();
            assert_eq!(differ, 0, "{round}, {preset}, {fit}");
            left_out[round % 3] += clusters - live;
        }
    }
    assert!(with_lists >= 14, "{with_lists} of 18 have lists");
    assert!(left_out.iter().all(|count| *count >= 30), "{left_out:?}");
}

/// Where all lists lack entries, receivers are pending in at most as many tiles as have any in
/// lists, and their clusters are among those of the lists.
#[test]
fn pending_receivers_have_few_clusters() {
    let mut random = Random(5);
    let light = DirectionalLight::new(DVec3::new(0.3, -1.0, 0.2)).into();
    let scene = scene(&mut random, Vec3::ZERO, light);
    let clusters = |preset: &str, entries: u32, captured: Capture| {
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let path = format!("pipelines/{preset}.ron");
        let plan = plan(&path, &provider, VIEWPORT, |request| {
            let entries = ParamValue::U32(entries);
            request.params.insert("max_entries".to_owned(), entries);
            request.captures.push(captured.clone());
        });
        let name = captured.name();
        values(&run_on(&open(), plan, &mut provider, &[&name]), &name)
    };
    for (preset, turn) in [
        ("light_buffer", "pending_turn"),
        ("light_buffer_area", "pending_turn[0]"),
    ] {
        // Read before they are emptied for the next layer.
        let bin = format!("pending_receivers.{turn}.pending_layer[0].bin");
        let boxes = clusters(preset, 1 << 20, Capture::new("cluster_boxes")).len() as u32 / 8;
        let of_lists = clusters(preset, 1 << 20, Capture::new("live_clusters"))[3];
        let of_pending = Capture::new("live_groups").with_after(bin);
        let of_pending = clusters(preset, 1, of_pending)[0];
        println!("{preset}: {of_pending}, {of_lists} of {boxes} clusters");
        assert!(0 < of_pending && of_pending <= of_lists && of_lists < boxes);
    }
}

/// Boxes hold all corners but those of a host's that are no places.
#[test]
fn boxes_of_clusters_are_around_all_corners_that_are_places() {
    let mut random = Random(11);
    let light = DirectionalLight::new(DVec3::new(0.3, -1.0, 0.2)).into();
    let scene = scene(&mut random, Vec3::ZERO, light);
    let path = "shaders/shared/geometry.wgsl";
    let geometry = EmbeddedSources.read(path).unwrap().unwrap().to_string();
    // NaN, then infinity.
    let broken = geometry.replace(
        "    return scene_positions",
        "    if corner % 97u < 2u {
             return vec3(1.0, bitcast<f32>(0x7fc00000u - (corner % 97u) * 0x400000u), 1.0);
         }
         return scene_positions",
    );
    assert!(broken != geometry);
    let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
    let files = layered(&[(path, &broken)]);
    let preset = "pipelines/light_buffer.ron";
    let plan = plan_with(&files, preset, &provider, VIEWPORT, |request| {
        request.captures.push(Capture::new("cluster_boxes"));
    });
    let report = run_on(&open(), plan, &mut provider, &["cluster_boxes"]);
    let boxes = values(&report, "cluster_boxes");
    let corners: Vec<u32> = scene.mesh.triangles.iter().flatten().copied().collect();
    assert_eq!(boxes.len(), 8 * corners.len().div_ceil(192));
    for (cluster, (words, corners)) in boxes.chunks(8).zip(corners.chunks(192)).enumerate() {
        let first = 192 * cluster;
        let places = corners.iter().enumerate();
        let places = places.filter(|(at, _)| (first + at) % 97 >= 2);
        let ends = places.map(|(_, corner)| [scene.mesh.positions[*corner as usize]; 2]);
        let ends = ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let place = |at: usize| Vec3::from_array([0, 1, 2].map(|i| f32::from_bits(words[at + i])));
        assert_eq!(Some([place(0), place(4)]), ends, "{cluster}");
    }
}

/// The share of clusters that are live, in percent, in views of 512² pixels.
fn assert_clusters_leave(expected: &[(&str, &str, f64)]) {
    for &(name, view, expected) in expected {
        let scene = load(name);
        let view = scene.views.iter().find(|one| one.name == view).unwrap();
        let viewport = [512, 512];
        let mut provider = provider(&scene, view, viewport);
        let path = "pipelines/light_buffer.ron";
        let plan = plan(path, &provider, viewport, |request| {
            request.captures.push(Capture::new("live_clusters"));
        });
        let report = run_on(&open(), plan, &mut provider, &["live_clusters"]);
        let live = values(&report, "live_clusters");
        let share = 100.0 * f64::from(live[3]) / (live.len() - 4) as f64;
        println!("{name}, {}: {share:.2} % of the clusters", view.name);
        assert!((0.9..1.1).contains(&(share / expected)), "{name}: {share}");
    }
}

/// As docs/light_buffer.md has it.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn clusters_leave_few_triangles_of_a_million() {
    assert_clusters_leave(&[
        ("city:1000000", "overview", 47.6),
        ("city:1000000", "street", 5.7),
        ("forest:1000000", "overview", 59.8),
    ]);
}

#[test]
#[ignore = "takes minutes: `.ci/long` runs it"]
fn ci_long_clusters_leave_few_triangles_of_ten_million() {
    assert_clusters_leave(&[
        ("city:10000000", "overview", 35.0),
        ("city:10000000", "street", 3.5),
        ("forest:10000000", "overview", 60.0),
    ]);
}
