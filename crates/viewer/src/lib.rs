#![doc = include_str!("../README.md")]
//!
//! The logic is in `state.rs`, which uses no window toolkit.

mod desired_state;
mod drawn;
#[cfg(feature = "window")]
mod flight;
mod ground_truth;
mod heat;
#[cfg(feature = "window")]
mod saving;
mod slot;
mod stage;
#[cfg(feature = "window")]
mod start;
#[cfg(feature = "window")]
mod state;
#[cfg(all(test, feature = "window"))]
mod tests;
mod texels;
#[cfg(feature = "window")]
mod ui;
#[cfg(feature = "window")]
mod window;
#[cfg(feature = "window")]
mod worker;

/// The frames that a window shows, without a window or a thread: for a host with an event loop of
/// its own, such as a page in a browser.
pub mod live {
    pub use crate::{
        desired_state::*,
        drawn::*,
        ground_truth::*,
        slot::{How, Lost, Slot},
        stage::{Clock, Stage},
        texels::*,
    };
}

#[cfg(feature = "window")]
pub use start::Opening;
#[cfg(feature = "window")]
pub use window::open;
#[cfg(feature = "window")]
pub use worker::LoadScene;
