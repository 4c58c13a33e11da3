//! Writes the matrices of `stress` as HTML, with the content of those for a terminal.

use crate::stress_matrix::{failures, heading, matrix, remarks};
use crate::table::html;
use skiagraph_chart::xml;
use skiagraph_compare::records::stress::{Report, Verdict};
use skiagraph_compare::wording::percent;

/// Returns the matrices of all reports as HTML, each with its remarks.
pub fn matrices(reports: &[Report]) -> String {
    reports.iter().map(of_report).collect()
}

fn of_report(report: &Report) -> String {
    let (table, rows) = matrix(report);
    let why = |row: usize| format!("title=\"{}\"", xml(&rows[row].0.reason));
    let verdict = |row: usize, column: usize| {
        let (case, cells) = &rows[row];
        let cell = column.checked_sub(3).and_then(|method| cells[method]);
        let verdict = cell.map(|cell| cell.verdict);
        let of_case = column == 2 && !table.rows[row][column].is_empty();
        let class = match verdict.or(of_case.then_some(case.verdict)) {
            Some(Verdict::Pass) => "pass",
            Some(Verdict::Fail) => "fail",
            Some(Verdict::Open) => "open",
            Some(Verdict::Unjudged) => "unjudged",
            None => return String::new(),
        };
        let counts = cell.and_then(|cell| cell.counts);
        let uncertainty = counts.map_or(String::new(), |counts| {
            let share = percent(counts.uncertain, case.pixels.facing_light);
            format!("; uncertain {share}")
        });
        format!("class=\"{class}\" title=\"{class}{uncertainty}\"")
    };
    let lines = |class: &str, text: &str| -> String {
        let lines = text.lines().filter(|line| !line.trim().is_empty());
        let lines = lines.map(|line| format!("<p class=\"{class}\">{}</p>\n", xml(line)));
        lines.collect()
    };
    lines("quiet", &heading(report))
        + &lines("warning", &failures(report, &|_, _, _| String::new()))
        + &html(&table, why, |_| String::new(), verdict, |_, text| text)
        + &lines("quiet", &remarks(report))
}
