//! Marks on the grid of the chart, names where materials begin, brackets.

use crate::chart::{Chart, Column, Group, Mark, numbers};
use crate::drawing::Access;
use crate::legend::Item;
use crate::text::{self, NOTE, SMALL};
use crate::words::{self, MOST};
use skiagraph_graph::text::{bytes, cut};
use std::collections::BTreeMap;

/// Number of rows from which on the column heads are too far away, so that materials are also named
/// at the row of their first use.
const FAR: usize = 12;

/// Adds a mark for each pass and material with accesses, and the room that it takes.
pub(crate) fn mark(chart: &mut Chart<'_>, accesses: &[Access]) {
    let rows = numbers(chart.rows.iter().map(|row| &*row.pass.name));
    let columns = numbers(chart.columns.iter().map(|column| &*column.material.name));
    let mut uses: BTreeMap<(usize, usize), Vec<&Access>> = BTreeMap::new();
    for access in accesses {
        let row = rows.get(&*access.pass).copied();
        if let Some(cell) = row.zip(columns.get(&*access.material).copied()) {
            uses.entry(cell).or_default().push(access);
        }
    }
    for ((row, column), accesses) in uses {
        let (pass, material) = (chart.rows[row].pass, chart.columns[column].material);
        let verb = |access: &Access| Item::new(access.reads, access.writes).text();
        let clause = |access: &&Access| match &access.part {
            Some(part) => format!("{} ({})", verb(access), words::part(part, material)),
            None => verb(access).to_owned(),
        };
        let clauses: Vec<String> = accesses.iter().map(clause).collect();
        let note = words::note(&accesses, material);
        let notes = &mut chart.columns[column].notes;
        *notes = notes.max(text::width(&note, NOTE));
        chart.marks.push(Mark {
            row,
            column,
            reads: accesses.iter().any(|access| access.reads),
            writes: accesses.iter().any(|access| access.writes),
            runs: pass.position.is_some(),
            note,
            title: format!("{} {} {}", pass.name, clauses.join(", "), material.name),
        });
    }
}

/// Extends the lines of rows and columns to their last marks.
pub(crate) fn reach(chart: &mut Chart<'_>) {
    for mark in &chart.marks {
        let (row, column) = (&mut chart.rows[mark.row], &mut chart.columns[mark.column]);
        row.reach = Some(row.reach.unwrap_or(0.0).max(column.x));
        column.end = column.end.max(row.middle);
    }
}

/// Adds the names of materials behind the mark of their first use, where there is room. Neighbours
/// that begin in the same row share a label.
pub(crate) fn name_beginnings(chart: &mut Chart<'_>) {
    if chart.live <= FAR {
        return;
    }
    for (position, row) in chart.rows[..chart.live].iter().enumerate() {
        let begins = |column: &Column<'_>| {
            let first = column.material.lifetime.map(|[first, _]| first);
            first == Some(position) && !column.material.origin.is_given()
        };
        for run in chart.columns.chunk_by(|a, b| begins(a) == begins(b)) {
            let Some(last) = run.last().filter(|column| begins(column)) else {
                continue;
            };
            let text = cut(&names(run.iter()), MOST);
            let start = last.x + 12.0 + last.notes;
            let end = start + text::width(&text, SMALL);
            let crosses = |column: &Column<'_>| {
                let lives = |[from, to]: [f64; 2]| from <= row.middle && row.middle <= to;
                column.x > last.x && column.x - 8.0 < end && column.bar.is_some_and(lives)
            };
            if !chart.columns.iter().any(crosses) && end < chart.width {
                chart.beginnings.push(([start, row.middle], text));
            }
        }
    }
}

/// Adds brackets over the columns that share memory; such columns are side by side.
pub(crate) fn group(chart: &mut Chart<'_>) {
    for columns in chart
        .columns
        .chunk_by(|a, b| a.material.memory.is_some() && a.material.memory == b.material.memory)
    {
        if let [first, .., last] = columns {
            let sizes = columns.iter().filter_map(|column| column.material.bytes);
            let size = bytes(sizes.max().unwrap_or(0));
            chart.groups.push(Group {
                from: first.x,
                to: last.x,
                title: format!("{} share {size}", names(columns.iter())),
            });
        }
    }
}

fn names<'c>(columns: impl Iterator<Item = &'c Column<'c>>) -> String {
    let names: Vec<&str> = columns.map(|column| &*column.material.name).collect();
    names.join(", ")
}
