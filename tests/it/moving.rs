//! Parts that a host moves: in which order it says so, what costs nothing, and what is refused.

use crate::{
    shadows::Shadows,
    support::{
        graphs::{self, open, values},
        meshes,
    },
};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use skiagraph_gpu::{ExecuteError, Executor, Frame, Provider, device::Gpu};
use skiagraph_passes::{Error, How, PartId, PartMesh, Room, SceneProvider, Work};
use skiagraph_reference::statistics::status;
use skiagraph_scene::{
    DirectionalLight, Group, LightKind, Mesh, Movable, MoveError, PointLight, View,
    texels::Texels,
    texture::{Source, Texture, Wrap},
};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [48, 32];
const PRESETS: [&str; 3] = ["light_buffer", "rt", "nsm"];

fn sun() -> DirectionalLight {
    DirectionalLight::new(DVec3::new(0.4, -1.0, -0.3))
}

/// So many stones, each around the origin of its own space.
fn stones(count: usize) -> Movable {
    let stone = meshes::potato(2, 0.2, 1);
    Movable::joined(&vec![&stone; count])
}

/// In rows on the ground.
fn rows(count: usize) -> Vec<DAffine3> {
    let place = |index: usize| DVec3::new((index % 6) as f64, 0.0, (index / 6) as f64);
    let map = |index| DAffine3::from_translation(3.0 * place(index));
    (0..count).map(map).collect()
}

fn view() -> View {
    View {
        name: String::new(),
        eye: DVec3::new(7.0, 9.0, 24.0),
        direction: DVec3::new(0.0, -0.5, -1.0),
        fov_y_degrees: 50.0,
        far: 60.0,
        ..View::default()
    }
}

fn provider(parts: Movable) -> SceneProvider {
    let mut provider = SceneProvider::from_parts(parts, sun());
    provider.set_camera(&view().camera(VIEWPORT));
    provider
}

fn start(gpu: &Gpu, preset: &str, provider: &mut SceneProvider) -> Executor {
    let path = format!("pipelines/{preset}.ron");
    let plan = graphs::plan(&path, provider, VIEWPORT, |_| {});
    Executor::on(gpu, plan, provider).unwrap()
}

fn shown(gpu: &Gpu, executor: &mut Executor) -> Vec<u32> {
    values(&graphs::frame(gpu, executor, &["visibility"]), "visibility")
}

/// Returns the resources that were made: names, how, how often.
fn made(provider: &SceneProvider) -> Vec<(&'static str, How, u32)> {
    let built = provider.built().iter();
    let mut made: Vec<_> = built.map(|it| (it.name, it.how, it.times)).collect();
    made.sort_unstable_by_key(|made| made.0);
    made
}

#[test]
fn an_executor_may_be_made_before_the_parts_have_places() {
    let (gpu, count) = (open(), 30);
    for preset in PRESETS {
        let mut before = provider(stones(count));
        let mut executor = start(&gpu, preset, &mut before);
        let of_places = [
            "scene.positions",
            "scene.normals",
            "scene.bvh_nodes",
            "light",
        ];
        let early = made(&before);
        assert!(
            early.iter().all(|(name, ..)| !of_places.contains(name)),
            "{preset}: over parts that lie on each other: {early:?}"
        );
        // Nothing is shown that is not there.
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let error = executor
            .encode(&mut encoder, &Frame::default())
            .unwrap_err();
        assert!(matches!(error, ExecuteError::NotProvided { .. }), "{error}");
        assert!(
            error
                .to_string()
                .contains("`SceneProvider::set_transforms`"),
            "{error}"
        );

        before.set_transforms(&rows(count)).unwrap();
        executor.refresh(&mut before).unwrap();
        let mut after = provider(stones(count));
        after.set_transforms(&rows(count)).unwrap();
        let mut made_after = start(&gpu, preset, &mut after);
        let (seen, expected) = (shown(&gpu, &mut executor), shown(&gpu, &mut made_after));
        assert!(expected.contains(&0) && expected.contains(&1), "{preset}");
        assert!(seen == expected, "{preset}");
        assert_eq!(made(&before), made(&after), "{preset}");
    }
}

#[test]
fn parts_that_stand_still_cost_nothing() {
    let (gpu, count) = (open(), 12);
    for preset in PRESETS {
        let mut provider = provider(stones(count));
        let mut maps = rows(count);
        provider.set_transforms(&maps).unwrap();
        let mut executor = start(&gpu, preset, &mut provider);
        let first = made(&provider);
        let expected = shown(&gpu, &mut executor);
        for _ in 0..3 {
            provider.set_transforms(&maps).unwrap();
            let mesh = provider.scene().mesh.clone();
            executor.refresh(&mut provider).unwrap();
            assert!(shown(&gpu, &mut executor) == expected, "{preset}");
            provider.deform(mesh.positions, mesh.normals).unwrap();
            executor.refresh(&mut provider).unwrap();
        }
        assert_eq!(made(&provider), first, "{preset}");
        for map in &mut maps[1..] {
            map.translation.y += 2.0;
        }
        provider.set_transforms(&maps).unwrap();
        executor.refresh(&mut provider).unwrap();
        assert_ne!(made(&provider), first, "{preset}");
        let mut anew = self::provider(stones(count));
        anew.set_transforms(&maps).unwrap();
        let moved = shown(&gpu, &mut start(&gpu, preset, &mut anew));
        assert!(shown(&gpu, &mut executor) == moved, "{preset}");
        let changed = moved.iter().zip(&expected).filter(|(a, b)| a != b).count();
        assert!(changed > 0, "{preset}");
    }
}

