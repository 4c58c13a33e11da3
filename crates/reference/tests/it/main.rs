//! Tests of `crates/truth`, one module for each subject.

mod common;

mod analytic;
mod area;
mod blockers;
mod indeterminate;
mod lamps;
mod roles;
mod shimmer;
mod standard_views;
mod visible;
