//! Reads expressions and references from text, and evaluates expressions.

pub(crate) mod eval;
mod lexer;
pub(crate) mod parser;

pub(crate) use eval::Environment;
