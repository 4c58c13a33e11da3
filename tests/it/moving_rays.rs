//! Parts that move under the device's own ray queries: each has a structure of its own, of the
//! positions that all passes read, so answers are those of a mesh that never moved.
//!
//! A suite for an adapter with `EXPERIMENTAL_RAY_QUERY`, as [`ray_query`](crate::ray_query) is.

use crate::{
    host_buffers,
    one_submission::{mesh, parts, places, sun, view},
    support::{
        bench::Bench,
        graphs::{self, RAY_QUERY, open, values},
        meshes,
    },
};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use skiagraph_gpu::{Executor, Frame, Provider, device::Gpu};
use skiagraph_graph::ParamValue;
use skiagraph_passes::{PartId, Room, SceneProvider, Work};
use skiagraph_scene::{DirectionalLight, Group, Light, Mesh, Movable, Scene, View};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [96, 64];
const COUNT: usize = 24;
const MOVING: usize = 5;
const TLAS: &str = "scene.tlas";

fn provider(parts: Movable, maps: &[DAffine3]) -> SceneProvider {
    let mut provider = SceneProvider::from_parts(parts, sun());
    provider.set_camera(&far_view().camera(VIEWPORT));
    provider.set_transforms(maps).unwrap();
    provider
}

fn far_view() -> View {
    View {
        eye: DVec3::new(7.0, 9.0, 20.0),
        direction: DVec3::new(0.0, -0.6, -1.0),
        ..view(0.0)
    }
}

fn rt(gpu: &Gpu, engine: &str, provider: &mut SceneProvider) -> Executor {
    assert!(
        gpu.device.features().contains(RAY_QUERY),
        "this adapter has no EXPERIMENTAL_RAY_QUERY, which this suite is about"
    );
    let plan = graphs::plan("pipelines/rt.ron", provider, VIEWPORT, |request| {
        graphs::allow_ray_queries(request);
        let engine = ParamValue::Choice(engine.to_owned());
        request.params.insert("engine".to_owned(), engine);
    });
    Executor::on(gpu, plan, provider).unwrap()
}

fn shown(gpu: &Gpu, executor: &mut Executor) -> Vec<u32> {
    values(&graphs::frame(gpu, executor, &["visibility"]), "visibility")
}

/// Shown by ray queries of a mesh that never moved.
fn of_mesh(gpu: &Gpu, mesh: Mesh) -> Vec<u32> {
    let mut alone = SceneProvider::from_mesh(mesh, sun());
    alone.set_camera(&far_view().camera(VIEWPORT));
    shown(gpu, &mut rt(gpu, "ray_query", &mut alone))
}

/// Shown by ray queries of the parts where they are, as one mesh.
fn at_rest(gpu: &Gpu, scene: &SceneProvider) -> Vec<u32> {
    of_mesh(gpu, scene.scene().mesh.clone())
}

fn alone(gpu: &Gpu, meshes: &[&Mesh], maps: &[DAffine3]) -> Vec<u32> {
    of_mesh(gpu, Movable::joined(meshes).moved(maps).unwrap())
}

fn stone() -> Mesh {
    meshes::potato(2, 0.2, 1)
}

/// A floor, and stones in rows above it.
fn rows() -> Vec<DAffine3> {
    let place = |index: usize| DVec3::new((index % 6) as f64, 0.0, (index / 6) as f64);
    let map = |index| DAffine3::from_translation(2.5 * place(index) + DVec3::Y);
    let floor = DAffine3::from_scale(DVec3::splat(3.0));
    std::iter::once(floor).chain((0..COUNT).map(map)).collect()
}

/// Turned, stretched, and every third time mirrored.
fn moved(rest: &DAffine3, turn: usize) -> DAffine3 {
    let angle = 0.37 * turn as f64;
    let turned = DQuat::from_axis_angle(DVec3::new(0.3, 1.0, 0.2).normalize(), angle);
    let mirror = if turn.is_multiple_of(3) { -1.0 } else { 1.0 };
    let scale = DVec3::new(mirror, 1.0 + 0.3 * angle.sin(), 0.8);
    let at = rest.translation + DVec3::new(angle.cos(), 0.5 + 0.5 * angle.sin(), 0.0);
    DAffine3::from_scale_rotation_translation(scale, turned, at)
}

fn work(
    provider: &mut SceneProvider,
    executor: &mut Executor,
    change: impl FnOnce(&mut SceneProvider),
) -> Work {
    let before = provider.work();
    change(provider);
    executor.refresh(provider).unwrap();
    provider.work().since(before)
}

