#![doc = include_str!("../README.md")]

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
