//! City and forest in all sizes: as many triangles as asked for, sound, the same every time, and
//! what their views promise.

use crate::common::{cast, nearest};
use crate::solids::{are_apart, are_closed, are_welded, winding};
use glam::DVec3;
use proptest::prelude::*;
use skiagraph_scene::{
    Bvh, Mesh, Scene, SceneError, SceneLibrary,
    generate::{Generator, TRIANGLES},
};

fn generators(triangles: u32) -> [Generator; 2] {
    [
        Generator::City { triangles },
        Generator::Forest { triangles },
    ]
}

fn scene(argument: &str) -> Result<Scene, SceneError> {
    let loaded = SceneLibrary::default().load(argument);
    loaded.map(|(scene, _)| scene)
}

/// Everything that can be asked of a mesh of any size in time linear in it.
fn is_sound(mesh: &Mesh, triangles: u32) -> Result<(), TestCaseError> {
    let off = mesh.triangles.len() as f64 / f64::from(triangles) - 1.0;
    prop_assert!(off.abs() < 0.03, "{} of {triangles}", mesh.triangles.len());
    prop_assert!(mesh.positions.iter().all(|p| p.is_finite()));
    prop_assert!(mesh.normals.iter().all(|n| n.is_normalized()));
    prop_assert_eq!(mesh.triangles.len(), mesh.normal_indices.len());
    let all_below = |indices: &[[u32; 3]], count: usize| {
        indices
            .iter()
            .flatten()
            .all(|&index| (index as usize) < count)
    };
    prop_assert!(all_below(&mesh.triangles, mesh.positions.len()));
    prop_assert!(all_below(&mesh.normal_indices, mesh.normals.len()));
    // Groups follow each other without a gap.
    let mut next = 0;
    for group in &mesh.groups {
        prop_assert_eq!(group.triangles.start, next, "{}", &group.name);
        next = group.triangles.end;
    }
    prop_assert_eq!(next as usize, mesh.triangles.len());
    Ok(())
}

fn bits(mesh: &Mesh) -> impl Iterator<Item = u32> + '_ {
    let floats = mesh.positions.iter().chain(&mesh.normals);
    let indices = mesh.triangles.iter().chain(&mesh.normal_indices);
    floats
        .flat_map(|v| v.to_array().map(f32::to_bits))
        .chain(indices.flatten().copied())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_size_has_its_triangles_is_sound_and_the_same_twice(
        triangles in *TRIANGLES.start()..300_000u32,
    ) {
        for generator in generators(triangles) {
            let mesh = generator.build();
            is_sound(&mesh, triangles)?;
            prop_assert!(bits(&mesh).eq(bits(&generator.build())), "{}", generator);
        }
    }
}

#[test]
#[ignore = "minutes; `bash .ci/long` runs it"]
fn ci_long_ten_million_are_sound_and_within_every_adapters_bindings() {
    let triangles = *TRIANGLES.end();
    for generator in generators(triangles) {
        let mesh = generator.build();
        is_sound(&mesh, triangles).unwrap();
        // 128 MiB is what Vulkan promises, 16 bytes what a position takes on the device.
        let most = mesh.positions.len().max(mesh.normals.len()) * 16;
        assert!(most <= 128 << 20, "{generator}: {most} bytes");
    }
}

/// FNV-1a over all numbers. Change them only together with the design: measurements refer to it.
#[test]
fn the_same_bits_everywhere() {
    let hashes = generators(20_000).map(|generator| {
        let mesh = generator.build();
        let hash = bits(&mesh)
            .flat_map(u32::to_le_bytes)
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            });
        format!("{generator} {hash:016x}")
    });
    insta::assert_snapshot!(
        hashes.join(", "),
        @"city:20000 ae2a17c6e04d5ecf, forest:20000 36182a94c1fd066b"
    );
}

#[test]
fn parts_are_closed_welded_and_apart() {
    for (generator, parts) in generators(150_000).into_iter().zip([10_000, 5_000]) {
        let mesh = generator.build();
        are_welded(&mesh);
        let closed = are_closed(&mesh);
        assert!(closed > parts, "{generator}: {closed}");
        // The test must have had something to do.
        assert!(are_apart(&mesh, &Bvh::build(&mesh)) > 1_000);
    }
}

#[test]
fn the_avenue_is_closed_and_2000_units_long() {
    let scene = scene("avenue").unwrap();
    let mesh = &scene.mesh;
    are_welded(mesh);
    assert!(are_closed(mesh) > 2000);
    let bvh = Bvh::build(mesh);
    // No two parts even come near.
    assert_eq!(are_apart(mesh, &bvh), 0);
    let (min, max) = mesh.bounds().unwrap();
    assert_eq!((max - min).z, 2000.0);
    assert!(bits(mesh).eq(bits(&Generator::Avenue.build())));
    for view in &scene.views {
        assert_eq!(winding(mesh, &bvh, view.eye), 0, "{}", view.name);
    }
}

