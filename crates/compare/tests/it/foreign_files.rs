//! Files of other programs have the pictures of their controls.

use crate::support::{NOWHERE, comparison, count, mesh_file, runs};
use glam::DVec3;
use skiagraph_compare::measuring::view_or_path::ViewOrPath;
use skiagraph_scene::{DirectionalLight, View};
use std::path::Path;

/// Pixels that `rt` has in shadow, and those that it has wrong, where all of the mesh is seen.
fn shadow(file: &str) -> (u64, u64) {
    let faults = concat!(env!("CARGO_MANIFEST_DIR"), "/../scene/tests/faults");
    let mut view = View {
        name: "all".into(),
        near: 1.0,
        far: 1e4,
        ..View::default()
    };
    let light = DirectionalLight::new(DVec3::new(-0.4, -1.0, -0.55));
    let scene = mesh_file(&Path::new(faults).join(file), view.clone(), light);
    let (min, max) = scene.mesh.bounds().unwrap();
    let (min, max) = (min.as_dvec3(), max.as_dvec3());
    let distance = (max - min).length() * 0.5 / 30f64.to_radians().sin();
    let away = DVec3::new(0.5, 0.6, 1.0).normalize() * distance;
    (view.eye, view.direction) = ((min + max) * 0.5 + away, -away);
    (view.near, view.far) = (distance * 0.01, distance * 10.0);
    let mut comparison = comparison(scene, &["rt"], NOWHERE.as_ref(), &[]);
    comparison.views = vec![ViewOrPath::Still(view)];
    comparison.viewports = vec![[128, 128]];
    let run = runs(&comparison).remove(0);
    let count = |pointer: &str| count(run.pointer(pointer).unwrap());
    (count("/pixels/shadow"), count("/wrong/certain"))
}

#[test]
fn foreign_files_have_the_pictures_of_their_controls() {
    let control = shadow("quantized-positions/control.gltf");
    assert_eq!(control, (108, 0));
    for (file, pixels) in [
        ("mtl-one-number/plate.obj", 108),
        ("skin-pose/centimetres.gltf", 108),
        ("mask-vertex-alpha/g2_mask_vertex_alpha.gltf", 0),
    ] {
        assert_eq!(shadow(file), (pixels, 0), "{file}");
    }
}
