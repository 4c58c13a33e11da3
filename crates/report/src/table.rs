//! Tables for a terminal.

use comfy_table::{Cell, CellAlignment, presets};
use skiagraph_compare::records::table::Table;

/// The table in lines of box-drawing characters, numbers to the right.
pub fn terminal(table: &Table) -> String {
    let mut drawn = comfy_table::Table::new();
    drawn.load_style(presets::UTF8_FULL_CONDENSED);
    drawn.set_header(table.heads.iter().map(Cell::new));
    drawn.add_rows(&table.rows);
    for column in drawn.column_iter_mut().skip(table.words) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    drawn.to_string()
}
