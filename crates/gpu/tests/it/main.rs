//! Tests of `crates/gpu`, one module for each subject.

#[path = "support/buffers.rs"]
mod buffers;
#[path = "../../../graph/tests/it/support/everything.rs"]
mod everything;
mod featured;
#[path = "support/given.rs"]
mod given;
#[path = "support/host.rs"]
mod host;
#[path = "support/program.rs"]
mod program;
#[path = "../../../graph/tests/it/support/mod.rs"]
mod support;
#[path = "support/tiny.rs"]
mod tiny;

mod changes;
mod clears;
mod compose;
mod edges;
mod embedding;
mod features;
mod features_depth;
mod features_materials;
mod features_raster;
mod flags;
mod flight;
mod frames;
mod gpu;
mod growth;
mod history;
mod idle;
mod imports;
mod keep;
mod lost;
mod memory;
mod on_cpu;
mod other_device;
mod pipelines;
mod provided;
mod readback;
mod recordings;
mod refusals;
mod robustness;
mod stale;
mod timing;
mod uniforms;
