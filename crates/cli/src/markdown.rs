//! Results as a document: a header, then for every view and viewport one table of errors and of the times of steps.

use crate::{
    parse::Beside,
    results::{Measured, Results, Run},
    table::{frames, ms, thousands, times_missing, warning},
};
use std::{collections::BTreeSet, env, ffi::OsString};

/// The step that a pass belongs to: its name up to the first dot, so that `create_shadow_map.big` and `create_shadow_map.small` are one.
pub fn step(pass: &str) -> &str {
    pass.split_once('.').map_or(pass, |(step, _)| step)
}

/// Heads of the presets' steps; other steps stand under their own names.
const HEADS: [(&str, &str); 5] = [
    ("create_shadow_map", "map"),
    ("detect_uncertain", "detect"),
    ("fill_rays", "fill"),
    ("trace_rays", "trace"),
    ("fix_pixels", "fix"),
];

/// The command line as it was typed, but for the program's path.
pub fn command_line(arguments: impl Iterator<Item = OsString>) -> String {
    let quoted = |argument: OsString| {
        let text = argument.to_string_lossy().into_owned();
        let is_plain = |c: char| c.is_alphanumeric() || "-_=.,:/\\@+".contains(c);
        match text.chars().all(is_plain) && !text.is_empty() {
            true => text,
            false => format!("'{}'", text.replace('\'', r"'\''")),
        }
    };
    let words = arguments.skip(1).map(quoted);
    let words: Vec<String> = ["skiagraph".into()].into_iter().chain(words).collect();
    words.join(" ")
}

/// What all tables have in common. `today` is the date of the runs that are still to be measured, if there are any.
pub fn header(results: &Results, today: Option<&str>, beside: &[Beside]) -> String {
    let dates = results.runs.iter().map(|run| run.date.as_str());
    let dates: BTreeSet<&str> = dates.chain(today).filter(|date| !date.is_empty()).collect();
    let date = match (dates.first(), dates.last()) {
        (Some(first), Some(last)) if first != last => format!("{first} to {last}"),
        (Some(first), _) => (*first).to_owned(),
        _ => "unknown".to_owned(),
    };
    let heads: Vec<String> = HEADS
        .iter()
        .map(|(step, head)| format!("*{head}* is the step `{step}`"))
        .collect();
    let mut lines = vec![
        format!("adapter: {}", results.adapter),
        format!("date: {date} (UTC)"),
        format!(
            "times: on the GPU, medians of {} after {} to warm up; {}; *frame* is from the first pass's begin to the last one's end",
            frames(results.frames),
            results.warmup,
            heads.join(", ")
        ),
        format!("oracle: {}", results.oracle),
        "shares are of the pixels that face the light (PFL), in-band pixels included; *wrong* is the final picture".into(),
    ];
    lines.extend(beside.iter().map(|Beside { label, file }| {
        let file = file.display().to_string().replace('\\', "/");
        format!("in parentheses: {label}, published figures of `{file}`")
    }));
    if let Some(reason) = &results.adapter.gpu_unavailable {
        lines.push(format!("no GPU times: {reason}"));
    }
    format!(
        "## {}\n\n    {}\n\n{}",
        results.scene,
        command_line(env::args_os()),
        list(&lines)
    )
}

/// The heading of a view.
pub fn view(name: &str) -> String {
    format!("\n### {name}\n")
}

/// The runs of one view and viewport: the reference's pixels, a table, and what cannot stand in it.
pub fn viewport(results: &Results, runs: &[Run]) -> String {
    let Some(first) = runs.first() else {
        return String::new();
    };
    let mut marks = Marks::default();
    let mut text = format!("\n{}\n", pixels(first, &mut marks));
    let measured: Vec<(&Run, &Measured)> = runs
        .iter()
        .filter_map(|run| Some((run, run.measured.as_ref()?)))
        .collect();
    if !measured.is_empty() {
        let steps = steps(&measured);
        text.push('\n');
        text.push_str(&header_row(&steps));
        for (run, measured) in &measured {
            text.push_str(&line(&cells(run, measured, &steps, &mut marks)));
        }
    }
    let mut notes: Vec<String> = warning(first).into_iter().collect();
    if results.adapter.gpu_unavailable.is_none() {
        notes.extend(runs.iter().filter_map(times_missing));
    }
    notes.extend(unavailable(runs));
    notes.extend(marks.notes());
    if !notes.is_empty() {
        text.push_str(&format!("\n{}", list(&notes)));
    }
    text
}

