//! Diagnostics of mistakes in documents and shaders, as [`Graph`](crate::Graph) returns them.
//!
//! A diagnostic has a stable [`Code`], a message, the places that it is about, and help.
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

pub(crate) use reports::{ErrorGuaranteed, Reported, Reports};
