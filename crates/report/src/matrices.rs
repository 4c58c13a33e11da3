//! Builds tables with a row for each method or pass and a column for each light or size. Nothing is
//! averaged over lights.

use crate::summary::{Row, Wrong};
use crate::summary_table::{Summary, summaries};
use crate::table::{or_dash, terminal};
use crate::verdict::main_choice;
use itertools::Itertools;
use skiagraph_compare::lists::unique;
use skiagraph_compare::records::regimes::Regime;
use skiagraph_compare::records::results::{Results, Run};
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{bytes, ms, percent, size};

/// Returns a table with a row for each method (with its map size) of the summaries, and a column
/// for each summary, under the head given with it. `cell` returns the text for a method that was
/// measured; other cells are `–`.
pub fn by_summary<'a>(
    columns: &[(&str, &Summary<'a>)],
    cell: impl Fn(&Summary<'a>, &Row<'a>) -> String,
) -> Table {
    let rows = columns.iter().flat_map(|(_, summary)| &summary.rows);
    let labels = unique(rows.map(|row| &row.label));
    let cells = labels.into_iter().map(|label| {
        let cell = |(_, summary): &(&str, &Summary<'a>)| {
            or_dash(measured(summary, label), |row| cell(summary, row))
        };
        let cells = columns.iter().map(cell);
        [label.clone()].into_iter().chain(cells).collect()
    });
    let heads = columns.iter().map(|(head, _)| *head);
    Table::new(["method"].into_iter().chain(heads), 1, cells)
}

/// Returns the row of a method that was measured; `None` if it could not run.
fn measured<'s, 'a>(summary: &'s Summary<'a>, label: &str) -> Option<&'s Row<'a>> {
    let mut rows = summary.rows.iter().filter(|row| row.views() > 0);
    rows.find(|row| row.label == label)
}

/// Returns, for each viewport with several lights, its size in pixels and a table with a row for
/// each method, a column for each light, and one for all lights at once. Cells show the percentage
/// of the pixels facing the light that are wrong outside the band (the pixels whose answer rounding
/// decides), over all views; the milliseconds of a frame, the mean of the views' medians; and the
/// memory, the most on a view.
///
/// A frame of all lights draws the first light as its column says (on views after it has moved,
/// without a G-buffer), and then of each other light the passes that run when it moves. Its memory
/// is the most of a light, as the lights are drawn one after another in the same. A method that
/// computes several lights at once has the frame of its first column. A method that lacks views
/// under a light has no such frame.
pub fn by_light(results: &Results) -> Vec<([u32; 2], Table)> {
    let summaries = summaries(results);
    let mut tables = Vec::new();
    for viewport in unique(summaries.iter().map(|summary| summary.viewport)) {
        let is_of = |summary: &&Summary| summary.viewport == viewport;
        let lights = summaries.iter().filter(is_of);
        let lights = lights.filter_map(|summary| Some((summary.light?, summary)));
        let lights: Vec<(&str, &Summary)> = lights.collect();
        if lights.len() < 2 {
            continue;
        }
        let of_row = |summary: &Summary, row: &Row| {
            let wrong = row.wrong();
            let time = row.frame_ms(main_choice(&summary.rows));
            text([wrong.outside_band, wrong.facing_light], time, row.bytes())
        };
        let mut table = by_summary(&lights, of_row);
        table.heads.push(format!("all {} at once", lights.len()));
        for cells in &mut table.rows {
            let rows = lights.iter();
            let rows = rows.map(|(_, summary)| Some((*summary, measured(summary, &cells[0])?)));
            let rows: Option<Vec<_>> = rows.collect();
            cells.push(or_dash(rows.and_then(|rows| at_once(&rows)), |text| text));
        }
        tables.push((viewport, table));
    }
    tables
}

/// The cell of the wrong pixels among all that face the light, milliseconds of a frame and memory.
fn text([wrong, facing]: [u64; 2], time: Option<f64>, memory: u64) -> String {
    let (share, time) = (percent(wrong, facing), or_dash(time, ms));
    format!("{share}, {time} ms, {}", bytes(memory))
}

/// The cell of all lights, from a method's rows under each.
fn at_once(rows: &[(&Summary, &Row)]) -> Option<String> {
    let ((summary, first), rest) = rows.split_first()?;
    if rest.iter().any(|(_, row)| row.views() != first.views()) {
        return None;
    }
    let has_all = first.runs().any(|(_, measured)| measured.lights.is_some());
    let rest = rest.iter().filter(|_| !has_all);
    let rest = rest.map(|(_, row)| row.frame_ms(Some(Regime::Light)));
    let first = first.frame_ms(main_choice(&summary.rows));
    let time = [first].into_iter().chain(rest).sum();
    let rows = rows.iter().map(|(_, row)| row);
    let wrong = rows.clone().map(|row| row.wrong());
    let count =
        |sum: [u64; 2], wrong: Wrong| [sum[0] + wrong.outside_band, sum[1] + wrong.facing_light];
    let memory = rows.map(|row| row.bytes()).max().unwrap_or_default();
    Some(text(wrong.fold([0; 2], count), time, memory))
}

/// Returns the GPU time of each pass as text: a table for each method, with a row for each pass and
/// a column for each viewport and map size. Cells are medians in milliseconds; several views are
/// averaged.
pub fn passes(results: &Results) -> String {
    let measured = results.runs.iter().filter(|run| run.measured.is_some());
    let methods = unique(measured.map(|run| &run.preset));
    let mut tables = methods.into_iter().map(|method| {
        let runs = results.runs.iter().filter(|run| run.preset == *method);
        matrix(method, &runs.collect::<Vec<_>>())
    });
    tables.join("\n")
}

fn matrix<'a>(method: &str, runs: &[&'a Run]) -> String {
    let with_figures = |run: &&'a Run| Some((*run, run.measured.as_ref()?));
    let measured = || runs.iter().filter_map(with_figures);
    let column = |run: &Run| (run.viewport, run.map_size);
    let columns = unique(measured().map(|(run, _)| column(run)));
    let passes = measured().flat_map(|(_, measured)| &measured.passes);
    let passes = unique(passes.map(|pass| pass.name.as_str()));
    let head = |(viewport, map): &([u32; 2], Option<u32>)| match map {
        Some(map) => format!("{}\nmap {map}", size(*viewport)),
        None => size(*viewport),
    };
    let heads = [format!("{method}, GPU ms")].into_iter();
    let heads = heads.chain(columns.iter().map(head));
    let rows = passes.into_iter().map(|name| {
        let cell = |of_column: &([u32; 2], Option<u32>)| {
            let runs = measured().filter(|(run, _)| column(run) == *of_column);
            let passes = runs.flat_map(|(_, measured)| &measured.passes);
            let times = passes.filter(|pass| pass.name == name);
            let times: Vec<f64> = times.filter_map(|pass| Some(pass.gpu_ms?.median)).collect();
            let mean = || times.iter().sum::<f64>() / times.len() as f64;
            or_dash((!times.is_empty()).then(mean), ms)
        };
        let cells = columns.iter().map(cell);
        [name.to_owned()].into_iter().chain(cells).collect()
    });
    terminal(&Table::new(heads, 1, rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::results as sample;

    #[test]
    fn a_pass_has_a_column_for_each_size() {
        let mut results = sample();
        let mut larger = results.runs[0].clone();
        larger.map_size = Some(2048);
        larger.measured.as_mut().unwrap().passes.pop();
        results.runs.push(larger);
        insta::assert_snapshot!(passes(&results));
    }
}