/// A host that begins with all parts in one place has no worse a tree later: that of each part is
/// its own, and the level above them is made of where they are.
#[test]
fn the_trees_of_parts_that_lay_on_each_other_are_only_fitted() {
    let (gpu, count) = (open(), 30);
    let mut provider = provider(stones(count));
    provider
        .set_transforms(&vec![DAffine3::IDENTITY; count])
        .unwrap();
    let mut executor = start(&gpu, "rt", &mut provider);
    let tree = |provider: &SceneProvider| {
        let made = made(provider);
        let tree = made.iter().find(|made| made.0 == "scene.bvh_nodes");
        tree.map(|(_, how, times)| (*how, *times))
    };
    assert_eq!(tree(&provider), Some((How::Made, 1)));
    provider.set_transforms(&rows(count)).unwrap();
    executor.refresh(&mut provider).unwrap();
    assert_eq!(tree(&provider), Some((How::Refitted, 2)));
    let mut apart = self::provider(stones(count));
    apart.set_transforms(&rows(count)).unwrap();
    let mut made_apart = start(&gpu, "rt", &mut apart);
    assert!(shown(&gpu, &mut executor) == shown(&gpu, &mut made_apart));
    let nodes = |provider: &mut SceneProvider| {
        let buffer = provider.build("scene.bvh_nodes", &gpu.device, &gpu.queue);
        provider.submit_built(&gpu.device, &gpu.queue).unwrap();
        graphs::buffer_bytes(&gpu, &buffer.unwrap())
    };
    assert!(nodes(&mut provider) == nodes(&mut apart));
}

/// Work that a change is for the provider and an executor of it.
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
fn the_work_follows_the_parts_that_move() {
    let (gpu, count) = (open(), 100);
    let stone = meshes::potato(2, 0.2, 1);
    let [positions, normals] = [stone.positions.len(), 3 * stone.triangles.len()];
    for preset in PRESETS {
        let mut provider = provider(stones(count));
        let mut maps = rows(count);
        provider.set_transforms(&maps).unwrap();
        let mut executor = start(&gpu, preset, &mut provider);
        for moving in [0, 1, 5, 10] {
            for map in &mut maps[..moving] {
                map.translation.y += 0.25;
            }
            let work = work(&mut provider, &mut executor, |provider| {
                provider.set_transforms(&maps).unwrap();
            });
            if moving == 0 {
                assert_eq!(work, Work::default(), "{preset}");
                continue;
            }
            let moved = (moving * positions) as u64;
            assert_eq!(work.moved, moved, "{preset}");
            // Those that may be on its border, for the box, and for the outline where that may
            // reach that of the scene.
            assert!(
                work.laid > 0 && work.laid <= 2 * moved,
                "{preset}: {work:?}"
            );
            // Items of 16 bytes, and a little of the light. Ranges near each other are one.
            let corners = 16 * (moving * (positions + normals)) as u64;
            let top = 2 * count as u64 - 1;
            let nodes = work.nodes;
            let has_tree = made(&provider)
                .iter()
                .any(|made| made.0 == "scene.bvh_nodes");
            assert_eq!(nodes > top, has_tree, "{preset}: {work:?}");
            assert!(nodes < top + 4 * moved, "{preset}: {work:?}");
            let most = corners + 32 * nodes + 4096 + 144;
            let least = 16 * moved + 32 * nodes.saturating_sub(moving as u64);
            let is_so = (least..=most).contains(&work.uploaded);
            assert!(is_so, "{preset}, {moving}: {work:?}, {least} to {most}");
        }
        // A light that moves is laid around what may be on the border, and moves nothing.
        let light = DirectionalLight::new(DVec3::new(0.5, -1.0, -0.2));
        let work = work(&mut provider, &mut executor, |provider| {
            provider.set_light(light.into());
        });
        assert_eq!([work.moved, work.nodes, work.copied], [0; 3], "{preset}");
        assert!(
            work.laid > 0 && work.laid < (count * positions) as u64,
            "{preset}"
        );
        assert_eq!(work.uploaded, 144, "{preset}");
    }
}

/// A mesh that is deformed has only the list uploaded that has others, and is shown with both.
#[test]
fn of_positions_and_normals_those_that_stay_are_not_uploaded_again() {
    let (gpu, count) = (open(), 6);
    let rest = stones(count).moved(&rows(count)).unwrap();
    let parts = Movable::new(&rest, &[]).unwrap();
    for mut provider in [
        SceneProvider::from_mesh(rest.clone(), sun()),
        SceneProvider::from_parts(parts, sun()),
    ] {
        provider.set_camera(&view().camera(VIEWPORT));
        let mut executor = start(&gpu, "light_buffer", &mut provider);
        let shifted: Vec<Vec3> = rest.positions.iter().map(|at| *at + Vec3::Y).collect();
        let turned: Vec<Vec3> = rest.normals.iter().map(|normal| -*normal).collect();
        let [places, directions] = [&shifted, &turned].map(|list| 16 * list.len() as u64);
        let changes = [
            (&shifted, &turned, places + directions),
            (&rest.positions, &turned, places),
            (&rest.positions, &rest.normals, directions),
        ];
        for (positions, normals, expected) in changes {
            let work = work(&mut provider, &mut executor, |provider| {
                provider.deform(positions.clone(), normals.clone()).unwrap();
            });
            // And the light's.
            assert_eq!(work.uploaded, expected + 144);
            let mut mesh = rest.clone();
            (mesh.positions, mesh.normals) = (positions.clone(), normals.clone());
            let mut apart = SceneProvider::from_mesh(mesh, sun());
            apart.set_camera(&view().camera(VIEWPORT));
            let mut anew = start(&gpu, "light_buffer", &mut apart);
            assert_eq!(shown(&gpu, &mut executor), shown(&gpu, &mut anew));
        }
    }
}

