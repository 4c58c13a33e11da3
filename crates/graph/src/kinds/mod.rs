//! Pass kinds: the kinds of entries that `passes` may have, and their lowering to steps. Each kind
//! has its own file.

mod blend;
mod clear;
mod compute;
mod copy;
mod entry_name;
mod fullscreen;
pub(crate) mod kind;
mod raster;
pub(crate) mod registry;
pub mod step;
mod targets;

pub use kind::{Lowering, PassKind};
pub use registry::Registry;

pub(crate) use kind::OF_PASS;
pub(crate) use registry::StandIn;
pub(crate) use step::{
    ColorTarget, CpuCall, CpuItems, DepthTarget, Dispatch, Draw, DrawCall, Groups, Names, Operand,
    Program, Scratch, ShaderUse, Stage, StencilTarget, Step, Threads,
};
