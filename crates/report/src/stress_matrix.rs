//! Writes the matrix of `stress` for a terminal: a row for each case, a column for each method, and
//! below it the failures.

use crate::notes::wrong_surface;
use crate::table::terminal;
use skiagraph_cases::HardCase;
use skiagraph_compare::lists::unique;
use skiagraph_compare::records::stress::{
    Case, Casters, Cell, Column, Guarantee, OutsideBand, Report, Verdict,
};
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{or_nothing, percent, size, thousands};

/// Function that returns the command line that draws a method's pictures of a case. Its arguments
/// are the method's column, the case's name, and [`Cell::set`], the additional assignment of a
/// param such as `cull=none`.
pub type CommandFor<'a> = &'a dyn Fn(&Column, &str, Option<&str>) -> String;

/// Returns the heading, the matrix, the remarks and, with the command lines of `command_for`, the
/// failures as text for a terminal.
pub fn render(report: &Report, command_for: CommandFor) -> String {
    let table = terminal(&matrix(report).0);
    let (heading, remarks) = (heading(report), remarks(report));
    let mut text = format!("{heading}\n{table}\n{remarks}\n");
    let failures = failures(report, command_for);
    if !failures.is_empty() {
        text += &format!("\nFailed\n{failures}");
    }
    text
}

/// Returns the catalogue of hard cases as text for a terminal: names, casters, reasons.
pub fn catalogue() -> String {
    let row = |case: HardCase| {
        let is_open = case.casters == Casters::Open;
        let casters = if is_open { "open" } else { "closed" };
        vec![case.name.into(), casters.into(), case.reason.into()]
    };
    let heads = ["case", "casters", "what it provokes"];
    let rows = skiagraph_cases::cases().into_iter().map(row);
    terminal(&Table::new(heads, 3, rows)) + "\n"
}

/// Returns lines with the adapter, the viewport and the meaning of the cells.
pub fn heading(report: &Report) -> String {
    let (adapter, viewport) = (&report.adapter, size(report.viewport));
    let maps = or_nothing(one_map(report), |size| format!(", maps of {size}x{size}"));
    format!(
        "{adapter}\n{viewport}{maps} · pixels outside the band: wrongly lit + wrongly in shadow · \
         ✗ fails · * all left to rays · PFL: pixels that face the light"
    )
}

/// Returns remarks below the matrix, a line each: the methods that could not run, warnings, and the
/// numbers of cells with each outcome.
pub fn remarks(report: &Report) -> String {
    let mut text = String::new();
    for column in &report.methods {
        if let Some(reason) = &column.unavailable {
            text += &format!("{} is unavailable: {reason}\n", named(report, column));
        }
    }
    for case in report.cases.iter().filter(|case| case.wrong_surface > 0) {
        let pixels = report.viewport.map(u64::from).iter().product();
        let what = wrong_surface(case.wrong_surface, pixels);
        text += &format!("{}: warning: {what}\n", case.name);
    }
    text + &summary(report)
}

/// The size of all maps, if they have the same.
fn one_map(report: &Report) -> Option<u32> {
    let mut sizes = report.methods.iter().filter_map(|column| column.map_size);
    let first = sizes.next()?;
    sizes.all(|size| size == first).then_some(first)
}

/// The preset, with its map size where there are several.
fn named(report: &Report, column: &Column) -> String {
    match column.map_size {
        Some(size) if one_map(report).is_none() => format!("{} {size}", column.preset),
        _ => column.preset.clone(),
    }
}

/// A row of the matrix: its case, and one entry for each method that can run, in the order of
/// [`Report::methods`]. An entry is `None` if the method has no result in this row.
pub type MatrixRow<'a> = (&'a Case, Vec<Option<&'a Cell>>);

/// Returns the matrix as a table for display, and its rows as data, in the same order. The table's
/// first three columns describe the case: its name, and the numbers of its pixels that face the
/// light and whose answer rounding decides. The others belong to the methods in the order of the
/// rows' entries. A case has a second row if methods also ran it with `cull=none`.
pub fn matrix(report: &Report) -> (Table, Vec<MatrixRow<'_>>) {
    let can_run = |column: &&Column| column.unavailable.is_none();
    let columns: Vec<&Column> = report.methods.iter().filter(can_run).collect();
    let head = |column: &&Column| {
        let guarantee = column.guarantee.map_or("", Guarantee::word);
        format!("{}\n{guarantee}", named(report, column))
    };
    let heads = ["case", "PFL", "band"].map(str::to_owned).into_iter();
    let mut table = Table::new(heads.chain(columns.iter().map(head)), 1, []);
    let mut rows = Vec::new();
    for case in &report.cases {
        for set in sets(case) {
            let find = |column: &&Column| {
                let mut cells = case.cells.iter();
                cells.find(|cell| cell.is_of(column) && cell.set.as_deref() == set)
            };
            let entries: Vec<Option<&Cell>> = columns.iter().map(find).collect();
            let cells = entries.iter().map(|entry| cell(case, *entry, set));
            let cells = heads_of(case, set).into_iter().chain(cells);
            table.rows.push(cells.collect());
            rows.push((case, entries));
        }
    }
    (table, rows)
}

