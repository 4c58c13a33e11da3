//! Parts that maps move are moved by the GPU where many are: to the bit where the CPU has them, and
//! without work of the CPU that grows with their corners.

use crate::support::{
    graphs::{self, open, values},
    meshes,
};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use skiagraph_gpu::{Executor, device::Gpu};
use skiagraph_passes::{SceneProvider, Work};
use skiagraph_scene::{DirectionalLight, Group, Mesh, Movable, View};

const VIEWPORT: [u32; 2] = [48, 32];
const PRESETS: [&str; 3] = ["light_buffer", "rt", "nsm"];

fn sun() -> DirectionalLight {
    DirectionalLight::new(DVec3::new(0.4, -1.0, -0.3))
}

fn view() -> View {
    View {
        eye: DVec3::new(7.0, 9.0, 24.0),
        direction: DVec3::new(0.0, -0.5, -1.0),
        fov_y_degrees: 50.0,
        far: 60.0,
        ..View::default()
    }
}

fn seen_from_the_view(mut provider: SceneProvider) -> SceneProvider {
    provider.set_camera(&view().camera(VIEWPORT));
    provider
}

/// Shifts, turns with other lengths, and mirrors.
fn maps(count: usize, turn: usize) -> Vec<DAffine3> {
    let map = |index: usize| {
        let place = DVec3::new((index % 6) as f64, 0.0, (index / 6) as f64) * 3.0;
        let shift = 0.1 * turn as f64 + 1e-7 * index as f64;
        let at = DAffine3::from_translation(place + DVec3::new(shift, 0.3 * shift.sin(), -shift));
        let angle = 0.3 * (turn + index) as f64;
        let turned = DMat3::from_rotation_y(angle) * DMat3::from_rotation_x(angle);
        match (index % 3, (index + turn) % 5) {
            (0, _) => at,
            (_, 0) => at * DAffine3::from_scale(DVec3::new(-0.9, 1.1, 1.0)),
            _ => at * DAffine3::from_mat3(turned * (1.0 + 0.01 * index as f64)),
        }
    };
    (0..count).map(map).collect()
}

fn start(gpu: &Gpu, preset: &str, provider: &mut SceneProvider) -> Executor {
    let path = format!("pipelines/{preset}.ron");
    let plan = graphs::plan(&path, provider, VIEWPORT, |_| {});
    Executor::on(gpu, plan, provider).unwrap()
}

fn shown(gpu: &Gpu, executor: &mut Executor) -> Vec<Vec<u32>> {
    let frame = graphs::frame(gpu, executor, &["visibility", "status"]);
    ["visibility", "status"]
        .map(|name| values(&frame, name))
        .to_vec()
}

fn bytes_of(positions: &[Vec3]) -> Vec<u8> {
    let items: Vec<[f32; 4]> = positions
        .iter()
        .map(|at| at.extend(1.0).to_array())
        .collect();
    bytemuck::cast_slice(&items).to_vec()
}

