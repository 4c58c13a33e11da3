//! The CPU references on scenes whose statuses are plain, and what of the oracle's they contradict.

use crate::scenes::{add_rectangle, floor, from_above, light, render};
#[allow(dead_code)] // the oracle's tests use all of it
use glam::{DVec3, Vec3};
use skiagraph_reference::{Class, Error, Oracle, OracleMode, Progress, statistics::status};
use skiagraph_scene::{Adjacency, DirectionalLight, Mesh};
use skiagraph_tests::cpu_reference::{Casters, CpuReference, Cull, Depth, LightSpace, Method};

const METHODS: [Method; 4] = [
    Method::HybridPcf,
    Method::Crsm,
    Method::Crsma,
    Method::CrsmaFull,
];

fn cpu_reference(method: Method, map_size: u32) -> CpuReference {
    CpuReference {
        method,
        map_size,
        cull: Cull::Front,
        n: 0.51,
        depth: Depth::Conservative,
    }
}

/// A square whose back the light sees, over a floor whose front it sees and which is culled:
/// nothing certain is wrong but by the four texels of the one that proves nothing; the less a
/// method joins triangles, the more it leaves uncertain.
#[test]
fn statuses_of_a_square_above_a_floor() {
    let mut mesh = floor();
    add_rectangle(&mut mesh, [3.0, -3.0], 2.0, [-3.01, 3.0]);
    let (camera, light) = (from_above(10.0, [120, 120]), light(0.3, -1.0, 0.1));
    let primitives = Oracle::new(&mesh)
        .primary(&camera, Progress::default())
        .unwrap();
    let truth = render(&mesh, &camera, light, OracleMode::Exact);
    let adjacency = Adjacency::new(&mesh);
    let mut uncertain = vec![];
    for method in METHODS {
        let cpu = cpu_reference(method, 1500);
        let maps = cpu.maps(&mesh, &adjacency, &light).unwrap();
        let classified = maps
            .classify(&camera, &primitives, Progress::default())
            .unwrap();
        let indeterminate = classified.indeterminate.iter().filter(|&&is| is).count();
        assert!(
            indeterminate < classified.status.len() / 200,
            "{method:?}: {indeterminate}"
        );
        let count = |wanted| {
            classified
                .status
                .iter()
                .filter(|&&status| status == wanted)
                .count()
        };
        for (index, &answer) in classified.status.iter().enumerate() {
            let wrong = matches!(
                (truth.classes[index], answer),
                (Class::Lit, status::CERTAIN_SHADOW) | (Class::Shadow, status::CERTAIN_LIGHT)
            );
            assert!(!wrong || method == Method::HybridPcf, "{method:?} {index}");
        }
        assert!(
            count(status::CERTAIN_LIGHT) > 5_000 && count(status::CERTAIN_SHADOW) > 500,
            "{method:?}"
        );
        uncertain.push(count(status::UNCERTAIN));
    }
    let [_, crsm, crsma, full] = uncertain[..] else {
        unreachable!("four methods were asked");
    };
    assert!(full < crsma && crsma < crsm, "{uncertain:?}");
}

/// Two triangles on one side of their edge, or one of them not in the map, do not continue
/// each other's surface; nor do three.
#[test]
fn folds_and_culled_neighbours_are_ends() {
    let corners = [[0.0, 0.0], [4.0, 0.0], [1.0, 3.0], [2.0, -3.0], [2.0, 2.0]];
    let cases = [
        // Wound alike on opposite sides; turned over; folded; folded and turned over; three at an
        // edge.
        (vec![[0, 1, 2], [1, 0, 3]], [true, true]),
        (vec![[0, 1, 2], [0, 1, 3]], [true, false]),
        (vec![[0, 1, 2], [1, 0, 4]], [false, false]),
        (vec![[0, 1, 2], [0, 1, 4]], [false, false]),
        (vec![[0, 1, 2], [1, 0, 3], [1, 0, 4]], [false, false]),
    ];
    for (triangles, expected) in cases {
        let mesh = Mesh {
            positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).into(),
            normal_indices: vec![[0; 3]; triangles.len()],
            normals: vec![Vec3::Z],
            triangles: triangles.clone(),
            ..Mesh::default()
        };
        let light = DirectionalLight::new(DVec3::Z);
        let adjacency = Adjacency::new(&mesh);
        let space = LightSpace::new(&mesh, &light, 64);
        let adjacent = [Cull::None, Cull::Front].map(|cull| {
            let casters = Casters::new(&mesh, &adjacency, space, cull);
            assert!(casters.casts(0, 0.0));
            [-1e-4, 0.0, 1e-4].map(|leeway| casters.adjacent_triangle(0, 0, leeway).is_some())
        });
        assert_eq!(
            adjacent,
            expected.map(|adjacent| [adjacent; 3]),
            "{triangles:?}"
        );
    }
}

#[test]
fn wrong_input_is_an_error() {
    let (mesh, camera) = (floor(), from_above(1.0, [4, 4]));
    let adjacency = Adjacency::new(&mesh);
    let cpu = cpu_reference(Method::Crsm, 8);
    let dark = DirectionalLight::new(DVec3::ZERO);
    assert!(matches!(
        cpu.maps(&mesh, &adjacency, &dark).err(),
        Some(Error::Light(_))
    ));
    let maps = cpu.maps(&mesh, &adjacency, &light(0.0, -1.0, 0.0)).unwrap();
    let classify = |primitives: &[u32]| {
        maps.classify(&camera, primitives, Progress::default())
            .err()
    };
    assert!(matches!(classify(&[0; 15]), Some(Error::PixelCount { .. })));
    assert!(matches!(
        classify(&[7; 16]),
        Some(Error::UnknownPrimitive { primitive: 7, .. })
    ));
    assert_eq!(classify(&[u32::MAX; 16]), None);
}
