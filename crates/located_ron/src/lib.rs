//! A reader of RON files whose values keep their place in the source text, and diagnostics that
//! point at that place.
//!
//! [`reader`] splits a text into nodes (a list entry, a field's value) and reads each node by
//! itself, as [`fields`] does with those of a struct, so that one mistake does not hide the next. A
//! [`diagnostics::Diagnostic`] holds the kind of a mistake, its message, its places in the text,
//! and a hint how to mend it.
//!
//! ```
//! use serde::Deserialize;
//! use skiagraph_located_ron::{fields::from_fields, reader::Node, span::SourceFile};
//!
//! #[derive(Debug, Deserialize)]
//! #[serde(deny_unknown_fields)]
//! struct Lamp { height: f64 }
//!
//! let root = Node::root(&SourceFile::new("lamp.ron", "(hieght: 3)"));
//! let error = from_fields::<Lamp>(&root.fields()?, &root).unwrap_err();
//! assert_eq!(error.message, "unknown field `hieght`");
//! assert_eq!(error.labels[0].span.to_string(), "lamp.ron:1:2");
//! assert_eq!(error.help.as_deref(), Some("did you mean `height`?"));
//! # Ok::<(), skiagraph_located_ron::diagnostics::Diagnostic>(())
//! ```

pub mod diagnostics;
pub mod fields;
pub mod mistakes;
pub mod panics;
pub mod reader;
#[cfg(feature = "schema")]
pub mod schema;
pub mod span;
pub mod writer;
