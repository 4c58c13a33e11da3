//! The grid of the chart: rows, columns, and how far apart they stand.

use crate::chart::{Arc, Area, BESIDE, COLUMN, Chart, Column, MARGIN, Row, SLANT, numbers};
use crate::drawing::{Drawing, Edge, Material, Pass};
use crate::legend;
use crate::marks::{group, mark, name_beginnings, reach};
use crate::text::{self, SMALL};
use crate::words::{self, Label, MOST};
use skiagraph_graph::text::cut;
use std::cmp::Reverse;
use std::collections::{HashMap, HashSet};

const ROW: f64 = 26.0;
const LINE: f64 = 14.0;
/// Room between the last head and the first row.
const NECK: f64 = 16.0;
/// Top of the legend: heading and summary stand above.
const LEGEND: f64 = 66.0;

pub(crate) fn chart(drawing: &Drawing) -> Chart<'_> {
    let (rows, live) = rows(drawing);
    let mut chart = Chart {
        title: &drawing.title,
        summary: words::summary(drawing),
        arcs: arcs(drawing, &rows[..live]),
        rows,
        live,
        columns: columns(drawing),
        ..Chart::default()
    };
    mark(&mut chart, &drawing.accesses);
    measure(&mut chart, drawing);
    place_rows(&mut chart);
    place_bars(&mut chart);
    reach(&mut chart);
    name_beginnings(&mut chart);
    group(&mut chart);
    chart
}

/// Where names, lanes and columns begin, and how high the heads are.
fn measure(chart: &mut Chart<'_>, drawing: &Drawing) {
    let rows = &chart.rows;
    let number = text::width(&chart.live.to_string(), SMALL);
    chart.spine = MARGIN + 8.0 + text::widest(chart.arcs.iter().map(|arc| arc.swing));
    chart.names = chart.spine + 8.0 + number + 6.0;
    chart.abouts = chart.names + text::widest(rows.iter().map(|row| row.name.width())) + 12.0;
    let about = |row: &Row<'_>| text::width(&row.about, SMALL);
    chart.lanes = chart.abouts + text::widest(rows.iter().map(about)) + 14.0;
    let (rise, run) = SLANT.to_radians().sin_cos();
    let (mut right, mut tallest) = (chart.lanes + 40.0, 0.0f64);
    let mut x = chart.lanes + COLUMN / 2.0;
    for column in &mut chart.columns {
        let detail = text::width(&column.detail, SMALL);
        let head = column.name.width().max(detail);
        column.x = x;
        x += COLUMN.max(column.notes + 2.0 * BESIDE);
        right = right.max(column.x + head * run + SMALL).max(x);
        tallest = tallest.max(head * rise);
    }
    chart.width = (right + MARGIN).max(720.0);
    let (legend, height) = legend::place(drawing, [MARGIN, LEGEND], chart.width - 2.0 * MARGIN);
    chart.legend = legend;
    chart.top = LEGEND + height + tallest + 18.0;
}

fn place_rows(chart: &mut Chart<'_>) {
    let mut y = chart.top + NECK;
    for index in 0..chart.live {
        y = place_row(chart, index, y);
    }
    chart.bottom = y;
    let outputs = || chart.columns.iter().map(|column| column.material);
    if outputs().any(|material| !material.outputs.is_empty()) {
        let names = outputs().map(|material| text::width(&words::renamed(material), SMALL));
        chart.outputs = Some(y + 16.0);
        y += 34.0 + text::widest(names) * SLANT.to_radians().sin();
    }
    if chart.live < chart.rows.len() {
        chart.culled = Some(y + 8.0);
        y += 36.0;
    }
    for index in chart.live..chart.rows.len() {
        y = place_row(chart, index, y);
    }
    chart.height = y + MARGIN;
}

/// Places a row at `y`; returns its bottom.
fn place_row(chart: &mut Chart<'_>, index: usize, y: f64) -> f64 {
    let row = &mut chart.rows[index];
    if let Some(reason) = &row.pass.culled {
        row.reason = text::wrap(reason, SMALL, chart.width - MARGIN - chart.names);
    }
    let height = ROW + LINE * row.reason.len() as f64;
    row.band = Area {
        x: MARGIN / 2.0,
        y,
        width: chart.width - MARGIN,
        height,
    };
    row.label = Area {
        x: chart.names,
        y: y + 4.0,
        width: chart.lanes - chart.names,
        height: height - 8.0,
    };
    row.middle = y + ROW / 2.0;
    y + height
}

