//! Phase 3: the tree of entries becomes one list of passes and one of resources, each with its full
//! name, every size a number.
//!
//! How often something is repeated follows params and sizes, hence this is done for every plan.

pub(crate) mod build;
pub(crate) mod flat;
mod growth;
pub(crate) mod include;
pub(crate) mod lower;
mod materials;
pub(crate) mod merge;
pub(crate) mod params;
mod parts;
pub(crate) mod scopes;
pub(crate) mod state;
pub(crate) mod symbols;

pub use flat::Run;
pub use params::Claim;
