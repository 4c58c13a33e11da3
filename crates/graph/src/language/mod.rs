//! The two small languages inside the strings of a document, references and expressions: their
//! names, syntax trees and values. `expressions/` reads and evaluates them.

pub(crate) mod formats;
pub(crate) mod name;
pub(crate) mod syntax;
pub(crate) mod value;

pub use name::{Name, wgsl_identifier};
pub use syntax::{Expr, Reference};

pub(crate) use formats::{FORMATS, format_named};
pub(crate) use name::{NameFault, RESERVED};
pub(crate) use syntax::{
    AdapterFact, Attribute, Binary, Component, ExprKind, Function, Leaf, Segment, Selection,
    Subject, Unary,
};
pub(crate) use value::{Scalar, Value, Word, least_common_multiple};
