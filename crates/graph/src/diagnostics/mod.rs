//! Diagnostics of mistakes in documents and shaders, as `Graph` returns them.
//!
//! The phases report typed mistakes; `errors/` turns them into diagnostics.
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

pub(crate) mod reports;

pub use skiagraph_located_ron::diagnostics::*;
