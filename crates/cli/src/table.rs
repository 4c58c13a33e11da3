//! Results as tables for a terminal: speed beside error, then the time of each pass.

use crate::results::{Measured, Results, Run, Spread};
use comfy_table::{Cell, CellAlignment, Table, presets};

/// A heading and both tables for the runs of one view and viewport, which must stand together in `runs`.
pub fn group(results: &Results, runs: &[Run]) -> String {
    let Some(first) = runs.first() else {
        return String::new();
    };
    let mut text = heading(results, first);
    text.push_str(&comparison(runs));
    text.push('\n');
    if runs.iter().any(|run| run.measured.is_some()) {
        text.push_str(&format!(
            "\nEach pass, ms: least, median and 95th percentile of {}\n",
            frames(results.frames)
        ));
        text.push_str(&passes(runs));
        text.push('\n');
    }
    for (index, note) in footnotes(results, runs).iter().enumerate() {
        text.push_str(if index == 0 { "\n" } else { "" });
        text.push_str(note);
        text.push('\n');
    }
    text
}

/// A band of more than one pixel in so many of those facing the light leaves too much open.
const MOST_BAND: u128 = 1000;

fn heading(results: &Results, run: &Run) -> String {
    let Run {
        view,
        viewport: [width, height],
        pixels,
        band,
        ..
    } = run;
    let title = format!("{} · view {view} · {width}x{height}", results.scene);
    let mut lines = vec![
        results.adapter.to_string(),
        format!(
            "medians of {} after {} to warm up · oracle {}",
            frames(results.frames),
            results.warmup,
            results.oracle
        ),
        format!(
            "facing the light (PFL) {} = lit {} + shadow {} · facing away {} · background {}",
            thousands(pixels.facing_light),
            thousands(pixels.lit),
            thousands(pixels.shadow),
            thousands(pixels.facing_away),
            thousands(pixels.background)
        ),
        format!(
            "in the band, where the answer hangs on rounding: {} ({} of PFL)",
            thousands(*band),
            percent(*band, pixels.facing_light)
        ),
    ];
    lines.extend(warning(run));
    format!("{title}\n{}\n", lines.join("\n"))
}

/// That the band of a view and viewport leaves too much open, if it does.
pub fn warning(run: &Run) -> Option<String> {
    let is_large = u128::from(run.band) * MOST_BAND > u128::from(run.pixels.facing_light);
    let text = "warning: the band is larger than 0.1 % of PFL; what lies in it is not proven";
    is_large.then(|| text.to_owned())
}

fn comparison(runs: &[Run]) -> String {
    let maps = runs.iter().any(|run| run.map_size.is_some());
    let mut header = vec!["method"];
    if maps {
        header.push("map");
    }
    header.extend([
        "GPU ms",
        "wall ms",
        "wrong",
        "wrong lit",
        "wrong shadow",
        "in band",
        "uncertain",
        "certain wrong",
        "rays",
    ]);
    let mut table = new_table(&header, 1);
    for run in runs {
        let mut row = vec![run.preset.clone()];
        if maps {
            row.push(run.map_size.map_or("–".into(), |size| size.to_string()));
        }
        match &run.measured {
            Some(measured) => row.extend(figures(measured, run.pixels.facing_light)),
            None => {
                row.push("n/a".into());
                row.resize(header.len(), "–".into());
            }
        }
        add_row(&mut table, row, 1);
    }
    table.to_string()
}

fn figures(measured: &Measured, facing_light: u64) -> [String; 9] {
    [
        measured
            .frame
            .gpu_ms
            .map_or("–".into(), |spread| ms(spread.median)),
        ms(measured.frame.wall_ms.median),
        percent(measured.wrong.total, facing_light),
        thousands(measured.wrong.lit),
        thousands(measured.wrong.shadow),
        thousands(measured.wrong.in_band),
        percent(measured.uncertain, facing_light),
        percent(measured.split.certain_wrong(), facing_light),
        measured.rays.map_or("–".into(), thousands),
    ]
}

fn passes(runs: &[Run]) -> String {
    let header = [
        "method",
        "pass",
        "GPU min",
        "GPU median",
        "GPU p95",
        "CPU median",
    ];
    let mut table = new_table(&header, 2);
    for run in runs {
        let Some(measured) = &run.measured else {
            continue;
        };
        let method_name = method(run);
        let whole = ("whole frame", measured.frame.gpu_ms, None);
        let cached = measured.cached.as_ref();
        let cached = cached.map(|cached| ("cached frame", cached.frame.gpu_ms, None));
        let rows = measured
            .passes
            .iter()
            .map(|pass| (pass.name.as_str(), pass.gpu_ms, Some(pass.cpu_ms)));
        for (index, (name, gpu, cpu)) in rows.chain([whole]).chain(cached).enumerate() {
            let gpu = |pick: fn(Spread) -> f64| gpu.map_or("–".into(), |spread| ms(pick(spread)));
            let row = vec![
                // The eye finds groups by their first line.
                if index == 0 {
                    method_name.clone()
                } else {
                    String::new()
                },
                name.into(),
                gpu(|spread| spread.min),
                gpu(|spread| spread.median),
                gpu(|spread| spread.p95),
                cpu.map_or(String::new(), |spread| ms(spread.median)),
            ];
            add_row(&mut table, row, 2);
        }
    }
    table.to_string()
}

