//! Draws the passes and materials of a graph's [`Plan`](skiagraph_graph::Plan): [`from_plan`]
//! converts a plan into a [`Drawing`] of plain values; [`to_svg`] and [`to_dot`] draw it.
//!
//! The SVG is a chart of lifetimes. Passes are rows in the order in which they run, materials are
//! columns, and a bar spans the passes during which a material lives. Its size is passes ×
//! materials, and it never tangles as nodes and links do; AMD's RPS visualiser draws the same way.
//!
//! ```
//! use skiagraph_draw::{from_plan, to_svg};
//! use skiagraph_graph::{Graph, MemorySources, NoProvider, PlanRequest, Registry};
//!
//! let sources = MemorySources::new([
//!     (
//!         "half.ron",
//!         r#"(format: 3, materials: [Texture(name: "image", format: R32Float)],
//!             passes: [Fullscreen(name: "half", color: ["image"])], outputs: ["image"])"#,
//!     ),
//!     ("shaders/half.wgsl", "@fragment fn fragment() -> @location(0) f32 { return 0.5; }"),
//! ]);
//! let graph = Graph::load("half.ron", &Registry::standard(), &sources)?;
//! let plan = graph.plan(&PlanRequest::new([64, 32], &NoProvider))?;
//! let svg = to_svg(&from_plan(&plan));
//! assert!(svg.contains("half") && svg.contains("image"));
//! # Ok::<(), skiagraph_graph::Diagnostics>(())
//! ```

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
