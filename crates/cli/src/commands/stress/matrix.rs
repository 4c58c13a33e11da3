//! The matrix for a terminal: a row per case, a column per method, and below it what failed.

use super::{
    promise::Promise,
    report::{Case, Casters, Cell, Column, Outside, Report, Verdict},
};
use crate::table::{add_row, new_table, percent, thousands};

/// The command that shows the pictures of a method on a case, and what to set for it besides.
pub type Look<'a> = &'a dyn Fn(&Column, &str, Option<&str>) -> String;

/// A heading, the matrix, and what there is to say of it.
pub fn render(report: &Report, look: Look) -> String {
    let [width, height] = report.viewport;
    let mut text = format!(
        "{}\n{width}x{height}{} · pixels outside the band: wrongly lit + wrongly in shadow · ✗ fails · * all left to rays · PFL: pixels that face the light\n{}\n",
        report.adapter,
        one_map(report).map_or(String::new(), |size| format!(", maps of {size}x{size}")),
        table(report),
    );
    for column in &report.methods {
        if let Some(reason) = &column.unavailable {
            text.push_str(&format!(
                "{} is unavailable: {reason}\n",
                named(report, column)
            ));
        }
    }
    text.push_str(&format!("{}\n", summary(report)));
    let failures = failures(report, look);
    if !failures.is_empty() {
        text.push_str(&format!("\nFailed\n{failures}"));
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

fn table(report: &Report) -> String {
    let head = |column: &Column| {
        let promise = column.promise.map_or("", Promise::word);
        format!("{}\n{promise}", named(report, column))
    };
    let able = report.methods.iter();
    let able: Vec<&Column> = able.filter(|column| column.unavailable.is_none()).collect();
    let mut header = vec!["case".to_owned(), "PFL".into(), "band".into()];
    header.extend(able.iter().map(|column| head(column)));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let mut table = new_table(&header, 1);
    for case in &report.cases {
        let own: Vec<Option<&str>> = sets(case);
        for set in own {
            let row = heads(case, set).into_iter();
            let cells = able.iter().map(|column| {
                let mut cells = case.cells.iter();
                match cells.find(|cell| cell.is_of(column) && cell.set.as_deref() == set) {
                    Some(cell) => shown(case, cell),
                    None if set.is_some() => String::new(),
                    None => "–".into(),
                }
            });
            add_row(&mut table, row.chain(cells).collect(), 1);
        }
    }
    table.to_string()
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

fn shown(case: &Case, cell: &Cell) -> String {
    let Some(counts) = &cell.counts else {
        return "✗ error".into();
    };
    let Outside { lit, shadow, .. } = counts.outside_band;
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
        0 => "no cell is judged: these methods promise nothing (--exact NAME judges one all the same)".into(),
        judged => format!(
            "{passed} of {judged} judged cells are as promised, {} of them by rays alone",
            report.left_to_rays()
        ),
    };
    text.push_str(&format!(
        "; {} of {} bands are within their caps",
        report.cases.len() - report.failed_cases(),
        report.cases.len()
    ));
    if open > 0 {
        text.push_str(
            "\nopen: casters that are not closed are wrong by culling; such methods are judged on them with cull=none",
        );
    }
    text
}

fn failures(report: &Report, look: Look) -> String {
    let mut text = String::new();
    for case in &report.cases {
        if let Some(reason) = &case.failed {
            text.push_str(&format!("  {}: no reference: {reason}\n", case.name));
        }
        if case.exceeds_cap() {
            text.push_str(&format!(
                "  {}: {} pixels in the band, {} of PFL; at most {} % may be\n",
                case.name,
                thousands(case.band),
                percent(case.band, case.pixels.facing_light),
                case.band_cap * 100.0
            ));
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
                    let Outside {
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
            text.push_str(&format!(
                "  {}{with} on {}: {what}\n    {}\n",
                named(report, column),
                case.name,
                look(column, &case.name, set)
            ));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{super::report::tests::sample, *};

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
