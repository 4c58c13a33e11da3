//! Scenes on which shadow methods go wrong: the catalogue of `skiagraph stress`.
//!
//! Every case builds a small scene with one view named `main` and one light, with the same bits on
//! every machine. One line of text says which error the case provokes. Of most cases the geometry
//! alone tells which points are lit: tests hold the ray tracer of the reference against it.
//!
//! ```
//! for case in skiagraph_cases::cases().into_iter().take(3) {
//!     let scene = case.scene();
//!     assert_eq!(scene.views[0].name, "main", "{}: {}", case.name, case.reason);
//! }
//! ```

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
#[cfg(test)]
mod tests;
mod thin;
mod topology;

pub use case::{Casters, HardCase};
pub use catalogue::{case, cases};
