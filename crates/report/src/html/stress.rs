//! Matrices of hard cases, as the terminal has them.

use crate::stress_matrix::{HEADS, cell_of, columns, failures, heading, matrix, remarks, rows};
use crate::table::html;
use skiagraph_chart::xml;
use skiagraph_compare::records::stress::{Report, Verdict};
use skiagraph_compare::wording::percent;

/// All matrices, each with its remarks.
pub fn matrices(reports: &[Report]) -> String {
    reports.iter().map(of_report).collect()
}

fn of_report(report: &Report) -> String {
    let (rows, columns) = (rows(report), columns(report));
    let why = |row: usize| format!("title=\"{}\"", xml(&rows[row].0.reason));
    let verdict = |row: usize, column: usize| {
        let method = column.checked_sub(HEADS).map(|column| columns[column]);
        let (verdict, told) = match method.map(|method| cell_of(rows[row], method)) {
            Some(None) => return String::new(),
            Some(Some(cell)) => {
                let facing = rows[row].0.pixels.facing_light;
                let counts = cell.counts.as_ref();
                let uncertain =
                    counts.map(|counts| format!("uncertain {}", percent(counts.uncertain, facing)));
                (cell.verdict, uncertain.or(cell.failed.clone()))
            }
            None if column + 1 == HEADS && rows[row].1.is_none() => {
                (rows[row].0.verdict, rows[row].0.failed.clone())
            }
            None => return String::new(),
        };
        let class = match verdict {
            Verdict::Pass => "pass",
            Verdict::Fail => "fail",
            Verdict::Open => "open",
            Verdict::Unjudged => "unjudged",
        };
        let told = told.map_or(String::new(), |told| format!("; {told}"));
        format!("class=\"{class}\" title=\"{class}{}\"", xml(&told))
    };
    let line = |class: &str, text: &str| format!("<p class=\"{class}\">{}</p>\n", xml(text));
    let heading: String = heading(report)
        .lines()
        .map(|text| line("quiet", text))
        .collect();
    let remarks: String = remarks(report)
        .iter()
        .map(|text| line("quiet", text))
        .collect();
    let failures = failures(report);
    let failures = failures
        .iter()
        .map(|failure| line("warning", &failure.what));
    let failures: String = failures.collect();
    let table = html(&matrix(report), why, verdict);
    format!("{heading}{failures}{table}{remarks}")
}
