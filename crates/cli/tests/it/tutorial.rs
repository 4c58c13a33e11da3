//! docs/tutorial.md, typed as it stands there: every file written, every command run. Needs an
//! adapter. And the options of commands on all pages.

use crate::support::skiagraph;
use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

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
                let stderr = String::from_utf8_lossy(&output.stderr);
                assert!(output.status.success(), "{line}: {stderr}");
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

    // Step 2: shares and hard answers have both wrong pixels and errors.
    let text_of = |folder: &Path| fs::read_to_string(folder.join("results.json")).unwrap();
    let step: Value = serde_json::from_str(&text_of(&folder.join("compare"))).unwrap();
    for name in ["nsm", "soft.ron"] {
        let runs = step["runs"].as_array().unwrap();
        let run = runs.iter().find(|run| run["preset"] == name).unwrap();
        assert!(run["wrong"]["total"].as_u64() > Some(0), "{name}: {run}");
        assert!(run["graded"]["rmse"].as_f64() > Some(0.0), "{name}: {run}");
    }
    assert!(text.contains("Both have wrong pixels, too"));

    // A blur brings it nearer to the wide light than none, and it stands beside the built-in ones.
    let rmse = |folder: &Path, name: &str| {
        let text = text_of(folder);
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

/// Pages with commands: the README and those of docs/.
fn pages() -> Vec<PathBuf> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut pages = vec![root.join("README.md")];
    for folder in ["docs", "docs/results", "docs/data", "docs/lab"] {
        let files = fs::read_dir(root.join(folder)).unwrap();
        let files = files.map(|file| file.unwrap().path());
        pages.extend(files.filter(|file| file.extension().is_some_and(|end| end == "md")));
    }
    pages
}

#[test]
fn the_options_that_pages_name_are_there() {
    let mut helps: BTreeMap<String, String> = BTreeMap::new();
    let mut options = 0;
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap().replace("\\\n", " ");
        for (at, name) in text.match_indices("skiagraph ") {
            let (before, rest) = (&text[..at], &text[at + name.len()..]);
            let line = rest.split(['`', '\n', '#', '|']).next().unwrap();
            let mut words = line.split_whitespace();
            let Some(command) = words
                .next()
                .filter(|word| word.chars().all(char::is_alphabetic))
            else {
                continue;
            };
            let help = helps.entry(command.to_owned()).or_insert_with(|| {
                let output = skiagraph(Path::new("."), &format!("{command} --help"));
                String::from_utf8(output.stdout).unwrap()
            });
            // A word of prose is no command; one in a line of code, or in backticks, is.
            if help.is_empty() {
                let indent = before.rsplit('\n').next().unwrap();
                let is_code = indent.len() >= 4 && indent.trim().is_empty();
                let is_told = is_code || before.ends_with('`');
                assert!(!is_told, "{}: there is no `{command}`", page.display());
                continue;
            }
            let help_words: Vec<&str> = help
                .split([' ', '\n', ',', '[', ']', '=', '`', '.', ':', ';'])
                .collect();
            for option in words.filter(|word| word.starts_with("--") && word.len() > 2) {
                let option = option.split('=').next().unwrap();
                let option = option.trim_end_matches([',', '.', ')', ';', ':', '…']);
                assert!(
                    help_words.contains(&option),
                    "{}: `{command}` has no {option}",
                    page.display()
                );
                options += 1;
            }
        }
    }
    assert!(options > 100, "{options} options");
}
