//! `results.csv`, one line per run for spreadsheets, and `results.json` beside it.
//!
//! ```
//! use skiagraph_compare::records::{read_back, results_csv};
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let results = read_back::kept(out.path())?;
//! results_csv::save(&results, out.path())?;
//! let csv = std::fs::read_to_string(out.path().join("results.csv"))?;
//! assert_eq!(csv.lines().count(), 1 + results.runs.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::json;
use crate::files::write::write_whole;
use crate::records::figure::Clocks;
use crate::records::figures::FIGURES;
use crate::records::results::Results;
use crate::records::table::Table;
use std::path::Path;

/// The contents of `results.csv`, with the runs of all joined results: empty cells are nulls.
fn to_csv(results: &Results) -> Result<String, ::csv::Error> {
    let figures = || FIGURES.iter().filter(|figure| figure.is_in_csv);
    let heads = figures().map(|figure| &*figure.name);
    let parts = [results].into_iter().chain(&results.others);
    let rows = parts.flat_map(|results| {
        let clocks = Clocks::new(results);
        let row = move |run| {
            let case = clocks.case(run);
            figures().map(|figure| figure.csv_cell(&case)).collect()
        };
        results.runs.iter().map(row)
    });
    Table::new(heads, 0, rows).csv()
}

/// Writes `results.json` and `results.csv` into `folder`, each whole or not at all.
///
/// # Errors
/// A file that cannot be written.
pub fn save(results: &Results, folder: &Path) -> Result<()> {
    let text = json::to_text(results);
    write_whole(&folder.join("results.json"), text.as_bytes())?;
    let path = folder.join("results.csv");
    let csv = to_csv(results).map_err(|error| CompareError::write(&path, error))?;
    write_whole(&path, csv.as_bytes())
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
        let lengths = reader.records().map(|record| record.unwrap().len());
        let columns = FIGURES.iter().filter(|figure| figure.is_in_csv).count();
        assert_eq!(lengths.collect::<Vec<_>>(), [columns; 3]);
    }

    #[test]
    fn runs_of_joined_results_have_lines_with_their_own_conditions() {
        let mut joined = sample();
        let mut far = sample();
        far.adapter.name = "Far GPU".into();
        far.runs[0].machine = None;
        far.machine.host = Some("far".into());
        joined.others = vec![far];
        let csv = to_csv(&joined).unwrap();
        let mut reader = ::csv::Reader::from_reader(csv.as_bytes());
        let heads = reader.headers().unwrap().clone();
        let place = |name| heads.iter().position(|head| head == name).unwrap();
        let lines: Vec<_> = reader.records().map(Result::unwrap).collect();
        let cells = |index: usize| {
            let names = ["adapter", "host", "preset", "params"];
            names.map(|name| lines[index][place(name)].to_owned())
        };
        let params = "cull=front;slope_bias=1.5";
        assert_eq!(lines.len(), 6);
        assert_eq!(cells(0), ["Some GPU", "bench", "nsm", params]);
        assert_eq!(cells(3), ["Far GPU", "far", "nsm", params]);
    }
}