fn place_bars(chart: &mut Chart<'_>) {
    let live = &chart.rows[..chart.live];
    for column in &mut chart.columns {
        let material = column.material;
        column.bar = material.lifetime.and_then(|[first, last]| {
            let from = if material.origin.is_given() {
                chart.top + 4.0
            } else {
                live.get(first)?.middle
            };
            let to = match chart.outputs {
                Some(outputs) if !material.outputs.is_empty() => outputs - 6.0,
                _ => live.get(last)?.middle,
            };
            Some([from, to])
        });
        column.end = column.bar.map_or(chart.top, |[_, end]| end);
    }
}

fn row(pass: &Pass) -> Row<'_> {
    Row {
        pass,
        name: Label::new(&pass.name),
        about: words::about(pass),
        reason: Vec::new(),
        band: Area::default(),
        label: Area::default(),
        middle: 0.0,
        reach: None,
    }
}

fn column(material: &Material) -> Column<'_> {
    Column {
        material,
        name: Label::new(&material.name),
        detail: cut(&words::detail(material), 2 * MOST),
        notes: 0.0,
        x: 0.0,
        bar: None,
        end: 0.0,
    }
}

/// The passes that run, in order, then the others, and how many run.
fn rows(drawing: &Drawing) -> (Vec<Row<'_>>, usize) {
    let mut passes: Vec<&Pass> = drawing.passes.iter().collect();
    passes.sort_by_key(|pass| pass.position.unwrap_or(usize::MAX));
    let live = passes.partition_point(|pass| pass.position.is_some());
    (passes.into_iter().map(row).collect(), live)
}

/// Returns the columns of all materials that a pass uses. First come those that exist before the
/// frame, then the others by first use, with those of one memory side by side. Last come those that
/// only passes use that do not run.
fn columns(drawing: &Drawing) -> Vec<Column<'_>> {
    let touched = drawing.accesses.iter();
    let touched: HashSet<&str> = touched.map(|access| &*access.material).collect();
    let first = |material: &Material| material.lifetime.map_or(usize::MAX, |[first, _]| first);
    let mut opened: HashMap<usize, usize> = HashMap::new();
    for material in &drawing.materials {
        if let Some(memory) = material.memory {
            let start = opened.entry(memory).or_insert(usize::MAX);
            *start = first(material).min(*start);
        }
    }
    let mut materials: Vec<&Material> = drawing.materials.iter().collect();
    materials.retain(|material| touched.contains(&*material.name) || !material.outputs.is_empty());
    materials.sort_by_key(|material| {
        let opened = material.memory.and_then(|memory| opened.get(&memory));
        (
            material.lifetime.is_none(),
            !material.origin.is_given(),
            *opened.unwrap_or(&first(material)),
            material.memory,
            first(material),
        )
    });
    materials.into_iter().map(column).collect()
}

/// The edges between passes that run.
fn arcs<'a>(drawing: &'a Drawing, live: &[Row<'_>]) -> Vec<Arc<'a>> {
    let numbers = numbers(live.iter().map(|row| &*row.pass.name));
    let arc = |edge: &'a Edge| {
        let rows = [*numbers.get(&*edge.from)?, *numbers.get(&*edge.to)?];
        Some(Arc {
            edge,
            hazard: edge.hazard()?,
            rows,
            swing: (rows[1].abs_diff(rows[0]) as f64).sqrt(),
        })
    };
    let mut arcs: Vec<Arc<'_>> = drawing.edges.iter().filter_map(arc).collect();
    // Swings grow with the root, so that short edges stay apart and long ones stay on the page.
    let longest = arcs.iter().map(|arc| arc.swing).fold(1.0, f64::max);
    for arc in &mut arcs {
        arc.swing *= (150.0 / longest).min(13.0);
    }
    // The more telling ones on top: first the implied, last what is read.
    arcs.sort_by_key(|arc| (!arc.edge.implied, Reverse(arc.hazard)));
    arcs
}