fn pixels<'a>(run: &'a Run, marks: &mut Marks<'a>) -> String {
    let [width, height] = run.viewport;
    let counts = &run.pixels;
    let mut count = |count, quantity| marks.beside(thousands(count), run, quantity);
    let facing_light = count(counts.facing_light, "facing_light");
    let (lit, shadow) = (count(counts.lit, "lit"), count(counts.shadow, "shadow"));
    let facing_away = count(counts.facing_away, "facing_away");
    format!(
        "**{width}×{height}**: PFL {facing_light} = lit {lit} + shadow {shadow}; PnFL {facing_away}; background {}; in the band {} ({} % of PFL)",
        thousands(counts.background),
        thousands(run.band),
        share(run.band, counts.facing_light),
    )
}

/// The steps of all runs in the order of their first use, then those that only others have published.
fn steps<'a>(runs: &[(&'a Run, &'a Measured)]) -> Vec<&'a str> {
    let passes = runs.iter().flat_map(|(_, measured)| &measured.passes);
    let published = runs.iter().flat_map(|(run, _)| &run.published);
    let published = published.filter_map(|figure| figure.quantity.strip_prefix("ms."));
    let mut steps = Vec::new();
    for step in passes.map(|pass| step(&pass.name)).chain(published) {
        if !steps.contains(&step) && step != "frame" {
            steps.push(step);
        }
    }
    steps
}

fn header_row(steps: &[&str]) -> String {
    let head = |step: &&str| {
        let short = HEADS.iter().find(|(name, _)| name == step);
        format!("{} ms", short.map_or(*step, |(_, head)| head))
    };
    let columns = [
        "method",
        "map",
        "certain right %",
        "uncertain %",
        "certain wrong %",
        "wrong %",
        "wrong lit / shadow",
        "rays",
    ];
    let columns = columns.map(String::from).into_iter();
    let row: Vec<String> = columns
        .chain(steps.iter().map(head))
        .chain(["frame ms".into()])
        .collect();
    format!("{}|---{}|\n", line(&row), "|---:".repeat(row.len() - 1))
}

fn cells<'a>(
    run: &'a Run,
    measured: &Measured,
    steps: &[&str],
    marks: &mut Marks<'a>,
) -> Vec<String> {
    let whole = run.pixels.facing_light;
    let unknown = || "–".to_owned();
    let wrong = &measured.wrong;
    let mut beside = |ours: String, quantity: &str| marks.beside(ours, run, quantity);
    let right = share(measured.split.certain_right(), whole);
    let uncertain = share(measured.uncertain, whole);
    let certain_wrong = share(measured.split.certain_wrong(), whole);
    let mut row = vec![
        run.preset.clone(),
        run.map_size.map_or_else(unknown, |size| size.to_string()),
        beside(right, "certain_right_percent"),
        beside(uncertain, "uncertain_percent"),
        beside(certain_wrong, "certain_wrong_percent"),
        beside(share(wrong.total, whole), "wrong_percent"),
        format!("{} / {}", thousands(wrong.lit), thousands(wrong.shadow)),
        beside(measured.rays.map_or_else(unknown, thousands), "rays"),
    ];
    let times = steps.iter().map(|step| (*step, step_ms(measured, step)));
    let frame = measured.frame.gpu_ms.map(|spread| spread.median);
    let times = times.chain([("frame", frame)]);
    row.extend(times.map(|(step, time)| {
        let ours = time.map_or_else(unknown, ms);
        beside(ours, &format!("ms.{step}"))
    }));
    row
}

/// Footnotes of published figures, each once per table.
#[derive(Default)]
struct Marks<'a>(Vec<(&'a str, &'a str, &'a str)>);

impl<'a> Marks<'a> {
    /// Our figure with the published ones in parentheses.
    fn beside(&mut self, mut ours: String, run: &'a Run, quantity: &str) -> String {
        let figures = run.published.iter();
        for figure in figures.filter(|figure| figure.quantity == quantity) {
            let value = published(figure.value, quantity);
            let mark = figure.note.as_deref().map_or_else(String::new, |note| {
                let note = (figure.by.as_str(), figure.source.as_str(), note);
                let known = self.0.iter().position(|known| *known == note);
                let index = known.unwrap_or_else(|| {
                    self.0.push(note);
                    self.0.len() - 1
                });
                superscript(index + 1)
            });
            ours.push_str(&format!(" ({} {value}{mark})", figure.by));
        }
        ours
    }

    fn notes(self) -> impl Iterator<Item = String> {
        let notes = self.0.into_iter().enumerate();
        notes.map(|(index, (by, source, note))| {
            format!("{} {by}, {source}: {note}", superscript(index + 1))
        })
    }
}