#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn parts_that_move_are_traced_where_all_passes_see_them() {
    let gpu = open();
    let (floor, stone) = (meshes::box_over_floor(8.0, Vec3::splat(0.5)), stone());
    let mut meshes = vec![&floor];
    meshes.extend(vec![&stone; COUNT]);
    let mut maps = rows();
    let mut scene = provider(Movable::joined(&meshes), &maps);
    let mut executors = ["ray_query", "hierarchy"].map(|engine| rt(&gpu, engine, &mut scene));
    let (mut differing, mut indeterminate, mut pixels) = (0, 0, 0);
    for turn in 0..12 {
        for step in 0..MOVING {
            let part = 1 + (7 * turn + step * step) % COUNT;
            maps[part] = moved(&rows()[part], turn + step);
        }
        let new_maps: Vec<DAffine3> = maps.clone();
        let [by_device, by_us] = &mut executors;
        let work = work(&mut scene, by_device, |scene| {
            scene.set_transforms(&new_maps).unwrap();
        });
        let most = MOVING * stone.triangles.len();
        assert!(
            work.triangles > 0 && work.triangles <= most as u64,
            "{work:?}"
        );
        by_us.refresh(&mut scene).unwrap();
        let [theirs, ours] = [shown(&gpu, by_device), shown(&gpu, by_us)];
        let at_rest = Arc::new(Scene {
            name: "moving parts".to_owned(),
            mesh: scene.scene().mesh.clone(),
            views: vec![far_view()],
            lights: vec![Light::only(sun())],
        });
        let engine = ParamValue::Choice("ray_query".to_owned());
        let mut bench = Bench::new(&at_rest, VIEWPORT);
        let whole = bench.answers("rt", &[("engine", engine)]);
        assert!(theirs == whole.visibility, "{turn}: others than at rest");
        let wrong = whole.counts.wrong;
        assert_eq!(wrong.total - wrong.in_band, 0, "{turn}: {:?}", whole.counts);
        let counts = whole.counts.pixels;
        assert!(counts.shadow > 100 && counts.lit > 500, "{counts:?}");
        let differences = theirs.iter().zip(&ours).filter(|(a, b)| a != b);
        differing += differences.count();
        let flags = whole.truth.indeterminate.iter();
        indeterminate += flags.filter(|flag| **flag).count();
        pixels += theirs.len();
    }
    println!(
        "{differing} of {pixels} pixels differ from `hierarchy`, {indeterminate} are indeterminate"
    );
    assert!(differing <= indeterminate);
}

#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn structures_are_built_of_what_moved_and_made_compact_once() {
    let gpu = open();
    let stone = stone();
    let triangles = stone.triangles.len() as u64;
    let mut maps = rows();
    let mut scene = provider(Movable::joined(&[&stone; COUNT + 1]), &maps);
    let mut executor = rt(&gpu, "ray_query", &mut scene);
    assert_eq!(scene.work().triangles, (COUNT as u64 + 1) * triangles);
    let times = |scene: &SceneProvider| {
        let built = scene.built().iter().find(|built| built.name == TLAS);
        built.map(|built| built.times)
    };
    assert_eq!(times(&scene), Some(1));
    let first = shown(&gpu, &mut executor);
    // The device has told the sizes by now: the same structure in less memory, once.
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .unwrap();
    let versions: Vec<u64> = (0..3)
        .map(|_| {
            let work = work(&mut scene, &mut executor, |_| {});
            assert_eq!(work, Work::default());
            assert!(shown(&gpu, &mut executor) == first);
            scene.version(TLAS)
        })
        .collect();
    assert!(
        versions.iter().all(|version| *version == versions[0]),
        "{versions:?}"
    );
    assert_eq!(times(&scene), Some(2));
    for moving in [1, 5] {
        for map in &mut maps[..moving] {
            map.translation.y += 0.25;
        }
        let work = work(&mut scene, &mut executor, |scene| {
            scene.set_transforms(&maps).unwrap();
        });
        assert_eq!(work.triangles, moving as u64 * triangles);
        // Nothing moves, and what has moved is not compact: no structure more.
        shown(&gpu, &mut executor);
        let times_before = times(&scene);
        assert_eq!(
            self::work(&mut scene, &mut executor, |_| {}),
            Work::default()
        );
        assert_eq!(times(&scene), times_before);
    }
    // A sun that moves has no part in them.
    let work = work(&mut scene, &mut executor, |scene| {
        scene.set_light(DirectionalLight::new(DVec3::new(0.3, -1.0, 0.1)).into());
    });
    assert_eq!(work.triangles, 0);
}

#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn parts_come_and_go_under_ray_queries() {
    let gpu = open();
    let (floor, stone) = (meshes::box_over_floor(8.0, Vec3::splat(0.5)), stone());
    let mut there = vec![&floor, &stone, &stone];
    let mut maps = rows()[..3].to_vec();
    let mut scene = SceneProvider::from_parts(Movable::joined(&there), sun());
    scene.set_camera(&far_view().camera(VIEWPORT));
    let room = Room::of_copies(&stone, 2);
    scene.reserve(room, &gpu.device.limits()).unwrap();
    scene.set_transforms(&maps).unwrap();
    let mut handles: Vec<PartId> = scene.parts().collect();
    let mut executor = rt(&gpu, "ray_query", &mut scene);
    let triangles = stone.triangles.len() as u64;
    for turn in 0..4 {
        let added = moved(&rows()[4 + turn], turn);
        let work = work(&mut scene, &mut executor, |scene| {
            handles.push(scene.add_part(&stone, &added).unwrap());
        });
        assert_eq!(work.triangles, triangles, "{turn}: one is added");
        there.push(&stone);
        maps.push(added);
        assert!(
            shown(&gpu, &mut executor) == alone(&gpu, &there, &maps),
            "{turn}"
        );
        let work = self::work(&mut scene, &mut executor, |scene| {
            scene.remove_part(handles.remove(1)).unwrap();
        });
        assert_eq!(work.triangles, 0, "{turn}: one is removed");
        there.remove(1);
        maps.remove(1);
        let seen = shown(&gpu, &mut executor);
        assert!(seen == alone(&gpu, &there, &maps), "{turn}");
        assert!(seen.contains(&0) && seen.contains(&1));
    }
}