/// The program of docs/embedding.md says in each frame where all of the scene is; that is the same
/// work as to move the parts one by one that are elsewhere.
#[test]
fn the_program_of_the_document_pays_for_what_moves() {
    let (gpu, count) = (open(), 100);
    let stone = meshes::potato(2, 0.2, 1);
    let copies = vec![&stone; count];
    let mut program = Shadows::new((&gpu.device, &gpu.queue), VIEWPORT, &copies).unwrap();
    let (camera, mut maps) = (view().camera(VIEWPORT), rows(count));
    let mut light = DirectionalLight::new(DVec3::NEG_Y);
    let mut by_hand = SceneProvider::from_parts(stones(count), light);
    by_hand.set_camera(&camera);
    by_hand.set_transforms(&maps).unwrap();
    let mut executor = start(&gpu, "light_buffer", &mut by_hand);
    let parts: Vec<PartId> = by_hand.parts().collect();
    let mut frame = |maps: &[DAffine3], light: DirectionalLight| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let before = program.provider.work();
        let seen = program.frame(&mut encoder, &camera, light.direction, maps);
        seen.unwrap();
        gpu.queue.submit([encoder.finish()]);
        program.provider.work().since(before)
    };
    frame(&maps, light);
    for (moving, turned) in [(0, 0.0), (1, 0.0), (5, 0.0), (5, 0.1), (0, 0.1)] {
        for map in &mut maps[..moving] {
            map.translation.y += 0.25;
        }
        light.direction.x += turned;
        let least = work(&mut by_hand, &mut executor, |provider| {
            provider.set_light(light.into());
            for (part, map) in parts.iter().zip(&maps[..moving]) {
                provider.set_transform(*part, map).unwrap();
            }
        });
        // In the frame's encoder parts are written where they are.
        let mut in_place = least;
        in_place.copied = 0;
        assert_eq!(frame(&maps, light), in_place, "{moving}, {turned}");
        assert_eq!(least == Work::default(), moving == 0 && turned == 0.0);
    }
}

/// Five of many parts move in each of so many frames. The exact presets answer alike in each, and
/// in every one of some as over a mesh that never moved; no frame is more than three times the work
/// of the median one.
fn exact_frames(count: usize, frames: usize, compared: usize) {
    let gpu = open();
    let parts = stones(count);
    let presets = ["rt", "light_buffer", "crsm"];
    let mut scene = provider(parts.clone());
    scene.set_transforms(&rows(count)).unwrap();
    let mut executors = presets.map(|preset| start(&gpu, preset, &mut scene));
    let mut works = Vec::new();
    let mut maps = rows(count);
    for turn in 0..frames {
        for index in 0..5 {
            let part = (7 * turn + index * index) % count;
            let angle = 0.3 * (turn + index) as f64;
            let map = DAffine3::from_rotation_z(angle) * DAffine3::from_rotation_y(angle);
            maps[part] = DAffine3::from_translation(maps[part].translation) * map;
            maps[part].translation.y = (3.0 * angle).sin();
        }
        let before = scene.work();
        scene.set_transforms(&maps).unwrap();
        for executor in &mut executors {
            executor.refresh(&mut scene).unwrap();
        }
        works.push(scene.work().since(before));
        let [rt, light_buffer, crsm] = &mut executors;
        let rays = shown(&gpu, rt);
        assert!(shown(&gpu, light_buffer) == rays, "{turn}");
        let map = graphs::frame(&gpu, crsm, &["visibility", "status"]);
        let [seen, status] = ["visibility", "status"].map(|name| values(&map, name));
        let pixels = seen.iter().zip(&status).zip(&rays);
        let wrong = pixels.filter(|((seen, status), ray)| is_certain(**status) && seen != ray);
        assert_eq!(wrong.count(), 0, "{turn}");
        if turn % compared != 0 {
            continue;
        }
        let mut alone = SceneProvider::from_mesh(parts.moved(&maps).unwrap(), sun());
        alone.set_camera(&view().camera(VIEWPORT));
        assert!(
            shown(&gpu, &mut start(&gpu, "rt", &mut alone)) == rays,
            "{turn}"
        );
        let expected = shown(&gpu, &mut start(&gpu, "crsm", &mut alone));
        assert!(seen == expected, "{turn}");
    }
    for counter in [
        |work: &Work| work.uploaded,
        |work: &Work| work.copied,
        |work: &Work| work.nodes,
        |work: &Work| work.laid,
    ] {
        let mut values: Vec<u64> = works.iter().map(counter).collect();
        values.sort_unstable();
        let median = values[frames / 2];
        assert!(values[frames - 1] <= 3 * median, "{median}, {values:?}");
    }
}

fn is_certain(status: u32) -> bool {
    [status::CERTAIN_LIGHT, status::CERTAIN_SHADOW].contains(&status)
}

#[test]
fn frames_of_moving_parts_are_those_of_meshes_that_never_moved() {
    exact_frames(60, 12, 1);
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_thousand_frames_of_moving_parts_are_exact() {
    exact_frames(60, 1000, 100);
}

#[test]
fn maps_by_which_nothing_can_be_moved_are_named() {
    let (count, bad) = (300, 217);
    let mut provider = provider(stones(count));
    let wrong = |change: fn(&mut DAffine3)| {
        let mut maps = rows(count);
        change(&mut maps[bad]);
        maps
    };
    let mut error = |maps: &[DAffine3]| {
        let error = provider.set_transforms(maps).unwrap_err();
        let Error::Move(error) = error else {
            panic!("{error}");
        };
        error
    };
    let nan = error(&wrong(|map| map.translation.x = f64::NAN));
    assert!(
        matches!(nan, MoveError::NotFinite { part: 217, .. }),
        "{nan}"
    );
    assert!(nan.to_string().contains("part 217"), "{nan}");
    let flat = error(&wrong(|map| {
        map.matrix3 = DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0))
    }));
    assert_eq!(flat, MoveError::Singular { part: bad });
    let far = error(&wrong(|map| map.translation.y = 1e39));
    assert!(
        matches!(far, MoveError::OutOfRange { part: 217, .. }),
        "{far}"
    );
    for maps in [0, count - 1, count + 1] {
        let expected = MoveError::Count { parts: count, maps };
        assert_eq!(error(&rows(maps)), expected);
    }
    // Nothing has changed: the parts still have no places.
    let places = provider.scene().mesh.positions.iter();
    assert!(places.map(|p| p.abs().max_element()).fold(0.0, f32::max) < 2.0);
    provider.set_transforms(&rows(count)).unwrap();

    let mut whole = SceneProvider::from_mesh(meshes::potato(1, 0.2, 1), sun());
    let error = whole.set_transforms(&rows(1)).unwrap_err().to_string();
    assert!(error.contains("`SceneProvider::from_parts`"), "{error}");
    let mesh = whole.scene().mesh.clone();
    let mut normals = mesh.normals.clone();
    normals[5] = Vec3::INFINITY;
    let error = whole.deform(mesh.positions, normals).unwrap_err();
    assert!(
        error.to_string().contains("normal 5 of the mesh is"),
        "{error}"
    );
}

