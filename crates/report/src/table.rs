//! Tables for a terminal and for a page.

use comfy_table::{Cell, CellAlignment, presets};
use skiagraph_chart::xml;
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

/// The table for a page. Cells with words are heads of their row; `row` gives the attributes of a
/// row by its index, `cell` those of a cell with a number by the indices of row and column.
pub fn html(
    table: &Table,
    row: impl Fn(usize) -> String,
    cell: impl Fn(usize, usize) -> String,
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
                format!("<td {}>{text}</td>", cell(index, column))
            };
        }
        body += "</tr>\n";
    }
    let heads: String = heads.collect();
    format!("<table><thead><tr>{heads}</tr></thead><tbody>\n{body}</tbody></table>")
}
