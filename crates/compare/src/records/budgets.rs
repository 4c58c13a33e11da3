//! Limits on frame time, wrong pixels and memory that an acceptable method keeps.
//!
//! ```
//! use skiagraph_compare::records::budgets::Budgets;
//!
//! let budgets = Budgets {
//!     frame_ms: Some(3.0),
//!     wrong_percent: Some(1.0),
//!     ..Budgets::default()
//! };
//! assert_eq!(budgets.to_string(), "at most 3 ms a frame and less than 1 % wrong");
//! ```

use crate::wording::bytes;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Limits that an acceptable method keeps on every view and in every frame of a camera path, set by
/// the user; `None` for no limit. They are recorded with the results and change no measurement: a
/// report recommends no method that exceeds one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Budgets {
    /// Most milliseconds of a frame in which every pass runs: the median of a view's frames, or
    /// any frame of a camera path, of GPU times. If any method of the comparison lacks GPU times,
    /// wall times of all are taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_ms: Option<f64>,
    /// Limit on wrong pixels outside the band (pixels whose answer rounding decides), in percent of
    /// the pixels facing the light. A method must stay below it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrong_percent: Option<f64>,
    /// Most bytes that the textures and buffers of the method, and the scene data that it reads,
    /// may take together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub memory_bytes: Option<u64>,
}

impl Budgets {
    /// True if there are no limits.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// True if a frame's time or memory is limited.
    pub fn limits_cost(&self) -> bool {
        self.frame_ms.is_some() || self.memory_bytes.is_some()
    }
}

impl fmt::Display for Budgets {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let time = self.frame_ms.map(|ms| format!("at most {ms} ms a frame"));
        let (wrong, memory) = (self.wrong_percent, self.memory_bytes);
        let wrong = wrong.map(|share| format!("less than {share} % wrong"));
        let memory = memory.map(|most| format!("at most {}", bytes(most)));
        let limits = [time, wrong, memory].into_iter().flatten();
        f.write_str(&limits.collect::<Vec<String>>().join(" and "))
    }
}
