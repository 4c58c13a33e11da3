//! Frames: which passes run, their commands in the host's encoder, another plan on what is there.

mod contents;
mod encode;
pub(crate) mod executor;
mod growth;
mod host;
mod pass;
mod poison;
mod replan;
mod watch;

pub use executor::{Executor, Frame, FrameReport};
pub use replan::ReplanReport;
