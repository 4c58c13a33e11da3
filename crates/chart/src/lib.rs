//! Draws charts of measurements: takes plain values and returns SVG. The crate does not depend on
//! the kind of measurement.
//!
//! A [`Figure`] is one picture of one or several [`Panel`]s that share a legend. Both axes of a
//! panel are logarithmic, except in [`Kind::Frames`].
//!
//! - [`Kind::Front`] shows two costs, draws the Pareto front and fills the marks on it. Values of 0
//!   stand in a strip below the axis, with a lane for each series, so that exact methods can be
//!   seen.
//! - [`Kind::Growth`] joins the marks of a series and draws a line of linear growth.
//! - [`Kind::Frames`] shows how a value changes along a path.
//!
//! [`Figure::to_svg`] is for files. [`Figure::to_page_svg`] is for a web page that has its own
//! title and legend: colours are variables of the page's style, series and marks are groups that a
//! script can find, and marks have their names beside them where there is room.
//!
//! Series differ by colour (Okabe and Ito's palette for colour-blind readers, 2008) *and* shape.
//! The same input always gives the same bytes.
//!
//! ```
//! use skiagraph_chart::{Figure, Kind, Mark, Panel, Series};
//!
//! let series = |name: &str, x, y| Series {
//!     name: name.into(),
//!     marks: vec![Mark::new(x, y)],
//! };
//! let figure = Figure {
//!     title: "Time against error".into(),
//!     panels: vec![Panel {
//!         title: "park".into(),
//!         kind: Kind::Front,
//!         x: "ms".into(),
//!         y: "wrong pixels, %".into(),
//!         series: vec![series("exact", 900.0, 0.0), series("fast", 60.0, 4.7)],
//!     }],
//!     ..Figure::default()
//! };
//! assert!(figure.to_svg()?.starts_with("<svg"));
//! # Ok::<(), skiagraph_chart::Error>(())
//! ```

mod canvas;
mod colours;
mod data;
mod error;
mod figure;
mod frames;
mod front;
mod legend;
mod marker;
mod panel;
mod scale;
mod text;

pub use data::{Kind, Mark, Panel, Series};
pub use error::Error;
pub use figure::Figure;
pub use front::front;
pub use text::{superscript, xml};
