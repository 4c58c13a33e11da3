//! What Skiagraph's graphs need of a scene, the tracer, and the shadow presets.
//!
//! - [`SceneProvider`] uploads a [`skiagraph_scene::Scene`] piece by piece, as live passes ask for it.
//! - [`registry`] knows the standard pass kinds and [`Trace`]: rays in, hits out, on compute shaders.
//! - [`EmbeddedSources`] holds the presets and their shaders, [`presets`] lists them.

pub mod error;
pub mod presets;
pub mod provider;
pub mod trace;
pub mod uniforms;

pub use error::Error;
pub use presets::{EmbeddedSources, presets, registry};
pub use provider::SceneProvider;
pub use trace::Trace;
