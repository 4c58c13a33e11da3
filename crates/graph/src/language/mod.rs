//! The two small grammars inside the strings of a document: references and expressions.

pub(crate) mod eval;
pub(crate) mod formats;
pub(crate) mod lexer;
pub(crate) mod name;
pub(crate) mod parser;
pub(crate) mod syntax;
pub(crate) mod value;

pub use name::{Name, wgsl_identifier};
pub use syntax::{Expr, Reference};
pub use value::{Scalar, Value, Word};
