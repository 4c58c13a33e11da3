//! The matrix for a terminal: a row per case, a column per method, and below it what failed.

use crate::notes::wrong_surface;
use crate::table::terminal;
use skiagraph_compare::records::stress::{
    Case, Casters, Cell, Column, Guarantee, OutsideBand, Report, Verdict,
};
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{percent, size, thousands};

/// The command that shows the pictures of a method on a case, and what to set for it besides.
pub type CommandFor<'a> = &'a dyn Fn(&Column, &str, Option<&str>) -> String;

/// A heading, the matrix, and what there is to say of it.
pub fn render(report: &Report, command_for: CommandFor) -> String {
    let mut text = format!(
        "{}\n{}{} · pixels outside the band: wrongly lit + wrongly in shadow · ✗ \
         fails · * all left to rays · PFL: pixels that face the light\n{}\n",
        report.adapter,
        size(report.viewport),
        one_map(report).map_or(String::new(), |size| format!(", maps of {size}x{size}")),
        matrix(report),
    );
    for column in &report.methods {
        if let Some(reason) = &column.unavailable {
            text += &format!("{} is unavailable: {reason}\n", named(report, column));
        }
    }
    for case in report.cases.iter().filter(|case| case.wrong_surface > 0) {
        text += &format!(
            "{}: warning: {}\n",
            case.name,
            wrong_surface(
                case.wrong_surface,
                report.viewport.map(u64::from).iter().product()
            )
        );
    }
    text += &format!("{}\n", summary(report));
    let failures = failures(report, command_for);
    if !failures.is_empty() {
        text += &format!("\nFailed\n{failures}");
    }
    text
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

fn matrix(report: &Report) -> String {
    let can_run = report.methods.iter();
    let columns: Vec<&Column> = can_run
        .filter(|column| column.unavailable.is_none())
        .collect();
    let head = |column: &&Column| {
        let guarantee = column.guarantee.map_or("", Guarantee::word);
        format!("{}\n{guarantee}", named(report, column))
    };
    let methods: Vec<String> = columns.iter().map(head).collect();
    let row = |case, set| {
        let cells = columns.iter().map(|column| cell(case, column, set));
        heads(case, set).into_iter().chain(cells).collect()
    };
    let rows = report.cases.iter().flat_map(|case| {
        let sets = sets(case).into_iter();
        sets.map(move |set| (case, set))
    });
    let heads = ["case", "PFL", "band"].into_iter();
    let heads = heads.chain(methods.iter().map(String::as_str));
    let rows = rows.map(|(case, set)| row(case, set));
    terminal(&Table::new(heads, 1, rows))
}

/// The rows of a case: as the methods are, then with what is set besides.
fn sets(case: &Case) -> Vec<Option<&str>> {
    let mut sets = vec![None];
    for cell in &case.cells {
        if !sets.contains(&cell.set.as_deref()) {
            sets.push(cell.set.as_deref());
        }
    }
    sets
}

fn heads(case: &Case, set: Option<&str>) -> [String; 3] {
    if let Some(set) = set {
        return [format!("  {set}"), String::new(), String::new()];
    }
    let open = match case.casters {
        Casters::Open => " (open)",
        Casters::Closed => "",
    };
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

fn cell(case: &Case, column: &Column, set: Option<&str>) -> String {
    let is_own = |cell: &&Cell| cell.is_of(column) && cell.set.as_deref() == set;
    let Some(cell) = case.cells.iter().find(is_own) else {
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
    let mut text = match passed + failed {
        0 => "no cell is judged: these methods guarantee nothing (--exact NAME judges one all the \
            same)"
            .into(),
        judged => format!(
            "{passed} of {judged} judged cells are as guaranteed, {} of them by rays alone",
            report.left_to_rays()
        ),
    };
    text += &format!(
        "; {} of {} bands are within their caps",
        report.cases.len() - report.failed_cases(),
        report.cases.len()
    );
    if open > 0 {
        text.push_str(
            "\nopen: casters that are not closed are wrong by culling; such methods are judged on \
             them with cull=none",
        );
    }
    text
}

fn failures(report: &Report, command_for: CommandFor) -> String {
    let mut text = String::new();
    for case in &report.cases {
        if let Some(reason) = &case.failed {
            text += &format!("  {}: no reference: {reason}\n", case.name);
        }
        if case.exceeds_cap() {
            text += &format!(
                "  {}: {} pixels in the band, {} of PFL; at most {} % may be\n",
                case.name,
                thousands(case.band),
                percent(case.band, case.pixels.facing_light),
                (case.band_cap * 100.0) as f32
            );
        }
        let pairs = report.methods.iter().flat_map(|column| {
            let cells = case.cells.iter().filter(|cell| cell.is_of(column));
            cells.map(move |cell| (column, cell))
        });
        for (column, cell) in pairs.filter(|(_, cell)| cell.verdict == Verdict::Fail) {
            let set = cell.set.as_deref();
            let with = set.map_or(String::new(), |set| format!(" with {set}"));
            let what = match (&cell.counts, &cell.failed) {
                (Some(counts), _) => {
                    let OutsideBand {
                        lit,
                        shadow,
                        certain,
                    } = counts.outside_band;
                    format!(
                        "{} wrongly lit, {} wrongly in shadow; {} of them called certain",
                        thousands(lit),
                        thousands(shadow),
                        thousands(certain)
                    )
                }
                (None, Some(reason)) => reason.clone(),
                (None, None) => "did not run".into(),
            };
            text += &format!(
                "  {}{with} on {}: {what}\n    {}\n",
                named(report, column),
                case.name,
                command_for(column, &case.name, set)
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::stress as sample;

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
            text.contains(" nsm 128 ") && text.contains(" crsm 64 "),
            "{text}"
        );
        assert!(text.contains("crsm 64 on needles"), "{text}");
    }
}
