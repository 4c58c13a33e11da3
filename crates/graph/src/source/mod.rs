//! Texts and pictures: where they come from, and places in them.

pub(crate) mod paths;
pub(crate) mod sources;
pub(crate) mod span;

pub use sources::{FolderSources, LayeredSources, Sources};
pub use span::{Located, SourceFile, SourceText, Span};
