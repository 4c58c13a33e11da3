#![doc = include_str!("../README.md")]

pub mod diagnostics;
pub mod fields;
pub mod mistakes;
pub mod panics;
pub mod reader;
#[cfg(feature = "schema")]
pub mod schema;
pub mod span;
pub mod writer;
