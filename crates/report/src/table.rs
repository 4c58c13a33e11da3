//! Draws tables for a terminal and for HTML.

use comfy_table::{Cell, CellAlignment, LineStyle, TableStyle};
use itertools::Itertools;
use skiagraph_chart::xml;
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::or_nothing;

/// Width of the terminal, in characters, for which tables and texts are broken into lines.
pub const TERMINAL: usize = 80;
/// Free between two columns.
const GAP: usize = 2;
/// Greatest width of a column of words beside numbers. Longer words are broken between parts.
const WORDS: usize = 40;
/// Least width of a last column of words, where others leave less of a line.
const NARROWEST: usize = 20;
/// Text of a cell without a figure.
const NONE: &str = "–";

/// Returns a table as text for a terminal; numbers are aligned right. Columns that do not fit into
/// 80 characters stand in further blocks below, each with the columns of words. Number columns in
/// which every cell is `–` are named in a last line instead.
pub fn terminal(table: &Table) -> String {
    let is_empty = |column: &usize| {
        let mut cells = table.rows.iter().map(|row| &row[*column]);
        !table.rows.is_empty() && cells.all(|cell| cell == NONE)
    };
    let (empty, numbers): (Vec<usize>, Vec<usize>) =
        (table.words..table.heads.len()).partition(is_empty);
    let words: Vec<usize> = (0..table.words).collect();
    let mut blocks = vec![words.clone()];
    for column in numbers {
        let block = &blocks[blocks.len() - 1];
        let wide = |column: &usize| width(table, *column) + GAP;
        let line_width = block.iter().chain([&column]).map(wide).sum::<usize>() - GAP;
        if line_width > TERMINAL && block.len() > table.words {
            blocks.push(words.clone());
        }
        blocks.last_mut().expect("there is one").push(column);
    }
    let blocks = blocks.iter().map(|columns| block(table, columns));
    let mut text = blocks.collect::<Vec<_>>().join("\n\n");
    if !empty.is_empty() {
        let heads = empty.iter().map(|column| &table.heads[*column]).join(", ");
        text += &format!("\nno row has: {heads}");
    }
    text
}

/// Width of a column: its longest cell, or the longest word of its head.
fn width(table: &Table, column: usize) -> usize {
    let room = room(table, column);
    let cells = table.rows.iter().map(|row| wrapped(&row[column], room));
    let head = wrapped(&table.heads[column], 1);
    let lines = |text: String| text.lines().map(|line| line.chars().count()).max();
    cells.chain([head]).filter_map(lines).max().unwrap_or(0)
}

/// How wide a cell of this column may get: of a table of words alone, the last column takes what
/// the others leave of a line.
fn room(table: &Table, column: usize) -> usize {
    let is_beside = table.words < table.heads.len();
    let is_last = column + 1 == table.heads.len();
    if column < table.words && is_beside {
        WORDS
    } else if !is_beside && is_last {
        let widths = (0..column).map(|other| width(table, other) + GAP);
        TERMINAL.saturating_sub(widths.sum()).max(NARROWEST)
    } else {
        usize::MAX
    }
}

