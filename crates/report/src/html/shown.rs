//! Tables of the page, and parts of the page that belong to some of them. Every part stands in the
//! page; its script shows those of the chosen tables.

use crate::summary::Row;
use crate::summary_table::Summary;
use itertools::Itertools;
use skiagraph_compare::records::regimes::{Regime, When};
use skiagraph_compare::records::results::Results;
use skiagraph_compare::records::sources::Source;
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{frames, or_nothing, size};
use std::collections::BTreeSet;

/// A table of the page: the rows of one source (a scene on one machine and adapter under one
/// protocol), viewport and light.
pub struct Shown<'a> {
    /// Index of the table's source among the page's sources.
    pub source: usize,
    /// Summary of the source in that viewport under that light.
    pub summary: &'a Summary<'a>,
    /// The rows as the terminal shows them, with the page's own columns.
    pub table: Table,
    /// Heading: scene, views and viewport, the adapter, machine or protocol if the sources differ
    /// in it, and the folder or a number if another table would have the same heading.
    pub title: String,
}

/// Returns a table for each summary, in order. Each summary comes with the index of its source in
/// `sources`.
pub fn shown<'a>(sources: &[Source], summaries: &'a [(usize, Summary<'a>)]) -> Vec<Shown<'a>> {
    let facts: [fn(&Results) -> String; 3] = [
        |results| results.adapter.to_string(),
        |results| results.machine.to_string(),
        protocol,
    ];
    let values = |fact: fn(&Results) -> String| sources.iter().map(move |it| fact(&it.results));
    let different = facts.into_iter().filter(|fact| !values(*fact).all_equal());
    let different = different.collect_vec();
    let table = |source: usize, summary: &'a Summary| {
        let results = &sources[source].results;
        let (what, size) = (summary.what(), size(summary.viewport));
        let mut title = format!("{}, {what}, {size}", results.scene.name);
        for fact in &different {
            title += &format!(" · {}", fact(results));
        }
        Shown {
            source,
            summary,
            table: summary.table(),
            title,
        }
    };
    let tables = summaries.iter();
    let tables = tables.map(|(source, summary)| table(*source, summary));
    let mut tables: Vec<Shown> = tables.collect();
    // Sources that have other cells under the same labels are told apart by their folders, or by
    // their numbers.
    let alike = tables.iter().map(|table| table.title.clone()).duplicates();
    for title in alike.collect::<Vec<_>>() {
        let folder = |table: &Shown| sources[table.source].folders.first().cloned();
        let alike = tables.iter().filter(|table| table.title == title);
        let by_folder = alike.map(folder).all_unique();
        let alike = tables.iter_mut().filter(|table| table.title == title);
        for (number, table) in (1..).zip(alike) {
            table.title += &match folder(table) {
                Some(folder) if by_folder => format!(" · {}", folder.display()),
                _ => format!(" · group {number}"),
            };
        }
    }
    tables
}

/// The protocol of results in words.
fn protocol(results: &Results) -> String {
    let (frames, warmup) = (frames(results.frames), results.warmup);
    format!("{frames} after {warmup}, oracle {}", results.oracle)
}

impl Shown<'_> {
    /// Returns the error of a row: wrong pixels outside the band (those whose answer rounding
    /// decides), in percent of the pixels that face the light; half a pixel if only shares of light
    /// are off. Under a light with an extent it is the root mean square error of the shares of
    /// light. `None` if no pixel was judged.
    pub fn error(&self, row: &Row) -> Option<f64> {
        if self.summary.is_soft() {
            return row.rmse();
        }
        let wrong = row.wrong();
        // Right at one half and off in its shares is not exact, but less than a pixel wrong.
        let least = if row.is_exact() { 0.0 } else { 0.5 };
        let pixels = (wrong.outside_band as f64).max(least);
        (wrong.facing_light > 0).then(|| 100.0 * pixels / wrong.facing_light as f64)
    }

    /// Returns the milliseconds of a row's frame; `None` if they are missing or 0, so that they
    /// cannot be drawn on a logarithmic axis.
    pub fn ms(&self, row: &Row, when: When) -> Option<f64> {
        let ms = row.frame_ms(when);
        ms.filter(|ms| ms.is_finite() && *ms > 0.0)
    }

    /// Returns the first and third quartile of the times of [`ms`](Self::ms), in milliseconds;
    /// `None` if they are missing, equal or 0.
    pub fn spread(&self, row: &Row, when: When) -> Option<[f64; 2]> {
        let quartiles = row.quartiles(when)?;
        Some(quartiles).filter(|[q1, q3]| *q1 > 0.0 && q1 < q3 && q3.is_finite())
    }
}

/// Returns the choices of frames for which the tables have times.
pub fn times(tables: &[Shown]) -> Vec<When> {
    let regimes = |table: &Shown| table.summary.regimes();
    let regimes = tables.iter().flat_map(regimes).map(Some);
    let choices: BTreeSet<When> = [None].into_iter().chain(regimes).collect();
    choices.into_iter().collect()
}

/// Returns an HTML element with the CSS class `class` around the HTML `content`. The page's script
/// shows it while one of the tables with the indices `tables` is chosen and, unless `when` is
/// `None`, while this choice of frames is.
pub fn part(class: &str, tables: &[usize], when: Option<When>, content: &str) -> String {
    let word = |when: When| when.map_or("frame", Regime::word);
    let time = or_nothing(when, |when| format!(" data-time=\"{}\"", word(when)));
    // The script begins with the first table.
    let is_shown = tables.contains(&0) && when.is_none_or(|when| when.is_none());
    let hidden = if is_shown { "" } else { " hidden" };
    let names = tables.iter().join(" ");
    format!("<div class=\"{class}\" data-table=\"{names}\"{time}{hidden}>{content}</div>\n")
}
