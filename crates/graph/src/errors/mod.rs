//! Mistakes of each phase and their messages: kind, words, places, the way out.
//!
//! A phase reports a variant; nothing else knows how it reads.

pub(crate) mod compose;
pub(crate) mod document;
pub(crate) mod edit;
pub(crate) mod evaluation;
pub(crate) mod flow;
pub(crate) mod instantiate;
pub(crate) mod language;
pub(crate) mod layout;
pub(crate) mod limits;
pub(crate) mod link;
pub(crate) mod plan;
pub(crate) mod resource;
pub(crate) mod shader;
