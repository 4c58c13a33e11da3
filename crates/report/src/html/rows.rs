//! All rows: the tables of the terminal, joined.

use crate::html::shown::{Shown, part};
use crate::summary::Row;
use crate::summary_table::NOT_THERE;
use crate::table::html;
use skiagraph_chart::xml;
use skiagraph_compare::records::table::Table;

/// A table of all rows of hard answers, and one of graded ones.
pub fn tables(tables: &[Shown]) -> String {
    let of_kind = |is_hard| {
        let alike = (0..tables.len()).filter(|index| tables[*index].group.is_hard == is_hard);
        let alike: Vec<usize> = alike.collect();
        let each = alike.iter().map(|index| &tables[*index].table);
        // Tables of paths have columns that others lack.
        let mut heads = each.max_by_key(|table| table.heads.len())?.heads.clone();
        let cells = alike.iter().map(|index| &tables[*index]).flat_map(|of| {
            let table = &of.table;
            table.rows.iter().map(|cells| {
                let cell = |head: &String| {
                    let column = table.heads.iter().position(|known| known == head);
                    column.map_or("–".into(), |column| cells[column].clone())
                };
                let mut row: Vec<String> = heads.iter().map(cell).collect();
                row.insert(1, of.title.clone());
                row
            })
        });
        let cells: Vec<Vec<String>> = cells.collect();
        heads.insert(1, "of".into());
        let rows = alike
            .iter()
            .flat_map(|index| attributes(*index, &tables[*index]));
        let rows: Vec<String> = rows.collect();
        let class = |row: usize, column: usize| match (&*heads[column], &*cells[row][column]) {
            ("wrong outside band", "0") => "class=\"zero\"".into(),
            ("wrong outside band", text) if text != NOT_THERE => "class=\"wrong\"".into(),
            _ => String::new(),
        };
        let table = Table::new(heads.clone(), 2, cells.clone());
        let table = html(&table, |row| rows[row].clone(), class);
        Some(part("rows", &alike, None, &table))
    };
    [true, false].into_iter().filter_map(of_kind).collect()
}

/// Attributes of each row.
fn attributes(index: usize, table: &Shown) -> Vec<String> {
    let best = table.group.verdict().fastest_exact;
    let of_row = |(place, row): (usize, &Row)| {
        let class = match table.error(row) {
            _ if best == Some(place) => "exact best",
            Some(0.0) => "exact",
            _ => "",
        };
        let label = xml(&row.label);
        format!("class=\"{class}\" data-of=\"{index}\" data-label=\"{label}\"")
    };
    table.group.rows.iter().enumerate().map(of_row).collect()
}