/// Meshes for which maps are dear: sheets without an inside, few triangles, each many times as
/// large as the cells of a map.
#[test]
fn the_level_is_of_large_open_sheets() {
    let scene = scene("level").unwrap();
    let mesh = &scene.mesh;
    are_welded(mesh);
    assert_eq!(mesh.triangles.len(), 3168);
    assert!(bits(mesh).eq(bits(&Generator::Level.build())));
    let mut edges = std::collections::HashMap::new();
    for corners in &mesh.triangles {
        for side in 0..3 {
            let ends = [corners[side], corners[(side + 1) % 3]];
            let key = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            *edges.entry(key).or_insert(0) += 1;
        }
    }
    let open = edges.values().filter(|&&triangles| triangles == 1).count();
    assert!(
        4 * open > edges.len(),
        "{open} of {} edges are open",
        edges.len()
    );
    let areas = (0..3168).map(|primitive| {
        let [a, b, c] = mesh.corners(primitive);
        (b - a).cross(c - a).length() / 2.0
    });
    assert!(areas.sum::<f64>() > 20_000.0);
}

/// The larger scene has the smaller one's ground, houses or ride: eyes stay outside, and a ray
/// through the middle of the picture passes more and more surfaces.
#[test]
fn eyes_are_outside_and_depth_complexity_grows() {
    for name in ["city", "forest"] {
        let scenes = ["10_000", "100_000", "1_000_000"]
            .map(|size| scene(&format!("{name}:{size}")).unwrap());
        let bvhs = scenes.each_ref().map(|scene| Bvh::build(&scene.mesh));
        assert_eq!(scenes[0].views.len(), 2);
        for index in 0..2 {
            let surfaces = [0, 1, 2].map(|size| {
                let (scene, bvh) = (&scenes[size], &bvhs[size]);
                let view = &scene.views[index];
                assert_eq!(
                    winding(&scene.mesh, bvh, view.eye),
                    0,
                    "{name}, {}",
                    view.name
                );
                surfaces(scene, bvh, index)
            });
            let [few, more, most] = surfaces;
            assert!(
                few < more && more < most,
                "{name}, view {index}: {surfaces:?}"
            );
        }
    }
}

#[test]
fn every_view_shows_light_and_shadow() {
    // A forest of few trees has few shadows.
    for (name, least) in [
        ("city:30_000", 100),
        ("city:600_000", 100),
        ("forest:600_000", 20),
    ] {
        let scene = scene(name).unwrap();
        let bvh = Bvh::build(&scene.mesh);
        let to_light = scene.light().towards(glam::DVec3::ZERO).direction;
        for view in &scene.views {
            let camera = view.camera([64, 36]);
            let (mut lit, mut shadow) = (0, 0);
            for (x, y) in (0..64).flat_map(|x| (0..36).map(move |y| (x, y))) {
                let direction = camera.pixel_direction(x, y);
                let Some(hit) = nearest(&scene.mesh, &bvh, camera.eye, direction) else {
                    continue;
                };
                assert!(
                    view.near < hit.t && hit.t < view.far,
                    "{name}, {}: {}",
                    view.name,
                    hit.t
                );
                if hit.normal(&scene.mesh).dot(to_light) <= 0.0 {
                    continue;
                }
                let point = camera.eye + direction * hit.t;
                let sees = cast(&scene.mesh, &bvh, point, to_light, |blocker| {
                    blocker.primitive == hit.primitive
                });
                *(if sees { &mut lit } else { &mut shadow }) += 1;
            }
            let places = format!("{name}, {}: {lit} lit, {shadow} in shadow", view.name);
            assert!(lit > 100 && shadow > least, "{places}");
        }
    }
}

/// Surfaces that the rays of a small picture cross, all together.
fn surfaces(scene: &Scene, bvh: &Bvh, view: usize) -> u32 {
    let camera = scene.views[view].camera([32, 18]);
    let mut count = 0;
    for (x, y) in (0..32).flat_map(|x| (0..18).map(move |y| (x, y))) {
        let direction: DVec3 = camera.pixel_direction(x, y);
        cast(&scene.mesh, bvh, camera.eye, direction, |_| {
            count += 1;
            true
        });
    }
    count
}

#[test]
fn a_size_that_cannot_be_had_says_why() {
    let error = |argument: &str| scene(argument).unwrap_err().to_string();
    insta::assert_snapshot!(
        ["city:9999", "forest:many", "park:20000", "sponza:20000"].map(error).join("\n"),
        @r#"
    "city:9999": "9999" is not a number of triangles from 10000 to 10000000
    "forest:many": "many" is not a number of triangles from 10000 to 10000000
    "park:20000": the mesh "park" has but one size
    "sponza:20000": the mesh "sponza/sponza.obj" is a file of one size
    "#
    );
    assert!(error("town:20000").starts_with("no scene \"town\": it is neither"));
    assert!(error(":20000").starts_with("no scene \":20000\": it is neither"));
}
