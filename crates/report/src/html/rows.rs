//! Writes the rows of all tables as HTML.

use crate::html::charts::sign;
use crate::html::shown::{Shown, part};
use crate::matrices::by_light;
use crate::overview::{Matrix, Overview, scene_names};
use crate::summary::Row;
use crate::summary_table::NOT_THERE;
use crate::table::html;
use itertools::Itertools;
use skiagraph_chart::xml;
use skiagraph_compare::records::figures::WRONG;
use skiagraph_compare::records::sources::Source;
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::size;
use std::path::{Path, PathBuf};

/// Returns one HTML table with the rows of all `tables`. The page's script shows the rows of the
/// tables that the reader has chosen.
pub fn tables(tables: &[Shown]) -> String {
    let each = tables.iter().map(|shown| &shown.table);
    // Tables of paths have columns that others lack.
    let Some(widest) = each.max_by_key(|table| table.heads.len()) else {
        return String::new();
    };
    let mut heads = widest.heads.clone();
    let cells = tables.iter().flat_map(|shown| {
        let table = &shown.table;
        table.rows.iter().map(|cells| {
            let cell = |head: &String| {
                let column = table.heads.iter().position(|name| name == head);
                column.map_or("–".into(), |column| cells[column].clone())
            };
            let mut row: Vec<String> = widest.heads.iter().map(cell).collect();
            row.insert(1, shown.title.clone());
            row
        })
    });
    let cells: Vec<Vec<String>> = cells.collect();
    heads.insert(1, "of".into());
    let rows = tables.iter().enumerate();
    let rows = rows.flat_map(|(index, shown)| attributes(index, shown));
    let rows: Vec<String> = rows.collect();
    let all_rows = tables.iter().flat_map(|shown| &shown.summary.rows);
    let signs: Vec<String> = all_rows.map(|row| sign(tables, &row.method)).collect();
    let class = |row: usize, column: usize| match (&*heads[column], &*cells[row][column]) {
        (WRONG, "0") => "class=\"zero\"".into(),
        (WRONG, text) if text != NOT_THERE => "class=\"wrong\"".into(),
        _ => String::new(),
    };
    let table = Table::new(heads.clone(), 2, cells.clone());
    let attributes = |row: usize| rows[row].clone();
    let sign = |row: usize| signs[row].clone();
    let table = html(&table, attributes, sign, class, |_, text| text);
    let indices: Vec<usize> = (0..tables.len()).collect();
    part("rows", &indices, None, &table)
}

/// Returns HTML tables with a row for each method and a column for each light, one for each source
/// and viewport with several lights; empty if there are none. `tables` are those of the page.
pub fn lights(sources: &[Source], tables: &[Shown]) -> String {
    let of_source = |source: &Source| {
        let of_lights = by_light(&source.results).into_iter();
        let scene = &source.results.scene.name;
        let table = |(viewport, table): ([u32; 2], Table)| {
            let head = format!("{scene}, {}", size(viewport));
            let (none, sign) = (|_, _| String::new(), |row| sign_of(tables, &table, row));
            let body = html(&table, |_| String::new(), sign, none, |_, text| text);
            format!("<h3>{}</h3>{body}", xml(&head))
        };
        of_lights.map(table).collect::<String>()
    };
    sources.iter().map(of_source).collect()
}

/// The sign of the method that a row of a table is of. The row begins with the label of a row of
/// the page's tables.
fn sign_of(tables: &[Shown], table: &Table, row: usize) -> String {
    let label = table.rows[row].first();
    let mut rows = tables.iter().flat_map(|shown| &shown.summary.rows);
    let row = rows.find(|row| Some(&row.label) == label);
    row.map_or(String::new(), |row| sign(tables, &row.method))
}

/// Returns the overview of the sources' scenes as HTML: tables of methods and scenes, whose cells
/// link to the table of their scene among the page's `tables`, and the verdicts. It is empty for
/// results of one scene.
pub fn overview(sources: &[Source], tables: &[Shown]) -> String {
    let scenes = sources.iter().map(|source| {
        let folder = source.folders.first().map(PathBuf::as_path);
        (folder.unwrap_or(Path::new("")), &source.results)
    });
    let scenes: Vec<_> = scenes.collect();
    // One scene on several machines has several sources.
    let mut source_scenes = sources.iter().map(|source| &source.results.scene);
    if source_scenes.all_equal() {
        return String::new();
    }
    let names = scene_names(&scenes);
    let columns = tables.iter();
    let columns = columns.map(|shown| (names[shown.source].as_str(), shown.summary));
    let Some(overview) = Overview::new(&columns.collect::<Vec<_>>()) else {
        return String::new();
    };
    let matrix = |matrix: Matrix| {
        let head = format!("<h3>{}</h3>", size(matrix.viewport));
        let class = |row: usize, column: usize| {
            let is_exact = matrix.table.rows[row][column].contains('*');
            if is_exact { "class=\"zero\"" } else { "" }.to_owned()
        };
        let link = |column: usize, text: String| {
            let (table, text) = (matrix.summaries[column - 1], text.replace("&#10;", "<br>"));
            format!("<a href=\"#table-section\" data-choose=\"{table}\">{text}</a>")
        };
        let none = |_| String::new();
        let sign = |row| sign_of(tables, &matrix.table, row);
        head + &html(&matrix.table, none, sign, class, link)
    };
    let matrices = overview.matrices().into_iter().map(matrix);
    let sentences = overview.sentences().into_iter();
    let sentences = sentences.map(|sentence| format!("<p>{}</p>\n", with_names(&sentence)));
    matrices.chain(sentences).collect()
}

/// A sentence as HTML; text between backquotes is a name.
fn with_names(sentence: &str) -> String {
    let named = |(index, part): (usize, String)| match index % 2 {
        1 => format!("<code>{part}</code>"),
        _ => part,
    };
    sentence
        .split('`')
        .map(xml)
        .enumerate()
        .map(named)
        .collect()
}

/// Attributes of each row.
fn attributes(index: usize, table: &Shown) -> Vec<String> {
    let fastest = table.summary.verdict().fastest_exact;
    let of_row = |(place, row): (usize, &Row)| {
        let class = match row.views() > 0 && row.is_exact() {
            _ if fastest.values().any(|best| *best == place) => "exact best",
            _ if table.summary.is_old(row) => "old",
            true => "exact",
            false => "",
        };
        let label = xml(&row.label);
        format!("class=\"{class}\" data-of=\"{index}\" data-label=\"{label}\"")
    };
    table.summary.rows.iter().enumerate().map(of_row).collect()
}
