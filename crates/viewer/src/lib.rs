//! Shows shadow methods in a window, side by side and beside the ground truth. One thread runs the
//! methods, another traces the reference, and the window shows their results. The logic is in
//! `state.rs`, which uses no window toolkit.

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
