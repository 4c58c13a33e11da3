//! Tests in minutes how right and how fast methods are on one adapter (a GPU through one backend
//! and driver). Each question is a *row*: a command of the program `skiagraph` in a process of its
//! own with a time limit. A crash, a lost device and a hang are answers, too.
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
