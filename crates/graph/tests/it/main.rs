//! Tests of `crates/graph`, one module for each subject.

#[path = "support/answers.rs"]
mod answers;
#[path = "../../../../tests/it/support/bounds.rs"]
mod bounds;
#[path = "support/broken.rs"]
mod broken;
#[path = "support/everything.rs"]
mod everything;
mod support;

mod compose;
mod conditions;
mod contents;
#[cfg(feature = "render")] // alone, this crate has no diagnostics for a terminal
mod diagnostics;
mod expressions;
mod extends;
mod features;
mod format_3;
mod growth;
mod hostile;
mod hostile_shaders;
mod includes;
mod inlining;
mod keep;
mod mistakes;
mod names;
mod origin;
mod plan;
mod reached;
mod remedies;
mod robustness;
mod sources;
mod uniforms;
mod ways_out;
mod wgsl;
