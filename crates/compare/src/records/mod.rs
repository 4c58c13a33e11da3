//! Measurements as plain data. The types of the JSON files are their schemas: scripts rely on them,
//! so fields are added and never renamed.

pub mod baseline;
pub mod check;
pub mod columns;
pub mod profile;
pub mod published;
pub mod published_row;
pub mod read_back;
pub mod results;
pub(crate) mod results_csv;
pub mod samples;
pub mod sequence;
pub mod statistics;
pub mod steady;
pub mod stress;
pub mod table;
