//! Mistakes in documents and shaders: collected, located, printed in source order.
//!
//! The phases report typed mistakes; `errors/` puts them into words.
//!
//! ```
//! use skiagraph_graph::{Code, FolderSources, Graph, Registry};
//!
//! let sources = FolderSources { root: "graphs".into() };
//! let Err(wrong) = Graph::load("no_such.ron", &Registry::standard(), &sources) else {
//!     panic!("there is no such document");
//! };
//! println!("{wrong}");
//! let first = wrong.iter().next().unwrap();
//! assert_eq!(first.code, Code::MissingFile);
//! assert!(first.message.contains("no_such.ron"));
//! ```

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
