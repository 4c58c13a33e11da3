//! Files of other programs, from the command line: options that load at once what was refused.

use crate::support::skiagraph;
use std::{fs, path::Path};
use tempfile::TempDir;

fn faults() -> &'static Path {
    Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../scene/tests/faults"
    ))
}

/// A folder with the files of one of `crates/scene/tests/faults/`.
fn folder(fault: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in fs::read_dir(faults().join(fault)).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    folder
}

const COMPARE: &str = "compare rt --size 128x128 --frames 1 --warmup 0 --images none --scene";

#[test]
fn a_bare_mesh_that_is_refused_has_an_option_that_loads_it() {
    let folder = folder("bare-obj-way-out");
    let run = "run rt --size 16x16 --scene";
    for (scene, option) in [
        ("missing_mtl.obj", "--materials ignore"),
        ("missing_mtl.obj", "--materials color"),
        ("bow_tie.obj", "--concave fan"),
    ] {
        let output = skiagraph(folder.path(), &format!("{run} {scene}"));
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(
            stderr.contains(option.split_whitespace().next().unwrap()),
            "{stderr}"
        );
        let output = skiagraph(folder.path(), &format!("{run} {scene} {option}"));
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{stderr}");
    }
    let output = skiagraph(folder.path(), "run rt --scene park --materials ignore");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(
        stderr.contains("leave them out with --scene park"),
        "{stderr}"
    );
}

#[test]
fn a_light_from_below_says_so() {
    let folder = folder("quantized-positions");
    let output = skiagraph(
        folder.path(),
        &format!("{COMPARE} control.gltf --light 0,1,0"),
    );
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    assert!(stderr.contains("shines from below"), "{stderr}");
    assert!(
        stderr.contains("--light 0,-1,0 shines from above"),
        "{stderr}"
    );
    assert!(stderr.contains("has nothing in light"), "{stderr}");
}

/// In a folder whose `pipelines/` or `scenes/` holds another text under a built-in name.
#[test]
fn files_that_stand_in_for_built_in_ones_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let show = skiagraph(folder.path(), "show rt --flat");
    let stderr = String::from_utf8_lossy(&show.stderr);
    assert!(
        show.status.success() && !stderr.contains("stands in"),
        "{stderr}"
    );
    fs::create_dir(folder.path().join("pipelines")).unwrap();
    fs::write(folder.path().join("pipelines/rt.ron"), &show.stdout).unwrap();
    let output = skiagraph(folder.path(), "show rt");
    let stderr = String::from_utf8_lossy(&output.stderr);
    let expected = "./pipelines stands in for built-in presets, which differ: rt";
    assert!(stderr.contains(expected), "{stderr}");
}
