//! Files as such, whatever they hold: writing them whole, CSV and JSON with the place of its
//! mistakes, fingerprints of what was read, locks.
//!
//! ```
//! use skiagraph_compare::{files::{lock::{RESULTS, wait_for}, write::write_whole}, sink::Silent};
//!
//! let folder = tempfile::tempdir()?;
//! let locked = wait_for(folder.path(), RESULTS, &Silent)?;
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
pub mod watch;
pub mod write;
