//! Tables of the page, and the parts of the page that are of some of them: each stands in the page,
//! and its script shows those that are chosen.

use crate::html::sources::Source;
use crate::summary::{Row, by_wall};
use crate::summary_table::{Group, Summary};
use skiagraph_compare::wording::size;
use std::collections::BTreeSet;

/// Rows that are judged alike, of one source and viewport.
pub struct Shown<'a> {
    /// Index of its source.
    pub source: usize,
    /// All of the source in that viewport.
    pub summary: &'a Summary<'a>,
    /// Its rows.
    pub group: &'a Group<'a>,
    /// True if times are the wall clock's.
    pub by_wall: bool,
    /// Source and viewport in words.
    pub title: String,
}

/// All tables of the summaries, each of which comes with the index of its source.
pub fn shown<'a>(sources: &[Source], all: &'a [(usize, Summary<'a>)]) -> Vec<Shown<'a>> {
    let adapters = sources.iter().map(|source| &source.results.adapter);
    let adapters: BTreeSet<String> = adapters.map(ToString::to_string).collect();
    let table = |source: usize, summary: &'a Summary, group: &'a Group| {
        let results = &sources[source].results;
        let mut title = format!(
            "{}, {}, {}",
            results.scene.name,
            summary.what(),
            size(summary.viewport)
        );
        if adapters.len() > 1 {
            title += &format!(" · {}", results.adapter);
        }
        Shown {
            source,
            summary,
            group,
            by_wall: by_wall(&group.rows),
            title,
        }
    };
    let tables = all.iter().flat_map(|(source, summary)| {
        let groups = summary.groups.iter();
        groups.map(move |group| table(*source, summary, group))
    });
    tables.collect()
}

impl Shown<'_> {
    /// The error of a row that was judged: the percentage of wrong pixels outside the band of those
    /// that face the light, or the root mean square error of shares.
    pub fn error(&self, row: &Row) -> Option<f64> {
        if self.group.is_hard {
            let wrong = row.wrong();
            (wrong.facing_light > 0).then(|| 100.0 * wrong.share())
        } else {
            row.rmse()
        }
    }
}

/// Frames of which times are shown.
#[derive(Clone, Copy, PartialEq)]
pub enum Time {
    /// Every pass runs.
    Frame,
    /// Only the camera has moved.
    Kept,
}

impl Time {
    /// Milliseconds of a row, if they can stand on an axis.
    pub fn of(self, table: &Shown, row: &Row) -> Option<f64> {
        let frame = row.frame_ms(table.by_wall);
        let kept = row.kept_ms(table.by_wall).filter(|_| self == Self::Kept);
        kept.or(frame).filter(|ms| ms.is_finite() && *ms > 0.0)
    }
}

/// Those in which the tables' rows differ.
pub fn times(tables: &[Shown]) -> &'static [Time] {
    let keeps = |table: &Shown| {
        let mut rows = table.group.rows.iter();
        rows.any(|row| row.kept_ms(table.by_wall).is_some())
    };
    if tables.iter().any(keeps) {
        &[Time::Frame, Time::Kept]
    } else {
        &[Time::Frame]
    }
}

/// An element that the script shows while one of these tables is chosen, and that time.
pub fn part(class: &str, tables: &[usize], time: Option<Time>, content: &str) -> String {
    let time = match time {
        Some(Time::Frame) => " data-time=\"frame\"",
        Some(Time::Kept) => " data-time=\"kept\" hidden",
        None => "",
    };
    let names: Vec<String> = tables.iter().map(ToString::to_string).collect();
    // The script begins with the first table.
    let hidden = if tables.contains(&0) { "" } else { " hidden" };
    let names = names.join(" ");
    format!("<div class=\"{class}\" data-table=\"{names}\"{time}{hidden}>{content}</div>\n")
}
