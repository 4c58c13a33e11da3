//! Where everything in the chart stands. Plain numbers, in pixels, so that tests can ask whether anything overlaps.

use super::{
    Access, Drawing, Edge, Hazard, Material, Pass,
    legend::{self, Item},
    text,
    words::{self, MOST},
};
use std::collections::{BTreeMap, HashMap};

pub(super) const MARGIN: f64 = 20.0;
/// Size of names.
pub(super) const NAME: f64 = 12.5;
/// Size of everything beside names.
pub(super) const SMALL: f64 = 10.5;
/// Slant of the column heads, degrees: flat enough to be read, steep enough for two lines per column.
pub(super) const SLANT: f64 = 55.0;
pub(super) const COLUMN: f64 = 34.0;
const ROW: f64 = 26.0;
const LINE: f64 = 14.0;
/// Room between the last head and the first row.
const NECK: f64 = 16.0;
/// Rows from which on the column heads are too far away, and what begins in a row is named there too.
const FAR: usize = 12;

/// A rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

/// A pass.
pub(super) struct Row<'a> {
    pub pass: &'a Pass,
    pub name: String,
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
pub(super) struct Column<'a> {
    pub material: &'a Material,
    pub name: String,
    pub detail: String,
    pub x: f64,
    /// Top and bottom of its lifetime.
    pub bar: Option<[f64; 2]>,
    /// Bottom of its lane: its last mark of any pass.
    pub end: f64,
}

/// What a pass does with a material.
pub(super) struct Mark {
    pub x: f64,
    pub y: f64,
    pub reads: bool,
    pub writes: bool,
    pub runs: bool,
    /// The part, if it is not the whole.
    pub note: String,
    pub title: String,
}

/// An edge.
pub(super) struct Arc<'a> {
    pub edge: &'a Edge,
    pub hazard: Hazard,
    pub from: f64,
    pub to: f64,
    /// How far it swings out to the left.
    pub swing: f64,
}

/// Columns that share memory.
pub(super) struct Group {
    pub from: f64,
    pub to: f64,
    pub title: String,
}

/// The chart.
pub(super) struct Layout<'a> {
    pub drawing: &'a Drawing,
    pub width: f64,
    pub height: f64,
    pub summary: String,
    pub legend: Vec<(f64, f64, Item)>,
    /// Bottom of the column heads.
    pub top: f64,
    /// Right ends of the arcs.
    pub spine: f64,
    pub names: f64,
    pub abouts: f64,
    pub lanes: f64,
    pub rows: Vec<Row<'a>>,
    pub columns: Vec<Column<'a>>,
    pub marks: Vec<Mark>,
    /// Names of materials where they begin, in charts so long that the heads are far away.
    pub beginnings: Vec<(f64, f64, String)>,
    pub arcs: Vec<Arc<'a>>,
    pub groups: Vec<Group>,
    /// Height of the outputs' arrows.
    pub outputs: Option<f64>,
    /// Top of the passes that do not run.
    pub culled: Option<f64>,
}

