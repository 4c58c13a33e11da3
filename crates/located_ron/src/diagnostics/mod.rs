//! Diagnostics of mistakes in files: collected, located, printed in source order.

pub mod code;
pub mod diagnostic;
pub mod list;
#[cfg(feature = "render")]
pub mod render;
pub mod suggest;

pub use code::Code;
pub use diagnostic::{Diagnostic, Label, Severity};
pub use list::Diagnostics;
#[cfg(feature = "render")]
pub use render::render;
pub use suggest::{closest, suggestion};
