//! Phase 2: WGSL is put together from its imports, parsed and validated, and asked what it binds.

mod binding_numbers;
mod blame;
pub(crate) mod class;
mod compiled;
pub(crate) mod constants;
pub(crate) mod expand;
pub(crate) mod footprint;
mod guard;
pub(crate) mod items;
pub(crate) mod members;
pub(crate) mod reflect;
pub(crate) mod store;
mod text;
pub(crate) mod unused;
pub(crate) mod varyings;
mod wgsl_errors;

pub use items::{Field, Item, ItemScalar};
pub use reflect::Shader;
