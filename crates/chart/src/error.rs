//! Why a chart cannot be drawn.

use thiserror::Error;

/// Why a chart cannot be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A figure without a mark.
    #[error("there is nothing to draw: panel {panel:?} has no marks")]
    Empty {
        /// The panel's title.
        panel: String,
    },
    /// A value that an axis has no place for.
    #[error(
        "panel {panel:?}, series {series:?}: ({x}, {y}) has no place on the axes; values must be \
         finite and above 0, upwards in a front at least 0, over frames both at least 0"
    )]
    Value {
        /// The panel's title.
        panel: String,
        /// The series' name.
        series: String,
        /// The mark's place to the right.
        x: f64,
        /// The mark's place upwards.
        y: f64,
    },
    /// A bar that belongs to no group or has no height.
    #[error(
        "panel {panel:?}, series {series:?}: ({x}, {y}) is no bar; expected the index of one of \
         {groups} groups, and a finite height of at least 0"
    )]
    Bar {
        /// The panel's title.
        panel: String,
        /// The series' name.
        series: String,
        /// The bar's group.
        x: f64,
        /// Its height.
        y: f64,
        /// How many groups there are.
        groups: usize,
    },
    /// A mark whose size has no meaning.
    #[error("panel {panel:?}, series {series:?}: size {size} of a mark, of {sizes} that there are")]
    Size {
        /// The panel's title.
        panel: String,
        /// The series' name.
        series: String,
        /// The mark's size.
        size: usize,
        /// How many there are.
        sizes: usize,
    },
    /// The library that draws gave up.
    #[error("the chart cannot be drawn: {0}")]
    Drawing(String),
}