impl<'a> Layout<'a> {
    pub fn new(drawing: &'a Drawing) -> Self {
        let mut live: Vec<&Pass> = drawing
            .passes
            .iter()
            .filter(|pass| pass.position.is_some())
            .collect();
        live.sort_by_key(|pass| pass.position);
        let culled: Vec<&Pass> = drawing
            .passes
            .iter()
            .filter(|pass| pass.position.is_none())
            .collect();
        let materials = order(drawing, &live);

        let place: HashMap<&str, usize> = live
            .iter()
            .enumerate()
            .map(|(index, pass)| (pass.name.as_str(), index))
            .collect();
        let span = |edge: &Edge| {
            Some((
                *place.get(edge.from.as_str())?,
                *place.get(edge.to.as_str())?,
            ))
        };
        let edges: Vec<(&Edge, usize, usize)> = drawing
            .edges
            .iter()
            .filter_map(|edge| span(edge).map(|(from, to)| (edge, from, to)))
            .collect();
        let longest = edges
            .iter()
            .map(|(_, from, to)| to.abs_diff(*from))
            .max()
            .unwrap_or(0) as f64;
        // Swings grow with the root, so that short edges stay apart and long ones stay on the page.
        let stretch = (150.0 / longest.max(1.0).sqrt()).min(13.0);
        let swing = |from: usize, to: usize| stretch * (to.abs_diff(from) as f64).sqrt();

        let spine = MARGIN + stretch * longest.sqrt() + 8.0;
        let number = text::width(&live.len().to_string(), SMALL);
        let names = spine + 8.0 + number + 6.0;
        let all = || live.iter().chain(&culled);
        let widest =
            |measure: &dyn Fn(&Pass) -> f64| all().map(|pass| measure(pass)).fold(0.0, f64::max);
        let abouts = names + widest(&|pass| text::bold(&text::cut(&pass.name, MOST), NAME)) + 12.0;
        let lanes = abouts + widest(&|pass| text::width(&words::about(pass), SMALL)) + 14.0;

        let heads: Vec<(String, String)> = materials
            .iter()
            .map(|material| {
                (
                    text::cut(&material.name, MOST),
                    text::cut(&words::detail(material), 2 * MOST),
                )
            })
            .collect();
        let head = |(name, detail): &(String, String)| {
            text::bold(name, NAME).max(text::width(detail, SMALL))
        };
        let (rise, run) = SLANT.to_radians().sin_cos();
        let x = |index: usize| lanes + COLUMN * (index as f64 + 0.5);
        let overhang = |(index, texts)| x(index) + head(texts) * run + SMALL;
        let right = heads
            .iter()
            .enumerate()
            .map(overhang)
            .fold(lanes + 40.0, f64::max);
        let width = (right + MARGIN).max(720.0);

        let (legend, legend_height) = legend::place(drawing, 66.0, width - 2.0 * MARGIN);
        let tallest = heads.iter().map(head).fold(0.0, f64::max);
        let top = 66.0 + legend_height + tallest * rise + 18.0;
        let mut layout = Self {
            drawing,
            width,
            height: 0.0,
            summary: words::summary(drawing, live.len()),
            legend,
            top,
            spine,
            names,
            abouts,
            lanes,
            rows: Vec::new(),
            columns: Vec::new(),
            marks: Vec::new(),
            beginnings: Vec::new(),
            arcs: Vec::new(),
            groups: Vec::new(),
            outputs: None,
            culled: None,
        };
        let mut y = top + NECK;
        for pass in &live {
            y = layout.row(pass, y);
        }
        let middles: Vec<f64> = layout.rows.iter().map(|row| row.middle).collect();
        if materials
            .iter()
            .any(|material| !material.outputs.is_empty())
        {
            layout.outputs = Some(y + 16.0);
            y += 34.0
                + materials
                    .iter()
                    .map(|material| text::width(&words::renamed(material), SMALL) * rise)
                    .fold(0.0, f64::max);
        }
        if !culled.is_empty() {
            layout.culled = Some(y + 8.0);
            y += 36.0;
        }
        for pass in &culled {
            y = layout.row(pass, y);
        }
        layout.height = y + MARGIN;
        for (index, (material, (name, detail))) in materials.iter().zip(heads).enumerate() {
            let bar = material.lifetime.and_then(|[first, last]| {
                let [first, last] = [*middles.get(first)?, *middles.get(last)?];
                let from = if material.origin.is_given() {
                    top + 4.0
                } else {
                    first
                };
                let to = match layout.outputs {
                    Some(outputs) if !material.outputs.is_empty() => outputs - 6.0,
                    _ => last,
                };
                Some([from, to])
            });
            let end = bar.map_or(top, |[_, end]| end);
            layout.columns.push(Column {
                material,
                name,
                detail,
                x: x(index),
                bar,
                end,
            });
        }
        layout.place_marks();
        layout.name_beginnings(live.len());
        layout.arcs = edges
            .into_iter()
            .filter_map(|(edge, from, to)| {
                Some(Arc {
                    edge,
                    hazard: edge.because.iter().map(|reason| reason.hazard).min()?,
                    from: middles[from],
                    to: middles[to],
                    swing: swing(from, to),
                })
            })
            .collect();
        // The more telling ones on top: first the implied, last what is read.
        layout
            .arcs
            .sort_by_key(|arc| (!arc.edge.implied, std::cmp::Reverse(arc.hazard)));
        layout.group();
        layout
    }

    /// Adds a row at `y`; returns its bottom.
    fn row(&mut self, pass: &'a Pass, y: f64) -> f64 {
        let room = self.width - MARGIN - self.names;
        let reason = pass
            .culled
            .as_deref()
            .map_or(Vec::new(), |reason| text::wrap(reason, SMALL, room));
        let height = ROW + LINE * reason.len() as f64;
        self.rows.push(Row {
            pass,
            name: text::cut(&pass.name, MOST),
            about: words::about(pass),
            reason,
            band: Area {
                x: MARGIN / 2.0,
                y,
                width: self.width - MARGIN,
                height,
            },
            label: Area {
                x: self.names,
                y: y + 4.0,
                width: self.lanes - self.names,
                height: height - 8.0,
            },
            middle: y + ROW / 2.0,
            reach: None,
        });
        y + height
    }

