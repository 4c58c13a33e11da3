//! Limits on methods that are to be taken.
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

/// Limits on methods that are to be taken, each where there is one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Budgets {
    /// Milliseconds of a frame in which every pass runs, at most.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_ms: Option<f64>,
    /// Wrong pixels outside the band in percent of those facing the light: less than this.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrong_percent: Option<f64>,
    /// Bytes of the method's own materials and of what it reads of the scene, at most.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub memory_bytes: Option<u64>,
}

impl Budgets {
    /// True without any.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl fmt::Display for Budgets {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let time = self.frame_ms.map(|ms| format!("at most {ms} ms a frame"));
        let wrong = self
            .wrong_percent
            .map(|share| format!("less than {share} % wrong"));
        let memory = self
            .memory_bytes
            .map(|most| format!("at most {}", bytes(most)));
        let all = [time, wrong, memory].into_iter().flatten();
        f.write_str(&all.collect::<Vec<String>>().join(" and "))
    }
}
