//! Charts of measurements: plain data in, SVG out. The crate knows nothing of what was measured.
//!
//! A [`Figure`] is one picture of one or several [`Panel`]s that share a legend. Both axes of a
//! panel are logarithmic, but those of bars and of frames. In a [`Kind::Front`], whose values may
//! be 0, zero has a strip of its own below the axis, with a lane per series, so that exact methods
//! stand beside each other instead of nowhere; the Pareto front is drawn, and what is on it is
//! filled. A [`Kind::Growth`] joins the marks of a series and draws what linear growth would be.
//! [`Kind::Bars`] stand in groups on a linear axis; [`Kind::Frames`] show how a figure changes
//! along a path.
//!
//! [`Figure::to_svg`] is for files. [`Figure::to_page_svg`] is for a page that has title and legend
//! of its own: its colours are variables of the page's style, its series and marks are groups that
//! a script finds, each mark with its name beside it where there is room.
//!
//! Series differ by colour (Okabe and Ito's palette for colour-blind readers, 2008) *and* shape.
//! The same data always give the same bytes.
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

mod bars;
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
pub use text::xml;
