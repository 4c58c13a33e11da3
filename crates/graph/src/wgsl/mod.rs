//! Phase 3: WGSL is put together from its imports, parsed and validated, and asked what it binds.

mod expand;
mod reflect;

pub(crate) use expand::{Expanded, ShaderFiles};
pub(crate) use reflect::{Class, Global, Member, ScalarClass, Shader, TextureClass};