/// The rows of a case: as the methods are, then with what is set besides.
fn sets(case: &Case) -> Vec<Option<&str>> {
    let sets = case.cells.iter().map(|cell| cell.set.as_deref());
    unique([None].into_iter().chain(sets))
}

fn heads_of(case: &Case, set: Option<&str>) -> [String; 3] {
    if let Some(set) = set {
        return [format!("  {set}"), String::new(), String::new()];
    }
    let is_open = case.casters == Casters::Open;
    let open = if is_open { " (open)" } else { "" };
    let facing = case.pixels.facing_light;
    let band = match case.band {
        0 => "0".into(),
        band => percent(band, facing),
    };
    [
        format!("{}{open}", case.name),
        thousands(facing),
        match case.verdict {
            Verdict::Fail => format!("✗ {band}"),
            _ => band,
        },
    ]
}

fn cell(case: &Case, cell: Option<&Cell>, set: Option<&str>) -> String {
    let Some(cell) = cell else {
        return set.map_or("–".into(), |_| String::new());
    };
    let Some(counts) = &cell.counts else {
        return "✗ error".into();
    };
    let OutsideBand { lit, shadow, .. } = counts.outside_band;
    let mut figures = match lit + shadow {
        0 => "0".to_owned(),
        _ => format!("{lit}+{shadow}"),
    };
    if case.is_left_to_rays(cell) {
        figures.push('*');
    }
    match cell.verdict {
        Verdict::Fail => format!("✗ {figures}"),
        Verdict::Open if lit + shadow > 0 => format!("{figures} open"),
        Verdict::Pass | Verdict::Open | Verdict::Unjudged => figures,
    }
}

fn summary(report: &Report) -> String {
    let [passed, failed, open] =
        [Verdict::Pass, Verdict::Fail, Verdict::Open].map(|verdict| report.count(verdict));
    let traced = report.left_to_rays();
    let mut text = match passed + failed {
        0 => "no cell is judged: these methods guarantee nothing (--exact NAME judges one all the \
            same)"
            .into(),
        judged => format!(
            "{passed} of {judged} judged cells are as guaranteed, {traced} of them by rays alone"
        ),
    };
    let count = report.cases.len();
    let within = count - report.failed_cases();
    text += &format!("; {within} of {count} bands are within their caps");
    if open > 0 {
        text += "\nopen: casters that are not closed are wrong by culling; such methods are judged \
                 on them with cull=none";
    }
    text
}

/// Lists the failures case by case, with the command lines of `command_for` that draw their
/// pictures. The text is empty if nothing failed.
pub fn failures(report: &Report, command_for: CommandFor) -> String {
    let mut text = String::new();
    for case in &report.cases {
        if let Some(reason) = &case.failed {
            text += &format!("  {}: no reference: {reason}\n", case.name);
        }
        if case.exceeds_cap() {
            let share = percent(case.band, case.pixels.facing_light);
            let (band, most) = (thousands(case.band), (case.band_cap * 100.0) as f32);
            text += &format!(
                "  {}: {band} pixels in the band, {share} of PFL; at most {most} % may be\n",
                case.name
            );
        }
        let pairs = report.methods.iter().flat_map(|column| {
            let cells = case.cells.iter().filter(|cell| cell.is_of(column));
            cells.map(move |cell| (column, cell))
        });
        for (column, cell) in pairs.filter(|(_, cell)| cell.verdict == Verdict::Fail) {
            let set = cell.set.as_deref();
            let with = or_nothing(set, |set| format!(" with {set}"));
            let what = match (&cell.counts, &cell.failed) {
                (Some(counts), _) => {
                    let outside = &counts.outside_band;
                    let counts = [outside.lit, outside.shadow, outside.certain];
                    let [lit, shadow, certain] = counts.map(thousands);
                    let wrong = format!("{lit} wrongly lit, {shadow} wrongly in shadow");
                    format!("{wrong}; {certain} of them called certain")
                }
                (None, Some(reason)) => reason.clone(),
                (None, None) => "did not run".into(),
            };
            let (method, command) = (named(report, column), command_for(column, &case.name, set));
            text += &format!("  {method}{with} on {}: {what}\n    {command}\n", case.name);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::stress as sample;

    #[test]
    fn failures_stand_out_and_come_with_the_way_to_look_at_them() {
        let look = |column: &Column, case: &str, set: Option<&str>| {
            format!(
                "look at {} {:?} {case} {set:?}",
                column.preset, column.map_size
            )
        };
        insta::assert_snapshot!(render(&sample(), &look));
    }

    #[test]
    fn one_map_size_stands_above_and_several_in_the_heads() {
        let mut report = sample();
        report.methods[2].map_size = Some(64);
        for case in &mut report.cases {
            let cells = case.cells.iter_mut();
            cells
                .filter(|cell| cell.preset == "crsm")
                .for_each(|cell| cell.map_size = Some(64));
        }
        let text = render(&report, &|_, _, _| String::new());
        assert!(!text.contains("maps of"), "{text}");
        assert!(
            text.contains("  nsm  ") && text.contains("  128  ") && text.contains("  crsm 64\n"),
            "{text}"
        );
        assert!(text.contains("crsm 64 on needles"), "{text}");
    }
}
