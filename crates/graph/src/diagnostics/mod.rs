//! Mistakes in documents and shaders: collected, located, printed in source order.
//!
//! The phases report typed mistakes; `errors/` puts them into words.

pub(crate) mod code;
pub(crate) mod diagnostic;
pub(crate) mod list;
#[cfg(feature = "render")]
pub(crate) mod render;
pub(crate) mod reports;
pub(crate) mod suggest;

pub use code::Code;
pub use diagnostic::{Diagnostic, Label, Severity};
pub use list::Diagnostics;
#[cfg(feature = "render")]
pub use render::render;
pub use suggest::{closest, suggestion};
