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
    /// A mark that has no place in its panel, or a size without a meaning.
    #[error("panel {panel:?}, series {series:?}: {why}")]
    Mark {
        /// The panel's title.
        panel: String,
        /// The series' name.
        series: String,
        /// Place or size of the mark, and what is expected of it.
        why: String,
    },
    /// The library that draws gave up.
    #[error("the chart cannot be drawn: {0}")]
    Drawing(String),
}
