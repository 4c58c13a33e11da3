//! `results.csv`, one line per run for spreadsheets, and `results.json` beside it.

use crate::error::CompareError;
use crate::files::json;
use crate::files::write::write_whole;
use crate::records::columns;
use crate::records::results::Results;
use crate::records::table::Table;
use std::path::Path;

/// The contents of `results.csv`: times are medians, empty cells are nulls.
fn to_csv(results: &Results) -> Result<String, ::csv::Error> {
    let columns = columns::csv();
    let heads = columns.iter().map(|column| column.head);
    let row = |run| {
        columns
            .iter()
            .map(|column| column.csv_cell(results, run))
            .collect()
    };
    Table::new(heads, 0, results.runs.iter().map(row)).csv()
}

/// Writes `results.json` and `results.csv` into `folder`, each whole or not at all. Returns the
/// text of `results.json`.
///
/// # Errors
/// A file that cannot be written.
pub fn save(results: &Results, folder: &Path) -> Result<String, CompareError> {
    let text = json::to_text(results);
    write_whole(&folder.join("results.json"), text.as_bytes())?;
    let path = folder.join("results.csv");
    let csv = to_csv(results).map_err(|error| CompareError::write(&path, error))?;
    write_whole(&path, csv.as_bytes())?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::results::tests::sample;

    #[test]
    fn csv_has_a_line_per_run_and_as_many_cells_as_columns() {
        let csv = to_csv(&sample()).unwrap();
        insta::assert_snapshot!(csv);
        let mut reader = ::csv::Reader::from_reader(csv.as_bytes());
        assert_eq!(
            reader
                .records()
                .map(|record| record.unwrap().len())
                .collect::<Vec<_>>(),
            [columns::csv().len(); 3]
        );
    }
}
