//! The table of `compare --baseline`: what has changed since the baseline.

use crate::table::terminal;
use itertools::Itertools;
use skiagraph_compare::records::regimes::Regime;
use skiagraph_compare::records::results_baseline::{
    CellChange, Change, Changes, Figures, TimeChange,
};
use skiagraph_compare::records::table::Table;
use skiagraph_compare::records::turns::Ratio;
use skiagraph_compare::wording::{ms, or_nothing, plural, size, thousands};

/// The most cells of which the table also shows those that are the same.
const FEW: usize = 16;

/// Returns the changes as text for a terminal: how many cells (a method on one view in one
/// viewport) are worse, better and the same, a table of their figures, and remarks. If there are
/// more than 16 cells, the table leaves out those that are the same.
pub fn text(changes: &Changes) -> String {
    let count = |verdict| changes.with(verdict).len();
    let cells = &changes.cells;
    let [worse, better, same] = [Change::Worse, Change::Better, Change::Same].map(count);
    let (baseline, began) = (&changes.baseline, &changes.began);
    let mut lines = vec![format!(
        "Against {baseline} of {began}: {worse} worse, {better} better, {same} the same"
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
    let has_times = cells.iter().any(|cell| !cell.times.is_empty());
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
        let place = format!("`{}` on {}", cell.method, place(cell));
        if cell.now.is_none() {
            return format!("{place} cannot run any more");
        }
        let [wrong, rmse] = errors(cell);
        let errors = format!("more wrong: wrong {wrong}, RMSE {rmse}");
        let errors = (cell.errors == Change::Worse).then_some(errors);
        let slower = cell.times.iter();
        let slower = slower.filter(|times| times.change() == Change::Worse);
        let slower = slower.map(|times| {
            let condition = times.regime.map_or("", Regime::condition);
            let words = format!("slower {condition}");
            let (words, then, now) = (words.trim_end(), ms(times.then), ms(times.now));
            format!("{words}: {then} → {now} ms")
        });
        let figures = errors.into_iter().chain(slower);
        format!("{place} is {}", figures.format("; "))
    };
    worse.map(line).collect()
}

/// A row for each cell, and one for each regime whose times have changed; the cell's view and size
/// only stand in it if there are several.
fn table(cells: &[&CellChange]) -> String {
    let are_several = !cells.iter().map(|cell| place(cell)).all_equal();
    let mut heads = vec!["method", "verdict", "wrong", "RMSE", "frame ms", "ratio"];
    if are_several {
        heads.insert(1, "on");
    }
    let rows = cells.iter().flat_map(|cell| {
        let (whole, regimes) = cell.times.split_at(cell.times.len().min(1));
        let row = |verdict: String, errors: [String; 2], times: Option<&TimeChange>| {
            let mut row = vec![cell.method.clone(), verdict];
            if are_several {
                row.insert(1, place(cell));
            }
            row.extend(errors);
            row.extend(times.map_or(["–", "–"].map(str::to_owned), figures));
            row
        };
        let first = row(words(cell, whole), errors(cell), whole.first());
        let changed = regimes.iter().filter_map(|times| {
            let nothing = ["", ""].map(str::to_owned);
            Some(row(time_words(times)?, nothing, Some(times)))
        });
        [first].into_iter().chain(changed).collect::<Vec<_>>()
    });
    terminal(&Table::new(heads.clone(), heads.len() - 4, rows))
}

/// View and viewport.
fn place(cell: &CellChange) -> String {
    format!("{} {}", cell.view, size(cell.viewport))
}

/// The changes of a cell's errors and of some of its times in words.
fn words(cell: &CellChange, times: &[TimeChange]) -> String {
    let errors = match cell.errors {
        _ if cell.now.is_none() => Some("cannot run any more".to_owned()),
        Change::Worse => Some("more wrong".to_owned()),
        Change::Better => Some("less wrong".to_owned()),
        Change::Same => None,
    };
    let times = times.iter().filter_map(time_words);
    match errors.into_iter().chain(times).join(", ") {
        words if words.is_empty() => "same".into(),
        words => words,
    }
}

/// The change of times in words: `slower`, of a regime `slower (light)`; `None` if they are the
/// same.
fn time_words(times: &TimeChange) -> Option<String> {
    let word = match times.change() {
        Change::Worse => "slower",
        Change::Better => "faster",
        Change::Same => return None,
    };
    let regime = or_nothing(times.regime, |regime| format!(" ({})", regime.word()));
    Some(format!("{word}{regime}"))
}

/// Wrong pixels and RMSE then and now.
fn errors(cell: &CellChange) -> [String; 2] {
    let pair = |text: fn(&Figures) -> String| {
        let now = cell.now.as_ref().map_or("–".into(), text);
        match text(&cell.then) {
            then if then == now => then,
            then => format!("{then} → {now}"),
        }
    };
    [
        pair(|figures| thousands(figures.wrong)),
        pair(|figures| format!("{:.5}", figures.rmse)),
    ]
}

/// A time then and now, and the ratio with its interval.
fn figures(times: &TimeChange) -> [String; 2] {
    let Ratio { low, median, high } = times.ratio;
    let ratio = format!("{median:.2} ({low:.2}–{high:.2})");
    [format!("{} → {}", ms(times.then), ms(times.now)), ratio]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(regime: Option<Regime>, median: f64) -> TimeChange {
        TimeChange {
            regime,
            then: 1.5,
            now: 1.5 * median,
            ratio: Ratio {
                low: median - 0.02,
                median,
                high: median + 0.02,
            },
        }
    }

    fn cell(method: &str) -> CellChange {
        let then = Figures {
            wrong: 497,
            rmse: 0.0705,
        };
        CellChange {
            method: method.into(),
            view: "main".into(),
            viewport: [512, 256],
            then,
            now: Some(then),
            errors: Change::Same,
            times: vec![times(None, 1.0), times(Some(Regime::Light), 1.0)],
        }
    }

    fn changes() -> Changes {
        let mut slower = cell("nsm 1024");
        slower.times = vec![times(None, 2.0), times(Some(Regime::Light), 3.0)];
        let mut wrong = slower.clone();
        (wrong.method, wrong.errors) = ("crsm 1024".into(), Change::Worse);
        wrong.now.as_mut().unwrap().wrong = 1_200;
        wrong.view = "other".into();
        let mut better = cell("pcf 1024");
        (better.errors, better.times) = (Change::Better, Vec::new());
        (better.now.as_mut().unwrap().wrong, better.then.rmse) = (12, 0.1);
        let mut lost = cell("rt_hw");
        (lost.now, lost.times, lost.errors) = (None, Vec::new(), Change::Worse);
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
