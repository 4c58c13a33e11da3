//! Tests of `crates/chart`, one module for each subject.

mod figures;
