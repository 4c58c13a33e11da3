//! `skiagraph adapter`: rows in processes of their own, kept and joined.

use crate::support::skiagraph;
use serde_json::Value;
use std::{fs, path::Path, process::Output};

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

fn fine(output: Output) -> String {
    let told = text(&output.stderr);
    assert!(output.status.success(), "{told}");
    told
}

#[test]
fn rows_are_kept_gone_on_with_and_joined() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let line = "adapter --small --out one --only hard,park";
    let told = fine(skiagraph(folder.path(), line));
    assert!(
        told.contains("1/2 hard") && told.contains("2/2 park"),
        "{told}"
    );
    let record = json(&place("one/adapter.json"));
    assert_eq!(record["rows"][0]["outcome"], "done", "{record}");
    assert!(record["abilities"]["machine"]["host"].is_null());
    let hard = &record["rows"][0]["figures"]["hard"];
    assert!(
        hard.as_array().unwrap().iter().all(|it| it["failed"] == 0),
        "{hard}"
    );
    let equal = record["rows"][1]["figures"]["equal"].as_array().unwrap();
    assert_eq!(equal.len(), 2, "{equal:?}");
    assert!(
        equal
            .iter()
            .all(|it| it["differing"] == 0 && it["pixels"] == 48 * 48)
    );
    let cells = record["rows"][1]["figures"]["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 4);
    let exact = cells.iter().filter(|cell| cell["is_exact"] == true);
    assert!(exact.clone().count() == 3 && exact.clone().all(|it| it["wrong_outside"] == 0));
    assert_eq!(json(&place("one/park/row.json")), record["rows"][1]);

    // A row that was killed is run, one that is there is not.
    let mut cut = record.clone();
    cut["rows"].as_array_mut().unwrap().remove(0);
    fs::write(place("one/adapter.json"), cut.to_string()).unwrap();
    let told = fine(skiagraph(folder.path(), line));
    assert!(
        told.contains("2/2 park: kept") && !told.contains("1/2 hard: kept"),
        "{told}"
    );

    // Another adapter's folder is not gone on with.
    let mut other = record.clone();
    other["abilities"]["adapter"]["driver"] = "some driver 1.2".into();
    other["rows"][1]["figures"]["cells"][3]["wrong"] = 1.into();
    fs::create_dir(place("two")).unwrap();
    fs::write(place("two/adapter.json"), other.to_string()).unwrap();
    let refused = skiagraph(folder.path(), "adapter --small --out two --only hard");
    assert_eq!(refused.status.code(), Some(1));
    assert!(
        text(&refused.stderr).contains("some driver 1.2"),
        "{}",
        text(&refused.stderr)
    );

    fine(skiagraph(
        folder.path(),
        "merge one two/adapter.json --out all",
    ));
    let page = fs::read_to_string(place("all/adapters.md")).unwrap();
    assert!(
        page.contains("some driver 1.2") && page.contains("| nsm on park"),
        "{page}"
    );
    assert!(place("all/report.html").exists() && place("all/results.json").exists());
    // Again, of what is there.
    fine(skiagraph(folder.path(), "merge two/adapter.json --out all"));
    assert_eq!(fs::read_to_string(place("all/adapters.md")).unwrap(), page);
}

#[test]
fn what_cannot_be_asked_is_told() {
    let folder = tempfile::tempdir().unwrap();
    for (line, code, words) in [
        ("adapter --small --only hardd", 2, "hard"),
        ("adapter --adapter nothing-like-it", 3, "nothing-like-it"),
        ("adapter --minutes 0", 2, "1..=1440"),
    ] {
        let output = skiagraph(folder.path(), line);
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{line}: {told}");
        assert!(told.contains(words), "{line}: {told}");
    }
}