/// Parts whose triangles lie among those of others share a structure, which is built as a whole.
#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn parts_among_the_triangles_of_others_are_one_structure() {
    let gpu = open();
    let (floor, stone) = (meshes::box_over_floor(8.0, Vec3::splat(0.5)), stone());
    let meshes = [&floor, &stone, &stone, &stone];
    let mut whole = Movable::joined(&meshes).moved(&rows()[..4]).unwrap();
    let first = floor.triangles.len();
    let count = stone.triangles.len();
    for step in (1..count).step_by(2) {
        whole.triangles.swap(first + step, first + count + step);
        whole
            .normal_indices
            .swap(first + step, first + count + step);
    }
    whole.groups.clear();
    for at in first..first + 3 * count {
        let name = match (at - first) / count {
            2 => "third",
            stone if stone == (at - first) % count % 2 => "first",
            _ => "second",
        };
        whole.groups.push(Group {
            name: name.to_owned(),
            triangles: at as u32..at as u32 + 1,
        });
    }
    let cut = Movable::new(&whole, &["first", "second", "third"]).unwrap();
    let mut scene = SceneProvider::from_parts(cut, sun());
    scene.set_camera(&far_view().camera(VIEWPORT));
    let mut executor = rt(&gpu, "ray_query", &mut scene);
    let up = DAffine3::from_translation(0.5 * DVec3::Y);
    let handles: Vec<PartId> = scene.parts().collect();
    let triangles = first + 2 * count;
    for (part, most) in [(0, triangles), (1, triangles), (2, count)] {
        let work = work(&mut scene, &mut executor, |scene| {
            scene.set_transform(handles[part], &up).unwrap();
        });
        assert!(
            (1..=most as u64).contains(&work.triangles),
            "{part}: {work:?}"
        );
        assert!(
            shown(&gpu, &mut executor) == at_rest(&gpu, &scene),
            "{part}"
        );
    }
    let before = shown(&gpu, &mut executor);
    scene.remove_part(handles[0]).unwrap();
    executor.refresh(&mut scene).unwrap();
    let seen = shown(&gpu, &mut executor);
    assert!(seen == at_rest(&gpu, &scene) && seen != before);
}

/// A frame that is encoded shows the parts where they were then, whatever moves before it is
/// submitted.
#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn frames_of_one_submission_have_structures_of_their_own() {
    let gpu = open();
    let parts = parts();
    let mut scene = provider(parts.clone(), &places(0.0));
    let times = [0.0, 0.5, 1.0];
    let mut executors = times.map(|_| rt(&gpu, "ray_query", &mut scene));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for (executor, time) in executors.iter_mut().zip(times) {
        scene.set_transforms(&places(time)).unwrap();
        executor.refresh(&mut scene).unwrap();
        let frame = Frame::new().with_read(&["visibility"]);
        executor.encode(&mut encoder, &frame).unwrap();
    }
    gpu.queue.submit([encoder.finish()]);
    let seen = executors.map(|mut executor| values(&executor.finish().unwrap(), "visibility"));
    for (seen, time) in seen.iter().zip(times) {
        assert!(*seen == of_mesh(&gpu, mesh(&parts, time)), "{time}");
    }
    assert!(seen[0] != seen[1] && seen[1] != seen[2]);
}

#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn parts_of_a_hosts_buffer_are_traced_as_uploaded_ones() {
    let gpu = open();
    let stones = host_buffers::stones(&gpu);
    let places = host_buffers::places;
    let mut scenes = host_buffers::scenes(&stones, &places(0), &gpu.device.limits());
    let mut executors = scenes.each_mut().map(|scene| rt(&gpu, "ray_query", scene));
    for turn in 0..4 {
        let seen = [0, 1].map(|at| {
            let (scene, executor) = (&mut scenes[at], &mut executors[at]);
            let maps = host_buffers::places_of(&places(turn));
            scene.set_transforms(&maps).unwrap();
            executor.refresh(scene).unwrap();
            shown(&gpu, executor)
        });
        assert!(seen[0].contains(&0) && seen[0].contains(&1), "{turn}");
        assert!(seen[0] == seen[1], "{turn}");
    }
}
