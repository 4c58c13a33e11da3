//! Every mistake that a document can hold gives one clear, located diagnostic: the rendered texts
//! are pinned.
//!
//! `tests/broken/NAME.ron` is a document with one mistake (or several, where the name says so); the
//! snapshot of that name is what its author reads. `INSTA_UPDATE=always cargo test` writes them
//! anew; read what changed.

use crate::broken::{all, documents, folder, root};
use crate::remedies::REMEDIES;
use skiagraph_graph::{Code, Diagnostic, Sources, diagnostics};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// True if a document may hold more than one mistake.
fn has_several(name: &str) -> bool {
    name.starts_with("several") || name == "all_at_once"
}

#[test]
fn every_mistake_has_its_text() {
    let settings = || {
        let mut settings = insta::Settings::clone_current();
        settings.set_prepend_module_to_snapshot(false);
        settings.set_snapshot_path("../broken/snapshots");
        settings.set_omit_expression(true);
        settings
    };
    let mut right = Vec::new();
    for (name, mistakes) in all() {
        if mistakes.is_empty() {
            right.push(name);
        } else {
            settings().bind(|| {
                insta::assert_snapshot!(name.as_str(), diagnostics::render(&mistakes, false));
            });
        }
    }
    assert!(
        right.is_empty(),
        "these broken documents are thought to be right: {right:?}"
    );
}

/// The consequences of a mistake are not told beside it.
#[test]
fn one_mistake_is_one_message() {
    let mut wrong = Vec::new();
    for (name, mistakes) in all() {
        if (mistakes.len() > 1) != has_several(&name) {
            let messages: Vec<&str> = mistakes
                .iter()
                .map(|mistake| mistake.message.as_str())
                .collect();
            wrong.push(format!("{name}: {messages:#?}"));
        }
    }
    assert!(
        wrong.is_empty(),
        "not as many as the name says:\n{}",
        wrong.join("\n")
    );
}

/// Each kind of mistake is shown by one snapshot at least.
#[test]
fn every_code_has_a_text() {
    let mistakes = all().into_iter().flat_map(|(_, mistakes)| mistakes);
    let shown: BTreeSet<Code> = mistakes.map(|mistake| mistake.code).collect();
    let missing = Code::ALL.iter().filter(|code| !shown.contains(code));
    let missing: Vec<&Code> = missing.collect();
    assert!(
        missing.is_empty(),
        "no document in tests/broken shows {missing:?}"
    );
}

/// The documents that show a kind of mistake, with all that is wrong with each.
type Shown = BTreeMap<Code, Vec<(String, Vec<Diagnostic>)>>;

fn shown() -> Shown {
    let mut shown = Shown::new();
    for (name, diagnostics) in all() {
        let codes: BTreeSet<Code> = diagnostics.iter().map(|mistake| mistake.code).collect();
        for code in codes {
            let of_code = shown.entry(code).or_default();
            of_code.push((name.clone(), diagnostics.clone()));
        }
    }
    shown
}

const TITLE: &str = "# Diagnostics\n\nEvery kind of mistake that `skiagraph check` finds, with an \
    example, what is printed, and the way out. The examples are documents of \
    [tests/broken](../crates/graph/tests/broken); this page is written by their test. `check \
    --format json` prints the same with the codes as they stand here.\n";

/// The chapter of one kind of mistake: its plainest document, then all of them in a table.
fn chapter(code: Code, of_code: &[(String, Vec<Diagnostic>)]) -> String {
    let text = |name: &str| {
        let text = folder()
            .read(&format!("{name}.ron"))
            .expect("it is readable");
        text.expect("it is there").trim_end().to_owned()
    };
    // The plainest: one mistake, and little around it.
    let plainest = of_code
        .iter()
        .min_by_key(|(name, mistakes)| (mistakes.len(), text(name).len()));
    let (example, mistakes) = plainest.expect("another test says that there is one");
    let remedy = REMEDIES.iter().find(|(of_code, _)| *of_code == code);
    let (_, remedy) = remedy.unwrap_or_else(|| panic!("remedies.rs has none for {code:?}"));
    let mut chapter = format!(
        "\n## {}\n\n{} **Way out:** {}\n\n```ron\n{}\n```\n\n```text\n{}\n```\n\n| document | says \
         |\n|---|---|\n",
        code.as_str(),
        code.description(),
        remedy,
        text(example),
        diagnostics::render(mistakes, false).trim_end(),
    );
    for (name, mistakes) in of_code {
        let of_code = mistakes.iter().filter(|mistake| mistake.code == code);
        let says = of_code.map(|mistake| mistake.message.replace('|', "\\|").replace('\n', " "));
        let says: BTreeSet<String> = says.collect();
        let says: Vec<String> = says.into_iter().collect();
        chapter += &format!(
            "| [{name}](../crates/graph/tests/broken/{name}.ron) | {} |\n",
            says.join("; ")
        );
    }
    chapter
}

/// `docs/diagnostics.md` lists every kind of mistake with its shortest example, and every broken
/// document. `INSTA_UPDATE=always` writes it anew.
#[test]
fn the_catalogue_is_current() {
    let shown = shown();
    let chapters = Code::ALL.iter().map(|code| chapter(*code, &shown[code]));
    let catalogue = TITLE.to_owned() + &chapters.collect::<String>();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/diagnostics.md");
    if std::env::var("INSTA_UPDATE").is_ok_and(|mode| mode == "always") {
        std::fs::write(&path, &catalogue).expect("it can be written");
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        written == catalogue,
        "docs/diagnostics.md is not what the documents give: run this test with INSTA_UPDATE=always"
    );
}

/// A snapshot without its document would be checked by nothing.
#[test]
fn every_text_has_its_document() {
    let documents = documents();
    let snapshots = std::fs::read_dir(root().join("snapshots"));
    for entry in snapshots.expect("the folder is part of the repository") {
        let name = entry.expect("it is readable").file_name();
        let name = name.to_string_lossy();
        let document = name.strip_suffix(".snap").unwrap_or(&name).to_owned();
        assert!(
            documents.contains(&document),
            "{name} belongs to no document"
        );
    }
}

/// Every error has a place, or its message names the file.
#[test]
fn every_error_has_its_place() {
    for (name, mistakes) in all() {
        for mistake in mistakes {
            let label = mistake.labels.first();
            let label =
                label.unwrap_or_else(|| panic!("{name}: `{}` has no place", mistake.message));
            assert!(
                label.span.range.end <= label.span.file.text.len(),
                "{name}: the place lies outside the file"
            );
        }
    }
}
