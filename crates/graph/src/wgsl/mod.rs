//! Phase 3: WGSL is put together from its imports, parsed and validated, and asked what it binds.

mod class;
mod errors;
mod expand;
mod guard;
mod reflect;

pub(crate) use class::{Class, Member, ScalarClass, TextureClass};
pub(crate) use expand::{Expanded, ShaderFiles};
pub(crate) use reflect::{Global, Shader};
