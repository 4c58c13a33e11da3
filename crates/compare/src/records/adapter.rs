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
use serde::{Deserialize, Serialize};

/// Content of `adapter.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdapterRecord {
    /// Version of this schema: 1.
    pub schema: u32,
    /// The program that measured, `skiagraph 0.1.0`.
    pub program: String,
    /// Commit that the program was built from; null where the program does not know it.
    pub commit: Option<String>,
    /// True if the rows are the small ones of [`rows`](crate::adapters::rows::rows), which only try
    /// the way.
    pub is_small: bool,
    /// Abilities of the adapter, without the machine's host name and load; null if they are
    /// unknown.
    pub abilities: Option<Abilities>,
    /// The rows that have ended, in the order in which they ended; the new record of a row that ran
    /// again stands last and replaces the old one. Rows that the adapter [lacks an
    /// ability](Outcome::Lacking) for are included.
    pub rows: Vec<RowRecord>,
}

/// Record of one [row](crate::adapters::rows::Row): a command that ran in a process of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowRecord {
    /// Name of the row, and of its folder.
    pub row: String,
    /// Command line of the row, as a user would type it, without `--out`.
    pub command: String,
    /// Way in which the row ended.
    pub outcome: Outcome,
    /// Exit code of the process; null if a signal ended it, or if it did not run.
    pub exit: Option<i32>,
    /// Number of the signal that ended the process; null without one.
    pub signal: Option<i32>,
    /// Seconds that the process took, to a tenth; 0 if it did not run.
    pub seconds: f64,
    /// Longest time for the row, in seconds
    /// ([`Row::seconds`](crate::adapters::rows::Row::seconds)).
    pub limit: u64,
    /// Day on which the row ran, `2026-11-27` (UTC).
    pub date: String,
    /// Last lines that the process wrote to standard error; empty if its outcome is
    /// [`Outcome::Done`] or it did not run.
    pub said: Vec<String>,
    /// Figures from the files that the process wrote.
    pub figures: Figures,
}

/// How a row ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The process ended with exit code 0.
    Done,
    /// The program found a fault, or could not run: exit code 1, 2, 4 or 5.
    Failed,
    /// The device was lost or hung: exit code 3.
    Lost,
    /// The process crashed: a signal or a panic ended it.
    Crashed,
    /// The process did not end within its time and was killed.
    TimedOut,
    /// The row did not run: the adapter lacks the ability that it needs, or its methods are not
    /// proven on the adapter's backend.
    Lacking,
}

impl Outcome {
    /// Returns the outcome in words, for tables.
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

/// Figures of a row. Those of files that the row's command does not write are empty or absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Runs of a row that is a comparison, one entry each, from its `results.json`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cells: Vec<CellFigures>,
    /// Pairs of methods that must answer alike to the bit, on each view where both were measured.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub equal: Vec<Equality>,
    /// Sums over the hard cases, one entry for each method that could run, from `stress.json`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hard: Vec<HardFigures>,
}

/// Figures of one method on one view in one viewport.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CellFigures {
    /// Name of the scene.
    pub scene: String,
    /// Number of triangles of the scene's mesh.
    pub triangles: u64,
    /// Name of the view.
    pub view: String,
    /// Name of the light, where the view is compared under several; absent elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub light: Option<String>,
    /// Width and height of the viewport in pixels.
    pub viewport: [u32; 2],
    /// Name of the method with its setting, such as `crsm@n=1`.
    pub method: String,
    /// Width and height of the shadow map in texels; null for a method without one.
    pub map_size: Option<u32>,
    /// Reason why the method could not run; absent if it did. Errors and times are then 0 or null.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unavailable: Option<String>,
    /// True if answers are 0 and 1, and the method's document promises that it is exact on this
    /// scene.
    #[serde(default)]
    pub is_exact: bool,
    /// Number of pixels that face the light.
    pub facing: u64,
    /// Number of pixels in the [band](crate#terms), whose answer rounding decides.
    pub band: u64,
    /// Number of wrong pixels, those in the [band](crate#terms) included.
    pub wrong: u64,
    /// Number of wrong pixels outside the [band](crate#terms).
    pub wrong_outside: u64,
    /// Root mean square error of the method's [shares of light](crate#terms), 0 to 1; absent for
    /// hard answers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rmse: Option<f64>,
    /// Median GPU time of a frame in milliseconds; null without timestamps that can be trusted.
    pub gpu_ms: Option<f64>,
    /// Median time of a frame by the CPU's clock, in milliseconds, until the GPU was done.
    pub wall_ms: f64,
    /// Name of the pass with the longest 95th percentile of GPU time, and that time in
    /// milliseconds; null without timestamps that can be trusted.
    pub longest_pass: Option<(String, f64)>,
}

/// Comparison of two methods that must answer alike to the bit, on one view.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Equality {
    /// Name of the scene.
    pub scene: String,
    /// Name of the view.
    pub view: String,
    /// Names of both methods with their settings.
    pub methods: [String; 2],
    /// Number of pixels of the viewport, all of which are compared.
    pub pixels: u64,
    /// Number of pixels whose `visibility` differs in a bit.
    pub differing: u64,
}

/// Sums over the hard cases of `stress` for one method.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HardFigures {
    /// Name of the method with its setting, such as `crsm@n=1`.
    pub method: String,
    /// Number of cells (the method on one case) that kept the method's
    /// [guarantee](super::stress::Guarantee). Cells that are not judged count neither here nor in
    /// [`failed`](Self::failed).
    pub passed: u64,
    /// Number of cells that broke the guarantee, or did not run.
    pub failed: u64,
    /// Number of wrong pixels outside the [band](crate#terms), over all cells, judged or not.
    pub wrong_outside: u64,
    /// Name of the case of each failed cell, in the order of the cases; twice if both cells of a
    /// case failed.
    pub failed_cases: Vec<String>,
}

impl CellFigures {
    /// True if both have the same scene, number of triangles, view, light, viewport, method and map
    /// size, so that adapters can be compared by them.
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
    /// in percent; 0 if no pixel faces the light.
    pub fn band_percent(&self) -> f64 {
        percent(self.band, self.facing)
    }
}

fn percent(count: u64, whole: u64) -> f64 {
    100.0 * count as f64 / whole.max(1) as f64
}

impl AdapterRecord {
    /// Returns the record of the row with this name; `None` if the row has not ended yet.
    pub fn row(&self, name: &str) -> Option<&RowRecord> {
        self.rows.iter().find(|row| row.row == name)
    }

    /// Returns the cells of all rows, in the order of [`rows`](Self::rows).
    pub fn cells(&self) -> impl Iterator<Item = &CellFigures> {
        self.rows.iter().flat_map(|row| &row.figures.cells)
    }

    /// Returns name, graphics API and driver of the adapter as one text; `None` without
    /// [`abilities`](Self::abilities).
    pub fn adapter(&self) -> Option<String> {
        Some(self.abilities.as_ref()?.adapter.to_string())
    }
}
