//! Writes texels and items as files: the pictures of a run, and any material for `run --save`.
//!
//! ```
//! use skiagraph_compare::pictures::save::{Encoding, Save};
//!
//! let save: Save = "position@gbuffer.surface=position.png".parse()?;
//! assert_eq!(save.capture.material, "position");
//! assert_eq!(save.capture.after.as_deref(), Some("gbuffer.surface"));
//! assert!(matches!(save.encoding, Encoding::Png));
//! # Ok::<(), String>(())
//! ```

pub mod buffer_csv;
pub mod colours;
pub mod data;
pub mod material;
mod png;
pub mod run_pictures;
pub mod save;
