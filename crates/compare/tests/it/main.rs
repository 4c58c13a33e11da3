//! Tests of `crates/compare`, one module for each subject.

mod support;

mod checking;
mod columns;
mod data;
mod default_views;
mod diagnostics;
mod dissertation;
mod engine;
mod foreign_files;
mod foreign_pictures;
mod frames;
mod hard_cases;
mod judging;
mod lights;
mod paths;
mod poison;
mod profile;
mod props;
mod remembering;
mod resume;
mod saves;
mod schema;
mod timeless;
mod tuning;