/// Draws these columns.
fn block(table: &Table, columns: &[usize]) -> String {
    let rule = LineStyle::none().fill('─').junction('─');
    let mut drawn = comfy_table::Table::new();
    drawn.load_style(TableStyle::new().header_separator(rule));
    let widths = columns.iter().map(|column| width(table, *column));
    let heads = columns.iter().zip(widths);
    let heads = heads.map(|(column, wide)| wrapped(table.heads[*column].trim_end(), wide));
    let heads: Vec<String> = heads.collect();
    let tall = |head: &String| head.lines().count();
    let tallest = heads.iter().map(tall).max().unwrap_or(0);
    // So that heads stand on the line.
    let on_the_line = |head: &String| Cell::new("\n".repeat(tallest - tall(head)) + head);
    drawn.set_header(heads.iter().map(on_the_line));
    for row in &table.rows {
        let cell = |column: &usize| wrapped(&row[*column], room(table, *column));
        drawn.add_row(columns.iter().map(cell));
    }
    for (place, column) in drawn.column_iter_mut().enumerate() {
        // One more stands between columns, where the rule has its junctions.
        column.set_padding((if place > 0 { GAP as u16 - 1 } else { 0 }, 0));
        if columns[place] >= table.words {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let text = drawn.to_string();
    text.lines().map(str::trim_end).join("\n")
}

/// Parts of a line that stay whole, with the space or comma behind them. Digits behind a comma are
/// part of a number.
fn words(line: &str) -> Vec<&str> {
    let next = line.chars().skip(1).chain([' ']);
    let ends = line.char_indices().zip(next);
    let ends = ends.filter(|((_, c), next)| *c == ' ' || (*c == ',' && next.is_alphabetic()));
    let ends = ends.map(|((at, _), _)| at + 1).chain([line.len()]);
    let mut begin = 0;
    let word = |end| &line[std::mem::replace(&mut begin, end)..end];
    ends.map(word).collect()
}

/// Breaks text behind spaces and commas into lines of at most `room` characters. A word that is
/// longer than that has a line of its own.
pub(crate) fn wrapped(text: &str, room: usize) -> String {
    let mut lines: Vec<String> = Vec::new();
    for line in text.split('\n') {
        lines.push(String::new());
        for word in words(line) {
            let last = lines.last_mut().expect("one was pushed");
            let wide = last.chars().count() + word.trim_end().chars().count();
            if wide > room && !last.is_empty() {
                lines.push(word.into());
            } else {
                last.push_str(word);
            }
        }
    }
    lines.iter().map(|line| line.trim_end()).join("\n")
}

/// Returns a value as the text that `text` makes of it; `–` for `None`.
pub fn or_dash<T>(value: Option<T>, text: impl Fn(T) -> String) -> String {
    value.map_or(NONE.into(), text)
}

/// Returns a table as HTML. Cells in the word columns become row headers. For the index of a row,
/// `row` returns its HTML attributes, and `sign` the HTML before its first text. For the indices of
/// row and column, `cell` returns the HTML attributes of a number cell. `content` returns the HTML
/// in a number cell, given the index of its column and its text, which is escaped.
pub fn html(
    table: &Table,
    row: impl Fn(usize) -> String,
    sign: impl Fn(usize) -> String,
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
                let sign = or_nothing((column == 0).then_some(index), &sign);
                format!("<th scope=\"row\">{sign}{text}</th>")
            } else {
                let (attributes, content) = (cell(index, column), content(column, text));
                format!("<td {attributes}>{content}</td>")
            };
        }
        body += "</tr>\n";
    }
    let heads: String = heads.collect();
    format!("<table><thead><tr>{heads}</tr></thead><tbody>\n{body}</tbody></table>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_without_room_stand_below_and_columns_of_nothing_are_named() {
        let heads = ["method", "first of all", "second", "none", "third"];
        let long = |digit: &str| digit.repeat(30);
        let row = |name: &str, n: &str| vec![name.into(), long(n), long(n), "–".into(), long(n)];
        let table = Table::new(heads, 1, [row("a", "1"), row("bb", "2")]);
        let text = terminal(&table);
        assert!(text.lines().all(|line| line.chars().count() <= TERMINAL));
        let blocks: Vec<&str> = text.split("\n\n").collect();
        let has = |block: &str, part: &str| block.contains(part) && block.contains("\nbb  ");
        assert!(
            has(blocks[0], "first of all") && has(blocks[0], "second"),
            "{text}"
        );
        assert!(has(blocks[1], "third") && blocks.len() == 2, "{text}");
        assert!(text.ends_with("\nno row has: none"), "{text}");
    }

    #[test]
    fn words_are_broken_behind_commas_and_never_within() {
        let label = "crsm@n=1,depth=plane,fit=receivers,cull=none 1024 (of another hour)";
        let table = Table::new(["method", "n"], 1, [vec![label.into(), "1".into()]]);
        let text = terminal(&table);
        let longest = text.lines().map(|line| line.chars().count()).max();
        assert!(longest <= Some(WORDS + 3), "{text}");
        assert!(
            text.contains("crsm@n=1,depth=plane,fit=receivers,"),
            "{text}"
        );
        assert_eq!(wrapped("one two three", 7), "one two\nthree");
        assert_eq!(wrapped("54,876 of 1", 3), "54,876\nof\n1");
        assert_eq!(wrapped("aaaaaa b", 2), "aaaaaa\nb");
    }
}
