//! Elements of the chart and their positions, in pixels. They are plain numbers, so tests can check
//! that nothing overlaps.

use crate::drawing::{Edge, Material, Pass};
use crate::legend::Item;
use crate::words::Label;
use skiagraph_graph::Hazard;
use std::collections::HashMap;

/// Distance of the chart from the border of the page, pixels.
pub(crate) const MARGIN: f64 = 20.0;
/// Slant of the column heads, degrees: flat enough to be read, steep enough for two lines per
/// column.
pub(crate) const SLANT: f64 = 55.0;
/// Least width of a column, pixels.
pub(crate) const COLUMN: f64 = 34.0;
/// Distance from the middle of a mark to its note, pixels.
pub(crate) const BESIDE: f64 = 7.5;

/// A rectangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Area {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

/// A row of the chart: a pass.
pub(crate) struct Row<'a> {
    pub pass: &'a Pass,
    pub name: Label,
    pub about: String,
    /// Lines of the reason why the pass does not run; empty if it runs.
    pub reason: Vec<String>,
    pub band: Area,
    /// Area of the pass's name and kind.
    pub label: Area,
    /// Vertical position of the middle of the row's marks.
    pub middle: f64,
    /// Horizontal position of the row's last mark, where the line from its name ends. `None`
    /// without marks.
    pub reach: Option<f64>,
}

/// A column of the chart: a material.
pub(crate) struct Column<'a> {
    pub material: &'a Material,
    pub name: Label,
    pub detail: String,
    /// Width of the widest note (the accessed part, such as `m0`) at the column's marks.
    pub notes: f64,
    pub x: f64,
    /// Vertical positions of top and bottom of the bar of the lifetime; `None` if no pass that runs
    /// uses the material.
    pub bar: Option<[f64; 2]>,
    /// Vertical position of the bottom of the column's line: its last mark, also in rows of passes
    /// that do not run.
    pub end: f64,
}

/// Mark in a cell of the chart: the accesses of a pass to all parts of a material.
pub(crate) struct Mark {
    /// Index of the mark's row.
    pub row: usize,
    /// Index of the mark's column.
    pub column: usize,
    pub reads: bool,
    pub writes: bool,
    pub runs: bool,
    /// The accessed part, such as `m0→m1`; empty for the whole material.
    pub note: String,
    pub title: String,
}

/// Arc on the left of the chart: the order of two passes.
pub(crate) struct Arc<'a> {
    pub edge: &'a Edge,
    pub hazard: Hazard,
    /// Indices of the rows of the earlier and the later pass.
    pub rows: [usize; 2],
    /// Greatest distance of the arc from the rows, to the left.
    pub swing: f64,
}

/// Bracket over columns that share memory.
pub(crate) struct Group {
    pub from: f64,
    pub to: f64,
    pub title: String,
}

/// Maps each name to its index in `names`.
pub(crate) fn numbers<'n>(names: impl Iterator<Item = &'n str>) -> HashMap<&'n str, usize> {
    names.zip(0..).collect()
}

/// Layout of the whole chart.
#[derive(Default)]
pub(crate) struct Chart<'a> {
    pub title: &'a str,
    pub summary: String,
    pub width: f64,
    pub height: f64,
    pub legend: Vec<([f64; 2], Item)>,
    /// Vertical position of the bottom of the column heads.
    pub top: f64,
    /// Vertical position of the bottom of the passes that run.
    pub bottom: f64,
    /// Horizontal position of the right ends of the arcs.
    pub spine: f64,
    pub names: f64,
    pub abouts: f64,
    pub lanes: f64,
    /// Number of passes that run; they are the first rows.
    pub live: usize,
    /// Passes that run, in order, then those that do not.
    pub rows: Vec<Row<'a>>,
    pub columns: Vec<Column<'a>>,
    pub marks: Vec<Mark>,
    /// Positions and names of materials at the row where each is first used. They are only in
    /// charts so long that the column heads are far away.
    pub beginnings: Vec<([f64; 2], String)>,
    pub arcs: Vec<Arc<'a>>,
    pub groups: Vec<Group>,
    /// Vertical position of the arrows of outputs; `None` if there are no outputs.
    pub outputs: Option<f64>,
    /// Vertical position of the line above passes that do not run; `None` if all run.
    pub culled: Option<f64>,
}
