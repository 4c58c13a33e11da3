//! One file per command.

pub mod check;
pub mod compare;
pub mod doctor;
pub mod graph;
pub mod presets;
pub mod profile;
pub mod run;
pub mod scenes;
pub mod stress;
