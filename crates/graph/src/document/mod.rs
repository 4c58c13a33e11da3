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

pub(crate) use materials::{
    BufferEntry, FormatEntry, GrowEntry, Input, InputKind, Material, Mips, SamplerEntry,
    TextureEntry,
};
pub(crate) use raw::{Invalid, RawDocument};
pub(crate) use typed::{
    ClaimEntry, Document, Entry, ImportEntry, Include, Output, Pass, Run, What,
};
