//! Phase 1, second half: reads the documents that a document extends and includes, each once.

pub(crate) mod loaded;
pub(crate) mod reader;
pub(crate) mod unique;
pub(crate) mod used;

pub(crate) use loaded::Loaded;
pub(crate) use reader::Reader;
pub(crate) use used::Used;
