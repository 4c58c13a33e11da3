//! Results as a document: a header, then for each view and viewport one table of errors and of the
//! times of steps.

use crate::graded::area_reference;
use crate::notes::{band_warning, of_runs, scene_notes, surface_warning};
use skiagraph_chart::superscript;
use skiagraph_compare::lists::{entry, place, unique};
use skiagraph_compare::records::columns::{self, Column, STEPS};
use skiagraph_compare::records::figure::Clocks;
use skiagraph_compare::records::published_row::PublishedFile;
use skiagraph_compare::records::results::{Measured, Results, Run, step};
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{command_line, frames, ms, or_nothing, share, thousands};
use std::{collections::BTreeSet, env};

/// Returns the document's header: a heading, the command line of this process, and the conditions
/// that all tables share. `today` is the date (`2026-11-21`) for runs that are still to be
/// measured; `None` if there are none. `published` are the files of published figures that tables
/// show. `are_paths` is true if the runs are of camera paths, of which each frame is timed.
pub fn header(
    results: &Results,
    today: Option<&str>,
    published: &[PublishedFile],
    are_paths: bool,
) -> String {
    let dates = results.runs.iter().map(|run| run.date.as_str());
    let dates: BTreeSet<&str> = dates.chain(today).collect();
    let date = match (dates.first(), dates.last()) {
        (Some(first), Some(last)) if first != last => format!("{first} to {last}"),
        (Some(first), _) => (*first).to_owned(),
        _ => "unknown".to_owned(),
    };
    let heads = STEPS.map(|(step, head)| format!("*{head}* is the step `{step}`"));
    let frames = (!are_paths).then(|| frames(results.frames));
    let frames = frames.unwrap_or("a path's frames".into());
    let (warmup, heads) = (results.warmup, heads.join(", "));
    let mut lines = vec![
        format!("adapter: {}", results.adapter),
        format!("date: {date} (UTC)"),
        format!(
            "times: on the GPU, medians of {frames} after {warmup} to warm up; {heads}; *frame* is \
             from the first pass's begin to the last one's end"
        ),
        format!("oracle: {}", results.oracle),
        "shares are of the pixels that face the light (PFL), in-band pixels included; *wrong* is \
         the final picture"
            .into(),
    ];
    if !published.is_empty() {
        lines.push(
            "where published: *wrong lit %* is of what the method lights, *wrong shadow %* of what \
             it has in shadow; *sum of steps* is of all passes, *fps* is 1000 / *frame*"
                .into(),
        );
    }
    lines.extend(published.iter().map(|PublishedFile { label, file }| {
        let file = file.display().to_string().replace('\\', "/");
        format!("in parentheses: {label}, published figures of `{file}`")
    }));
    if let Some(reason) = &results.adapter.gpu_unavailable {
        lines.push(format!("no GPU times: {reason}"));
    }
    lines.extend(scene_notes(results));
    let (scene, command, lines) = (&results.scene, command_line(env::args_os()), list(&lines));
    format!("## {scene}\n\n    {command}\n\n{lines}")
}

/// Returns the heading of the view named `name` in Markdown.
pub fn view(name: &str) -> String {
    format!("\n### {name}\n")
}

/// Returns the section of one view and viewport in Markdown: the
/// [reference](skiagraph_compare#terms)'s pixel counts, a table of the runs with measurements, and
/// notes. `runs` are those of this view and viewport; without runs the text is empty.
pub fn viewport(results: &Results, runs: &[Run]) -> String {
    let Some(first) = runs.first() else {
        return String::new();
    };
    let mut footnotes = Footnotes::default();
    let mut text = format!("\n{}\n", pixels(first, &mut footnotes));
    text += &table(results, runs, &mut footnotes);
    let mut notes: Vec<String> = band_warning(first).into_iter().collect();
    notes.extend(surface_warning(first.wrong_surface, &first.pixels));
    notes.extend(of_runs(results, runs));
    notes.extend(unavailable(runs));
    notes.extend(footnotes.notes());
    if !notes.is_empty() {
        text += &format!("\n{}", list(&notes));
    }
    text
}

