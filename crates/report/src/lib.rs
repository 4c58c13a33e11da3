//! Presents measurements as tables, documents, charts, CSV and traces. It reads the records of
//! `skiagraph-compare`, and measures nothing itself.
//!
//! ```
//! use skiagraph_compare::records::table::Table;
//! use skiagraph_report::table::terminal;
//!
//! let rows = [vec!["nsm".to_owned(), "12".to_owned()]];
//! let text = terminal(&Table::new(["method", "wrong"], 1, rows));
//! assert!(text.contains("nsm") && text.contains("12"));
//! ```

pub mod baseline_text;
pub mod charts;
mod contender;
mod equal_cost;
pub mod gate;
pub mod graded;
pub mod html;
pub mod judged_text;
pub mod language;
pub mod looks;
pub mod markdown;
pub mod matrices;
pub mod notes;
pub mod overview;
pub mod page;
pub mod profile_csv;
pub mod profile_text;
pub mod raster;
pub mod results_table;
mod single_verdict;
pub mod stress_matrix;
pub mod summary;
pub mod summary_table;
pub mod table;
#[cfg(test)]
mod test_support;
pub mod trace;
mod tuning;
pub mod verdict;
