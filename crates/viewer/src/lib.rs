//! Shows shadow methods in a window, side by side and beside the ground truth. One thread runs the
//! methods, another traces the reference, and the window shows their results. The logic is in
//! `state.rs`, which uses no window toolkit.
//!
//! ```no_run
//! use skiagraph_compare::{measuring::device::GpuRequest, sink::Silent};
//! use skiagraph_scene::SceneLibrary;
//! use skiagraph_viewer::{Opening, open};
//!
//! let opening = Opening {
//!     methods: vec!["nsm".into(), "light_buffer".into()],
//!     params: vec![],
//!     map_size: None,
//!     size: [640, 480],
//!     scene: "park".into(),
//!     load_scene: Box::new(|name| {
//!         let (scene, _) = SceneLibrary::default().load(name)?;
//!         Ok((scene, vec![]))
//!     }),
//!     gpu: GpuRequest::default(),
//! };
//! open(opening, &Silent)?;
//! # Ok::<(), skiagraph_compare::error::CompareError>(())
//! ```

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