/// Each frame shows what the mesh of its places shows, whatever has moved before, and its positions
/// are those of the CPU.
#[test]
fn frames_of_parts_are_those_of_the_mesh_of_their_places() {
    let (gpu, count) = (open(), 24);
    let (stone, other) = (meshes::potato(2, 0.2, 1), meshes::potato(3, 0.1, 2));
    let kinds = (0..count).map(|at| if at % 4 == 0 { &other } else { &stone });
    let parts = Movable::joined(&kinds.collect::<Vec<_>>());
    for preset in PRESETS {
        let mut scene = seen_from_the_view(SceneProvider::from_parts(parts.clone(), sun()));
        let mut now = maps(count, 0);
        scene.set_transforms(&now).unwrap();
        let mut executor = start(&gpu, preset, &mut scene);
        for turn in 1..9 {
            let mut next = maps(count, turn);
            match turn {
                // A few, while the GPU has moved many.
                4 => now[5] = next[5],
                // As a mesh that is bent.
                6 => {
                    // Which keeps its winding.
                    next.clone_from(&now);
                    next.iter_mut().for_each(|map| map.translation.y += 0.3);
                    let mesh = parts.moved(&next).unwrap();
                    scene.deform(mesh.positions, mesh.normals).unwrap();
                }
                _ => {}
            }
            if turn != 4 {
                now = next;
            }
            if turn != 6 {
                scene.set_transforms(&now).unwrap();
            }
            executor.refresh(&mut scene).unwrap();
            let mesh = parts.moved(&now).unwrap();
            let positions = graphs::resource_bytes(&gpu, &mut scene, "scene.positions");
            assert!(positions == bytes_of(&mesh.positions), "{preset}, {turn}");
            let mut alone = SceneProvider::from_mesh(mesh.clone(), sun());
            alone.set_camera(&view().camera(VIEWPORT));
            let expected = shown(&gpu, &mut start(&gpu, preset, &mut alone));
            assert!(
                expected[0].contains(&0) && expected[0].contains(&1),
                "{preset}"
            );
            assert!(shown(&gpu, &mut executor) == expected, "{preset}, {turn}");
            let light = |scene: &mut SceneProvider| graphs::resource_bytes(&gpu, scene, "light");
            assert!(light(&mut scene) == light(&mut alone), "{preset}, {turn}");
            // The scene tells where they are, in whatever order it is asked.
            if turn % 2 == 0 {
                assert_eq!(scene.scene().mesh.positions, mesh.positions, "{turn}");
                assert_eq!(scene.scene().mesh.normals, mesh.normals, "{turn}");
                assert_eq!(scene.scene().mesh.triangles, mesh.triangles, "{turn}");
            }
        }
    }
}

/// Parts whose positions lie between those of others, with triangles that are in no part.
fn cut() -> Mesh {
    let mut mesh = meshes::box_over_floor(12.0, Vec3::splat(0.4));
    let mut groups = Vec::new();
    for number in 0..8u32 {
        let stone = meshes::potato(2, 0.2, 1);
        let first = [mesh.positions.len(), mesh.normals.len()].map(|at| at as u32);
        let begins = mesh.triangles.len() as u32;
        let shift = Vec3::new(3.0 * (number % 4) as f32, 1.0, 4.0 * (number / 4) as f32);
        mesh.positions
            .extend(stone.positions.iter().map(|at| *at + shift));
        mesh.normals.extend(&stone.normals);
        let moved = |corners: &[u32; 3], by: u32| corners.map(|at| at + by);
        let triangles = stone.triangles.iter().map(|it| moved(it, first[0]));
        mesh.triangles.extend(triangles);
        let normals = stone.normal_indices.iter().map(|it| moved(it, first[1]));
        mesh.normal_indices.extend(normals);
        groups.push(Group {
            name: format!("stone {}", number % 4),
            triangles: begins..mesh.triangles.len() as u32,
        });
    }
    mesh.groups = groups;
    mesh
}

