//! Error of a chart that cannot be drawn.

use thiserror::Error;

/// Reasons why a chart cannot be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A panel has no marks.
    #[error("there is nothing to draw: panel {panel:?} has no marks")]
    Empty {
        /// Title of the panel.
        panel: String,
    },
    /// A mark has a value that its panel's axes cannot show (NaN, infinite, negative, 0 on a
    /// logarithmic axis, or not the index of a group), or an unknown size.
    #[error("panel {panel:?}, series {series:?}: {why}")]
    Mark {
        /// Title of the panel.
        panel: String,
        /// Name of the series.
        series: String,
        /// The value or size of the mark, and those that are expected, as text.
        why: String,
    },
    /// The drawing library failed; the text is its message.
    #[error("the chart cannot be drawn: {0}")]
    Drawing(String),
}
