//! The schema of `stress.json`, version 1, and what is judged of it. Scripts rely on it: extend it, rename nothing.

use super::promise::Promise;
use crate::{
    error::CliError,
    files::write_whole,
    results::{Adapter, Images},
};
use serde::Serialize;
use serde_json::Value;
use skiagraph_reference::{PixelCounts, Statistics, WrongCounts};
use std::{collections::BTreeMap, path::Path};

/// The matrix.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Version of this schema: 1.
    pub schema: u32,
    /// The program that ran, `skiagraph 0.1.0`.
    pub program: String,
    /// Where.
    pub adapter: Adapter,
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// The columns.
    pub methods: Vec<Column>,
    /// The rows that are done, in the order of the catalogue or of the command line.
    pub cases: Vec<Case>,
}

/// A method.
#[derive(Clone, Debug, Serialize)]
pub struct Column {
    /// Name of the preset, or path of the graph.
    pub preset: String,
    /// Value of the param `map_size`; null where the graph has none.
    pub map_size: Option<u32>,
    /// All params of the graph with the values it runs with, but for cells with a `set` of their own.
    pub params: BTreeMap<String, Value>,
    /// Which pixels must be right; null where none is promised.
    pub promise: Option<Promise>,
    /// Why it can be promised; null where nothing is.
    pub because: Option<String>,
    /// Why it cannot run on this adapter; absent where it can, and then it has no cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unavailable: Option<String>,
}

/// A case with all methods.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    /// Its name in the catalogue.
    pub name: String,
    /// What it provokes.
    pub reason: String,
    /// Whether the casters are closed or open.
    pub casters: Casters,
    /// The greatest share of the pixels facing the light that the band may take.
    pub band_cap: f64,
    /// Why there is no reference, and so no cell; absent where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// The reference's pixels.
    pub pixels: PixelCounts,
    /// Of those facing the light, the ones whose answer flips within the rounding error of receiver and casters.
    pub band: u64,
    /// One per method that runs, and one more without culling where that is what is judged.
    pub cells: Vec<Cell>,
}

/// What the casters of a case are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Casters {
    /// Closed, wound outward, apart from each other.
    Closed,
    /// Anything else.
    Open,
}

/// One method on one case.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// Index of its method.
    pub method: usize,
    /// The param that differs from the method's, `cull=none`; null where none does.
    pub set: Option<String>,
    /// What it comes to.
    pub verdict: Verdict,
    /// What was counted; absent where it could not run.
    #[serde(flatten)]
    pub counts: Option<Counts>,
    /// Why it could not run; absent where it could.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// Its pictures, file names in the folder of `--save`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub images: Option<Images>,
}

/// What a cell comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// As promised.
    Pass,
    /// Not as promised, or it could not run.
    Fail,
    /// Not judged: what the method promises of closed casters does not hold for this case's open ones.
    Open,
    /// Not judged: the method promises nothing.
    Unjudged,
}

/// What was counted of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Counts {
    /// Pixels on which method and reference disagree.
    pub wrong: WrongCounts,
    /// Those of them that are not in the band.
    pub outside_band: Outside,
    /// Pixels facing the light that the method left to rays, or all that it traced.
    pub uncertain: u64,
    /// The same as a share.
    pub uncertain_share: f64,
    /// Rays traced; null where the graph does not count them.
    pub rays: Option<u64>,
}

/// Wrong pixels outside the band.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Outside {
    /// Lit by the method, not by the reference.
    pub lit: u64,
    /// In shadow by the method, lit by the reference.
    pub shadow: u64,
    /// Of both: called certain.
    pub certain: u64,
}

impl Outside {
    /// Whether this breaks the promise.
    pub fn breaks(&self, promise: Promise) -> bool {
        match promise {
            Promise::Exact => self.lit + self.shadow > 0,
            Promise::Certain => self.certain > 0,
        }
    }
}

impl Verdict {
    /// Of a cell that ran. `culls`: not all faces cast shadows, so that nothing is promised of open casters.
    pub fn of(promise: Option<Promise>, culls: bool, casters: Casters, outside: &Outside) -> Self {
        match promise {
            None => Self::Unjudged,
            Some(_) if culls && casters == Casters::Open => Self::Open,
            Some(promise) if outside.breaks(promise) => Self::Fail,
            Some(_) => Self::Pass,
        }
    }
}

impl Counts {
    /// Of a picture: `whole` counts all of its pixels, `settled` the same with the reference's answer wherever that is in the band.
    pub fn new(whole: &Statistics, settled: &Statistics, rays: Option<u64>) -> Self {
        let WrongCounts {
            lit,
            shadow,
            certain,
            ..
        } = settled.wrong;
        Self {
            wrong: whole.wrong,
            outside_band: Outside {
                lit,
                shadow,
                certain,
            },
            uncertain: whole.uncertain,
            uncertain_share: whole.uncertain_share(),
            rays,
        }
    }
}

impl Case {
    /// Whether the band takes more than its cap: what lies in it is not proven, and a band that swallows a case proves nothing.
    pub fn exceeds_cap(&self) -> bool {
        self.band as f64 > self.band_cap * self.pixels.facing_light as f64
    }
}

impl Report {
    /// How many cells came to this.
    pub fn count(&self, verdict: Verdict) -> usize {
        let cells = self.cases.iter().flat_map(|case| &case.cells);
        cells.filter(|cell| cell.verdict == verdict).count()
    }

    /// How many cases have too large a band, or no reference.
    pub fn failed_cases(&self) -> usize {
        let failed = |case: &&Case| case.exceeds_cap() || case.failed.is_some();
        self.cases.iter().filter(failed).count()
    }

    /// The contents of `stress.json`.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self)
            .expect("plain structs with string keys always serialise");
        text.push('\n');
        text
    }

    /// Writes `stress.json` into `folder`, whole or not at all.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn save(&self, folder: &Path) -> Result<(), CliError> {
        write_whole(&folder.join("stress.json"), self.to_json().as_bytes())
    }
}
