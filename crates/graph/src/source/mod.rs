//! Sources of documents, shaders and pictures, and places in their texts.

pub(crate) mod paths;
pub(crate) mod sources;

pub(crate) use skiagraph_located_ron::span;
pub use skiagraph_located_ron::span::{Located, SourceFile, SourceText, Span};
pub use sources::{FolderSources, LayeredSources, MemorySources, Sources};
