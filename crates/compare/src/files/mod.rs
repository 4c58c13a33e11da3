//! Works with files whatever they hold: writes them whole, locks, watches and hashes them, and
//! shows mistakes in JSON and CSV.
//!
//! ```
//! use skiagraph_compare::{files::{lock::{STRESS, wait_for}, write::write_whole}, sink::Silent};
//!
//! let folder = tempfile::tempdir()?;
//! let locked = wait_for(folder.path(), STRESS, &Silent)?;
//! write_whole(&folder.path().join("notes.txt"), b"measured at night")?;
//! drop(locked);
//! assert_eq!(std::fs::read(folder.path().join("notes.txt"))?, b"measured at night");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub(crate) mod csv;
pub mod fingerprint;
pub mod json;
pub mod lock;
pub(crate) mod picture_sources;
pub mod scene;
pub mod truth_file;
pub mod watch;
pub mod write;
