//! Communicates with the user: standard output and error, progress, Ctrl-C.

pub mod console;
pub mod interrupt;
pub mod progress;
pub mod stop;

pub use progress::Terminal;
