//! Shadow methods in a window, beside each other and beside the ground truth. One thread runs them,
//! one traces the reference, and the window shows what comes; what is decided is in `state.rs`,
//! without a toolkit.

mod desired_state;
mod drawn;
mod flight;
mod ground_truth;
mod heat;
mod saving;
mod slot;
mod start;
mod state;
#[cfg(test)]
mod tests;
mod texels;
mod ui;
mod window;
mod worker;

pub use start::Opening;
pub use window::open;
pub use worker::LoadScene;
