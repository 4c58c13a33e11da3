//! The steady state of a method that remembers, in `results.json`.
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

/// How long a view stood still until a method that remembers showed the same again and again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Steady {
    /// Frames until then, the first of them with an empty memory.
    pub frames: u32,
    /// Its picture repeats after so many frames, a graded one within 1/1024; null if it did not
    /// within `frames`.
    pub period: Option<u32>,
    /// The cycle that was judged in this state; absent where a camera path begins in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub judged: Option<Cycle>,
}

/// Pictures of the steady state. By their mean methods are ranked; a run's counts are those of the
/// worst.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// How many: those of one period, or as many as the longest that was looked for.
    pub pictures: u32,
    /// Wrong pixels of a picture in the mean, in-band ones included.
    pub wrong_mean: f64,
    /// Wrong pixels of a picture outside the band, in the mean.
    pub wrong_outside_band_mean: f64,
    /// Root mean square error of a picture in the mean.
    pub rmse_mean: f64,
    /// FLIP of a picture in the mean.
    pub flip_mean: f64,
}
