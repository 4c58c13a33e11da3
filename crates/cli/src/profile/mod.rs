//! What `skiagraph profile` measures, and the ways to look at it.

pub mod baseline;
mod csv;
pub mod read;
pub mod record;
mod report;
pub mod trace;
