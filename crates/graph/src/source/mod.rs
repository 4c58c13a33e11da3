//! Texts and pictures: where they come from, and places in them.

pub(crate) mod paths;
pub(crate) mod sources;

pub(crate) use skiagraph_located_ron::span;
pub use skiagraph_located_ron::span::{Located, SourceFile, SourceText, Span};
pub use sources::{FolderSources, LayeredSources, Sources};
