//! The frames of a camera path, in `results.json`.
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

use crate::records::statistics::FrameTimes;
use serde::{Deserialize, Serialize};
use skiagraph_reference::{Graded, Shimmer};
use std::collections::BTreeMap;

/// Measurements of each frame of a path. The run's own counts are the sums over all frames, its
/// times the spread over them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sequence {
    /// In their order.
    pub frames: Vec<SequenceFrame>,
    /// Answers that changed though the right ones did not, all frames together.
    pub shimmer: Shimmer,
    /// The spread over the path of the frames' times with every pass run; absent where no frame
    /// skips one, and with `--cached-frames 0`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub every_pass: Option<FrameTimes>,
}

/// One frame of a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SequenceFrame {
    /// Pixels facing the light (PFL).
    pub facing_light: u64,
    /// Number of these that are wrong, in-band pixels included.
    pub wrong: u64,
    /// Number of these that are wrong outside the band.
    pub wrong_outside_band: u64,
    /// How far the shown shares of light are off.
    pub graded: Graded,
    /// Rays traced; null where the graph does not count them.
    pub rays: Option<u64>,
    /// Its times; they stand beside its other figures.
    #[serde(flatten)]
    pub cost: FrameCost,
    /// Beside the frame before; absent in the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shimmer: Option<Shimmer>,
    /// Passes that did not run, as nothing that they read had changed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub skipped: Vec<String>,
    /// Resources of the scene that were made anew before it, as something that they follow from has
    /// changed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remade: Vec<Remade>,
    /// Its times when every pass runs: what it costs without what is kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub every_pass: Option<FrameCost>,
}

/// A resource of the scene that was made anew before a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Remade {
    /// Its name.
    pub name: String,
    /// `made`, or `refitted`, of a hierarchy.
    pub how: String,
    /// Time that this took on the CPU in milliseconds, uploads included; not part of the frame's
    /// times.
    pub ms: f64,
}

/// The times of one frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameCost {
    /// From the first pass's begin to the last one's end; null where it cannot be had or trusted.
    pub gpu_ms: Option<f64>,
    /// From the start of encoding until the outputs were read back.
    pub wall_ms: f64,
}

impl FrameCost {
    /// The GPU's time, or that of the wall where there is none.
    pub fn ms(self) -> f64 {
        self.gpu_ms.unwrap_or(self.wall_ms)
    }
}

impl SequenceFrame {
    /// By what frames are ranked: the root mean square error of shares.
    pub fn error(&self) -> f64 {
        self.graded.rmse
    }
}

impl Sequence {
    /// The frame with the largest [error](SequenceFrame::error), the first of equal ones, with its
    /// index: the one that columns name and that pictures are of.
    pub fn worst(&self) -> Option<(usize, &SequenceFrame)> {
        greatest(self.frames.iter(), |frame| frame.error())
    }

    /// The frame that takes the longest as it is, the first of equal ones, with its index.
    pub fn slowest(&self) -> Option<(usize, FrameCost)> {
        greatest(self.frames.iter().map(|frame| frame.cost), |cost| cost.ms())
    }

    /// The frame that takes the longest with every pass run.
    pub fn slowest_with_every_pass(&self) -> Option<(usize, FrameCost)> {
        greatest(
            self.frames.iter().filter_map(|frame| frame.every_pass),
            |cost| cost.ms(),
        )
    }

    /// Lists resources of the scene whose remaking took a tenth of a millisecond or more, each with
    /// how, in how many frames, and the median time in ms.
    pub fn remade<'s>(&'s self) -> Vec<(&'s str, &'s str, usize, f64)> {
        let all = self.frames.iter().flat_map(|frame| &frame.remade);
        let mut times: BTreeMap<(&str, &str), Vec<f64>> = BTreeMap::new();
        for Remade { name, how, ms } in all {
            times.entry((name, how)).or_default().push(*ms);
        }
        let median = |((name, how), mut times): ((&'s str, &'s str), Vec<f64>)| {
            times.sort_by(f64::total_cmp);
            (name, how, times.len(), times[times.len() / 2])
        };
        let all = times.into_iter().map(median);
        all.filter(|(.., ms)| *ms >= 0.1).collect()
    }
}

/// The first item of the greatest figure, with its index.
fn greatest<T>(items: impl Iterator<Item = T>, figure: impl Fn(&T) -> f64) -> Option<(usize, T)> {
    items.enumerate().reduce(|most, other| {
        let is_more = figure(&other.1) > figure(&most.1);
        if is_more { other } else { most }
    })
}
