//! Writes the words and pictures of the page as JSON for its script.

use crate::html::pictures::Pictures;
use crate::html::shown::Shown;
use crate::results_table::timed_frames;
use crate::summary::Row;
use serde_json::{Value, json};
use skiagraph_compare::own_scene_notes::chosen_for_it;
use skiagraph_compare::records::results::PROGRAM;
use skiagraph_compare::records::sources::Source;
use std::collections::BTreeSet;

/// Returns the words and pictures of the page as JSON, escaped for an HTML script element. The
/// indices in it refer to `sources` and `tables`.
pub fn text(sources: &[Source], tables: &[Shown], pictures: &Pictures) -> String {
    let data = json!({
        "program": PROGRAM,
        "sources": sources.iter().map(conditions).collect::<Vec<_>>(),
        "tables": tables.iter().map(|shown| table(shown, sources)).collect::<Vec<_>>(),
        "pictures": pictures,
        "left_out": pictures.left_out,
    });
    data.to_string().replace('<', "\\u003c")
}

/// The conditions of a source.
fn conditions(source: &Source) -> Value {
    let results = &source.results;
    let dates = results.runs.iter().map(|run| run.date.as_str());
    let folders = source.folders.iter();
    json!({
        "scene": results.scene.name,
        "triangles": results.scene.triangles,
        "adapter": results.adapter.to_string(),
        "machine": results.machine.to_string(),
        "device_type": results.adapter.device_type,
        "oracle": results.oracle,
        // How many were timed of each run, in words.
        "frames": timed_frames(results, &results.runs),
        "warmup": results.warmup,
        "dates": dates.collect::<BTreeSet<_>>(),
        "commands": results.commands,
        "notes": results.notes,
        "folders": folders.map(|folder| folder.display().to_string()).collect::<Vec<_>>(),
    })
}

/// All rows of one source and viewport, each a method in one setting over all views.
fn table(shown: &Shown, sources: &[Source]) -> Value {
    let mut sentences = shown.summary.verdict().sentences;
    sentences.extend(chosen_for_it(&sources[shown.source].results.notes));
    let line = |row: &Row| {
        let wrong = row.wrong().outside_band;
        json!({ "label": row.label, "method": row.method, "wrong": wrong })
    };
    json!({
        "source": shown.source,
        "viewport": shown.summary.viewport,
        "of": shown.title,
        "views": shown.summary.views(),
        "sentences": sentences,
        "conditions": shown.summary.conditions(),
        "notes": shown.summary.notes(),
        "rows": shown.summary.rows.iter().map(line).collect::<Vec<_>>(),
    })
}
