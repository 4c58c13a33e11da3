//! `new`: what it writes passes `check`, and it overwrites nothing. The last test needs an adapter.

use crate::support::{results, skiagraph};
use std::{fs, path::Path};

fn told(folder: &Path, line: &str) -> String {
    let output = skiagraph(folder, line);
    assert!(!output.status.success(), "{line}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn works(folder: &Path, line: &str) -> String {
    let output = skiagraph(folder, line);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {stderr}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn every_variant_passes_check_also_with_all_its_lines_taken() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for preset in ["nsm", "crsm", "rt", "vsm", "light_buffer"] {
        works(folder, &format!("new my_{preset} --from {preset}"));
        let file = folder.join(format!("my_{preset}.ron"));
        works(folder, &format!("check my_{preset}.ron"));
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains("        // \""), "no params: {text}");
        fs::write(&file, text.replace("        // \"", "        \"")).unwrap();
        works(folder, &format!("check my_{preset}.ron"));
    }
}

#[test]
fn nothing_is_overwritten_and_bad_names_say_what_is_good() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("mine.wgsl"), "kept").unwrap();
    assert!(told(folder, "new mine").contains("there is a `mine.wgsl` already"));
    assert!(!folder.join("mine.ron").exists());
    assert_eq!(
        fs::read_to_string(folder.join("mine.wgsl")).unwrap(),
        "kept"
    );
    assert!(told(folder, "new nsm").contains("take another name"));
    assert!(told(folder, "new Mine.ron").contains("a lowercase letter, then"));
    assert!(told(folder, "new other --from crsn").contains("did you mean `crsm`?"));
    assert!(!folder.join("other.ron").exists());
}

#[test]
fn a_new_method_is_compared_with_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let stdout = works(folder.path(), "new mine");
    assert!(
        stdout.starts_with("wrote mine.ron and mine.wgsl\n"),
        "{stdout}"
    );
    works(folder.path(), "check mine.ron");
    let line = "compare rt mine.ron --scene park --size 64x64 --map-size 256 --frames 1 \
                --warmup 0 --images none --out out";
    let (runs, _) = results(folder.path(), line);
    let wrong = |index: usize| {
        let wrong = &runs[index]["wrong"];
        wrong["total"].as_u64().unwrap() - wrong["in_band"].as_u64().unwrap()
    };
    let facing = runs[1]["pixels"]["facing_light"].as_u64().unwrap();
    // It is a shadow map: wrong somewhere, right on most.
    assert_eq!(wrong(0), 0);
    assert!(wrong(1) > 0 && wrong(1) * 4 < facing, "{}", wrong(1));
}
