//! Draws tables for a terminal and for HTML.

use comfy_table::{Cell, CellAlignment, presets};
use skiagraph_chart::xml;
use skiagraph_compare::records::table::Table;

/// Returns a table drawn with box characters for a terminal; numbers are aligned right.
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

/// Returns a value as text, or a dash without one.
pub fn or_dash<T>(value: Option<T>, text: impl Fn(T) -> String) -> String {
    value.map_or("–".into(), text)
}

/// Returns a table as HTML. Cells in the word columns become row headers. `row` returns the HTML
/// attributes of the row with this index; `cell` returns those of the number cell with this index
/// of row and column.
pub fn html(
    table: &Table,
    row: impl Fn(usize) -> String,
    cell: impl Fn(usize, usize) -> String,
) -> String {
    html_with(table, row, cell, |_, text| text)
}

/// Returns a table as [`html`] does; `content` returns the content of a number cell, given its
/// column and its text as HTML.
pub fn html_with(
    table: &Table,
    row: impl Fn(usize) -> String,
    cell: impl Fn(usize, usize) -> String,
    content: impl Fn(usize, String) -> String,
) -> String {
    let heads = table.heads.iter();
    let heads = heads.map(|head| format!("<th scope=\"col\">{}</th>", xml(head)));
    let mut body = String::new();
    for (index, cells) in table.rows.iter().enumerate() {
        body += &format!("<tr {}>", row(index));
        for (column, text) in cells.iter().map(|text| xml(text)).enumerate() {
            body += &if column < table.words {
                format!("<th scope=\"row\">{text}</th>")
            } else {
                let (of, content) = (cell(index, column), content(column, text));
                format!("<td {of}>{content}</td>")
            };
        }
        body += "</tr>\n";
    }
    let heads: String = heads.collect();
    format!("<table><thead><tr>{heads}</tr></thead><tbody>\n{body}</tbody></table>")
}
