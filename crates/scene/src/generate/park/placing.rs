//! How far apart the park's parts are, and how they are turned.

/// Free space between two parts that would touch in a real park; far below a pixel in every view.
pub(super) const GAP: f64 = 0.02;

/// How bench and planter are turned, as a fraction of a full turn: their long sides lie across the
/// light, but 10° off, so that no side face lies along it. There n · l and the shadows of
/// neighbours would hang on the last bits.
pub(super) const ACROSS_THE_LIGHT: f64 = 0.18;