    /// One mark per pass and material, whatever parts the pass touches.
    fn place_marks(&mut self) {
        let rows: HashMap<&str, usize> = self
            .rows
            .iter()
            .enumerate()
            .map(|(index, row)| (row.pass.name.as_str(), index))
            .collect();
        let columns: HashMap<&str, usize> = self
            .columns
            .iter()
            .enumerate()
            .map(|(index, column)| (column.material.name.as_str(), index))
            .collect();
        let mut uses: BTreeMap<(usize, usize), Vec<&Access>> = BTreeMap::new();
        for access in &self.drawing.accesses {
            if let (Some(&row), Some(&column)) = (
                rows.get(access.pass.as_str()),
                columns.get(access.material.as_str()),
            ) {
                uses.entry((row, column)).or_default().push(access);
            }
        }
        for ((row, column), accesses) in uses {
            let (row, column) = (&mut self.rows[row], &mut self.columns[column]);
            row.reach = Some(row.reach.unwrap_or(0.0).max(column.x));
            column.end = column.end.max(row.middle);
            let material = column.material;
            let clause = |access: &&Access| {
                let part = access
                    .part
                    .as_ref()
                    .map(|part| format!(" ({})", words::part(part, material)));
                format!("{}{}", words::verb(access), part.unwrap_or_default())
            };
            let clauses: Vec<String> = accesses.iter().map(clause).collect();
            self.marks.push(Mark {
                x: column.x,
                y: row.middle,
                reads: accesses.iter().any(|access| access.reads),
                writes: accesses.iter().any(|access| access.writes),
                runs: row.pass.position.is_some(),
                note: words::note(&accesses, material),
                title: format!("{} {} {}", row.pass.name, clauses.join(", "), material.name),
            });
        }
    }

    /// Names what begins to live in a row behind its mark, where nothing is in the way and the page has room. Neighbours that begin
    /// together are named together.
    fn name_beginnings(&mut self, live: usize) {
        if live <= FAR {
            return;
        }
        for (position, row) in self.rows.iter().enumerate().take(live) {
            let begins = |column: &Column<'_>| {
                let first = column.material.lifetime.map(|[first, _]| first);
                first == Some(position) && !column.material.origin.is_given()
            };
            for run in self.columns.chunk_by(|a, b| begins(a) == begins(b)) {
                let Some(last) = run.last().filter(|column| begins(column)) else {
                    continue;
                };
                let names: Vec<&str> = run
                    .iter()
                    .map(|column| column.material.name.as_str())
                    .collect();
                let text = text::cut(&names.join(", "), MOST);
                let [x, end] = [last.x + 12.0, last.x + 12.0 + text::width(&text, SMALL)];
                let crosses = |column: &Column<'_>| {
                    let lives = column
                        .bar
                        .is_some_and(|[from, to]| from <= row.middle && row.middle <= to);
                    column.x > last.x && column.x - 8.0 < end && lives
                };
                if !self.columns.iter().any(crosses) && end < self.width {
                    self.beginnings.push((x, row.middle, text));
                }
            }
        }
    }

    /// Brackets over the columns that share memory; they stand side by side.
    fn group(&mut self) {
        let mut members: BTreeMap<usize, Vec<&Column<'_>>> = BTreeMap::new();
        for column in &self.columns {
            if let Some(memory) = column.material.memory {
                members.entry(memory).or_default().push(column);
            }
        }
        for columns in members.into_values().filter(|columns| columns.len() > 1) {
            let names: Vec<&str> = columns
                .iter()
                .map(|column| column.material.name.as_str())
                .collect();
            let bytes = columns
                .iter()
                .filter_map(|column| column.material.bytes)
                .max()
                .unwrap_or(0);
            self.groups.push(Group {
                from: columns[0].x,
                to: columns[columns.len() - 1].x,
                title: format!("{} share {}", names.join(", "), text::bytes(bytes)),
            });
        }
    }
}

/// The materials that any pass touches: what is there before the frame, then by first use, those of one memory side by side, then
/// those that only passes touch that do not run.
fn order<'a>(drawing: &'a Drawing, live: &[&Pass]) -> Vec<&'a Material> {
    let touched: std::collections::HashSet<&str> = drawing
        .accesses
        .iter()
        .map(|access| access.material.as_str())
        .collect();
    let first = |material: &Material| material.lifetime.map_or(live.len(), |[first, _]| first);
    let mut opened: HashMap<usize, usize> = HashMap::new();
    for material in &drawing.materials {
        if let Some(memory) = material.memory {
            let known = opened.entry(memory).or_insert(usize::MAX);
            *known = first(material).min(*known);
        }
    }
    let mut materials: Vec<&Material> = drawing
        .materials
        .iter()
        .filter(|material| touched.contains(material.name.as_str()) || !material.outputs.is_empty())
        .collect();
    materials.sort_by_key(|material| {
        let first = first(material);
        let opened = material
            .memory
            .and_then(|memory| opened.get(&memory))
            .copied()
            .unwrap_or(first);
        (
            material.lifetime.is_none(),
            !material.origin.is_given(),
            opened,
            material.memory,
            first,
        )
    });
    materials
}
