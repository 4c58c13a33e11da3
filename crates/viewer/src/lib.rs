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
