//! Measurements of the frames of a camera path, in `results.json`.
//!
//! ```
//! use skiagraph_compare::records::sequence::Sequence;
//!
//! // As it stands under `sequence` of a run.
//! let path: Sequence = serde_json::from_str(
//!     r#"{"shimmer": {"compared": 900, "changed": 3}, "frames": [
//!         {"facing_light": 900, "wrong": 2, "wrong_outside_band": 0,
//!             "graded": {"rmse": 0.05}, "rays": null, "gpu_ms": null, "wall_ms": 3.5},
//!         {"facing_light": 900, "wrong": 7, "wrong_outside_band": 1,
//!             "graded": {"rmse": 0.09}, "rays": null, "gpu_ms": null, "wall_ms": 3.0}]}"#,
//! )?;
//! let (worst, _) = path.worst().ok_or("a path has frames")?;
//! let (slowest, cost) = path.slowest().ok_or("a path has frames")?;
//! assert_eq!((worst, slowest, cost.ms()), (1, 0, 3.5));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::records::statistics::median;
use serde::{Deserialize, Serialize};
use skiagraph_reference::{Graded, Shimmer};
use std::collections::BTreeMap;

/// Measurements of each frame of a camera path. The counts of its run are sums over all frames; the
/// run's times are order statistics over the frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sequence {
    /// Measurements of each frame, in the order of the path.
    pub frames: Vec<SequenceFrame>,
    /// Counts, over all frames, of answers that changed from one frame to the next although the
    /// right answers did not.
    pub shimmer: Shimmer,
}

/// Measurements of one frame of a camera path.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SequenceFrame {
    /// Number of pixels whose visible surface faces the light.
    pub facing_light: u64,
    /// Number of pixels facing the light on which method and reference disagree, also where
    /// rounding decides the answer.
    pub wrong: u64,
    /// Number of wrong pixels facing the light outside the band, which is the set of pixels whose
    /// answer rounding decides.
    pub wrong_outside_band: u64,
    /// Errors of the [shares of light](crate#terms), 0 to 1, that the frame shows.
    pub graded: Graded,
    /// Number of rays traced in the frame; null where the graph does not count them.
    pub rays: Option<u64>,
    /// Times of the frame. In JSON the fields of this struct are beside the other fields.
    #[serde(flatten)]
    pub cost: FrameCost,
    /// Counts of the answers that changed since the frame before; absent in the first frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shimmer: Option<Shimmer>,
    /// Names of the passes that did not run, because none of their inputs had changed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub skipped: Vec<String>,
    /// Resources of the scene (such as its bounding-volume hierarchy) that were built again before
    /// the frame, because something that they depend on had changed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remade: Vec<Remade>,
}

/// A resource of the scene that was built again before a frame, such as a hierarchy over moved
/// triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Remade {
    /// Name of the resource in graph documents.
    pub name: String,
    /// `made` if it was built from scratch, `refitted` for a hierarchy whose boxes were updated.
    pub how: String,
    /// Milliseconds that the work took on the CPU, uploads included; part of the frame's upkeep.
    pub ms: f64,
}

/// Times of one frame of a camera path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameCost {
    /// GPU time in milliseconds, from the start of the first pass to the end of the last; null if
    /// there are no timestamps or they cannot be trusted.
    pub gpu_ms: Option<f64>,
    /// CPU time of the frame's upkeep in milliseconds: what is made of the scene for the method,
    /// new bind groups and encoding.
    #[serde(default)]
    pub cpu_ms: f64,
    /// Milliseconds from the start of the upkeep until the GPU was done, by the CPU's clock.
    pub wall_ms: f64,
}

impl FrameCost {
    /// Returns GPU time and upkeep in milliseconds, added; without GPU time the time by the CPU's
    /// clock.
    pub fn ms(self) -> f64 {
        self.gpu_ms.map_or(self.wall_ms, |gpu| gpu + self.cpu_ms)
    }
}

impl SequenceFrame {
    /// Returns the error by which frames are ranked: the root mean square error of the [shares of
    /// light](crate#terms).
    pub fn error(&self) -> f64 {
        self.graded.rmse
    }
}

impl Sequence {
    /// Returns the frame with the largest [error](SequenceFrame::error) and its index, the first of
    /// equal ones. Columns and pictures show this frame. Returns `None` if there are no frames.
    pub fn worst(&self) -> Option<(usize, &SequenceFrame)> {
        greatest(self.frames.iter(), |frame| frame.error())
    }

    /// Returns the index and times of the frame that takes longest, the first of equal ones; `None`
    /// if there are no frames.
    pub fn slowest(&self) -> Option<(usize, FrameCost)> {
        greatest(self.frames.iter().map(|frame| frame.cost), |cost| cost.ms())
    }

    /// Lists the resources of the scene that took a median of 0.1 ms or more to build again between
    /// frames: name, `made` or `refitted`, number of frames, and median time in milliseconds. They
    /// are sorted by name.
    pub fn remade<'s>(&'s self) -> Vec<(&'s str, &'s str, usize, f64)> {
        let remade = self.frames.iter().flat_map(|frame| &frame.remade);
        let mut times: BTreeMap<(&str, &str), Vec<f64>> = BTreeMap::new();
        for Remade { name, how, ms } in remade {
            times.entry((name, how)).or_default().push(*ms);
        }
        let medians = |((name, how), times): ((&'s str, &'s str), Vec<f64>)| {
            (name, how, times.len(), median(times))
        };
        let medians = times.into_iter().map(medians);
        medians.filter(|(.., ms)| *ms >= 0.1).collect()
    }
}

/// The first item of the greatest figure, with its index.
pub(super) fn greatest<T>(
    items: impl Iterator<Item = T>,
    figure: impl Fn(&T) -> f64,
) -> Option<(usize, T)> {
    items.enumerate().reduce(|most, other| {
        let is_more = figure(&other.1) > figure(&most.1);
        if is_more { other } else { most }
    })
}
