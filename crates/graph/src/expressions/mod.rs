//! Expressions and references: from text, and to values.

pub(crate) mod eval;
mod lexer;
pub(crate) mod parser;
