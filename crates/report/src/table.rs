//! Tables for a terminal.

use comfy_table::{Cell, CellAlignment, Table, presets};

/// A table whose first `left` columns hold words.
pub fn table<'a>(
    heads: impl IntoIterator<Item = &'a str>,
    left: usize,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let mut table = Table::new();
    table.load_style(presets::UTF8_FULL_CONDENSED);
    table.set_header(heads.into_iter().map(Cell::new));
    table.add_rows(rows);
    for column in table.column_iter_mut().skip(left) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.to_string()
}
