//! docs/tutorial.md, typed as it stands there: every file written, every command run. Needs an
//! adapter.

use crate::support::skiagraph;
use serde_json::Value;
use std::{fs, path::Path};

/// The fenced blocks in their order, each with its language and the last file named before it.
fn blocks(text: &str) -> Vec<(String, Option<String>, String)> {
    let mut blocks = Vec::new();
    let mut named = None;
    for (index, part) in text.split("```").enumerate() {
        if index % 2 == 0 {
            let words = part.split('`').skip(1).step_by(2);
            let is_file = |word: &&str| word.ends_with(".ron") || word.ends_with(".wgsl");
            named = words.filter(is_file).last().map(str::to_owned).or(named);
            continue;
        }
        let (language, body) = part.split_once('\n').unwrap();
        blocks.push((language.to_owned(), named.clone(), body.to_owned()));
    }
    blocks
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn the_tutorial_can_be_typed() {
    let text = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/tutorial.md");
    let text = fs::read_to_string(text).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (mut files, mut commands) = (0, 0);
    for (language, file, body) in blocks(&text) {
        if language == "sh" {
            for line in body.lines() {
                let line = line.strip_prefix("skiagraph ").expect("a command of ours");
                let output = skiagraph(folder, line);
                let told = String::from_utf8_lossy(&output.stderr);
                assert!(output.status.success(), "{line}: {told}");
                commands += 1;
            }
        } else {
            let file = file.expect("the file is named before it");
            let is_shader = file.ends_with(".wgsl");
            assert_eq!(
                language == "wgsl",
                is_shader,
                "{file} is shown as {language}"
            );
            fs::write(folder.join(file), body).unwrap();
            files += 1;
        }
    }
    assert!(
        files == 5 && commands > 10,
        "{files} files, {commands} commands"
    );

    // A blur brings it nearer to the wide light than none, and it stands beside the built-in ones.
    let rmse = |folder: &Path, name: &str| {
        let text = fs::read_to_string(folder.join("results.json")).unwrap();
        let results: Value = serde_json::from_str(&text).unwrap();
        let runs = results["runs"].as_array().unwrap();
        let run = runs.iter().find(|run| run["preset"] == name);
        let run = run.unwrap_or_else(|| panic!("no {name} in {text}"));
        run["graded"]["rmse"].as_f64().unwrap()
    };
    let wide = folder.join("wide");
    let [none, some] = ["0", "2"].map(|n| rmse(&wide, &format!("blurred.ron@radius={n}")));
    assert!(some < none, "{some} with a blur, {none} without");
    let field = folder.join("field");
    let [mine, vsm] = ["blurred.ron", "vsm"].map(|name| rmse(&field, name));
    assert!(mine < 1.5 * vsm, "mine {mine}, the built-in one {vsm}");
    assert!(folder.join("soft.html").is_file());
}
