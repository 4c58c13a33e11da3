//! Runs the commands, one in each file (`loaded` and `run_sequence` are parts of some). Each takes
//! its arguments and may return an error.

pub mod cells;
pub mod chart;
pub mod check;
pub mod compare;
pub mod completions;
pub mod doctor;
pub mod graph;
pub mod judge;
pub mod loaded;
pub mod merge;
pub mod new;
pub mod presets;
pub mod profile;
pub mod report;
pub mod run;
pub mod run_sequence;
pub mod scenes;
pub mod schema;
pub mod show;
pub mod stress;
pub mod view;
