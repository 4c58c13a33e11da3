//! Phase 4: links shaders with resources. Resolves every reference of every step, checks every
//! binding and attachment, and lists the reads and writes of each pass.

mod attachments;
mod bindings;
mod canvas;
mod capture;
mod covered;
mod cpu;
mod dispatch;
mod layouts;
mod limits;
pub(crate) mod linker;
pub(crate) mod params;
pub(crate) mod pass;
mod programs;
mod rounds;
mod scope;
mod steps;
mod textures;
mod transfers;

pub use pass::{
    Access, Attachment, BindTarget, Block, CAPTURE, Ids, LinkedBinding, LinkedPass, LinkedProgram,
    PassId, Usage,
};

pub(crate) use linker::Linked;
