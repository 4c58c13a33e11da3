#![doc = include_str!("../README.md")]
//!
//! A document names *materials* (textures, buffers, samplers) and *passes*, which run in the order
//! of the document. Bindings, and the reads and writes of each pass, come from the shaders by
//! reflection. Each phase is a folder, in this order: `document` (with `compose`, which reads the
//! documents that a document extends and includes), `shader`, `instantiate`, `link`, `flow`,
//! `plan`. `language` and `expressions` hold the two small grammars inside of strings; `errors`
//! holds the mistakes that each phase can report, and their messages.
//!
//! The crate knows no scenes and no shadows. A provider describes the resources that a graph does
//! not make itself ([`Describe`]); the crate `skiagraph-gpu` makes them on a device.
//!
//! # Terms
//!
//! - *Document*: a RON file that describes a graph. [`Graph::load`] reads it with the documents
//!   that it *extends* (takes over and edits) and *includes* (uses as parts). docs/authoring.md is
//!   the guide to its language.
//! - *Host*: the program that loads a graph and runs it in its own frames.
//! - *Material*: a texture, buffer or sampler that a document declares; in a plan a [`Resource`]. A
//!   buffer consists of *items*, the elements of the array that shaders declare.
//! - *Pass*: an entry of a document that does work, such as `Raster(…)`. Its *kind* ([`PassKind`])
//!   turns it into *steps* ([`step::Step`]): draws, dispatches, copies, clears.
//! - *Group*: an entry that puts passes under one name. *Full name*: the name of a pass or material
//!   with the names of the includes and groups around it in front: `left.depth`.
//! - *Param* ([`Param`]): a typed setting of a graph, read by shaders and expressions.
//! - *Provided resource*: a buffer or acceleration structure that the host's *provider* makes
//!   ([`Describe`]), such as the scene's positions. *Import* ([`Import`]): a texture, buffer or
//!   sampler that the host hands over for an *input* of the document.
//! - *Output*: a result that the document lists. *Capture* ([`Capture`]): another content that the
//!   host asks for.
//! - *Plan* ([`Plan`]): a graph for one viewport, device and set of param values. Its *live* passes
//!   run: those whose results are seen in an output, a capture or an import, or by a live pass of
//!   the same frame or a later one, and those that count for a resource that grows. The others are
//!   *culled*.
//! - *Executor*: the type of `skiagraph-gpu` that runs a plan on a device.
//! - *`.previous`*: the content of a material at the end of the frame before.

mod adapter_facts;
mod compose;
pub mod diagnostics;
mod document;
mod errors;
mod expressions;
mod fields;
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
#[cfg(feature = "schema")]
mod written;

pub use adapter_facts::AdapterFacts;
pub use diagnostics::{Code, Diagnostic, Diagnostics, Label, Severity};
pub use document::{Address, Filter};
pub use fields::Chosen;
pub use flow::{
    Aliases, Allocation, Alone, Conditions, Dependences, Hazard, Lifetime, Lifetimes, Schedule,
    When,
};
pub use graph::Graph;
pub use instantiate::{Claim, Run};
pub use kinds::{Lowering, PassKind, Registry, step};
pub use language::{Expr, Name, Reference, wgsl_identifier};
pub use link::{
    Access, Attachment, BindTarget, Block, CAPTURE, Ids, LinkedBinding, LinkedPass, LinkedProgram,
    PassId, Usage,
};
pub use param::{Param, ParamError, ParamFault, ParamType, ParamValue};
pub use picture::Picture;
pub use plan::{CulledPass, MemoryEntry, OutputSummary, PartSummary, PassSummary, Plan, text};
pub use provided_kind::ProvidedKind;
pub use provider::{Describe, Import, NoProvider, Provided, ProvidedBinding};
pub use request::{Capture, PartialBackend, PlanRequest, Request};
pub use resource::{
    Buffer, FRAME_BYTES, Growth, Origin, Resource, ResourceId, ResourceKind, Sampler,
    SubresourceRange, Target, Texture,
};
pub use scalar_class::ItemScalar;
#[cfg(feature = "schema")]
pub use schema::schema;
pub use shader::{Field, Item, Shader};
pub use skiagraph_located_ron::panics::{Panicked, caught};
pub use source::{
    FolderSources, LayeredSources, Located, MemorySources, SourceFile, SourceText, Sources, Span,
};
