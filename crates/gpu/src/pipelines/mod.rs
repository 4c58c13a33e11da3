//! Pipelines and bindings of the live passes.

pub(crate) mod bind;
mod cores;
pub(crate) mod handles;
mod kept;
pub(crate) mod key;
#[expect(
    clippy::module_inception,
    reason = "the folder is named after what it makes"
)]
pub(crate) mod pipelines;
