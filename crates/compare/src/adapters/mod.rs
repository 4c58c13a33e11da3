//! Finds out about one adapter what there is to find out, in minutes: each question is a row, a
//! command of this program in a process of its own with a time limit. A crash, a lost device and a
//! hang are answers, too.
//!
//! ```no_run
//! use skiagraph_compare::{adapters::running::{AdapterRequest, run}, sink::Silent};
//!
//! let mut request = AdapterRequest::new(std::env::current_exe()?);
//! request.arguments = vec!["--backend".into(), "vulkan".into()];
//! let finished = run(&request, &Silent)?;
//! println!("{} rows in {}", finished.record.rows.len(), finished.folder.display());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod figures;
mod process;
pub mod rows;
pub mod running;
