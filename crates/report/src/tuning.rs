//! Writes sentences on the outcome of the search for good settings (`compare --tune`).

use crate::summary::Row;
use itertools::Itertools;
use skiagraph_compare::records::results::{Promise, Run};
use skiagraph_compare::records::tuned::Tuned;
use skiagraph_compare::wording::{percent, plural};

/// Returns sentences on the tuned methods among `rows`: on which views settings were chosen, how
/// wrong each method is with its defaults and with the best setting on the views of the rows, and
/// the arguments that name these settings. Empty if no method was tuned.
pub fn sentences(rows: &[Row]) -> Vec<String> {
    let tuned = rows.iter().filter_map(|row| Some((row, row.tuned()?)));
    let tuned: Vec<(&Row, &Tuned)> = tuned.collect();
    let Some((_, first)) = tuned.first() else {
        return Vec::new();
    };
    let mut sentences = vec![chosen_on(first)];
    let tuned = tuned.into_iter();
    let (changed, kept): (Vec<_>, Vec<_>) = tuned.partition(|(row, _)| row.is_tuned());
    let brought = |(row, tuned): &(&Row, &Tuned)| {
        let before = rows.iter().find(|other| is_default_of(other, row))?;
        let (with, name, now, before) = (tuned.words(), &tuned.of, error(row), error(before));
        Some(format!(
            "With {with} `{name}` is {now} here, with its defaults {before}."
        ))
    };
    sentences.extend(changed.iter().filter_map(brought));
    if !changed.is_empty() {
        let arguments = changed.iter().map(|(_, tuned)| tuned.argument());
        let command = format!("skiagraph compare {}", arguments.unique().join(" "));
        sentences.push(format!("To have the tuned methods again: {command}."));
    }
    let tried = |(row, tuned): &(&Row, &Tuned)| {
        let settings = plural(tuned.tried as usize, "setting");
        format!("`{}` (of {settings})", row.method)
    };
    if let Some((names, _)) = list(kept.iter().map(tried)) {
        sentences.push(format!("The defaults stay the best of {names}."));
    }
    let all_tuned = changed.iter().chain(&kept);
    let short = all_tuned.filter(|(_, tuned)| !tuned.is_whole);
    if let Some((names, _)) = list(short.map(|(_, tuned)| format!("`{}`", tuned.of))) {
        sentences.push(format!(
            "The search for {names} ended at the bound of its cost: more frames (--frames) allow a \
             longer one."
        ));
    }
    let without = rows.iter().filter(|row| is_exact_anyway(row));
    if let Some((names, count)) = list(without.map(|row| format!("`{}`", row.method))) {
        let (have, their) = match count {
            1 => ("has", "its"),
            _ => ("have", "their"),
        };
        sentences.push(format!(
            "{names} {have} nothing to tune, which is {their} point."
        ));
    }
    sentences
}

/// True if `other` is the method of `row` with its params as they were before it was tuned.
pub fn is_default_of(other: &Row, row: &Row) -> bool {
    let Some(tuned) = row.tuned() else {
        return false;
    };
    let is_same_map = tuned.set.contains_key("map_size") || other.map_size() == row.map_size();
    other.method == tuned.of && is_same_map && !other.is_tuned()
}

/// True if a method is exact whatever its params are.
fn is_exact_anyway(row: &Row) -> bool {
    let is_exact = |run: &Run| run.promise.iter().any(Promise::is_exact_for_all);
    row.tuned().is_none() && row.views() > 0 && row.runs().all(|(run, _)| is_exact(run))
}

/// The views on which settings were chosen.
fn chosen_on(tuned: &Tuned) -> String {
    let views = plural(tuned.chosen_on.len(), "other view");
    let names = tuned.chosen_on.join(", ");
    format!("Tuned settings were chosen on {views} ({names}) than those they are judged on here.")
}

/// How wrong a row is.
fn error(row: &Row) -> String {
    let wrong = row.wrong();
    match (row.is_soft(), row.rmse()) {
        (true, Some(rmse)) => format!("off by RMSE {rmse:.4}"),
        _ => format!(
            "wrong on {}",
            percent(wrong.outside_band, wrong.facing_light)
        ),
    }
}

/// A list of different items in words, and their number; `None` without items.
fn list(items: impl Iterator<Item = String>) -> Option<(String, usize)> {
    let items = items.unique().collect_vec();
    let (last, first) = items.split_last()?;
    let text = match first {
        [] => last.clone(),
        first => format!("{} and {last}", first.join(", ")),
    };
    Some((text, items.len()))
}
