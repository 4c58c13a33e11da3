//! Scenes on which shadow methods go wrong: the catalogue of `skiagraph stress`.
//!
//! Every case builds a small scene with one view named `main` and one light, with the same bits on
//! every machine. One line of text says which error the case provokes. Tests know of most of them from
//! the geometry alone which points are lit, so that the ray tracer of the reference is tested, too.
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