fn footnotes(results: &Results, runs: &[Run]) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(reason) = &results.adapter.gpu_unavailable {
        notes.push(format!("No GPU times: {reason}"));
    }
    if results.adapter.gpu_unavailable.is_none() {
        notes.extend(runs.iter().filter_map(times_missing));
    }
    notes.extend(runs.iter().filter_map(|run| {
        let cached = run.measured.as_ref()?.cached.as_ref()?;
        Some(format!(
            "cached frame of {}: only the camera moved; it skips {}",
            method(run),
            cached.skipped.join(", ")
        ))
    }));
    notes.extend(runs.iter().filter_map(|run| {
        Some(format!(
            "{} is unavailable: {}",
            run.preset,
            run.unavailable.as_ref()?
        ))
    }));
    notes
}

/// Preset and map size, as a row's name.
fn method(run: &Run) -> String {
    run.map_size
        .map_or(run.preset.clone(), |size| format!("{} {size}", run.preset))
}

/// Which GPU times a run lacks on an adapter whose timestamps are true.
pub fn times_missing(run: &Run) -> Option<String> {
    let measured = run.measured.as_ref()?;
    let passes = measured.passes.iter();
    let passes = passes.map(|pass| (pass.name.as_str(), pass.gpu_ms.is_some()));
    let why = untimed(passes, measured.frame.gpu_ms.is_some())?;
    Some(format!("{}: {why}", method(run)))
}

/// Which GPU times are missing: of passes, each with whether it has one, and of the frame.
pub fn untimed<'a>(passes: impl Iterator<Item = (&'a str, bool)>, frame: bool) -> Option<String> {
    let untimed: Vec<&str> = passes
        .filter_map(|(name, is_timed)| (!is_timed).then_some(name))
        .collect();
    let untimed = untimed.join(", ");
    Some(match (frame, untimed.as_str()) {
        (true, "") => return None,
        (true, _) => {
            format!(
                "the whole frame is timed over its other passes, there are no GPU times of {untimed}"
            )
        }
        (false, "") => "no GPU time of the whole frame: some frames had none".into(),
        (false, _) => format!("no GPU time of the whole frame: there are none of {untimed}"),
    })
}

/// An empty table whose first `left` columns hold words.
pub fn new_table(header: &[&str], left: usize) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_FULL_CONDENSED);
    table.set_header(
        header
            .iter()
            .enumerate()
            .map(|(column, text)| cell(text, column, left)),
    );
    table
}

/// Adds a row to such a table.
pub fn add_row(table: &mut Table, row: Vec<String>, left: usize) {
    table.add_row(
        row.iter()
            .enumerate()
            .map(|(column, text)| cell(text, column, left)),
    );
}

fn cell(text: &str, column: usize, left: usize) -> Cell {
    Cell::new(text).set_alignment(if column < left {
        CellAlignment::Left
    } else {
        CellAlignment::Right
    })
}

/// So many frames, in words.
pub fn frames(count: u32) -> String {
    if count == 1 {
        "1 frame".into()
    } else {
        format!("{count} frames")
    }
}

/// Three significant digits or milliseconds to the microsecond, whichever is shorter.
pub fn ms(ms: f64) -> String {
    match ms {
        _ if ms >= 99.95 => format!("{ms:.0}"),
        _ if ms >= 9.995 => format!("{ms:.1}"),
        _ if ms >= 0.9995 => format!("{ms:.2}"),
        _ => format!("{ms:.3}"),
    }
}

/// A share in percent; a count that is not zero never shows as zero.
pub fn percent(count: u64, whole: u64) -> String {
    let share = count as f64 / whole as f64 * 100.0;
    match (count, whole) {
        (_, 0) => "–".into(),
        (0, _) => "0 %".into(),
        _ if share < 0.001 => "<0.001 %".into(),
        _ => format!("{share:.3} %"),
    }
}

/// 1234567 as 1,234,567.
pub fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A number of bytes with a binary prefix.
pub fn bytes(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} bytes"),
        1024..1_048_576 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        1_048_576..1_073_741_824 => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
        _ => format!("{:.2} GiB", bytes as f64 / 1_073_741_824.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::tests::sample;

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
            "nsm 1024: the whole frame is timed over its other passes, there are no GPU times of gbuffer\n",
            "rt: no GPU time of the whole frame: there are none of gbuffer, trace_rays\n",
        ] {
            assert!(text.contains(note), "{text}");
        }
    }

    #[test]
    fn numbers_stay_readable_over_ten_orders_of_magnitude() {
        assert_eq!(
            [0.0, 0.00049, 1.234, 12.34, 123.4, 99999.0].map(ms),
            ["0.000", "0.000", "1.23", "12.3", "123", "99999"]
        );
        assert_eq!(
            [0, 999, 1000, 1_234_567].map(thousands),
            ["0", "999", "1,000", "1,234,567"]
        );
        assert_eq!(
            [512, 1536, 3 << 20].map(bytes),
            ["512 bytes", "1.5 KiB", "3.0 MiB"]
        );
        assert_eq!(
            [(0, 9), (1, 1_000_000), (1, 3), (0, 0)].map(|(n, d)| percent(n, d)),
            ["0 %", "<0.001 %", "33.333 %", "–"]
        );
    }
}
