//! Parts that a host mirrors: their triangles are wound the other way then, as glTF's are, so that
//! every preset shows what it shows of a mesh that was mirrored before it was loaded.

use crate::support::{
    graphs::{self, open, values},
    meshes,
};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use skiagraph_gpu::{Executor, device::Gpu};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{DirectionalLight, Mesh, Movable, View};

const VIEWPORT: [u32; 2] = [64, 40];
/// Those that ask which side of a caster is lit, and two that do not.
const PRESETS: [&str; 6] = [
    "nsm",
    "crsm_single",
    "hybrid_pcf",
    "crsma",
    "light_buffer",
    "rt",
];

fn light() -> DirectionalLight {
    DirectionalLight::new(DVec3::new(0.4, -1.0, -0.3))
}

fn view() -> View {
    View {
        name: String::new(),
        eye: DVec3::new(1.0, 6.0, 9.0),
        direction: DVec3::new(-0.1, -0.6, -1.0),
        fov_y_degrees: 50.0,
        far: 60.0,
        ..View::default()
    }
}

/// One of them with holes in its surfaces.
fn meshes() -> [Mesh; 3] {
    [
        meshes::box_over_floor(8.0, Vec3::splat(0.5)),
        meshes::potato(3, 0.2, 1),
        meshes::foliage(40, 0.4, 1.0, 1),
    ]
}

/// All three mirrored, or only the second, or none.
fn places(time: usize) -> [DAffine3; 3] {
    let by = |scale: DVec3, at: DVec3| DAffine3 {
        matrix3: DMat3::from_diagonal(scale) * DMat3::from_rotation_y(0.3 * time as f64),
        translation: at,
    };
    let [floor, stone, leaves] = match time {
        0 => [DVec3::ONE; 3],
        1 => [DVec3::ONE, DVec3::new(1.0, -1.2, 1.0), DVec3::ONE],
        _ => [
            DVec3::new(-1.0, 1.0, 1.0),
            DVec3::new(1.0, 1.0, 1.3),
            DVec3::splat(-1.0),
        ],
    };
    [
        by(floor, DVec3::ZERO),
        by(stone, DVec3::new(2.0, 1.5, 0.0)),
        by(leaves, DVec3::new(-2.0, 2.0, 1.0)),
    ]
}

/// The meshes as a program exports them that applies their places first.
fn applied(time: usize) -> Mesh {
    let mut made = meshes();
    for (mesh, place) in made.iter_mut().zip(places(time)) {
        for position in &mut mesh.positions {
            *position = place.transform_point3(position.as_dvec3()).as_vec3();
        }
        let across = place.matrix3.inverse().transpose();
        for normal in &mut mesh.normals {
            *normal = (across * normal.as_dvec3()).normalize().as_vec3();
        }
        if place.matrix3.determinant() < 0.0 {
            let lists = [&mut mesh.triangles, &mut mesh.normal_indices];
            for corners in lists.into_iter().chain([&mut mesh.surfaces.uv_indices]) {
                corners.iter_mut().for_each(|corners| corners.swap(1, 2));
            }
        }
    }
    Movable::joined(&made.each_ref()).rest
}

fn start(gpu: &Gpu, preset: &str, provider: &mut SceneProvider) -> Executor {
    let path = format!("pipelines/{preset}.ron");
    let plan = graphs::plan(&path, provider, VIEWPORT, |_| {});
    Executor::on(gpu, plan, provider).unwrap()
}

fn shown(gpu: &Gpu, executor: &mut Executor) -> Vec<u32> {
    values(&graphs::frame(gpu, executor, &["visibility"]), "visibility")
}

/// How many pixels differ.
fn wrong(seen: &[u32], expected: &[u32]) -> usize {
    seen.iter().zip(expected).filter(|(a, b)| a != b).count()
}

/// Determinants that change their signs while frames go on.
#[test]
fn a_part_that_is_mirrored_is_shown_as_one_that_was_made_so() {
    let gpu = open();
    let parts = meshes();
    let parts = Movable::joined(&parts.each_ref());
    for preset in PRESETS {
        let mut host = SceneProvider::from_parts(parts.clone(), light());
        host.set_camera(&view().camera(VIEWPORT));
        host.set_transforms(&places(0)).unwrap();
        let mut executor = start(&gpu, preset, &mut host);
        let made_so = [0, 1, 2].map(|time| {
            let mut made_so = SceneProvider::from_mesh(applied(time), light());
            made_so.set_camera(&view().camera(VIEWPORT));
            shown(&gpu, &mut start(&gpu, preset, &mut made_so))
        });
        for time in [0, 1, 2, 1, 0] {
            host.set_transforms(&places(time)).unwrap();
            executor.refresh(&mut host).unwrap();
            let seen = shown(&gpu, &mut executor);
            let expected = &made_so[time];
            assert!(expected.contains(&0) && expected.contains(&1), "{preset}");
            println!("{preset}, {time}: {} wrong", wrong(&seen, expected));
            assert_eq!(wrong(&seen, expected), 0, "{preset}, {time}");
        }
    }
}