#[test]
fn a_light_of_another_kind_is_an_error_of_its_own() {
    let gpu = open();
    let mut provider = provider(stones(2));
    provider.set_transforms(&rows(2)).unwrap();
    let mut executor = start(&gpu, "rt", &mut provider);
    let expected = shown(&gpu, &mut executor);
    let lamp = PointLight {
        position: DVec3::new(0.0, 9.0, 0.0),
        radius: 0.0,
    };
    provider.set_light(LightKind::Point(lamp));
    let error = executor.refresh(&mut provider).unwrap_err();
    let ExecuteError::OtherThanPlanned {
        name,
        planned,
        given,
    } = &error
    else {
        panic!("{error}");
    };
    let word = |provided: &Option<skiagraph_graph::Provided>| {
        provided.and_then(|provided| provided.kind?.word().into())
    };
    assert_eq!(name, "light");
    assert_eq!(
        [word(planned), word(given)],
        [Some("directional"), Some("point")]
    );
    let text = error.to_string();
    assert!(
        text.starts_with("`light` is point now, but the graph was planned for directional: plan"),
        "{text}"
    );
    // The way out that it names.
    let plan = executor.plan().with(|request| request.provider = &provider);
    executor
        .replace_graph(plan.unwrap(), &mut provider)
        .unwrap();
    assert!(shown(&gpu, &mut executor) != expected);
}

/// Parts that come and go: each frame is that of a mesh of those that there are.
#[test]
fn parts_that_are_added_and_removed_leave_the_mesh_of_the_others() {
    let gpu = open();
    let floor = meshes::box_over_floor(12.0, Vec3::splat(0.4));
    let kinds = [meshes::potato(2, 0.2, 1), meshes::potato(3, 0.1, 2)];
    let mut scene = provider(Movable::joined(&[&floor, &kinds[0], &kinds[0]]));
    let place = |x: f64, z: f64| DAffine3::from_translation(DVec3::new(x, 1.5, z));
    let mut there = vec![
        (&floor, place(7.0, 6.0)),
        (&kinds[0], place(1.0, 6.0)),
        (&kinds[0], place(4.0, 3.0)),
    ];
    let room = Room::of_copies(&kinds[1], 4).and(Room::of_copies(&kinds[0], 1));
    scene.reserve(room, &gpu.device.limits()).unwrap();
    let maps: Vec<DAffine3> = there.iter().map(|part| part.1).collect();
    scene.set_transforms(&maps).unwrap();
    let mut handles: Vec<PartId> = scene.parts().collect();
    let presets = ["rt", "light_buffer", "crsm"];
    let mut executors = presets.map(|preset| start(&gpu, preset, &mut scene));
    let mut turn = |scene: &mut SceneProvider, there: &[(&Mesh, DAffine3)], what: &str| {
        let meshes: Vec<&Mesh> = there.iter().map(|part| part.0).collect();
        let maps: Vec<DAffine3> = there.iter().map(|part| part.1).collect();
        let mut alone = provider(Movable::joined(&meshes));
        alone.set_transforms(&maps).unwrap();
        let before = scene.work();
        for (preset, executor) in presets.iter().zip(&mut executors) {
            executor.refresh(scene).unwrap();
            let expected = shown(&gpu, &mut start(&gpu, preset, &mut alone));
            assert!(expected.contains(&0) && expected.contains(&1), "{what}");
            assert!(shown(&gpu, executor) == expected, "{what}: {preset}");
        }
        scene.work().since(before)
    };
    turn(&mut scene, &there, "at first");
    // One is added, mirrored, and one removed whose room the next one takes.
    let mirrored = place(9.0, 6.0) * DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    there.push((&kinds[1], mirrored));
    handles.push(scene.add_part(&kinds[1], &mirrored).unwrap());
    turn(&mut scene, &there, "one is added");
    there.remove(1);
    let gone = handles.remove(1);
    scene.remove_part(gone).unwrap();
    turn(&mut scene, &there, "one is removed");
    for index in 0..4 {
        let map = place(3.0 + 2.0 * f64::from(index), 9.0);
        there.push((&kinds[usize::from(index < 3)], map));
        handles.push(scene.add_part(there.last().unwrap().0, &map).unwrap());
        turn(&mut scene, &there, "more are added");
    }
    assert!(scene.parts().eq(handles.iter().copied()));
    // They move as all others do, one by one and together.
    there[5].1.translation.y += 1.0;
    scene.set_transform(handles[5], &there[5].1).unwrap();
    turn(&mut scene, &there, "the last one moves");
    for (_, map) in &mut there {
        map.translation.x += 0.5;
    }
    let maps: Vec<DAffine3> = there.iter().map(|part| part.1).collect();
    scene.set_transforms(&maps).unwrap();
    turn(&mut scene, &there, "all move");
    // A branch, and a hierarchy that is built when some have come and gone already.
    let mut branch = scene.branch();
    branch.remove_part(handles[0]).unwrap();
    turn(&mut scene, &there, "the branch has one less");
    let mut later = provider(Movable::joined(&[&floor, &kinds[0]]));
    let room = Room::of_copies(&kinds[1], 2);
    later.reserve(room, &gpu.device.limits()).unwrap();
    let first: Vec<PartId> = later.parts().collect();
    later.remove_part(first[1]).unwrap();
    later.add_part(&kinds[1], &there[3].1).unwrap();
    later.set_transform(first[0], &there[0].1).unwrap();
    let mut whole = provider(Movable::joined(&[&floor, &kinds[1]]));
    whole.set_transforms(&[there[0].1, there[3].1]).unwrap();
    for preset in presets {
        let [seen, expected] =
            [&mut later, &mut whole].map(|scene| shown(&gpu, &mut start(&gpu, preset, scene)));
        assert!(seen == expected, "{preset}");
    }
}

