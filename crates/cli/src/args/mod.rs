//! Defines the command line for clap: every flag with its help.

pub mod cli;
pub mod commands;
pub mod shared;
pub mod values;
