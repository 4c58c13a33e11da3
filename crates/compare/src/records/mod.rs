//! Holds measurements as plain data. The types of the JSON files are their schemas: scripts rely on
//! them, so fields are added and never renamed. A field that is `None` is `null` in the file where
//! its comment says *null*, and left out of the file where it says *absent*.
//!
//! ```
//! use skiagraph_compare::records::read_back;
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let results = read_back::kept(out.path())?;
//! for run in &results.runs {
//!     match &run.measured {
//!         Some(measured) => println!("{}: {} wrong", run.label(), measured.wrong.total),
//!         None => println!("{} cannot run on {}", run.preset, results.adapter),
//!     }
//! }
//! assert_eq!(results.runs.len(), 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod abilities;
pub mod baseline;
pub mod budgets;
pub mod cell_files;
pub mod cell_plan;
pub mod cells;
pub mod check;
pub mod columns;
pub mod figure;
pub mod figures;
pub mod hint;
pub mod judged_pictures;
mod measured;
pub mod profile;
pub mod published;
pub mod published_row;
pub mod read_back;
pub mod regimes;
pub mod results;
pub mod results_baseline;
pub mod results_csv;
pub mod samples;
pub mod sequence;
pub mod shard;
pub mod sources;
pub mod statistics;
pub mod steady;
pub mod stress;
pub mod table;
pub mod tuned;
pub mod turns;
pub mod unpaired;
