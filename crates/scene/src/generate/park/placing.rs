//! How far apart the park's parts are, and how they are turned.

pub(super) use crate::generate::solid::GAP;

/// How bench and planter are turned, as a fraction of a full turn: their long sides lie across the
/// light, but 10° off, so that no side face lies along it. There n · l and the shadows of
/// neighbours would hang on the last bits.
pub(super) const ACROSS_THE_LIGHT: f64 = 0.18;
