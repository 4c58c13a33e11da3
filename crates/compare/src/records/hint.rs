//! A hint at a setting with which most of a method's wrong pixels are right.
//!
//! ```
//! use skiagraph_compare::records::hint::Cause;
//!
//! assert_eq!(Cause::OpenParts.words(), "are shadowed by open parts alone");
//! ```

use serde::{Deserialize, Serialize};

/// Cause of most of a method's wrong pixels on a view, and a setting that was tried on this view
/// and makes more than half of them right. Pixels whose right answer rounding may flip are not
/// counted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hint {
    /// Cause of the wrong pixels.
    pub cause: Cause,
    /// Number of the pixels of `wrong` that have this cause.
    pub explained: u64,
    /// Number of wrong pixels of the method on the view, without those whose right answer rounding
    /// may flip.
    pub wrong: u64,
    /// The method with the setting to try and what `--set` gave to it, as an argument of `compare`:
    /// `nsm@cull=none,slope_bias=1`.
    pub set: String,
    /// Number of wrong pixels with the setting `set`, without those whose right answer rounding may
    /// flip.
    pub wrong_then: u64,
}

/// Cause of wrong pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The pixels are lit by mistake: only an open part of the mesh, such as a one-sided wall,
    /// blocks their light, and the shadow map does not hold the side that faces the light.
    OpenParts,
    /// The pixels are in shadow by mistake: nothing is between them and the light.
    NoBlocker,
}

impl Cause {
    /// Returns the cause as the end of a sentence whose subject is the pixels: `are shadowed by
    /// open parts alone`.
    pub fn words(self) -> &'static str {
        match self {
            Self::OpenParts => "are shadowed by open parts alone",
            Self::NoBlocker => "are in shadow with nothing before the light",
        }
    }
}
