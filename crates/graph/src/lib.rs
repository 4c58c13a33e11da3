//! A render graph for wgpu, written in RON and WGSL: from documents to a plan, without a GPU.
//!
//! A document names *materials* (textures, buffers, samplers) and *passes*; bindings and access
//! come from the shaders by reflection, order from what passes read and write. The phases are a
//! folder each, in this order: `document` (with `compose`, which reads what it extends and
//! includes), `shader`, `instantiate`, `link`, `flow`, `plan`. `language` has the two small
//! grammars inside of strings, `errors` what can be wrong in each phase and how it is told.
//!
//! The crate knows no scenes and no shadows. A provider describes the resources that a graph does
//! not make itself ([`Describe`]); the crate `skiagraph-gpu` makes them on a device.

mod compose;
pub mod diagnostics;
mod document;
mod errors;
mod expressions;
mod flow;
mod graph;
mod instantiate;
mod kinds;
mod language;
mod link;
mod param;
mod picture;
mod plan;
mod provided_kind;
mod provider;
mod request;
mod resource;
mod scalar_class;
#[cfg(feature = "schema")]
mod schema;
mod shader;
mod source;

pub use diagnostics::{Code, Diagnostic, Diagnostics, Label, Severity};
pub use document::{Address, Chosen, Filter};
pub use flow::{
    Aliases, Allocation, Conditions, Dependences, Hazard, Lifetime, Lifetimes, Schedule, When,
};
pub use graph::Graph;
pub use instantiate::{Claim, Run};
pub use kinds::{Lowering, PassKind, Registry, step};
pub use language::{Expr, Name, Reference, Scalar, Value, Word, wgsl_identifier};
pub use link::{
    Access, Attachment, BindTarget, Block, CAPTURE, Ids, LinkedBinding, LinkedPass, LinkedProgram,
    PassId, Usage,
};
pub use param::{Param, ParamError, ParamFault, ParamType, ParamValue};
pub use picture::Picture;
pub use plan::{CulledPass, MemoryEntry, OutputSummary, PartSummary, PassSummary, Plan, text};
pub use provided_kind::ProvidedKind;
pub use provider::{Describe, Import, NoProvider, Provided, ProvidedBinding};
pub use request::{Capture, PartialBackend, PlanRequest};
pub use resource::{
    Buffer, FRAME_BYTES, Growth, Origin, Resource, ResourceId, ResourceKind, Sampler,
    SubresourceRange, Target, Texture,
};
#[cfg(feature = "schema")]
pub use schema::schema;
pub use shader::{Field, Item, ItemScalar, Shader};
pub use skiagraph_located_ron::panics::{Panicked, caught};
pub use source::{FolderSources, LayeredSources, Located, SourceFile, SourceText, Sources, Span};
