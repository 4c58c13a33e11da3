//! `skiagraph check`: hosts that it plans for, and faults that it finds; small pictures.

use crate::support::{results, skiagraph};
use std::{fs, path::Path, process::Output};
use tempfile::TempDir;

/// The files of `tests/it/checked`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/checked");
    for file in fs::read_dir(from).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    folder
}

/// A document in the folder: its sections after the format.
fn write(folder: &TempDir, name: &str, sections: &str) {
    let text = format!("(format: 3, {sections})");
    fs::write(folder.path().join(name), text).unwrap();
    let shader = "@fragment fn fragment() -> @location(0) f32 { return 1.0; }";
    fs::write(folder.path().join("fill.wgsl"), shader).unwrap();
}

/// Exit code and all that is said, on one line.
fn said(folder: &TempDir, line: &str) -> (i32, String) {
    let Output {
        status,
        stdout,
        stderr,
    } = skiagraph(folder.path(), line);
    let text = [stdout, stderr].concat();
    let text = String::from_utf8(text).unwrap();
    let words: Vec<&str> = text.split_whitespace().collect();
    (status.code().unwrap(), words.join(" "))
}

#[track_caller]
fn assert_said(folder: &TempDir, line: &str, code: i32, part: &str) {
    let (exit, text) = said(folder, line);
    assert!(
        exit == code && text.contains(part),
        "{line}: {exit}: {text}"
    );
}

/// A fault that only a stand-in of `check` has names it; with what the document is made for there
/// is none.
#[test]
fn a_fault_of_a_stand_in_names_it() {
    let folder = folder();
    let one = "× for one light: `lights[1]` does not exist";
    assert_said(&folder, "check two.ron", 1, one);
    assert_said(
        &folder,
        "check two.ron",
        1,
        "`needs: [\"lights.count >= 2\"]`",
    );
    assert_said(
        &folder,
        "check two_if.ron",
        1,
        "× for one light: pass `shade` reads a part of",
    );
    for document in ["two.ron", "two_if.ron"] {
        let line = format!("check {document} --scene twolights.ron");
        let fine = "passes for 64×64 pixels and the scene twolights";
        assert_said(&folder, &line, 0, fine);
    }
    let image = "materials: [Texture(name: \"image\", format: R32Float";
    let rest = "outputs: [\"image\"]";
    let fill = "passes: [Fullscreen(name: \"fill\", color: [\"image\"]";
    let narrow = format!("{image}, size: \"viewport.width - 100\")], {fill})], {rest}");
    write(&folder, "narrow.ron", &narrow);
    let faulty = "× for 64×64 pixels: `viewport.width - 100` is -36, below 0";
    assert_said(&folder, "check narrow.ron", 1, faulty);
    let fine = "narrow.ron: fine, 1 pass for 101×1 pixels";
    assert_said(&folder, "check narrow.ron --size 101x1", 0, fine);
    let least = format!("needs: [\"viewport.width > 100\"], {narrow}");
    write(&folder, "wide.ron", &least);
    assert_said(
        &folder,
        "check wide.ron",
        0,
        "1 pass for 1920×1080 pixels, a small scene",
    );
    let refused = "`wide.ron` needs `viewport.width > 100`";
    assert_said(&folder, "check wide.ron --size 100x100", 1, refused);
    let many = format!("{image})], {fill}, repeat: \"scene.indices.count / 100000\")], {rest}");
    write(&folder, "many.ron", &many);
    let faulty = "× for a small scene: no pass writes the output `image`";
    assert_said(&folder, "check many.ron", 1, faulty);
    let large = format!("needs: [\"scene.indices.count > 100000\"], {many}");
    write(&folder, "large.ron", &large);
    assert_said(&folder, "check large.ron", 0, "large.ron: fine");
    // A fault of every host names none.
    write(
        &folder,
        "never.ron",
        &format!("{image}, size: \"1 - 2\")], {fill})], {rest}"),
    );
    assert_said(&folder, "check never.ron", 1, "× `1 - 2` is -1, below 0");
}

/// Adds the section to a document that `check` advises, and returns it.
fn with_advice(folder: &TempDir, name: &str) -> String {
    let (_, output) = said(folder, &format!("check {name}"));
    let (_, advice) = output.split_once("`needs: ").expect("advice");
    let (needs, _) = advice.split_once('`').unwrap();
    let path = folder.path().join(name);
    let text = fs::read_to_string(&path).unwrap();
    let needed = format!("format: 3, needs: {needs},");
    fs::write(path, text.replacen("format: 3,", &needed, 1)).unwrap();
    needs.to_owned()
}

/// In a comparison the scene is known: faults of stand-ins for one are none there.
#[test]
fn a_faulty_document_in_a_comparison_has_no_faults_of_stand_ins() {
    let folder = folder();
    let two = fs::read_to_string(folder.path().join("two.ron")).unwrap();
    let faulty = two.replace("color: [\"image\"]", "color: [\"imagee\"]");
    fs::write(folder.path().join("faulty.ron"), faulty).unwrap();
    let line = "compare rt faulty.ron --scene twolights.ron --size 16x16 --frames 1 --warmup 0 \
                --images none --out out";
    let (code, output) = said(&folder, line);
    assert_eq!(code, 1, "{output}");
    assert!(output.contains("`imagee`"), "{output}");
    assert!(
        !output.contains("`lights[1]` does not exist") && !output.contains("for one light"),
        "{output}"
    );
}

