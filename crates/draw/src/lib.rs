#![doc = include_str!("../README.md")]

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