/// The table of those runs that measured something.
fn table<'a>(results: &Results, runs: &'a [Run], footnotes: &mut Footnotes<'a>) -> String {
    let measured = |run: &'a Run| Some((run, run.measured.as_ref()?));
    let measured: Vec<(&Run, &Measured)> = runs.iter().filter_map(measured).collect();
    if measured.is_empty() {
        return String::new();
    }
    let is_published = |quantity: &str| {
        let mut figures = measured.iter().flat_map(|(run, _)| &run.published);
        figures.any(|figure| figure.quantity == quantity)
    };
    let of_runs: Vec<&Run> = measured.iter().map(|(run, _)| *run).collect();
    let columns = columns::document(&of_runs, is_published);
    let steps = steps(&measured);
    let head = |column: &Column| column.head.to_owned();
    let heads = of_table(&columns, &steps, head, columns::step_head);
    let clocks = Clocks::new(results);
    let row = |(run, measured): &(&'a Run, &'a Measured)| {
        let case = clocks.case(run);
        let figure =
            |column: &Column| (column.cell(&case, share), column.figure.quantity.to_owned());
        let time = |step: &str| {
            let ours = measured.step_ms(step).map_or_else(|| "–".to_owned(), ms);
            (ours, format!("ms.{step}"))
        };
        let cells = of_table(&columns, &steps, figure, time).into_iter();
        let cells = cells.map(|(ours, quantity)| footnotes.with_published(ours, run, &quantity));
        cells.collect()
    };
    let rows: Vec<Vec<String>> = measured.iter().map(row).collect();
    format!("\n{}", Table::new(heads, 1, rows).markdown())
}

fn pixels<'a>(run: &'a Run, footnotes: &mut Footnotes<'a>) -> String {
    let [width, height] = run.viewport;
    let counts = &run.pixels;
    let mut count = |count, quantity| footnotes.with_published(thousands(count), run, quantity);
    let facing_light = count(counts.facing_light, "facing_light");
    let (lit, shadow) = (count(counts.lit, "lit"), count(counts.shadow, "shadow"));
    let facing_away = count(counts.facing_away, "facing_away");
    let doubt = match &run.area {
        Some(area) => area_reference(area, run.band),
        None => {
            let (band, part) = (thousands(run.band), share(run.band, counts.facing_light));
            format!("in the band {band} ({part} % of PFL)")
        }
    };
    format!(
        "**{width}×{height}**: PFL {facing_light} = lit {lit} + shadow {shadow}; PnFL \
         {facing_away}; background {}; {doubt}",
        thousands(counts.background),
    )
}

/// The steps of all runs in the order of their first use, then those that only others have
/// published.
fn steps<'a>(runs: &[(&'a Run, &'a Measured)]) -> Vec<&'a str> {
    let passes = runs.iter().flat_map(|(_, measured)| &measured.passes);
    let published = runs.iter().flat_map(|(run, _)| &run.published);
    let published = published.filter_map(|figure| figure.quantity.strip_prefix("ms."));
    let names = passes.map(|pass| step(&pass.name)).chain(published);
    unique(names.filter(|step| !["frame", "steps"].contains(step)))
}

/// A row: the columns before the steps, the steps, and the columns behind them.
fn of_table<T>(
    columns: &[Vec<Column>; 2],
    steps: &[&str],
    of_column: impl Fn(&Column) -> T,
    of_step: impl Fn(&str) -> T,
) -> Vec<T> {
    let [front, back] = columns.each_ref().map(|part| part.iter().map(&of_column));
    let steps = steps.iter().map(|step| of_step(step));
    front.chain(steps).chain(back).collect()
}

/// Footnotes of published figures, each once per table.
#[derive(Default)]
struct Footnotes<'a>(Vec<(&'a str, &'a str, &'a str)>);

impl<'a> Footnotes<'a> {
    /// Our figure with the published ones in parentheses.
    fn with_published(&mut self, mut ours: String, run: &'a Run, quantity: &str) -> String {
        let figures = run.published.iter();
        for figure in figures.filter(|figure| figure.quantity == quantity) {
            let value = published(figure.value, quantity);
            let mark = or_nothing(figure.note.as_deref(), |note| {
                let note = (figure.by.as_str(), figure.source.as_str(), note);
                superscript(place(&mut self.0, note) as i64 + 1)
            });
            ours += &format!(" ({} {value}{mark})", figure.by);
        }
        ours
    }

    fn notes(self) -> impl Iterator<Item = String> {
        let notes = self.0.into_iter().enumerate();
        notes.map(|(index, (by, source, note))| {
            format!("{} {by}, {source}: {note}", superscript(index as i64 + 1))
        })
    }
}

/// A published figure as it is usually printed: counts in thousands, shares with two decimals at
/// least.
fn published(value: f64, quantity: &str) -> String {
    let text = value.to_string();
    let decimals = text.find('.').map_or(0, |point| text.len() - point - 1);
    match quantity {
        _ if quantity.starts_with("ms.") => text,
        _ if quantity.ends_with("_percent") || quantity == "fps" => {
            format!("{value:.*}", decimals.max(2))
        }
        _ => thousands(value as u64),
    }
}

