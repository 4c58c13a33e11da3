//! Draws the passes and materials of a graph's [`Plan`](skiagraph_graph::Plan): [`from_plan`]
//! converts a plan into a [`Drawing`] of plain values; [`to_svg`] and [`to_dot`] draw it.
//!
//! The SVG is a chart of lifetimes. Passes are rows in the order in which they run, materials are
//! columns, and a bar spans the passes during which a material lives. Its size is passes ×
//! materials, and it never tangles as nodes and links do; AMD's RPS visualiser draws the same way.

mod canvas;
mod chart;
mod dot;
mod drawing;
mod gather;
mod layout;
#[cfg(test)]
mod layout_tests;
mod legend;
mod marks;
mod reduction;
mod svg;
mod text;
mod words;

pub use dot::to_dot;
pub use drawing::{Access, Aspect, Drawing, Edge, Kind, Material, Origin, Part, Pass, Reason};
pub use gather::from_plan;
pub use skiagraph_graph::Hazard;
pub use svg::to_svg;
