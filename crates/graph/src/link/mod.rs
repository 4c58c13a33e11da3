//! Phase 4: shaders meet resources. Every reference of every step is resolved, every binding and
//! attachment checked, and what each pass reads and writes is written down.

mod attachments;
mod bindings;
mod canvas;
mod capture;
mod covered;
mod dispatch;
mod layouts;
mod limits;
pub(crate) mod linker;
pub(crate) mod params;
pub(crate) mod pass;
mod programs;
mod scope;
mod steps;
mod textures;
mod transfers;

pub use pass::{
    Access, Attachment, BindTarget, Block, CAPTURE, Ids, LinkedBinding, LinkedPass, LinkedProgram,
    PassId, Usage,
};
