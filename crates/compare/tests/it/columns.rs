//! Columns of results.csv.

use skiagraph_compare::records::columns;

/// Adding a column without saying what it holds fails here.
#[test]
fn every_column_is_documented() {
    let text = std::fs::read_to_string("../../docs/results_files.md").unwrap();
    let (_, table) = text.split_once("\n## Columns of results.csv\n").unwrap();
    let table = table.split("\n## ").next().unwrap();
    for column in columns::csv() {
        let name = format!("`{}`", column.head);
        assert_eq!(
            table.matches(&name).count(),
            1 + usize::from(MENTIONED.contains(&column.head)),
            "{name}"
        );
    }
}

/// Columns that the text of another one names.
const MENTIONED: [&str; 1] = ["wrong_certain"];
