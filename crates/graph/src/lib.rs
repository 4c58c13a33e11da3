//! A render graph for wgpu, written in RON and WGSL.
//!
//! A document names *materials* (textures, buffers, samplers) and *passes*; bindings and access come from the shaders by
//! reflection, order from what passes read and write. The phases are one file each, in this order:
//! [`document`] (with `include`), `instantiate`, `resolve`, `wgsl` (reflection), `link`, `order`, `cull`, `schedule`, `lifetime`,
//! `conditions`, `pool`, `allocate`, `execute`.
//! All before `allocate` are pure functions on plain data and need no GPU.
//!
//! The crate knows no scenes and no shadows: what a graph does not make itself comes from a [`Provider`].

mod allocate;
mod conditions;
mod cull;
pub mod diagnostics;
pub mod document;
pub mod draw;
mod execute;
pub mod gpu;
mod graph;
mod include;
mod instantiate;
mod lifetime;
mod link;
mod memory;
mod order;
#[cfg(test)]
mod order_tests;
mod passes;
mod plan;
mod pool;
mod provider;
mod readback;
pub mod registry;
mod resolve;
mod schedule;
mod source;
pub mod step;
pub mod timing;
mod wgsl;

pub use diagnostics::{Code, Diagnostic, Diagnostics, Label, Severity};
pub use document::{
    located::Located,
    params::{Param, ParamType, ParamValue},
};
pub use draw::Drawing;
pub use execute::{ExecuteError, Executor, Frame, FrameReport, Renewed};
pub use graph::{Graph, ParamError};
pub use instantiate::Fallback;
pub use plan::{
    Capture, CulledPass, Field, Item, MemoryEntry, OutputSummary, PassSummary, Plan, PlanRequest,
    Scalar,
};
pub use provider::{Import, NoProvider, Provided, Provider, ProviderError};
pub use readback::{Content, Readback};
pub use registry::{Lowering, PassKind, Registry};
pub use source::{FolderSources, LayeredSources, SourceFile, Sources, Span};
pub use step::{Dispatch, Draw, Groups, Program, Step};
pub use timing::{FrameTiming, PassTiming};
