//! The schema of `adapter.json`, version 1: everything that `skiagraph adapter` found out about one
//! adapter, in one small file. It names no host.
//!
//! ```
//! use skiagraph_compare::records::adapter::{AdapterRecord, Outcome};
//!
//! let text = r#"{"schema": 1, "program": "skiagraph 0.1.0", "commit": null, "is_small": true,
//!     "abilities": null, "rows": [{"row": "hard", "command": "skiagraph stress rt", "outcome":
//!     "timed_out", "exit": null, "signal": 9, "seconds": 60.1, "limit": 60, "date": "2026-11-27",
//!     "said": [], "figures": {}}]}"#;
//! let record: AdapterRecord = serde_json::from_str(text)?;
//! assert_eq!(record.row("hard").map(|row| row.outcome), Some(Outcome::TimedOut));
//! # Ok::<(), serde_json::Error>(())
//! ```

use crate::records::abilities::Abilities;
use crate::records::rays::{Conformance, RaySetSpeed};
use serde::{Deserialize, Serialize};

/// Content of `adapter.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdapterRecord {
    /// Version of this schema: 1.
    pub schema: u32,
    /// The program that measured, `skiagraph 0.1.0`.
    pub program: String,
    /// Commit that it was built from; null where it does not know.
    pub commit: Option<String>,
    /// True if the rows were the small ones, which try the way and measure little.
    pub is_small: bool,
    /// Abilities of the adapter, without the host's name; null before the first row.
    pub abilities: Option<Abilities>,
    /// The rows that have run, in their order.
    pub rows: Vec<RowRecord>,
}

/// One row: a command that ran in a process of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowRecord {
    /// Name of the row, and of its folder.
    pub row: String,
    /// Its command, as one would type it.
    pub command: String,
    /// How it ended.
    pub outcome: Outcome,
    /// Exit code; null if a signal ended the process.
    pub exit: Option<i32>,
    /// Signal that ended the process; null without one.
    pub signal: Option<i32>,
    /// Seconds that it took.
    pub seconds: f64,
    /// Seconds that it was given.
    pub limit: u64,
    /// Day on which it ran, `2026-11-27` (UTC).
    pub date: String,
    /// Last lines that it wrote to standard error, where it did not end well.
    pub said: Vec<String>,
    /// Figures from its files.
    pub figures: Figures,
}

/// How a row ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Well.
    Done,
    /// It found a fault, or could not run: exit code 1, 2, 4 or 5.
    Failed,
    /// The device was lost or hung: exit code 3.
    Lost,
    /// A signal ended the process: it crashed.
    Crashed,
    /// It did not end within its time.
    TimedOut,
    /// Not run, as the adapter lacks what it needs.
    Lacking,
}

impl Outcome {
    /// Returns the words for tables.
    pub fn words(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Failed => "failed",
            Self::Lost => "device lost",
            Self::Crashed => "crashed",
            Self::TimedOut => "timed out",
            Self::Lacking => "not on this adapter",
        }
    }
}

/// Figures of a row.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Cells of a comparison.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cells: Vec<CellFigures>,
    /// Methods that must answer alike to the bit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub equal: Vec<Equality>,
    /// Hard cases by method.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hard: Vec<HardFigures>,
    /// Rays whose right answer is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rays: Option<Conformance>,
    /// Speed of the engines.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub any_hits: Vec<RaySetSpeed>,
}

/// A method on a view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CellFigures {
    /// Name of the scene.
    pub scene: String,
    /// Number of triangles.
    pub triangles: u64,
    /// Name of the view.
    pub view: String,
    /// Name of the light, where there are several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub light: Option<String>,
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// Method with what tells its settings apart.
    pub method: String,
    /// Edge of the shadow map in texels, where there is one.
    pub map_size: Option<u32>,
    /// Reason why it could not run; absent if it did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unavailable: Option<String>,
    /// True if the method's document promises that it is exact on this scene.
    #[serde(default)]
    pub is_exact: bool,
    /// Number of pixels that face the light.
    pub facing: u64,
    /// Number of pixels whose answer rounding decides.
    pub band: u64,
    /// Number of wrong pixels.
    pub wrong: u64,
    /// Number of wrong pixels outside the band.
    pub wrong_outside: u64,
    /// Root mean square error of shares of light; absent for hard answers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rmse: Option<f64>,
    /// Median GPU time of a frame in milliseconds; null without trusted timestamps.
    pub gpu_ms: Option<f64>,
    /// Median time of a frame by the CPU's clock, in milliseconds.
    pub wall_ms: f64,
    /// Pass with the longest 95th percentile of GPU time, and that time in milliseconds; null
    /// without trusted timestamps.
    pub longest_pass: Option<(String, f64)>,
}

/// Two methods that must answer alike.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Equality {
    /// Name of the scene.
    pub scene: String,
    /// Name of the view.
    pub view: String,
    /// Both methods.
    pub methods: [String; 2],
    /// Number of pixels compared.
    pub pixels: u64,
    /// Number of pixels whose `visibility` differs in a bit.
    pub differing: u64,
}

/// A method on all hard cases.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HardFigures {
    /// Method with what tells its settings apart.
    pub method: String,
    /// Number of cells that kept the method's guarantee.
    pub passed: u64,
    /// Number of cells that broke it, or did not run.
    pub failed: u64,
    /// Number of wrong pixels outside the band, over all cells.
    pub wrong_outside: u64,
    /// Names of the cases in which it failed.
    pub failed_cases: Vec<String>,
}

impl CellFigures {
    /// True if both are the same cell, on whichever adapter.
    pub fn is_same(&self, other: &Self) -> bool {
        let key = |of: &Self| {
            (
                of.scene.clone(),
                of.view.clone(),
                of.light.clone(),
                of.method.clone(),
            )
        };
        key(self) == key(other)
            && (self.viewport, self.map_size) == (other.viewport, other.map_size)
            // Cities of several sizes have one name.
            && self.triangles == other.triangles
    }

    /// Returns the share of wrong pixels, those in the band included, among those that face the
    /// light, in percent; 0 if no pixel faces the light, also of a cell that is
    /// [unavailable](Self::unavailable).
    pub fn wrong_percent(&self) -> f64 {
        percent(self.wrong, self.facing)
    }

    /// Returns the share of pixels whose answer rounding decides among those that face the light,
    /// in percent; 0 if none faces it.
    pub fn band_percent(&self) -> f64 {
        percent(self.band, self.facing)
    }
}

fn percent(count: u64, whole: u64) -> f64 {
    100.0 * count as f64 / whole.max(1) as f64
}

impl AdapterRecord {
    /// Returns the row of a name, if it has run.
    pub fn row(&self, name: &str) -> Option<&RowRecord> {
        self.rows.iter().find(|row| row.row == name)
    }

    /// Returns the cells of all rows.
    pub fn cells(&self) -> impl Iterator<Item = &CellFigures> {
        self.rows.iter().flat_map(|row| &row.figures.cells)
    }

    /// Returns name, interface and driver of the adapter; `None` before the first row.
    pub fn adapter(&self) -> Option<String> {
        Some(self.abilities.as_ref()?.adapter.to_string())
    }
}
