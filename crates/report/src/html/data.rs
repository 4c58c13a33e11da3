//! The content of the page, as JSON.

use crate::html::pictures::Pictures;
use crate::html::sources::Source;
use crate::results_table::timed_frames;
use crate::summary::{Row, by_wall};
use crate::summary_table::{Group, Summary, summaries};
use serde::Serialize;
use serde_json::Value;
use skiagraph_compare::records::results::{PROGRAM, Part, Results};
use skiagraph_compare::records::sequence::SequenceFrame;
use std::collections::BTreeSet;

/// All of it.
#[derive(Serialize)]
struct Data<'a> {
    program: &'static str,
    sources: Vec<Conditions<'a>>,
    tables: Vec<Table<'a>>,
    pictures: &'a Pictures,
    stress: &'a [Value],
    left_out: &'a [String],
}

/// Conditions of a source.
#[derive(Serialize)]
struct Conditions<'a> {
    scene: &'a str,
    triangles: u64,
    adapter: String,
    device_type: &'a str,
    oracle: &'a str,
    /// How many were timed of each run, in words.
    frames: String,
    warmup: u32,
    dates: BTreeSet<&'a str>,
    commands: &'a [String],
    folders: Vec<String>,
}

/// Rows that are judged alike, of one source and viewport.
#[derive(Serialize)]
struct Table<'a> {
    source: usize,
    viewport: [u32; 2],
    /// `view main`, `9 views`.
    what: String,
    title: &'a str,
    /// By wrong pixels; else by the root mean square error of shares.
    hard: bool,
    /// True if times are the wall clock's.
    wall: bool,
    sentences: Vec<String>,
    conditions: Vec<String>,
    notes: Vec<String>,
    rows: Vec<Line<'a>>,
}

/// A method in one setting, over all views.
#[derive(Serialize)]
struct Line<'a> {
    label: &'a str,
    method: &'a str,
    map: Option<u32>,
    views: usize,
    /// True if it is the fastest with nothing wrong outside the band.
    best: bool,
    wrong: u64,
    facing: u64,
    in_band: u64,
    rmse: Option<f64>,
    /// The error of the worst frame of all paths: the share of its wrong pixels, or its root mean
    /// square error.
    worst_frame: Option<f64>,
    shimmer: Option<f64>,
    frame_ms: Option<f64>,
    kept_ms: Option<f64>,
    rays: Option<f64>,
    bytes: u64,
    steps: Vec<(&'a str, f64)>,
    unavailable: Option<&'a str>,
}

/// As text that may stand in a script element.
pub fn text(sources: &[Source], stress: &[Value], pictures: &Pictures) -> String {
    let all: Vec<(usize, Summary)> = sources
        .iter()
        .enumerate()
        .flat_map(|(index, source)| {
            let summaries = summaries(&source.results).into_iter();
            summaries.map(move |summary| (index, summary))
        })
        .collect();
    let data = Data {
        program: PROGRAM,
        sources: sources.iter().map(conditions).collect(),
        tables: all
            .iter()
            .flat_map(|(source, summary)| {
                let tables = summary.groups.iter();
                tables.map(|group| table(*source, summary, group))
            })
            .collect(),
        pictures,
        stress,
        left_out: &pictures.left_out,
    };
    let json = serde_json::to_string(&data).expect("plain structs with string keys serialise");
    json.replace('<', "\\u003c")
}

fn conditions(source: &Source) -> Conditions<'_> {
    let Results {
        adapter,
        scene,
        oracle,
        warmup,
        commands,
        runs,
        ..
    } = &source.results;
    let dates = runs.iter().map(|run| run.date.as_str());
    Conditions {
        scene: &scene.name,
        triangles: scene.triangles,
        adapter: adapter.to_string(),
        device_type: &adapter.device_type,
        oracle,
        frames: timed_frames(&source.results, runs),
        warmup: *warmup,
        dates: dates.collect(),
        commands,
        folders: source
            .folders
            .iter()
            .map(|folder| folder.display().to_string())
            .collect(),
    }
}

fn table<'a>(source: usize, summary: &'a Summary, group: &'a Group) -> Table<'a> {
    let verdict = group.verdict();
    let wall = by_wall(&group.rows);
    let rows = group.rows.iter().enumerate();
    Table {
        source,
        viewport: summary.viewport,
        what: summary.what(),
        title: group.title(),
        hard: group.is_hard,
        wall,
        sentences: verdict.sentences,
        conditions: summary.conditions(),
        notes: summary.notes(),
        rows: rows
            .map(|(index, row)| line(row, verdict.fastest_exact == Some(index), wall))
            .collect(),
    }
}

fn line<'a>(row: &'a Row, best: bool, wall: bool) -> Line<'a> {
    let share = |part: Part| part.count as f64 / part.of.max(1) as f64;
    let wrong = row.wrong();
    Line {
        label: &row.label,
        method: &row.method,
        map: row.map_size(),
        views: row.views(),
        best,
        wrong: wrong.outside_band,
        facing: wrong.facing_light,
        in_band: wrong.in_band,
        rmse: row.rmse(),
        worst_frame: row.worst_frame().map(SequenceFrame::error),
        shimmer: row.shimmer().map(share),
        frame_ms: row.frame_ms(wall),
        kept_ms: row.kept_ms(wall),
        rays: row.rays(),
        bytes: row.bytes(),
        steps: row.steps(),
        unavailable: row.unavailable,
    }
}
