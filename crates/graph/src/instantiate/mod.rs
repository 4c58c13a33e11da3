//! Phase 3: flattens the tree of entries into one list of passes and one of resources. Each has its
//! full name, and every size becomes a number.
//!
//! The number of repetitions depends on params and sizes, so this is done anew for every plan.

pub(crate) mod build;
mod environment;
pub(crate) mod flat;
mod growth;
mod imports;
pub(crate) mod include;
pub(crate) mod lower;
mod materials;
pub(crate) mod merge;
mod modules;
pub(crate) mod params;
mod parts;
mod resolve;
mod runs;
pub(crate) mod scopes;
pub(crate) mod settings;
pub(crate) mod state;
pub(crate) mod symbols;

pub use flat::Run;
pub use params::Claim;

pub(crate) use flat::{Flat, Merge, PlanInputs, Round};
pub(crate) use lower::LoweredPass;
pub(crate) use params::{BoundParam, Surroundings};
pub(crate) use scopes::{InstanceId, Position};
pub(crate) use settings::Settings;
pub(crate) use symbols::{At, SymbolTable};
