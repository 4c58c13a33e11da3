//! Turns arguments into graphs that can run: presets, params, plans, and the outputs that a shadow
//! method must have. Nothing here runs on a GPU.
//!
//! ```
//! use skiagraph_compare::graphs::{planning::{Capabilities, placeholder}, shadow_method};
//! use skiagraph_passes::EmbeddedSources;
//!
//! let words = ["nsm", "crsm@n=1"];
//! for method in shadow_method::load_methods(&words, &[], &[1024], &EmbeddedSources)? {
//!     let scene = placeholder([64, 64], &method.preset.graph);
//!     let plan = method.plan([64, 64], Capabilities::greatest(), &scene)?;
//!     println!("{}: {} passes", method.name, plan.passes().len());
//!     assert_eq!(plan.outputs()[0].name, "visibility");
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod argument;
pub mod contract;
pub mod faults;
pub mod ground_truth;
pub mod idle_params;
pub mod light_kinds;
pub mod method;
pub mod openings;
pub mod planning;
pub mod preset;
pub mod shadow_method;
pub mod variants;
