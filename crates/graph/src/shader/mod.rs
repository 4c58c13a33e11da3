//! Phase 2: puts WGSL together from its imports, parses and validates it, and finds its bindings.

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
pub(crate) mod mixed;
pub(crate) mod reflect;
pub(crate) mod store;
mod text;
pub(crate) mod unused;
pub(crate) mod varyings;
mod wgsl_errors;

pub use items::{Field, Item};
pub use reflect::Shader;

pub(crate) use class::{Class, Member, SampledClass, TextureClass};
pub(crate) use expand::{Expanded, Replaced, ShaderFiles};
pub(crate) use footprint::{Footprint, Memory};
pub(crate) use reflect::Global;
pub(crate) use store::Shaders;
pub(crate) use varyings::{Varying, Varyings};
