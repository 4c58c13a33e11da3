//! Phase 2: WGSL is put together from its imports, parsed and validated, and asked what it binds.

pub(crate) mod class;
pub(crate) mod constants;
pub(crate) mod expand;
mod guard;
pub(crate) mod items;
pub(crate) mod reflect;
mod text;
mod wgsl_errors;

pub use items::{Field, Item, ItemScalar};
pub use reflect::Shader;