/// Which methods could not run, each reason once.
fn unavailable(runs: &[Run]) -> Vec<String> {
    let mut reasons: Vec<((&str, &str), Vec<String>)> = Vec::new();
    for run in runs {
        if let Some(reason) = &run.unavailable {
            let maps = entry(&mut reasons, (&run.preset, reason));
            maps.extend(run.map_size.iter().map(u32::to_string));
        }
    }
    let text = |((preset, reason), maps): ((&str, &str), Vec<String>)| {
        let maps = match &maps[..] {
            [] => String::new(),
            maps => format!(", map {},", maps.join(", ")),
        };
        format!("{preset}{maps} is unavailable: {reason}")
    };
    reasons.into_iter().map(text).collect()
}

fn list(lines: &[String]) -> String {
    lines.iter().map(|line| format!("- {line}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::results as sample;

    #[test]
    fn a_document_has_a_table_per_viewport() {
        let results = sample();
        let beside = ["D:docs/d.csv".parse().unwrap()];
        let header = header(&results, None, &beside, false);
        // The test runner's own arguments.
        let command = command_line(env::args_os());
        let text = [header, view("main"), viewport(&results, &results.runs)].concat();
        insta::assert_snapshot!(text.replace(&command, "COMMAND"));
    }

    #[test]
    fn like_stands_beside_like_where_it_is_published() {
        let mut results = sample();
        results.runs.truncate(1);
        let figures = &mut results.runs[0].published;
        let first = figures[0].clone();
        for (quantity, value) in [
            ("wrong_lit_percent", 0.4),
            ("ms.gbuffer+create_shadow_map", 0.5),
            ("ms.steps", 0.9),
            ("fps", 44.9),
        ] {
            let mut figure = first.clone();
            (figure.quantity, figure.value) = (quantity.into(), value);
            figures.push(figure);
        }
        let text = viewport(&results, &results.runs);
        let table: Vec<Vec<&str>> = text
            .lines()
            .filter(|line| line.starts_with('|'))
            .map(|line| line.split('|').map(str::trim).collect())
            .collect();
        let cell = |head: &str| {
            let column = table[0].iter().position(|cell| *cell == head);
            column.map(|column| table[2][column])
        };
        // 102 of 60,000 + 102 - 401 are lit wrongly; two passes of 0.375 ms in a frame of 1.5 ms.
        assert_eq!(cell("wrong lit %"), Some("0.171 (D 0.40)"));
        assert_eq!(cell("wrong shadow %"), None);
        assert_eq!(cell("gbuffer + map ms"), Some("0.750 (D 0.5)"));
        assert_eq!(cell("sum of steps ms"), Some("0.750 (D 0.9)"));
        assert_eq!(cell("fps"), Some("666.67 (D 44.90)"));
        assert_eq!(cell("frame ms"), Some("1.50"));
        assert!(
            text.contains("0.750 (D 0.9) | 666.67 (D 44.90) | 1.50 |"),
            "{text}"
        );
    }

    #[test]
    fn dates_are_a_day_or_a_span() {
        let mut results = sample();
        assert!(header(&results, None, &[], true).contains("date: 2026-11-20 (UTC)"));
        let both = header(&results, Some("2026-11-21"), &[], false);
        assert!(both.contains("date: 2026-11-20 to 2026-11-21"), "{both}");
        results.runs.clear();
        let none = header(&results, Some("2026-11-21"), &[], true);
        assert!(none.contains("date: 2026-11-21") && none.contains("medians of a path's frames"));
    }

    #[test]
    fn a_step_is_the_sum_of_its_passes_or_unknown() {
        let mut run = sample().runs.remove(0);
        let measured = run.measured.as_mut().unwrap();
        let mut more = measured.passes[0].clone();
        more.name = "gbuffer.surface".into();
        measured.passes.push(more);
        assert_eq!(measured.step_ms("gbuffer"), Some(0.75));
        assert_eq!(measured.step_ms("create_shadow_map"), Some(0.375));
        measured.passes[0].gpu_ms = None;
        assert_eq!(measured.step_ms("gbuffer"), None);
        assert_eq!(measured.step_ms("trace_rays"), None);
    }

    #[test]
    fn a_reason_stands_once_for_all_maps() {
        let mut runs = vec![sample().runs.remove(2); 2];
        runs[0].map_size = Some(512);
        runs[1].map_size = Some(1024);
        let reason = "needs ray queries, \"not\" here";
        let expected = format!("rt_hw, map 512, 1024, is unavailable: {reason}");
        assert_eq!(unavailable(&runs), [expected]);
    }

    #[test]
    fn published_figures_keep_their_decimals() {
        let texts = [
            published(5.3, "wrong_percent"),
            published(0.125, "wrong_percent"),
            published(12.5, "ms.frame"),
            published(829_652.0, "facing_light"),
            superscript(120),
        ];
        assert_eq!(texts, ["5.30", "0.125", "12.5", "829,652", "¹²⁰"]);
    }
}
