//! Steady state of a method that remembers earlier frames, in `results.json`.
//!
//! ```
//! use skiagraph_compare::records::steady::Steady;
//!
//! // As it stands under `steady` of a run.
//! let steady: Steady = serde_json::from_str(r#"{"frames": 36, "period": 4}"#)?;
//! match steady.period {
//!     Some(period) => println!("repeats every {period} frames after {}", steady.frames),
//!     None => println!("did not repeat within {} frames", steady.frames),
//! }
//! assert_eq!(steady.period, Some(4));
//! # Ok::<(), serde_json::Error>(())
//! ```

use serde::{Deserialize, Serialize};

/// Steady state of a method that reuses results of earlier frames: the pictures of a still view
/// that it repeats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Steady {
    /// Number of frames that were run, the first without earlier ones to reuse, until the picture
    /// had repeated over 32 frames; 256 if it did not.
    pub frames: u32,
    /// Number of frames after which the picture repeats, at most 16, or the period in which the
    /// graph's passes take turns, if that is longer; [shares of light](crate#terms)
    /// may differ by 1/1024. Null if the picture did not repeat within `frames`.
    pub period: Option<u32>,
    /// The pictures after 1, 4, 16 … of these frames: how fast errors fall from empty memory.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub begin: Vec<EarlyPicture>,
    /// Means over the pictures that were judged in the steady state; absent for a camera path that
    /// begins in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub judged: Option<Cycle>,
}

/// Errors of a picture on the way to the steady state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EarlyPicture {
    /// Number of frames that were run until then, this one included.
    pub frames: u32,
    /// Number of wrong pixels outside the band.
    pub wrong_outside_band: u64,
    /// Root mean square error of the [shares of light](crate#terms), 0 to 1.
    pub rmse: f64,
    /// FLIP error (perceptual difference to the [reference](crate#terms)'s picture, 0 to 1): of two
    /// noises of one RMSE it is less for the one that the eye filters, blue noise.
    pub flip: f64,
}

/// Means over the pictures of a steady state, by which methods are ranked. A run's counts are those
/// of the worst picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// Number of pictures over which the means are taken: one period, or 16 if the picture did not
    /// repeat.
    pub pictures: u32,
    /// Mean number of all wrong pixels of a picture.
    pub wrong_mean: f64,
    /// Mean number of wrong pixels of a picture outside the band (the pixels whose answer rounding
    /// decides).
    pub wrong_outside_band_mean: f64,
    /// Mean of the pictures' root mean square errors of the [shares of light](crate#terms), 0 to 1.
    pub rmse_mean: f64,
    /// Mean of the pictures' FLIP errors (perceptual difference to the [reference](crate#terms)'s
    /// picture, 0 to 1).
    pub flip_mean: f64,
}
