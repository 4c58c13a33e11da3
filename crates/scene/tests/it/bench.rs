//! The dissertation's own park, where its folder is at hand.

use skiagraph_scene::{Parts, SceneLibrary, library::ASSETS_VARIABLE};

#[test]
fn bench_has_the_dissertations_triangles_and_few_closed_parts() {
    if std::env::var_os(ASSETS_VARIABLE).is_none() {
        println!(
            "nothing tested: {ASSETS_VARIABLE} does not name a folder that holds bench/bench.obj"
        );
        return;
    }
    let (scene, report) = SceneLibrary::from_environment().load("bench").unwrap();
    // The dissertation's 55,026 triangles are about its 55,020 indices.
    assert_eq!(3 * scene.mesh.triangles.len(), 55_020);
    assert_eq!((report.points, report.lines), (0, 0));
    assert_eq!(report.dropped.triangles, 0);
    let parts = Parts::new(&scene.mesh);
    let closed = parts.open.iter().filter(|&&open| !open).count();
    let in_open =
        (0..scene.mesh.triangles.len() as u32).filter(|&primitive| parts.is_open(primitive));
    assert_eq!(
        (parts.open.len(), closed, in_open.count()),
        (257, 24, 15_148)
    );
}
