//! The generated park: what its nine views promise, and that its parts are closed solids that touch
//! nothing.

use crate::common::{cast, nearest};
use crate::solids::{CLEARANCE, are_apart, are_closed, are_welded, area, components, winding};
use glam::DVec3;
use skiagraph_scene::{Bvh, Parts, Scene, SceneLibrary};
use std::{collections::HashMap, sync::LazyLock};

static PARK: LazyLock<(Scene, Bvh)> = LazyLock::new(|| {
    let (scene, _) = SceneLibrary::default().load("park").unwrap();
    let bvh = Bvh::build(&scene.mesh);
    (scene, bvh)
});

#[test]
fn about_55_000_triangles_in_seven_groups() {
    let mesh = &PARK.0.mesh;
    assert!(
        (54_000..56_000).contains(&mesh.triangles.len()),
        "{}",
        mesh.triangles.len()
    );
    let names: Vec<&str> = mesh
        .groups
        .iter()
        .map(|group| group.name.as_str())
        .collect();
    assert_eq!(
        names,
        [
            "lawn", "bench", "lamp", "planter", "flowers", "tree 1", "tree 2"
        ]
    );
    let mut next = 0;
    for group in &mesh.groups {
        assert_eq!(group.triangles.start, next);
        next = group.triangles.end;
    }
    assert_eq!(next as usize, mesh.triangles.len());
}

#[test]
fn big_triangles_in_the_trees_and_tiny_ones_in_the_flowers() {
    let mesh = &PARK.0.mesh;
    let median_area = |name: &str| {
        let group = mesh.groups.iter().find(|group| group.name == name).unwrap();
        let mut areas: Vec<f64> = group
            .triangles
            .clone()
            .map(|p| area(mesh.corners(p)))
            .collect();
        areas.sort_by(f64::total_cmp);
        areas[areas.len() / 2]
    };
    assert!(median_area("flowers") < 0.02, "{}", median_area("flowers"));
    assert!(median_area("tree 1") > 1.0, "{}", median_area("tree 1"));
}

#[test]
fn no_flat_face_of_the_furniture_lies_along_the_light() {
    let (scene, _) = &*PARK;
    let to_light = scene.light().towards(glam::DVec3::ZERO).direction;
    for name in ["lawn", "bench", "planter"] {
        let group = scene.mesh.groups.iter().find(|group| group.name == name);
        for primitive in group.unwrap().triangles.clone() {
            let [a, b, c] = scene.mesh.corners(primitive);
            let cosine = (b - a).cross(c - a).normalize().dot(to_light);
            assert!(cosine.abs() > 0.03, "{name}, near {a}: {cosine}");
        }
    }
}

#[test]
fn the_same_bits_everywhere() {
    // FNV-1a over positions and indices. Change it only together with the park's design:
    // measurements refer to it.
    let mesh = &PARK.0.mesh;
    let words = mesh
        .positions
        .iter()
        .flat_map(|p| p.to_array().map(f32::to_bits))
        .chain(mesh.triangles.iter().flatten().copied());
    let hash = words
        .flat_map(u32::to_le_bytes)
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
    assert_eq!(format!("{hash:016x}"), "f8793b64a85315ee");
}

#[test]
fn parts_are_closed_welded_and_apart() {
    let (scene, bvh) = &*PARK;
    are_welded(&scene.mesh);
    let parts = are_closed(&scene.mesh);
    assert!(parts > 1_500);
    assert_eq!(Parts::new(&scene.mesh).open, vec![false; parts]);
    // The test must have had something to do.
    assert!(are_apart(&scene.mesh, bvh) > 1_000);
}

#[test]
fn no_part_is_inside_another_and_no_eye_is_inside_a_part() {
    let (scene, bvh) = &*PARK;
    let component = components(&scene.mesh);
    let first_of: HashMap<usize, usize> = component
        .iter()
        .enumerate()
        .rev()
        .map(|(i, &part)| (part, i))
        .collect();
    for &triangle in first_of.values() {
        // A point just outside a part lies outside all of them.
        let [a, b, c] = scene.mesh.corners(triangle as u32);
        let outwards = (b - a).cross(c - a).normalize();
        assert_eq!(
            winding(
                &scene.mesh,
                bvh,
                (a + b + c) / 3.0 + outwards * (CLEARANCE / 4.0)
            ),
            0,
            "near {a}"
        );
    }
    for view in &scene.views {
        assert_eq!(winding(&scene.mesh, bvh, view.eye), 0, "{}", view.name);
    }
    assert_eq!(
        winding(&scene.mesh, bvh, DVec3::new(0.0, -0.5, 0.0)),
        1,
        "inside the lawn's slab"
    );
}

#[test]
fn every_view_sees_ground_to_its_borders() {
    let (scene, bvh) = &*PARK;
    for view in &scene.views {
        for (width, height) in [(96, 96), (160, 90)] {
            let camera = view.camera([width, height]);
            for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
                let hit = nearest(&scene.mesh, bvh, camera.eye, camera.pixel_direction(x, y));
                let hit = hit.unwrap_or_else(|| {
                    panic!(
                        "{} sees background at {x}, {y} of {width}×{height}",
                        view.name
                    )
                });
                assert!(
                    view.near < hit.t && hit.t < view.far,
                    "{}: {}",
                    view.name,
                    hit.t
                );
            }
        }
    }
}

#[test]
fn the_views_face_the_light_and_show_light_and_shadow() {
    let (scene, bvh) = &*PARK;
    let to_light = scene.light().towards(glam::DVec3::ZERO).direction;
    for view in &scene.views {
        let (name, camera) = (&view.name, view.camera([96, 96]));
        let (mut facing, mut shadow) = (0, 0);
        for (x, y) in (0..96).flat_map(|x| (0..96).map(move |y| (x, y))) {
            let Some(hit) = nearest(&scene.mesh, bvh, camera.eye, camera.pixel_direction(x, y))
            else {
                continue;
            };
            if hit.normal(&scene.mesh).dot(to_light) <= 0.0 {
                continue;
            }
            facing += 1;
            let point = camera.eye + camera.pixel_direction(x, y) * hit.t;
            let lit = cast(&scene.mesh, bvh, point, to_light, |blocker| {
                blocker.primitive == hit.primitive
            });
            shadow += i32::from(!lit);
        }
        let shares = (
            f64::from(facing) / 92.16,
            100.0 * f64::from(shadow) / f64::from(facing),
        );
        assert!(shares.0 > 90.0, "{name}: {:.1} % face the light", shares.0);
        assert!(
            (20.0..60.0).contains(&shares.1),
            "{name}: {:.1} % in shadow",
            shares.1
        );
    }
}

#[test]
fn in_the_trees_views_only_shadows_of_the_trees_are_seen() {
    let (scene, bvh) = &*PARK;
    for view in scene
        .views
        .iter()
        .filter(|view| view.name.starts_with("trees"))
    {
        let camera = view.camera([96, 96]);
        for (x, y) in (0..96).flat_map(|x| (0..96).map(move |y| (x, y))) {
            let hit = nearest(&scene.mesh, bvh, camera.eye, camera.pixel_direction(x, y)).unwrap();
            assert!(
                scene.mesh.groups[0].triangles.contains(&hit.primitive),
                "{} sees more than the lawn",
                view.name
            );
        }
    }
}
