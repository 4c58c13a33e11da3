//! The command line as clap reads it: every flag with its help.

pub mod cli;
pub mod commands;
pub mod shared;
pub mod values;
