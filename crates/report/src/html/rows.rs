//! All rows: the tables of the terminal, joined.

use crate::html::charts::sign;
use crate::html::shown::{Shown, part};
use crate::html::sources::Source;
use crate::summary::Row;
use crate::summary_table::{NOT_THERE, WRONG, by_light};
use crate::table::html;
use skiagraph_chart::xml;
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::size;

/// Returns one HTML table with the rows of all tables.
pub fn tables(tables: &[Shown]) -> String {
    let each = tables.iter().map(|of| &of.table);
    // Tables of paths have columns that others lack.
    let Some(widest) = each.max_by_key(|table| table.heads.len()) else {
        return String::new();
    };
    let mut heads = widest.heads.clone();
    let cells = tables.iter().flat_map(|of| {
        let table = &of.table;
        table.rows.iter().map(|cells| {
            let cell = |head: &String| {
                let column = table.heads.iter().position(|known| known == head);
                column.map_or("–".into(), |column| cells[column].clone())
            };
            let mut row: Vec<String> = widest.heads.iter().map(cell).collect();
            row.insert(1, of.title.clone());
            row
        })
    });
    let cells: Vec<Vec<String>> = cells.collect();
    heads.insert(1, "of".into());
    let rows = tables.iter().enumerate();
    let rows: Vec<String> = rows.flat_map(|(index, of)| attributes(index, of)).collect();
    let all_rows = tables.iter().flat_map(|of| &of.summary.rows);
    let signs: Vec<String> = all_rows.map(|row| sign(tables, &row.method)).collect();
    let class = |row: usize, column: usize| match (&*heads[column], &*cells[row][column]) {
        (WRONG, "0") => "class=\"zero\"".into(),
        (WRONG, text) if text != NOT_THERE => "class=\"wrong\"".into(),
        _ => String::new(),
    };
    let table = Table::new(heads.clone(), 2, cells.clone());
    let table = html(
        &table,
        |row| rows[row].clone(),
        |row| signs[row].clone(),
        class,
    );
    let all: Vec<usize> = (0..tables.len()).collect();
    part("rows", &all, None, &table)
}

/// Returns HTML tables of each method under each light, for the sources and viewports with several
/// lights.
pub fn lights(sources: &[Source]) -> String {
    let of_source = |source: &Source| {
        let tables = by_light(&source.results).into_iter();
        let scene = &source.results.scene.name;
        let table = |(viewport, table): ([u32; 2], Table)| {
            let head = format!("{scene}, {}", size(viewport));
            let none = |_, _| String::new();
            format!(
                "<h3>{}</h3>{}",
                xml(&head),
                html(&table, |_| String::new(), |_| String::new(), none)
            )
        };
        tables.map(table).collect::<String>()
    };
    sources.iter().map(of_source).collect()
}

/// Attributes of each row.
fn attributes(index: usize, table: &Shown) -> Vec<String> {
    let best = table.summary.verdict().fastest_exact;
    let of_row = |(place, row): (usize, &Row)| {
        let class = match row.views() > 0 && row.is_exact() {
            _ if best == Some(place) => "exact best",
            _ if table.summary.is_old(row) => "old",
            true => "exact",
            false => "",
        };
        let label = xml(&row.label);
        format!("class=\"{class}\" data-of=\"{index}\" data-label=\"{label}\"")
    };
    table.summary.rows.iter().enumerate().map(of_row).collect()
}