/// Numbers of lights are tried as values of params are, from one to three.
#[test]
fn numbers_of_lights_are_tried() {
    let folder = folder();
    let two = fs::read_to_string(folder.path().join("two.ron")).unwrap();
    let needs = two.replace(
        "format: 3,",
        "format: 3,\n    needs: [\"lights.count >= 2\"],",
    );
    fs::write(folder.path().join("needs.ron"), &needs).unwrap();
    let fine = "for 64×64 pixels, a small scene and 2 to 3 lights";
    assert_said(&folder, "check needs.ron", 0, fine);
    assert_said(&folder, "show needs.ron", 0, "lights[1]");
    let refused = "`needs.ron` needs `lights.count >= 2`";
    assert_said(&folder, "run needs.ron --size 8x8", 1, refused);
    let image = "materials: [Texture(name: \"image\", format: R32Float)]";
    for (condition, faulty) in [
        (
            "lights.count > 2",
            "× for 3 lights: `fill.wgsl` has no fragment entry point",
        ),
        (
            "lights.count == 2",
            "× for 2 lights: `fill.wgsl` has no fragment entry point",
        ),
    ] {
        let sections = format!(
            "{image}, passes: [Fullscreen(name: \"fill\", color: [\"image\"]), \
             Fullscreen(name: \"more\", shader: \"fill\", if: \"{condition}\")], \
             outputs: [\"image\"]"
        );
        write(&folder, "counts.ron", &sections);
        assert_said(&folder, "check counts.ron", 1, faulty);
        let advised = with_advice(&folder, "counts.ron");
        assert!(advised.contains("lights.count <= "), "{advised}");
        assert_said(&folder, "check counts.ron", 0, "counts.ron: fine");
    }
    for light in ["lights[1]", "lights[2]"] {
        fs::write(
            folder.path().join("further.ron"),
            two.replace("lights[1]", light),
        )
        .unwrap();
        assert_said(&folder, "check further.ron", 1, "× for one light: ");
        with_advice(&folder, "further.ron");
        assert_said(&folder, "check further.ron", 0, "further.ron: fine");
    }
    assert_said(
        &folder,
        "check rt",
        0,
        "rt: fine, 6 passes for 64×64 pixels, a small scene and one light",
    );
}

/// `--light` is a kind, a direction, or a light of the scene.
#[test]
fn a_light_is_chosen() {
    let folder = folder();
    assert_said(&folder, "check crsm --light directional", 0, "crsm: fine");
    assert_said(&folder, "check crsm --light 0,-1,0", 0, "crsm: fine");
    assert_said(
        &folder,
        "check crsm --light point",
        1,
        "takes no point light",
    );
    assert_said(
        &folder,
        "check crsm --scene twolights.ron --light bulb",
        1,
        "takes no point light",
    );
    assert_said(
        &folder,
        "check crsm --scene twolights.ron --light lamp",
        0,
        "crsm: fine",
    );
    let unknown = "name it with --scene, or a kind: directional, spot, point";
    assert_said(&folder, "check crsm --light bulb", 2, unknown);
}

/// A mark of the bytes' order is passed over in documents and shaders, and so is the picture.
#[test]
fn a_byte_order_mark_is_passed_over() {
    let folder = folder();
    assert_said(
        &folder,
        "check bom_facing.ron",
        0,
        "bom_facing.ron: fine, 3 passes",
    );
}

/// A `LoadIf` that may clear an area is refused, and the `Clear` that stands above clears a depth
/// texture to what its test compares with, as the message prints it.
#[test]
fn a_clear_in_the_place_of_a_load_clears_depths_to_one() {
    let folder = folder();
    let refused = "× clearing knows no area";
    assert_said(&folder, "check loadif.ron", 1, refused);
    let ok = fs::read_to_string(folder.path().join("ok.ron")).unwrap();
    let clear = "Clear(name: \"clear\", target: \"atlas\", value: 1),";
    assert!(ok.contains(clear));
    fs::write(folder.path().join("bare.ron"), ok.replace(clear, "")).unwrap();
    let (_, text) = said(&folder, "check bare.ron");
    let printed = text.split('`').find(|code| code.starts_with("Clear("));
    let printed = printed.unwrap_or_else(|| panic!("{text}"));
    fs::write(
        folder.path().join("mended.ron"),
        ok.replace(clear, &format!("{printed},")),
    )
    .unwrap();
    let wrong = |document: &str| {
        let (runs, _) = results(
            folder.path(),
            &format!("compare {document} --size 32x32 --frames 1 --warmup 0 --out out"),
        );
        runs[0]["wrong"].clone()
    };
    assert_eq!(wrong("mended.ron"), wrong("ok.ron"));
}

/// A multisampled texture that no pass draws into is named, though no shader reads a texel of it.
#[test]
fn a_multisampled_texture_that_is_only_bound() {
    let folder = folder();
    let faulty = "no pass draws to the multisampled texture `t`";
    assert_said(&folder, "check ms.ron", 1, faulty);
    assert_said(&folder, "run ms.ron --size 8x8", 1, faulty);
}

/// Methods with rays run from one pixel on.
#[test]
fn few_pixels_are_enough() {
    let folder = folder();
    for size in ["1x1", "7x9", "1x63"] {
        let line = format!(
            "compare rt light_buffer crsm rt_area --scene plain.obj --size {size} --frames 1 \
             --warmup 0 --out out"
        );
        let (runs, table) = results(folder.path(), &line);
        assert!(runs.len() >= 4, "{size}: {table}");
    }
}