/// One mesh more is uploaded and gets a hierarchy; the others have both.
#[test]
fn a_part_that_is_added_is_work_of_its_own_size() {
    let (gpu, count) = (open(), 100);
    let stone = meshes::potato(2, 0.2, 1);
    let size = [stone.positions.len(), stone.triangles.len()];
    for preset in PRESETS {
        let mut provider = provider(stones(count));
        let room = Room::of_copies(&stone, 10);
        provider.reserve(room, &gpu.device.limits()).unwrap();
        provider.set_transforms(&rows(count)).unwrap();
        let mut executor = start(&gpu, preset, &mut provider);
        let mut added = Vec::new();
        for map in &rows(count + 10)[count..] {
            let work = work(&mut provider, &mut executor, |provider| {
                added.push(provider.add_part(&stone, map).unwrap());
            });
            let moved = size[0] as u64;
            assert_eq!(work.moved, moved, "{preset}");
            assert!(
                work.laid > 0 && work.laid <= 2 * moved,
                "{preset}: {work:?}"
            );
            let top = 2 * (count + 10) * 32;
            let own = 16 * (size[0] + 3 * size[1]) + 4 * 10 * size[1] + 32 * 2 * size[1];
            let most = (top + own + 2 * 4096 + 144) as u64;
            assert!(work.uploaded <= most, "{preset}: {work:?}, {most}");
        }
        let seen = shown(&gpu, &mut executor);
        let mut whole = self::provider(stones(count + 10));
        whole.set_transforms(&rows(count + 10)).unwrap();
        assert!(
            seen == shown(&gpu, &mut start(&gpu, preset, &mut whole)),
            "{preset}"
        );
        // Without room the mesh grows, for which the refresh plans.
        provider
            .add_part(&stone, &rows(count + 11)[count + 10])
            .unwrap();
        executor.refresh(&mut provider).unwrap();
        let mut whole = self::provider(stones(count + 11));
        whole.set_transforms(&rows(count + 11)).unwrap();
        let expected = shown(&gpu, &mut start(&gpu, preset, &mut whole));
        assert!(shown(&gpu, &mut executor) == expected, "{preset}");
    }
}

/// A plan without masks binds none, so that no other resource tells that it is no longer right.
#[test]
fn the_first_masked_part_asks_for_another_plan() {
    let gpu = open();
    let (floor, leaves) = (
        meshes::box_over_floor(12.0, Vec3::splat(0.5)),
        meshes::foliage(12, 1.5, 0.5, 1),
    );
    let maps =
        [DVec3::new(7.0, 0.0, 8.0), DVec3::new(7.0, 3.0, 12.0)].map(DAffine3::from_translation);
    let mut whole = provider(Movable::joined(&[&floor, &leaves]));
    whole.set_transforms(&maps).unwrap();
    let mut solid = leaves.clone();
    solid.surfaces = Default::default();
    let mut solid = provider(Movable::joined(&[&floor, &solid]));
    solid.set_transforms(&maps).unwrap();
    for preset in PRESETS {
        let mut scene = provider(Movable::joined(&[&floor]));
        let room = Room::of_copies(&leaves, 1);
        scene.reserve(room, &gpu.device.limits()).unwrap();
        scene.set_transforms(&maps[..1]).unwrap();
        let mut executor = start(&gpu, preset, &mut scene);
        let relies_on: Vec<&String> = executor.plan().relies_on().keys().collect();
        // Lists and maps hold casters, maps both faces of what is masked.
        let asked = [
            "scene.casters",
            "scene.masks",
            "scene.shadows",
            "scene.sheets",
        ];
        let first = usize::from(preset == "rt");
        let end = 3 + usize::from(preset == "nsm");
        assert_eq!(relies_on, asked[first..end], "{preset}");
        scene.add_part(&leaves, &maps[1]).unwrap();
        let of_masks = |error: ExecuteError| {
            let text = error.to_string();
            assert!(text.contains("`scene.masks`"), "{preset}: {text}");
            assert!(
                matches!(error, ExecuteError::OtherThanPlanned { .. }),
                "{preset}: {text}"
            );
        };
        of_masks(executor.refresh(&mut scene).unwrap_err());
        of_masks(executor.refresh(&mut scene).unwrap_err());
        let old = executor.plan().clone();
        of_masks(Executor::on(&gpu, old, &mut scene).map(|_| ()).unwrap_err());
        let plan = executor.plan().with(|request| request.provider = &scene);
        executor.replace_graph(plan.unwrap(), &mut scene).unwrap();
        let relies_on = executor.plan().relies_on();
        assert!(!relies_on.contains_key("scene.masks"), "{preset}");
        let seen = shown(&gpu, &mut executor);
        let [masked, solid] =
            [&mut whole, &mut solid].map(|scene| shown(&gpu, &mut start(&gpu, preset, scene)));
        assert!(seen == masked && seen != solid, "{preset}");
    }
}

