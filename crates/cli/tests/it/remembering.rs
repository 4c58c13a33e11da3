//! The table of `compare` on methods that remember. Needs an adapter; their figures are tested in
//! `crates/compare`.

use crate::support::{results, temporal};
use std::fs;

#[test]
fn the_table_names_a_method_that_remembers() {
    let folder = tempfile::tempdir().unwrap();
    temporal(folder.path());
    for subject in ["", "--path walk"] {
        let line = format!(
            "compare temporal.ron --size 48x48 --images none --replace --out out --frames 1 \
             --warmup 0 --cached-frames 0 {subject}"
        );
        let (_, table) = results(folder.path(), &line);
        assert!(table.contains("temporal.ron remembers"), "{table}");
    }
}

#[test]
fn the_table_says_after_how_many_frames_a_picture_repeats() {
    let folder = tempfile::tempdir().unwrap();
    let document = r#"(
        format: 3,
        description: "All in shadow in two frames of three, and all in light in the third.",
        materials: [Texture(name: "visibility", format: R32Uint)],
        passes: [Fullscreen(name: "blink", color: ["visibility"])],
        outputs: ["visibility"],
    )"#;
    let shader = "#import \"shared/frame.wgsl\"
        @fragment fn fragment() -> @location(0) u32 { return u32(frame.index % 3u == 0u); }";
    fs::write(folder.path().join("blink.ron"), document).unwrap();
    fs::write(folder.path().join("blink.wgsl"), shader).unwrap();
    let line = "compare blink.ron --size 48x48 --images none --frames 1 --out out";
    let (_, table) = results(folder.path(), line);
    assert!(table.contains("repeats every 3 frames"), "{table}");
}
