//! Writes the words and pictures of the page as JSON for its script.

use crate::html::pictures::Pictures;
use crate::html::shown::Shown;
use crate::results_table::timed_frames;
use crate::summary::Row;
use serde::Serialize;
use skiagraph_compare::own_scene_notes::chosen_for_it;
use skiagraph_compare::records::results::PROGRAM;
use skiagraph_compare::records::sources::Source;
use std::collections::BTreeSet;

/// All of it.
#[derive(Serialize)]
struct Data<'a> {
    program: &'static str,
    sources: Vec<Conditions<'a>>,
    tables: Vec<Table<'a>>,
    pictures: &'a Pictures,
    left_out: &'a [String],
}

/// Conditions of a source.
#[derive(Serialize)]
struct Conditions<'a> {
    scene: &'a str,
    triangles: u64,
    adapter: String,
    /// Host and processor.
    machine: String,
    device_type: &'a str,
    oracle: &'a str,
    /// How many were timed of each run, in words.
    frames: String,
    warmup: u32,
    dates: BTreeSet<&'a str>,
    commands: &'a [String],
    notes: &'a [String],
    folders: Vec<String>,
}

/// All rows of one source and viewport.
#[derive(Serialize)]
struct Table<'a> {
    source: usize,
    viewport: [u32; 2],
    /// Source and viewport in words.
    of: &'a str,
    views: BTreeSet<&'a str>,
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
    wrong: u64,
}

/// Returns the words and pictures of the page as JSON, escaped for an HTML script element. The
/// indices in it refer to `sources` and `tables`.
pub fn text(sources: &[Source], tables: &[Shown], pictures: &Pictures) -> String {
    let data = Data {
        program: PROGRAM,
        sources: sources.iter().map(conditions).collect(),
        tables: tables.iter().map(|shown| table(shown, sources)).collect(),
        pictures,
        left_out: &pictures.left_out,
    };
    let json = serde_json::to_string(&data).expect("plain structs with string keys serialise");
    json.replace('<', "\\u003c")
}

fn conditions(source: &Source) -> Conditions<'_> {
    let results = &source.results;
    let dates = results.runs.iter().map(|run| run.date.as_str());
    let folders = source.folders.iter();
    Conditions {
        scene: &results.scene.name,
        triangles: results.scene.triangles,
        adapter: results.adapter.to_string(),
        machine: results.machine.to_string(),
        device_type: &results.adapter.device_type,
        oracle: &results.oracle,
        frames: timed_frames(results, &results.runs),
        warmup: results.warmup,
        dates: dates.collect(),
        commands: &results.commands,
        notes: &results.notes,
        folders: folders.map(|folder| folder.display().to_string()).collect(),
    }
}

fn table<'a>(shown: &'a Shown, sources: &[Source]) -> Table<'a> {
    let mut sentences = shown.summary.verdict().sentences;
    sentences.extend(chosen_for_it(&sources[shown.source].results.notes));
    let line = |row: &'a Row| Line {
        label: &row.label,
        method: &row.method,
        wrong: row.wrong().outside_band,
    };
    Table {
        source: shown.source,
        viewport: shown.summary.viewport,
        of: &shown.title,
        views: shown.summary.views(),
        sentences,
        conditions: shown.summary.conditions(),
        notes: shown.summary.notes(),
        rows: shown.summary.rows.iter().map(line).collect(),
    }
}