/// The lines of docs/embedding.md, whose text `readme.rs` compares with this file.
fn parts_of_the_document(gpu: &Gpu) -> Result<Vec<u32>, Box<dyn std::error::Error>> {
    let (floor, stone) = (
        meshes::box_over_floor(8.0, Vec3::splat(0.5)),
        meshes::potato(2, 0.2, 1),
    );
    let (light, device) = (sun(), &gpu.device);
    let mut provider = SceneProvider::from_parts(Movable::joined(&[&floor, &stone]), light);
    provider.reserve(Room::of_copies(&stone, 20), &device.limits())?;
    provider.set_camera(&view().camera(VIEWPORT));
    let places = &rows(2);
    provider.set_transforms(places)?;
    let mut executor = start(gpu, "light_buffer", &mut provider);
    let (place, elsewhere) = (rows(5)[4], rows(6)[5]);
    let part = provider.add_part(&stone, &place)?;
    provider.set_transform(part, &elsewhere)?;
    provider.remove_part(part)?;
    executor.refresh(&mut provider)?;
    let seen = shown(gpu, &mut executor);
    provider.add_part(&stone, &place)?;
    executor.refresh(&mut provider)?;
    assert!(shown(gpu, &mut executor) != seen);
    Ok(seen)
}

#[test]
fn the_parts_of_the_document_come_and_go() {
    let gpu = open();
    let seen = parts_of_the_document(&gpu).unwrap();
    assert!(seen.contains(&1));
}

/// A frame that was encoded shows a part that was removed before it was submitted.
#[test]
fn a_part_is_removed_while_frames_with_it_wait() {
    let (gpu, count) = (open(), 12);
    for preset in PRESETS {
        let mut provider = provider(stones(count));
        provider.set_transforms(&rows(count)).unwrap();
        let mut executor = start(&gpu, preset, &mut provider);
        let expected = shown(&gpu, &mut executor);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let frame = Frame::new().with_read(&["visibility"]);
        executor.encode(&mut encoder, &frame).unwrap();
        let parts: Vec<PartId> = provider.parts().collect();
        for part in &parts[3..] {
            provider.remove_part(*part).unwrap();
        }
        executor.refresh(&mut provider).unwrap();
        executor.encode(&mut encoder, &frame).unwrap();
        gpu.queue.submit([encoder.finish()]);
        let mut next = || values(&executor.finish().unwrap(), "visibility");
        let (with, without) = (next(), next());
        let mut few = self::provider(stones(3));
        few.set_transforms(&rows(3)).unwrap();
        let alone = shown(&gpu, &mut start(&gpu, preset, &mut few));
        assert!(with == expected && without == alone, "{preset}");
    }
}

/// Materials and masks come with the parts that have them.
#[test]
fn leaves_are_added_to_a_scene_without_and_with_masks() {
    let gpu = open();
    let floor = meshes::box_over_floor(12.0, Vec3::splat(0.4));
    let leaves = meshes::foliage(40, 2.0, 4.0, 3);
    let place = |x: f64| DAffine3::from_translation(DVec3::new(x, 2.0, 8.0));
    let mut scene = provider(Movable::joined(&[&floor]));
    scene.set_transforms(&[place(6.0)]).unwrap();
    let mut there = vec![(&floor, place(6.0))];
    for (mesh, at) in [(&leaves, 4.0), (&floor, 7.0), (&leaves, 9.0)] {
        scene.add_part(mesh, &place(at)).unwrap();
        there.push((mesh, place(at)));
        let meshes: Vec<&Mesh> = there.iter().map(|part| part.0).collect();
        let maps: Vec<DAffine3> = there.iter().map(|part| part.1).collect();
        let mut whole = provider(Movable::joined(&meshes));
        whole.set_transforms(&maps).unwrap();
        for preset in ["rt", "light_buffer", "crsm"] {
            let [seen, expected] =
                [&mut scene, &mut whole].map(|scene| shown(&gpu, &mut start(&gpu, preset, scene)));
            assert!(seen == expected, "{preset}, {at}");
        }
    }
}

/// Only the materials of the part that is added are uploaded, behind the others: the buffers are
/// those of a mesh that had the part from the start.
#[test]
fn materials_are_uploaded_of_the_part_that_is_added() {
    let gpu = open();
    let painted = |seed: u64, edge: u32| {
        let mut mesh = meshes::foliage(60, 0.4, 3.0, seed);
        let rgba = (0..edge * edge).map(|texel| (texel + edge).to_le_bytes());
        let texels = Texels {
            size: [edge; 2],
            rgba: rgba.collect(),
            has_alpha: true,
        };
        mesh.surfaces.materials[0].texture = Some(Texture::new(
            "leaf".into(),
            Source::Texels(Arc::new(texels)),
            [Wrap::Mirror, Wrap::Clamp],
        ));
        mesh
    };
    let (trees, bush) = (painted(1, 32), painted(2, 8));
    let names = [
        "scene.uvs",
        "scene.uv_indices",
        "scene.materials",
        "scene.material_indices",
        "scene.texels",
    ];
    let uploads = |provider: &mut SceneProvider| {
        let buffers = names.map(|name| provider.build(name, &gpu.device, &gpu.queue).unwrap());
        provider.submit_built(&gpu.device, &gpu.queue).unwrap();
        buffers.map(|buffer| graphs::buffer_bytes(&gpu, &buffer))
    };
    let maps = rows(4);
    let mut provider = provider(Movable::joined(&[&trees; 3]));
    let room = Room::of_copies(&bush, 1);
    provider.reserve(room, &gpu.device.limits()).unwrap();
    provider.set_transforms(&maps[..3]).unwrap();
    uploads(&mut provider);
    let before = provider.work();
    provider.add_part(&bush, &maps[3]).unwrap();
    let seen = uploads(&mut provider);
    let (surfaces, triangles) = (&bush.surfaces, bush.triangles.len());
    let own =
        8 * surfaces.uvs.len() + 32 * surfaces.materials.len() + (12 + 4) * triangles + 4 * 64;
    assert_eq!(provider.work().since(before).uploaded, own as u64);
    let mut whole = self::provider(Movable::joined(&[&trees, &trees, &trees, &bush]));
    whole.set_transforms(&maps).unwrap();
    for ((name, seen), expected) in names.iter().zip(seen).zip(uploads(&mut whole)) {
        assert!(seen == expected, "{name}");
    }
    // Another mesh begins anew.
    provider.set_parts(Movable::joined(&[&bush]));
    let mut alone = self::provider(Movable::joined(&[&bush]));
    assert!(uploads(&mut provider) == uploads(&mut alone));
}

