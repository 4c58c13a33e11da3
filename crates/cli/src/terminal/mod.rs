//! How the program talks to whoever runs it: standard output and error, progress, Ctrl-C.

pub mod console;
pub mod interrupt;
pub mod progress;
