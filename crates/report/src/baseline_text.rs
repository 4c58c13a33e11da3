//! The table of `compare --baseline`: what has changed since the baseline.

use crate::table::terminal;
use itertools::Itertools;
use skiagraph_compare::records::results_baseline::{CellChange, Change, Changes, Figures};
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{ms, plural, size, thousands};

/// The most cells of which the table also shows those that are the same.
const FEW: usize = 16;

/// Returns the changes as text for a terminal: how many cells (a method on one view in one
/// viewport) are worse, better and the same, a table of their figures, and remarks. If there are
/// more than 16 cells, the table leaves out those that are the same.
pub fn text(changes: &Changes) -> String {
    let count = |verdict| changes.with(verdict).len();
    let cells = &changes.cells;
    let mut lines = vec![format!(
        "Against {} of {}: {} worse, {} better, {} the same",
        changes.baseline,
        changes.began,
        count(Change::Worse),
        count(Change::Better),
        count(Change::Same)
    )];
    let is_shown = |cell: &&CellChange| cells.len() <= FEW || cell.verdict() != Change::Same;
    let shown: Vec<&CellChange> = cells.iter().filter(is_shown).collect();
    if !shown.is_empty() {
        lines.push(table(&shown));
    }
    let names = &changes.only_now;
    if !names.is_empty() {
        let runs = plural(names.len(), "run");
        lines.push(format!("{runs} not in the baseline: {}", names.join(", ")));
    }
    if changes.only_then > 0 {
        let cells = plural(changes.only_then, "cell");
        lines.push(format!("{cells} of the baseline not in this comparison"));
    }
    lines.extend(changes.notes.iter().cloned());
    let has_times = cells.iter().any(|cell| cell.ratio.is_some());
    if has_times {
        let text = "Slower or faster: by 3 % and more, and the interval (99.9 %) of the ratio of \
                    new to old frames does not hold 1.";
        lines.push(text.into());
    }
    lines.join("\n") + "\n"
}

/// Returns a line for each cell (a method on one view in one viewport) that is worse than in the
/// baseline, or could not run this time; empty if there is none.
pub fn failures(changes: &Changes) -> Vec<String> {
    let worse = changes.with(Change::Worse).into_iter();
    let line = |cell: &CellChange| {
        let [wrong, rmse, time, _] = figures(cell);
        let place = format!("`{}` on {}", cell.method, place(cell));
        let figures = match cell.errors {
            _ if cell.now.is_none() => return format!("{place} cannot run any more"),
            Change::Worse if cell.times() == Change::Worse => {
                format!("wrong {wrong}, RMSE {rmse}, {time} ms")
            }
            Change::Worse => format!("wrong {wrong}, RMSE {rmse}"),
            _ => format!("{time} ms"),
        };
        format!("{place} is {}: {figures}", words(cell))
    };
    worse.map(line).collect()
}

/// A row for each cell; its view and size only stand in it if there are several.
fn table(cells: &[&CellChange]) -> String {
    let are_several = !cells.iter().map(|cell| place(cell)).all_equal();
    let mut heads = vec!["method", "verdict", "wrong", "RMSE", "frame ms", "ratio"];
    if are_several {
        heads.insert(1, "on");
    }
    let rows = cells.iter().map(|cell| {
        let mut named = vec![cell.method.clone(), words(cell)];
        if are_several {
            named.insert(1, place(cell));
        }
        named.into_iter().chain(figures(cell)).collect()
    });
    terminal(&Table::new(heads.clone(), heads.len() - 4, rows))
}

/// View and viewport.
fn place(cell: &CellChange) -> String {
    format!("{} {}", cell.view, size(cell.viewport))
}

/// The change of a cell in words.
fn words(cell: &CellChange) -> String {
    let errors = match cell.errors {
        _ if cell.now.is_none() => "cannot run any more",
        Change::Worse => "more wrong",
        Change::Better => "less wrong",
        Change::Same => "",
    };
    let times = match cell.times() {
        Change::Worse => "slower",
        Change::Better => "faster",
        Change::Same => "",
    };
    match [errors, times] {
        ["", ""] => "same".into(),
        [one, ""] | ["", one] => one.into(),
        [errors, times] => format!("{errors}, {times}"),
    }
}

/// Wrong pixels, RMSE and time then and now, and the ratio of times with its interval.
fn figures(cell: &CellChange) -> [String; 4] {
    let pair = |text: fn(&Figures) -> String| {
        let now = cell.now.as_ref().map_or("–".into(), text);
        match text(&cell.then) {
            then if then == now => then,
            then => format!("{then} → {now}"),
        }
    };
    let ratio = cell.ratio.map_or("–".into(), |ratio| {
        format!("{:.2} ({:.2}–{:.2})", ratio.median, ratio.low, ratio.high)
    });
    [
        pair(|figures| thousands(figures.wrong)),
        pair(|figures| format!("{:.5}", figures.rmse)),
        pair(|figures| ms(figures.ms)),
        ratio,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_compare::records::turns::Ratio;

    fn cell(method: &str) -> CellChange {
        let then = Figures {
            wrong: 497,
            rmse: 0.0705,
            ms: 1.5,
        };
        CellChange {
            method: method.into(),
            view: "main".into(),
            viewport: [512, 256],
            then,
            now: Some(then),
            errors: Change::Same,
            ratio: Some(Ratio {
                low: 0.98,
                median: 1.0,
                high: 1.02,
            }),
        }
    }

    fn changes() -> Changes {
        let mut slower = cell("nsm 1024");
        slower.now.as_mut().unwrap().ms = 3.0;
        slower.ratio = Some(Ratio {
            low: 1.9,
            median: 2.0,
            high: 2.1,
        });
        let mut wrong = slower.clone();
        (wrong.method, wrong.errors) = ("crsm 1024".into(), Change::Worse);
        wrong.now.as_mut().unwrap().wrong = 1_200;
        wrong.view = "other".into();
        let mut better = cell("pcf 1024");
        (better.errors, better.ratio) = (Change::Better, None);
        (better.now.as_mut().unwrap().wrong, better.then.rmse) = (12, 0.1);
        let mut lost = cell("rt_hw");
        (lost.now, lost.ratio, lost.errors) = (None, None, Change::Worse);
        Changes {
            baseline: "old/results.json".into(),
            began: "2026-11-20T04:30:12Z".into(),
            cells: vec![slower, wrong, better, lost, cell("rt")],
            only_then: 1,
            only_now: vec!["vsm on main 512x256".into()],
            notes: vec!["times are not compared: another adapter or driver (1 cell)".into()],
        }
    }

    #[test]
    fn changes_stand_in_a_table_with_their_figures() {
        insta::assert_snapshot!(text(&changes()) + "\n" + &failures(&changes()).join("\n"));
    }

    #[test]
    fn of_many_cells_those_that_are_the_same_are_only_counted() {
        let mut many = changes();
        many.cells.extend((0..FEW).map(|_| cell("same")));
        let printed = text(&many);
        assert!(
            printed.contains("3 worse, 1 better, 17 the same"),
            "{printed}"
        );
        assert!(!printed.contains("  same"), "{printed}");
        let mut one = changes();
        one.cells.truncate(1);
        assert!(!text(&one).contains("  on "), "one view and size");
    }
}