/// A world that is shifted, camera and all, so that it stays near the origin.
#[test]
fn a_floating_origin_uploads_a_map_for_each_part() {
    let (gpu, count) = (open(), 40);
    let mut provider = provider(stones(count));
    provider.set_transforms(&rows(count)).unwrap();
    let mut executor = start(&gpu, "light_buffer", &mut provider);
    shown(&gpu, &mut executor);
    let shifts = [[64.0, 0.0, -32.0], [512.0, 16.0, 256.0], [32.0, 0.0, 8.0]];
    for (number, shift) in shifts.map(DVec3::from).into_iter().enumerate() {
        let before = provider.work();
        let shift_all = |map: &DAffine3| DAffine3::from_translation(-shift) * *map;
        let maps: Vec<DAffine3> = rows(count).iter().map(shift_all).collect();
        provider.set_transforms(&maps).unwrap();
        let eye = View {
            eye: view().eye - shift,
            ..view()
        };
        provider.set_camera(&eye.camera(VIEWPORT));
        executor.refresh(&mut provider).unwrap();
        let work = provider.work().since(before);
        // The first one brings positions at rest to the GPU.
        let most = 192 * count as u64 + 512;
        assert!(number == 0 || work.uploaded <= most, "{work:?}");
        let seen = shown(&gpu, &mut executor);
        let mut whole = self::provider(stones(count));
        whole.set_transforms(&maps).unwrap();
        whole.set_camera(&eye.camera(VIEWPORT));
        assert!(seen == shown(&gpu, &mut start(&gpu, "light_buffer", &mut whole)));
    }
}

/// Lists of materials and texture coordinates hold those of a mesh once, however many parts have
/// it, and those of meshes that are gone for a while only.
#[test]
fn lists_of_materials_follow_the_meshes_that_there_are() {
    let gpu = open();
    let floor = meshes::box_over_floor(12.0, Vec3::splat(0.4));
    let place = |x: f64| DAffine3::from_translation(DVec3::new(x, 2.0, 8.0));
    let mut provider = provider(Movable::joined(&[&floor]));
    provider.set_transforms(&[place(6.0)]).unwrap();
    let leaves = |seed| PartMesh::new(&meshes::foliage(80, 1.5, 4.0, seed)).unwrap();
    let lengths = |provider: &SceneProvider| {
        let surfaces = &provider.scene().mesh.surfaces;
        [surfaces.materials.len(), surfaces.uvs.len()]
    };
    let common = leaves(0);
    provider.add_mesh(&common, &place(3.0)).unwrap();
    let once = lengths(&provider);
    provider.add_mesh(&common, &place(9.0)).unwrap();
    assert_eq!(lengths(&provider), once);

    let part = provider.add_mesh(&common, &place(6.0)).unwrap();
    let mut executor = start(&gpu, "light_buffer", &mut provider);
    let mut longest = 0;
    for seed in 1..60 {
        let map = place(4.0 + 0.05 * seed as f64);
        provider.replace_part(part, &leaves(seed), &map).unwrap();
        longest = longest.max(lengths(&provider)[1]);
        if seed % 10 != 9 {
            continue;
        }
        let plan = executor.plan();
        let plan = plan.with(|request| request.provider = &provider);
        executor
            .replace_graph(plan.unwrap(), &mut provider)
            .unwrap();
        let bush = meshes::foliage(80, 1.5, 4.0, seed);
        let own = meshes::foliage(80, 1.5, 4.0, 0);
        let mut whole = self::provider(Movable::joined(&[&floor, &own, &own, &bush]));
        let maps = [place(6.0), place(3.0), place(9.0), map];
        whole.set_transforms(&maps).unwrap();
        let seen = shown(&gpu, &mut executor);
        assert!(
            seen == shown(&gpu, &mut start(&gpu, "light_buffer", &mut whole)),
            "{seed}"
        );
        for id in 0..provider.scene().mesh.triangles.len() as u32 {
            let [one, other] = [&provider, &whole].map(|it| &it.scene().mesh);
            let own = (0..other.triangles.len() as u32).find(|own| {
                other.corners(*own) == one.corners(id) && one.triangles[id as usize] != [0; 3]
            });
            if let Some(own) = own {
                let [one, other] = [(one, id), (other, own)].map(|(mesh, id)| {
                    let surfaces = &mesh.surfaces;
                    (surfaces.corner_uvs(id), surfaces.mask(id).is_some())
                });
                assert_eq!(one, other, "triangle {id}");
            }
        }
    }
    assert!(longest < 5000, "{longest} texture coordinates");
}

/// A part that was cut out of a mesh is removed from between the others.
#[test]
fn a_part_that_was_cut_out_is_removed_alone() {
    let gpu = open();
    let (floor, stone) = (
        meshes::box_over_floor(8.0, Vec3::splat(0.5)),
        meshes::potato(2, 0.2, 1),
    );
    let parts = Movable::joined(&[&floor, &stone, &stone, &stone]);
    let mut whole = parts.moved(&rows(4)).unwrap();
    // Triangles of two parts in turns.
    let [first, second] = [
        floor.triangles.len(),
        floor.triangles.len() + stone.triangles.len(),
    ];
    let ends = [first, second, second + stone.triangles.len()];
    for step in (1..stone.triangles.len()).step_by(2) {
        whole.triangles.swap(ends[0] + step, ends[1] + step);
        whole.normal_indices.swap(ends[0] + step, ends[1] + step);
    }
    whole.groups.clear();
    for at in ends[0]..ends[2] {
        let of_first = (at < ends[1]) == ((at - ends[0]) % stone.triangles.len() % 2 == 0);
        whole.groups.push(Group {
            name: if of_first { "first" } else { "second" }.to_owned(),
            triangles: at as u32..at as u32 + 1,
        });
    }
    let cut = Movable::new(&whole, &["first", "second"]).unwrap();
    let mut scene = provider(cut);
    let handles: Vec<PartId> = scene.parts().collect();
    let mut executors =
        ["rt", "light_buffer", "crsm"].map(|preset| (preset, start(&gpu, preset, &mut scene)));
    scene.remove_part(handles[0]).unwrap();
    scene
        .set_transforms(&[DAffine3::from_translation(DVec3::Y)])
        .unwrap();
    let mut alone = provider(Movable::joined(&[&floor, &stone, &stone]));
    let [_, _, second, third] = rows(4)[..] else {
        panic!("four places");
    };
    let second = DAffine3::from_translation(DVec3::Y) * second;
    alone.set_transforms(&[rows(1)[0], second, third]).unwrap();
    for (preset, executor) in &mut executors {
        executor.refresh(&mut scene).unwrap();
        let expected = shown(&gpu, &mut start(&gpu, preset, &mut alone));
        assert!(shown(&gpu, executor) == expected, "{preset}");
    }
}

