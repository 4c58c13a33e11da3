//! Phase 1: the RON text becomes a document; nothing is looked up yet but pass kinds.

pub(crate) mod entries;
pub(crate) mod extend;
pub(crate) mod flat;
pub(crate) mod materials;
pub(crate) mod params;
pub(crate) mod raw;
pub(crate) mod read;
pub(crate) mod typed;

pub use materials::{Address, Filter};
