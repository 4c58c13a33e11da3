//! Writes sentences on the outcome of the search for good settings (`compare --tune`).

use crate::summary::Row;
use itertools::Itertools;
use skiagraph_compare::records::results::Promise;
use skiagraph_compare::records::tuned::Tuned;
use skiagraph_compare::wording::{percent, plural};

/// Returns sentences on the tuned methods among `rows`: on which views settings were chosen, how
/// wrong each method is with its defaults and with the best setting on the views of the rows, and
/// the arguments that name these settings. Empty if no method was tuned.
pub fn sentences(rows: &[Row]) -> Vec<String> {
    let tuned: Vec<(&Row, &Tuned)> = rows
        .iter()
        .filter_map(|row| Some((row, row.tuned()?)))
        .collect();
    let Some((_, first)) = tuned.first() else {
        return Vec::new();
    };
    let mut sentences = vec![chosen_on(first)];
    let (changed, kept): (Vec<_>, Vec<_>) = tuned
        .into_iter()
        .partition(|(_, tuned)| !tuned.set.is_empty());
    let brought = |(row, tuned): &(&Row, &Tuned)| {
        let before = rows.iter().find(|other| is_default_of(other, row))?;
        let (with, name, now, before) = (tuned.words(), &tuned.of, error(row), error(before));
        Some(format!(
            "With {with} `{name}` is {now} here, with its defaults {before}."
        ))
    };
    sentences.extend(changed.iter().filter_map(brought));
    if !changed.is_empty() {
        let arguments = changed
            .iter()
            .map(|(_, tuned)| tuned.argument())
            .unique()
            .join(" ");
        sentences.push(format!(
            "To have the tuned methods again: skiagraph compare {arguments}."
        ));
    }
    if !kept.is_empty() {
        let tried = |(row, tuned): &(&Row, &Tuned)| {
            format!(
                "`{}` (of {})",
                row.method,
                plural(tuned.tried as usize, "setting")
            )
        };
        let names = and(kept.iter().map(tried).unique());
        sentences.push(format!("The defaults stay the best of {names}."));
    }
    let short = changed
        .iter()
        .chain(&kept)
        .filter(|(_, tuned)| !tuned.is_whole);
    let short = short
        .map(|(_, tuned)| format!("`{}`", tuned.of))
        .unique()
        .collect_vec();
    if !short.is_empty() {
        sentences.push(format!(
            "The search for {} ended at the bound of its cost: more frames (--frames) allow a \
             longer one.",
            and(short.into_iter())
        ));
    }
    let without = rows.iter().filter(|row| is_exact_anyway(row));
    let without = without
        .map(|row| format!("`{}`", row.method))
        .unique()
        .collect_vec();
    if !without.is_empty() {
        let (have, their) = match without.len() {
            1 => ("has", "its"),
            _ => ("have", "their"),
        };
        sentences.push(format!(
            "{} {have} nothing to tune, which is {their} point.",
            and(without.into_iter())
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
    other.method == tuned.of
        && is_same_map
        && other.tuned().is_none_or(|tuned| tuned.set.is_empty())
}

/// True if a method is exact whatever its params are.
fn is_exact_anyway(row: &Row) -> bool {
    row.tuned().is_none()
        && row
            .runs()
            .all(|(run, _)| run.promise.as_ref().is_some_and(Promise::is_exact_for_all))
        && row.views() > 0
}

/// The views on which settings were chosen.
fn chosen_on(tuned: &Tuned) -> String {
    let views = plural(tuned.chosen_on.len(), "other view");
    let names = tuned.chosen_on.join(", ");
    format!("Tuned settings were chosen on {views} ({names}) than those they are judged on here.")
}

/// How wrong a row is.
fn error(row: &Row) -> String {
    match (row.is_soft(), row.rmse()) {
        (true, Some(rmse)) => format!("off by RMSE {rmse:.4}"),
        _ => {
            let wrong = row.wrong();
            let share = percent(wrong.outside_band, wrong.facing_light);
            format!("wrong on {share}")
        }
    }
}

/// A list in words.
fn and(items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.collect();
    match &items[..] {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        items => items.join(", "),
    }
}
