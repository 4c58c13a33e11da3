//! Textures, buffers and samplers of what the live passes touch.

pub(crate) mod allocation;
pub(crate) mod import;
#[expect(
    clippy::module_inception,
    reason = "the folder is named after what it makes"
)]
pub(crate) mod memory;
pub(crate) mod physical;