/// Bytes of the positions, normals and corners of a mesh on the device.
fn bytes(mesh: &Mesh) -> [u64; 3] {
    let [positions, normals] = [&mesh.positions, &mesh.normals].map(|list| 16 * list.len() as u64);
    [positions, normals, 12 * mesh.triangles.len() as u64]
}

/// Room beyond the device's limits is refused before anything is allocated, and so is a part for
/// which the mesh would have to grow beyond them.
#[test]
fn room_that_no_device_has_is_refused() {
    let stone = meshes::potato(1, 0.2, 1);
    let mut provider = provider(stones(3));
    provider.set_transforms(&rows(3)).unwrap();
    let counts = |provider: &SceneProvider| bytes(&provider.scene().mesh);
    let (before, most) = (counts(&provider), usize::MAX);
    let absurd = |set: fn(&mut Room, usize)| {
        let mut room = Room::default();
        set(&mut room, most);
        room
    };
    let limits = wgpu::Limits::default();
    for (room, named) in [
        (Room::of_copies(&stone, most), "scene.bvh_nodes"),
        (
            absurd(|room, most| room.positions = most),
            "scene.positions",
        ),
        (absurd(|room, most| room.normals = most), "scene.normals"),
        (absurd(|room, most| room.triangles = most), "scene.indices"),
        (absurd(|room, most| room.parts = most), "scene.bvh_nodes"),
        (Room::of_copies(&stone, 1 << 20), "scene.positions"),
    ] {
        let error = provider.reserve(room, &limits).unwrap_err();
        let text = error.to_string();
        assert!(matches!(error, Error::TooLarge { .. }), "{text}");
        assert!(text.contains(named), "{text}");
        assert!(text.contains("max_storage_buffer_binding_size"), "{text}");
        assert_eq!(counts(&provider), before);
    }
    // A mesh that is nearly full grows by what is left, and then no more.
    let own = bytes(&Movable::joined(&[&stone]).rest);
    let most = before.iter().zip(own).map(|(before, own)| before + own);
    let limits = wgpu::Limits {
        max_storage_buffer_binding_size: 16 + most.max().unwrap(),
        ..limits
    };
    provider.reserve(Room::default(), &limits).unwrap();
    provider.add_part(&stone, &rows(4)[3]).unwrap();
    let full = counts(&provider);
    let limit = limits.max_storage_buffer_binding_size;
    assert!(full.iter().all(|bytes| *bytes <= limit), "{full:?}");
    let error = provider.add_part(&stone, &rows(5)[4]).unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    assert_eq!(counts(&provider), full);
    assert_eq!(provider.parts().count(), 4);
}

#[test]
fn parts_that_there_are_not_are_named() {
    let stone = meshes::potato(1, 0.2, 1);
    let mut whole = SceneProvider::from_mesh(stone.clone(), sun());
    let error = whole.add_part(&stone, &DAffine3::IDENTITY).unwrap_err();
    assert!(matches!(error, Error::NoParts), "{error}");
    let (room, limits) = (Room::of_copies(&stone, 1), wgpu::Limits::default());
    let error = whole.reserve(room, &limits).unwrap_err();
    assert!(matches!(error, Error::NoParts), "{error}");

    let mut provider = provider(stones(3));
    let parts: Vec<PartId> = provider.parts().collect();
    provider.set_transforms(&rows(3)).unwrap();
    provider.remove_part(parts[1]).unwrap();
    let map = DAffine3::IDENTITY;
    for error in [
        provider.remove_part(parts[1]).unwrap_err(),
        provider.set_transform(parts[1], &map).unwrap_err(),
    ] {
        assert!(
            matches!(error, Error::NoPart(part) if part == parts[1]),
            "{error}"
        );
        assert!(
            error.to_string().contains("`SceneProvider::parts`"),
            "{error}"
        );
    }
    let count = MoveError::Count { parts: 2, maps: 3 };
    let error = provider.set_transforms(&rows(3)).unwrap_err();
    assert!(
        matches!(&error, Error::Move(error) if *error == count),
        "{error}"
    );
    let nan = DAffine3::from_translation(DVec3::NAN);
    for error in [
        provider.add_part(&stone, &nan).unwrap_err(),
        provider.set_transform(parts[2], &nan).unwrap_err(),
    ] {
        assert!(
            matches!(error, Error::Move(MoveError::NotFinite { .. })),
            "{error}"
        );
    }
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let error = provider.set_transform(parts[2], &flat).unwrap_err();
    assert!(error.to_string().contains("part 1 is singular"), "{error}");
    assert_eq!(provider.parts().count(), 2);
    // Those of a mesh that was replaced are of it alone.
    provider.set_parts(stones(3));
    assert!(provider.set_transform(parts[0], &map).is_err());
    // A mesh may begin without parts.
    let mut none = self::provider(Movable::joined(&[]));
    let part = none.add_part(&stone, &map).unwrap();
    assert!(none.parts().eq([part]));
}
