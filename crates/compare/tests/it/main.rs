//! Tests of `crates/compare`, one module for each subject.

mod support;

mod engine;
mod hard_cases;
mod paths;
mod remembering;
mod resume;
mod timeless;
