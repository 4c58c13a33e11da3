//! Textures, buffers and samplers that the live passes use.

pub(crate) mod allocation;
pub(crate) mod import;
#[expect(
    clippy::module_inception,
    reason = "the folder is named after what it makes"
)]
pub(crate) mod memory;
pub(crate) mod physical;