#[test]
fn parts_cut_from_a_mesh_move_with_what_is_outside_of_them() {
    let gpu = open();
    let mesh = cut();
    let names = ["stone 0", "stone 1", "stone 2"];
    let parts = Movable::new(&mesh, &names).unwrap();
    let outside = parts.outside();
    let whole = parts.clone().with_outside();
    assert_eq!((parts.parts(), whole.parts()), (3, 4));
    assert_eq!(whole.triangles(3), outside);
    assert!(whole.outside().is_empty());
    assert_eq!(whole.clone().with_outside().parts(), 4);
    assert_eq!(whole.rest.triangles, parts.rest.triangles);
    assert_eq!(whole.rest.normals, parts.rest.normals);
    for preset in PRESETS {
        let mut scene = seen_from_the_view(SceneProvider::from_parts(whole.clone(), sun()));
        let mut executor = start(&gpu, preset, &mut scene);
        for turn in 1..4 {
            let shift = DVec3::splat(0.01 * f64::from(turn));
            let map = DAffine3::from_translation(shift);
            scene.set_transforms(&[map; 4]).unwrap();
            executor.refresh(&mut scene).unwrap();
            let moved = whole.moved(&[map; 4]).unwrap();
            let shifted = whole.rest.positions.iter();
            let shifted = shifted.map(|at| (at.as_dvec3() + shift).as_vec3());
            assert!(shifted.eq(moved.positions.iter().copied()), "{turn}");
            let positions = graphs::resource_bytes(&gpu, &mut scene, "scene.positions");
            assert!(positions == bytes_of(&moved.positions), "{preset}, {turn}");
            let mut alone = seen_from_the_view(SceneProvider::from_mesh(moved, sun()));
            let expected = shown(&gpu, &mut start(&gpu, preset, &mut alone));
            assert!(shown(&gpu, &mut executor) == expected, "{preset}, {turn}");
        }
        // Now only the parts: the rest of the mesh stays.
        let mut scene = seen_from_the_view(SceneProvider::from_parts(parts.clone(), sun()));
        let mut executor = start(&gpu, preset, &mut scene);
        for turn in 1..4 {
            let map = DAffine3::from_translation(DVec3::Y * f64::from(turn));
            scene.set_transforms(&[map; 3]).unwrap();
            executor.refresh(&mut scene).unwrap();
            let moved = parts.moved(&[map; 3]).unwrap();
            let positions = graphs::resource_bytes(&gpu, &mut scene, "scene.positions");
            assert!(positions == bytes_of(&moved.positions), "{preset}, {turn}");
            let mut alone = seen_from_the_view(SceneProvider::from_mesh(moved, sun()));
            let expected = shown(&gpu, &mut start(&gpu, preset, &mut alone));
            assert!(shown(&gpu, &mut executor) == expected, "{preset}, {turn}");
        }
    }
}

fn work(provider: &mut SceneProvider, executor: &mut Executor, maps: &[DAffine3]) -> Work {
    let before = provider.work();
    provider.set_transforms(maps).unwrap();
    executor.refresh(provider).unwrap();
    provider.work().since(before)
}

/// A stone in a box.
fn caged(levels: u32) -> Mesh {
    let mut mesh = meshes::potato(levels, 0.2, 1);
    let first = mesh.positions.len() as u32;
    let ends = [-2.0, 2.0];
    let corner = |at: usize| Vec3::new(ends[at & 1], ends[at >> 1 & 1], ends[at >> 2]);
    mesh.positions.extend((0..8).map(corner));
    for side in [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 3, 6, 7]] {
        let [a, b, c, d] = side.map(|at| first + at);
        mesh.triangles.extend([[a, b, c], [b, d, c]]);
        mesh.normal_indices.extend([[0; 3]; 2]);
    }
    mesh
}

/// The bytes that a frame brings to the device, and the corners that the light's box looks at, are
/// those of parts, however many corners they have inside.
#[test]
fn what_a_shift_costs_does_not_grow_with_corners() {
    let (gpu, count) = (open(), 6);
    let mut costs = Vec::new();
    for levels in [3, 5] {
        let stone = caged(levels);
        let parts = Movable::joined(&vec![&stone; count]);
        let positions = parts.rest.positions.len() as u64;
        let mut scene = seen_from_the_view(SceneProvider::from_parts(parts, sun()));
        let shifted = |turn: usize| -> Vec<DAffine3> {
            let place = |at: usize| DVec3::new(3.0 * at as f64, 0.1 * turn as f64, 0.0);
            (0..count)
                .map(|at| DAffine3::from_translation(place(at)))
                .collect()
        };
        scene.set_transforms(&shifted(0)).unwrap();
        let mut executor = start(&gpu, "light_buffer", &mut scene);
        // Their positions at rest, once.
        let first = work(&mut scene, &mut executor, &shifted(1));
        assert!(first.uploaded >= 16 * positions, "{first:?}");
        let next = work(&mut scene, &mut executor, &shifted(2));
        assert_eq!(next.moved, positions);
        // A record of 192 bytes for each part, and the light.
        assert_eq!(next.uploaded, 192 * count as u64 + 144, "{next:?}");
        assert_eq!(next.nodes, 0, "{next:?}");
        costs.push(next.laid);
    }
    assert!(costs[0] >= 8, "{costs:?}");
    assert_eq!(costs[0], costs[1]);
}
