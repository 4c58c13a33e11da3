//! Times of a method by what has moved since the frame before.
//!
//! ```
//! use skiagraph_compare::records::regimes::{Regime, RegimeTimes};
//!
//! // As it stands in the list `regimes` of a run.
//! let light: RegimeTimes = serde_json::from_str(
//!     r#"{"regime": "light", "uploaded_bytes": 144, "frame": {
//!         "gpu_ms": null, "gpu_frames": [3, 2], "cpu_ms": null, "cpu_frames": [1, 1],
//!         "wall_ms": {"min": 5, "q1": 5, "median": 5, "q3": 5, "p95": 5},
//!         "wall_frames": [5, 5]}}"#,
//! )?;
//! assert_eq!(light.regime, Regime::Light);
//! let (by_gpu, by_wall) = (light.frame.costs(false), light.frame.costs(true));
//! assert_eq!((by_gpu, by_wall), (Some(vec![4.0, 3.0]), Some(vec![5.0, 5.0])));
//! # Ok::<(), serde_json::Error>(())
//! ```

use crate::records::statistics::FrameTimes;
use serde::{Deserialize, Serialize};

/// Milliseconds of a frame in which nothing moves that are too few to choose a method by.
pub const AT_REST_MS: f64 = 0.1;

/// Kind of frame, by that which has moved since the frame before. A pass whose inputs are unchanged
/// is skipped, so that methods differ in what they do in each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Regime {
    /// Nothing has moved.
    Nothing,
    /// The camera has moved, by far less than a pixel.
    Camera,
    /// The light has moved, by far less than a texel of a shadow map. The camera has not.
    Light,
    /// The parts that the path moves have moved.
    SomeMeshes,
    /// All parts of the mesh have moved.
    AllMeshes,
}

/// Choice of frames: those before each of which that has moved. `None` chooses the frames of a
/// still view in which every pass runs, and all frames of a path.
pub type When = Option<Regime>;

/// Returns the word for such frames in names and limits: `frame`, or `some_meshes`.
pub fn word(when: When) -> String {
    when.map_or("frame".into(), |regime| regime.word().replace(' ', "_"))
}

/// Returns the name of the figure with the time of such a frame: `frame_ms`.
pub fn time_name(when: When) -> String {
    word(when) + "_ms"
}

/// Returns the name of the figure with the quartiles of these times: `frame_quartiles`.
pub fn quartiles_name(when: When) -> String {
    word(when) + "_quartiles"
}

impl Regime {
    /// All regimes, from the least that moves to the most.
    pub const ALL: [Self; 5] = [
        Self::Nothing,
        Self::Camera,
        Self::Light,
        Self::SomeMeshes,
        Self::AllMeshes,
    ];

    /// Returns the head of the column of its times: `nothing`, `camera`, `light`, `some meshes`,
    /// `all meshes`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Camera => "camera",
            Self::Light => "light",
            Self::SomeMeshes => "some meshes",
            Self::AllMeshes => "all meshes",
        }
    }

    /// Returns its condition in a sentence: `while the camera moves`.
    pub fn condition(self) -> &'static str {
        match self {
            Self::Nothing => "while nothing moves",
            Self::Camera => "while the camera moves",
            Self::Light => "while the light moves",
            Self::SomeMeshes => "while some meshes move",
            Self::AllMeshes => "while all meshes move",
        }
    }
}

/// Times of a method in frames before each of which the same has moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RegimeTimes {
    /// The kind of the frames.
    pub regime: Regime,
    /// Times of the frames, with those of the CPU's upkeep.
    pub frame: FrameTimes,
    /// Number of bytes that the CPU has uploaded for the method before a frame: the median.
    pub uploaded_bytes: u64,
    /// Names of the passes that did not run, because none of their inputs had changed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub skipped: Vec<String>,
}
