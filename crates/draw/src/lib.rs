//! Seeing a plan: [`Drawing`] holds as plain data what a plan made of a document; [`to_svg`] and
//! [`to_dot`] draw it.
//!
//! The SVG is a chart of lifetimes, not of nodes and links: passes are rows in the order in which
//! they run, materials are columns, a bar is the time that a material lives. It grows with passes ×
//! materials but never tangles; AMD's RPS visualiser draws the same way.

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
