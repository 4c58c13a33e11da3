//! All rows: the tables of the terminal, and one of all sizes and sources.

use crate::html::shown::{Shown, part};
use crate::summary::Row;
use crate::summary_table::NOT_THERE;
use crate::table::html;
use skiagraph_chart::xml;
use skiagraph_compare::records::table::Table;

/// Each table; and for those of hard and of graded answers one of all.
pub fn tables(tables: &[Shown]) -> String {
    let mut written = String::new();
    let each: Vec<Table> = tables.iter().map(|of| of.summary.table(of.group)).collect();
    for (index, (of, table)) in tables.iter().zip(&each).enumerate() {
        let of = rows(of);
        written += &part("one", &[index], None, &with_rows(table, &of));
    }
    // A single table would be repeated.
    for is_hard in [true, false].into_iter().filter(|_| tables.len() > 1) {
        let alike = (0..tables.len()).filter(|index| tables[*index].group.is_hard == is_hard);
        let alike: Vec<usize> = alike.collect();
        // Tables of paths have columns that others lack.
        let longest = alike.iter().max_by_key(|index| each[**index].heads.len());
        let Some(heads) = longest.map(|index| &each[*index].heads) else {
            continue;
        };
        let cells = alike.iter().flat_map(|index| {
            let table = &each[*index];
            table.rows.iter().map(|cells| {
                let cell = |head: &String| {
                    let column = table.heads.iter().position(|known| known == head);
                    column.map_or("–".into(), |column| cells[column].clone())
                };
                let mut row: Vec<String> = heads.iter().map(cell).collect();
                row.insert(1, tables[*index].title.clone());
                row
            })
        });
        let mut heads = heads.clone();
        heads.insert(1, "of".into());
        let table = Table::new(heads, 2, cells);
        let of: Vec<String> = alike
            .iter()
            .flat_map(|index| rows(&tables[*index]))
            .collect();
        written += &part("all", &alike, None, &with_rows(&table, &of));
    }
    written
}

/// Attributes of each row.
fn rows(table: &Shown) -> Vec<String> {
    let best = table.group.verdict().fastest_exact;
    let of_row = |(index, row): (usize, &Row)| {
        let class = match table.error(row) {
            _ if best == Some(index) => "exact best",
            Some(0.0) => "exact",
            _ => "",
        };
        format!("class=\"{class}\" data-label=\"{}\"", xml(&row.label))
    };
    table.group.rows.iter().enumerate().map(of_row).collect()
}

fn with_rows(table: &Table, rows: &[String]) -> String {
    let class = |row: usize, column: usize| {
        let text = table.rows[row][column].as_str();
        match (table.heads[column].as_str(), text) {
            ("wrong outside band", "0") => "class=\"zero\"".into(),
            ("wrong outside band", text) if text != NOT_THERE => "class=\"wrong\"".into(),
            _ => String::new(),
        }
    };
    html(table, |row| rows[row].clone(), class)
}
