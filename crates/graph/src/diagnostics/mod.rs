//! Mistakes in documents and shaders.
//!
//! The phases report typed mistakes; `errors/` puts them into words.

pub(crate) mod reports;

pub use skiagraph_located_ron::diagnostics::*;
