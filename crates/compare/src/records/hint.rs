//! A hint at a setting with which most of a method's wrong pixels are right.
//!
//! ```
//! use skiagraph_compare::records::hint::Cause;
//!
//! assert_eq!(Cause::OpenParts.words(), "are shadowed by open parts alone");
//! ```

use serde::{Deserialize, Serialize};

/// Cause of most of a method's wrong pixels, and a setting that was tried on the same view and
/// makes more than half of them right.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hint {
    /// Cause of the wrong pixels.
    pub cause: Cause,
    /// Number of wrong pixels outside the band that have this cause.
    pub explained: u64,
    /// Number of all wrong pixels outside the band.
    pub wrong: u64,
    /// The method with the setting to try and what `--set` gave to it, as an argument of `compare`:
    /// `nsm@cull=none,slope_bias=1`.
    pub set: String,
    /// Number of wrong pixels outside the band with that setting.
    pub wrong_then: u64,
}

/// Cause of wrong pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// Wrongly lit: the shadow is that of an open part alone, such as a wall with one side, and the
    /// map does not hold the side that faces the light.
    OpenParts,
    /// Wrongly in shadow, with nothing between them and the light.
    NoBlocker,
}

impl Cause {
    /// Returns the words behind "of so many wrong pixels so many": `are shadowed by open parts`.
    pub fn words(self) -> &'static str {
        match self {
            Self::OpenParts => "are shadowed by open parts alone",
            Self::NoBlocker => "are in shadow with nothing before the light",
        }
    }
}
