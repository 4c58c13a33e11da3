//! The real Sponza, where its folder is at hand.

use crate::common;
use skiagraph_scene::{Bvh, SceneLibrary, library::ASSETS_VARIABLE};

#[test]
fn sponza_has_the_dissertations_triangles() {
    if std::env::var_os(ASSETS_VARIABLE).is_none() {
        println!(
            "nothing tested: {ASSETS_VARIABLE} does not name a folder that holds sponza/sponza.obj"
        );
        return;
    }
    let (scene, report) = SceneLibrary::from_environment().load("sponza").unwrap();
    assert_eq!(scene.mesh.triangles.len(), 262_267);
    assert_eq!(scene.mesh.groups.len(), 381);
    assert!(
        scene
            .mesh
            .groups
            .iter()
            .all(|group| group.name != "sponza_04")
    );
    assert_eq!((report.points, report.lines), (0, 0));
    assert_eq!(
        (report.dropped.triangles, report.zero_area.triangles),
        (0, 125)
    );

    let bvh = Bvh::build(&scene.mesh);
    assert!(bvh.depth < 50, "{}", bvh.depth);
    // The view's facing-away share at a small size: the dissertation's is 20.9 % at every size.
    let camera = scene.views[0].camera([128, 128]);
    let to_light = scene.light().towards(glam::DVec3::ZERO).direction;
    let mut facing = 0;
    for (x, y) in (0..128).flat_map(|x| (0..128).map(move |y| (x, y))) {
        let direction = camera.pixel_direction(x, y);
        let nearest = common::nearest(&scene.mesh, &bvh, camera.eye, direction);
        facing += i32::from(nearest.unwrap().normal(&scene.mesh).dot(to_light) > 0.0);
    }
    let share = f64::from(facing) / (128.0 * 128.0);
    assert!((share - 829_652.0 / 1_048_576.0).abs() < 0.003, "{share}");
}
