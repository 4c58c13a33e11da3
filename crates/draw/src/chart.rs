//! The elements of the chart and where they stand. Plain numbers, in pixels, so that tests can ask
//! whether anything overlaps.

use crate::{
    drawing::{Edge, Material, Pass},
    legend::Item,
    words::Label,
};
use skiagraph_graph::Hazard;
use std::collections::HashMap;

/// Room around the page.
pub(crate) const MARGIN: f64 = 20.0;
/// Slant of the column heads, degrees: flat enough to be read, steep enough for two lines per
/// column.
pub(crate) const SLANT: f64 = 55.0;
/// Least width of a column.
pub(crate) const COLUMN: f64 = 34.0;
/// From the middle of a mark to its note.
pub(crate) const BESIDE: f64 = 7.5;

/// A rectangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Area {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

/// A pass.
pub(crate) struct Row<'a> {
    pub pass: &'a Pass,
    pub name: Label,
    pub about: String,
    /// Why it is culled, in lines.
    pub reason: Vec<String>,
    pub band: Area,
    /// Where its name and its kind stand.
    pub label: Area,
    /// Height of its marks.
    pub middle: f64,
    /// Its last mark; a line leads there from its name.
    pub reach: Option<f64>,
}

/// A material.
pub(crate) struct Column<'a> {
    pub material: &'a Material,
    pub name: Label,
    pub detail: String,
    /// Width of the notes at its marks.
    pub notes: f64,
    pub x: f64,
    /// Top and bottom of its lifetime.
    pub bar: Option<[f64; 2]>,
    /// Bottom of its lane: its last mark of any pass.
    pub end: f64,
}

/// Accesses of a pass to a material, over all of its parts.
pub(crate) struct Mark {
    /// Number of its row.
    pub row: usize,
    /// Number of its column.
    pub column: usize,
    pub reads: bool,
    pub writes: bool,
    pub runs: bool,
    /// The part, if it is not the whole.
    pub note: String,
    pub title: String,
}

/// An edge.
pub(crate) struct Arc<'a> {
    pub edge: &'a Edge,
    pub hazard: Hazard,
    /// Numbers of the rows that it leads from and to.
    pub rows: [usize; 2],
    /// How far it swings out to the left.
    pub swing: f64,
}

/// Columns that share memory.
pub(crate) struct Group {
    pub from: f64,
    pub to: f64,
    pub title: String,
}

/// The number of each name.
pub(crate) fn numbers<'n>(names: impl Iterator<Item = &'n str>) -> HashMap<&'n str, usize> {
    names.zip(0..).collect()
}

/// The chart.
#[derive(Default)]
pub(crate) struct Chart<'a> {
    pub title: &'a str,
    pub summary: String,
    pub width: f64,
    pub height: f64,
    pub legend: Vec<([f64; 2], Item)>,
    /// Bottom of the column heads.
    pub top: f64,
    /// Bottom of the passes that run.
    pub bottom: f64,
    /// Right ends of the arcs.
    pub spine: f64,
    pub names: f64,
    pub abouts: f64,
    pub lanes: f64,
    /// How many passes run.
    pub live: usize,
    /// The passes that run, in order, then the others.
    pub rows: Vec<Row<'a>>,
    pub columns: Vec<Column<'a>>,
    pub marks: Vec<Mark>,
    /// Names of materials where they begin, in charts so long that the heads are far away.
    pub beginnings: Vec<([f64; 2], String)>,
    pub arcs: Vec<Arc<'a>>,
    pub groups: Vec<Group>,
    /// Height of the outputs' arrows.
    pub outputs: Option<f64>,
    /// Top of the passes that do not run.
    pub culled: Option<f64>,
}
