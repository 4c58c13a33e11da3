//! Scenes on which shadow methods go wrong: the catalogue of `skiagraph stress`.
//!
//! Every case is a function that builds a small scene, the same bits on every machine, with one
//! view named `main`, and says in a line what it provokes. Where geometry alone tells which points
//! are lit, it tells so, so that the oracle is tested, too.

mod answer;
mod case;
mod catalogue;
mod fences;
mod lamps;
mod light;
mod lists;
mod map;
mod masked;
mod plain;
mod rounding;
mod shape;
mod soft;
mod solids;
mod thin;
mod topology;

pub use case::{Casters, HardCase, Shows};
pub use catalogue::{case, cases};
