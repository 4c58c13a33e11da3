//! Tests of `crates/draw`, one module for each subject.

#[path = "../../../graph/tests/it/support/generated.rs"]
mod generated;
#[path = "../../../graph/tests/it/support/mod.rs"]
mod support;

mod drawing;
mod materials;
