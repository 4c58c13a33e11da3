//! Results of one view and viewport as tables for a terminal: times beside errors, then the times
//! of passes.

use crate::notes::{band_warning, of_runs, pixels, surface_warning};
use crate::table::terminal;
use skiagraph_compare::records::columns::{self, Column};
use skiagraph_compare::records::figure::Clocks;
use skiagraph_compare::records::figures::are_paths;
use skiagraph_compare::records::results::{Results, Run};
use skiagraph_compare::records::statistics::Spread;
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{frames, ms, or_nothing, percent, size};
use std::collections::BTreeSet;

/// Returns the heading, a table of times and errors, a table of the times of passes, and notes for
/// the runs of one view and viewport, as text. `runs` must be a contiguous part of `results.runs`;
/// without runs the text is empty.
pub fn group(results: &Results, runs: &[Run]) -> String {
    let Some(first) = runs.first() else {
        return String::new();
    };
    let mut text = heading(results, first, runs) + &comparison(results, runs) + "\n";
    if runs.iter().any(|run| run.measured.is_some()) {
        let (frames, passes) = (timed_frames(results, runs), passes(runs));
        let what = "Each pass, ms: least, median and 95th percentile of";
        text += &format!("\n{what} {frames}\n{passes}\n");
    }
    let notes = footnotes(results, runs);
    if !notes.is_empty() {
        text += &format!("\n{}\n", notes.join("\n"));
    }
    text
}

fn heading(results: &Results, run: &Run, runs: &[Run]) -> String {
    let view = &run.view;
    let is_path = are_paths(&runs.iter().collect::<Vec<_>>());
    let path = is_path.then(|| format!("path {view}, counts of all its frames together"));
    let what = path.unwrap_or_else(|| format!("view {view}"));
    let title = format!("{} · {what} · {}", results.scene, size(run.viewport));
    let frames = timed_frames(results, runs);
    let (warmup, oracle) = (results.warmup, &results.oracle);
    let mut lines = vec![
        results.adapter.to_string(),
        format!("medians of {frames} after {warmup} to warm up · oracle {oracle}"),
        pixels(&run.pixels, run.area.as_ref(), run.band),
    ];
    lines.extend(band_warning(run));
    lines.extend(surface_warning(run.wrong_surface, &run.pixels));
    format!("{title}\n{}\n", lines.join("\n"))
}

/// Returns text on how many frames were timed for each run: `10 frames`, or `9 to 25 frames` for
/// camera paths of different lengths.
pub fn timed_frames<'a>(results: &Results, runs: impl IntoIterator<Item = &'a Run>) -> String {
    let measured = runs.into_iter().filter_map(|run| run.measured.as_ref());
    let counts = measured.map(|measured| {
        let path = measured.sequence.as_ref();
        path.map_or(results.frames, |path| path.frames.len() as u32)
    });
    let counts: BTreeSet<u32> = counts.collect();
    let least = counts.first().copied().unwrap_or(results.frames);
    match counts.last() {
        Some(most) if *most != least => format!("{least} to {}", frames(*most)),
        _ => frames(least),
    }
}

fn comparison(results: &Results, runs: &[Run]) -> String {
    let columns = columns::terminal(&runs.iter().collect::<Vec<_>>());
    let clocks = Clocks::new(results);
    // Behind the names of the method and its map.
    let is_name = |column: &Column| ["preset", "map_size"].contains(&&*column.figure.name);
    let first = columns.iter().position(|column| !is_name(column));
    let row = |run: &Run| {
        let case = clocks.case(run);
        let cells = columns.iter().map(|column| column.cell(&case, percent));
        let mut row: Vec<String> = cells.collect();
        if let (None, Some(first)) = (&run.measured, first) {
            row[first] = "n/a".into();
        }
        row
    };
    let heads = columns.iter().map(|column| column.head);
    terminal(&Table::new(heads, 1, runs.iter().map(row)))
}

fn passes(runs: &[Run]) -> String {
    let mut rows = Vec::new();
    let runs = runs
        .iter()
        .filter_map(|run| Some((run, run.measured.as_ref()?)));
    for (run, measured) in runs {
        let whole = ("whole frame", measured.frame.gpu_ms, measured.frame.cpu_ms);
        let regimes = measured.regimes.iter();
        let regimes = regimes.map(|times| {
            let frame = &times.frame;
            (times.regime.word(), frame.gpu_ms, frame.cpu_ms)
        });
        let passes = measured.passes.iter();
        let passes = passes.map(|pass| (pass.name.as_str(), pass.gpu_ms, Some(pass.cpu_ms)));
        for (index, (name, gpu, cpu)) in passes.chain([whole]).chain(regimes).enumerate() {
            let gpu = |pick: fn(Spread) -> f64| gpu.map_or("–".into(), |spread| ms(pick(spread)));
            // The eye finds groups by their first line.
            let label = or_nothing((index == 0).then_some(run), Run::method_label);
            rows.push(vec![
                label,
                name.into(),
                gpu(|spread| spread.min),
                gpu(|spread| spread.median),
                gpu(|spread| spread.p95),
                or_nothing(cpu, |spread| ms(spread.median)),
            ]);
        }
    }
    let heads = "method|pass|GPU min|GPU median|GPU p95|CPU median".split('|');
    terminal(&Table::new(heads, 2, rows))
}

fn footnotes(results: &Results, runs: &[Run]) -> Vec<String> {
    let mut notes = of_runs(results, runs);
    let reason = results.adapter.gpu_unavailable.as_ref();
    notes.extend(reason.map(|reason| format!("No GPU times: {reason}")));
    notes.extend(runs.iter().flat_map(|run| {
        let regimes = run.measured.iter().flat_map(|measured| &measured.regimes);
        let skipping = regimes.filter(|times| !times.skipped.is_empty());
        skipping.map(|times| {
            let (condition, skipped) = (times.regime.condition(), times.skipped.join(", "));
            format!("{} skips {condition}: {skipped}", run.method_label())
        })
    }));
    notes.extend(runs.iter().filter_map(|run| {
        let why = run.unavailable.as_ref()?;
        Some(format!("{} is unavailable: {why}", run.preset))
    }));
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::results as sample;

    #[test]
    fn the_terminal_shows_speed_beside_error() {
        let mut results = sample();
        results.adapter.gpu_unavailable = Some("the driver's timestamps are not true".into());
        insta::assert_snapshot!(group(&results, &results.runs));
    }

    #[test]
    fn a_band_of_more_than_a_thousandth_is_warned_of() {
        let mut results = sample();
        let warned = |results: &Results| {
            group(results, &results.runs).contains("the band is larger than 0.1 % of PFL")
        };
        for (band, expected) in [(0, false), (100, false), (101, true)] {
            results.runs.iter_mut().for_each(|run| run.band = band);
            assert_eq!(warned(&results), expected, "{band} of 100,000");
        }
    }

    #[test]
    fn a_pass_without_a_gpu_time_is_named() {
        let mut results = sample();
        let passes = |run: &mut Run| run.measured.as_mut().map(|m| m.passes[0].gpu_ms = None);
        passes(&mut results.runs[0]);
        let text = group(&results, &results.runs);
        for note in [
            "nsm 1024: the whole frame is timed over its other passes, there are no GPU times of \
             gbuffer\n",
            "rt: no GPU time of the whole frame: there are none of gbuffer, trace_rays\n",
        ] {
            assert!(text.contains(note), "{text}");
        }
    }
}