/// A published figure as it is usually printed: counts in thousands, shares with two decimals at least.
fn published(value: f64, quantity: &str) -> String {
    let text = value.to_string();
    let decimals = text
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    match quantity {
        _ if quantity.starts_with("ms.") => text,
        _ if quantity.ends_with("_percent") => format!("{value:.*}", decimals.max(2)),
        _ => thousands(value as u64),
    }
}

/// A number in small raised digits.
fn superscript(number: usize) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = number.to_string().into_bytes().into_iter();
    digits
        .map(|digit| DIGITS[usize::from(digit - b'0')])
        .collect()
}

/// The sum of the medians of a step's passes; `None` if it has none, or one without a GPU time.
pub fn step_ms(measured: &Measured, name: &str) -> Option<f64> {
    let passes = measured.passes.iter();
    let medians: Vec<f64> = passes
        .filter(|pass| step(&pass.name) == name)
        .map(|pass| Some(pass.gpu_ms?.median))
        .collect::<Option<_>>()?;
    (!medians.is_empty()).then(|| medians.iter().sum())
}

/// Which methods could not run, each reason once.
fn unavailable(runs: &[Run]) -> Vec<String> {
    let mut reasons: Vec<(&str, &str, Vec<String>)> = Vec::new();
    for run in runs {
        let Some(reason) = &run.unavailable else {
            continue;
        };
        let maps = run.map_size.iter().map(u32::to_string);
        match reasons
            .iter_mut()
            .find(|(preset, known, _)| *preset == run.preset && known == reason)
        {
            Some((.., known)) => known.extend(maps),
            None => reasons.push((&run.preset, reason, maps.collect())),
        }
    }
    let text = |(preset, reason, maps): (&str, &str, Vec<String>)| {
        let maps = match maps.is_empty() {
            true => String::new(),
            false => format!(", map {},", maps.join(", ")),
        };
        format!("{preset}{maps} is unavailable: {reason}")
    };
    reasons.into_iter().map(text).collect()
}

/// A share in percent without its sign; a count that is not zero never shows as zero.
fn share(count: u64, whole: u64) -> String {
    let share = count as f64 / whole as f64 * 100.0;
    match (count, whole) {
        (_, 0) => "–".into(),
        (0, _) => "0".into(),
        _ if share < 0.001 => "<0.001".into(),
        _ if share < 1.0 => format!("{share:.3}"),
        _ => format!("{share:.2}"),
    }
}

fn line(cells: &[String]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}

fn list(lines: &[String]) -> String {
    lines.iter().map(|line| format!("- {line}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::tests::sample;

    #[test]
    fn a_document_has_a_table_per_viewport() {
        let results = sample();
        let beside = ["D:docs/d.csv".parse().unwrap()];
        let header = header(&results, None, &beside);
        // The test runner's own arguments.
        let command = command_line(env::args_os());
        let text = [header, view("main"), viewport(&results, &results.runs)].concat();
        insta::assert_snapshot!(text.replace(&command, "COMMAND"));
    }

    #[test]
    fn a_command_line_can_be_typed_again() {
        let words = [
            "/some/where/skiagraph.exe",
            "compare",
            "my method.ron",
            "--set",
            "a=1",
        ];
        let text = command_line(words.into_iter().map(OsString::from));
        assert_eq!(text, "skiagraph compare 'my method.ron' --set a=1");
    }

    #[test]
    fn dates_are_a_day_or_a_span() {
        let mut results = sample();
        assert!(header(&results, None, &[]).contains("date: 2026-11-20 (UTC)"));
        let both = header(&results, Some("2026-11-21"), &[]);
        assert!(both.contains("date: 2026-11-20 to 2026-11-21"), "{both}");
        results.runs.clear();
        assert!(header(&results, Some("2026-11-21"), &[]).contains("date: 2026-11-21"));
    }

    #[test]
    fn a_step_is_the_sum_of_its_passes_or_unknown() {
        let mut run = sample().runs.remove(0);
        let measured = run.measured.as_mut().unwrap();
        let mut more = measured.passes[0].clone();
        more.name = "gbuffer.surface".into();
        measured.passes.push(more);
        assert_eq!(step_ms(measured, "gbuffer"), Some(0.75));
        assert_eq!(step_ms(measured, "create_shadow_map"), Some(0.375));
        measured.passes[0].gpu_ms = None;
        assert_eq!(step_ms(measured, "gbuffer"), None);
        assert_eq!(step_ms(measured, "trace_rays"), None);
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

    #[test]
    fn shares_keep_what_is_small() {
        let shares = [(0, 9), (1, 1_000_000), (1, 1000), (1, 3), (0, 0)];
        let texts = shares.map(|(count, whole)| share(count, whole));
        assert_eq!(texts, ["0", "<0.001", "0.100", "33.33", "–"]);
    }
}
