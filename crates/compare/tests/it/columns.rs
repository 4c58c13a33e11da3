//! Columns of results.csv, and limits, in the documents.

use skiagraph_compare::records::figures::{self, FIGURES};

/// Adding a column without saying what it holds fails here.
#[test]
fn every_column_is_documented() {
    let text = std::fs::read_to_string("../../docs/results_files.md").unwrap();
    let (_, table) = text.split_once("\n## Columns of results.csv\n").unwrap();
    let table = table.split("\n## ").next().unwrap();
    for figure in FIGURES.iter().filter(|figure| figure.is_in_csv) {
        let name = format!("`{}`", figure.name);
        assert_eq!(
            table.matches(&name).count(),
            1 + usize::from(MENTIONED.contains(&&*figure.name)),
            "{name}"
        );
    }
}

/// Adding a limit, or an error that charts draw, without a word on it fails here.
#[test]
fn limits_and_errors_of_charts_are_documented() {
    let text = std::fs::read_to_string("../../docs/compare.md").unwrap();
    let words = figures::limited().filter_map(|figure| figure.gate.as_ref());
    for word in words.chain(figures::drawn().map(|figure| &figure.name)) {
        let is_named = [format!("`{word}`"), format!("`{word} >")];
        assert!(is_named.iter().any(|name| text.contains(name)), "{word}");
    }
}

/// Columns that the text of another one names.
const MENTIONED: [&str; 1] = ["wrong_certain"];
