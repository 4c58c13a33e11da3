//! Phase 1, second half: the documents that a document extends and includes are read, each once.

pub(crate) mod loaded;
pub(crate) mod reader;
pub(crate) mod unique;
pub(crate) mod used;
