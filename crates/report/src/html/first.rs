//! Writes the first screen: pictures of the reference, of the method to take, and of the errors of
//! the alternative, beside each other. The page's script inserts the picture files.

use crate::contender::Condition;
use crate::html::charts::sign;
use crate::html::shown::{Shown, part};
use crate::summary::Row;
use crate::table::or_dash;
use crate::verdict::main_choice;
use skiagraph_chart::xml;
use skiagraph_compare::records::results::{Measured, Run};
use skiagraph_compare::records::sequence::SequenceFrame;
use skiagraph_compare::wording::{ms, or_nothing, percent};

/// Returns HTML with the pictures of each table's verdict: reference, recommended method, and
/// errors of the alternative. A table without a verdict or without pictures has none.
pub fn pictures(tables: &[Shown]) -> String {
    let of_table = |(index, table): (usize, &Shown)| {
        let figures = figures(tables, table)?;
        Some(part("first", &[index], None, &figures))
    };
    tables.iter().enumerate().filter_map(of_table).collect()
}

fn figures(tables: &[Shown], table: &Shown) -> Option<String> {
    let verdict = table.summary.verdict();
    let row = |index: Option<usize>| table.summary.rows.get(index?);
    let (taken, runner_up) = (row(verdict.first.first().copied())?, row(verdict.runner_up));
    let (run, judged) = worst_view(runner_up.unwrap_or(taken))?;
    let caption_of = |row: &Row, run: &Run, measured: &Measured| {
        let (sign, label) = (sign(tables, &row.method), xml(&row.label));
        if let Some(frame) = frame(measured)? {
            let figures = figures_of_frame(table, measured, frame)?;
            let frame = frame_in_words(Some(frame));
            return Some(format!("<b>{sign}{label}</b>{frame}: {figures}"));
        }
        let time = or_dash(row.frame_ms(main_choice(&table.summary.rows)), ms);
        let error = error(table, row);
        let is_part = row.views() > 1 && !table.summary.is_soft() && !is_right(row);
        let suffix = or_nothing(is_part.then_some(run), |run| {
            let share = percent(measured.wrong_outside_band(), run.pixels.facing_light);
            format!(" ({share} on this view)")
        });
        Some(format!("<b>{sign}{label}</b>: {error}{suffix}, {time} ms"))
    };
    let (its_run, measured) = taken.runs().find(|(own, _)| own.view == run.view)?;
    let caption = caption_of(taken, its_run, measured)?;
    let alt = format!("{} on {}, shaded", taken.label, run.view);
    let label = Some(its_run.method_label());
    let shaded = figure(its_run, frame(measured)?, label, ["shaded", &alt, &caption]);
    let mut html = reference(run, frame(judged)?) + &shaded;
    let caption = runner_up.map(|row| Some((row, caption_of(row, run, judged)?)));
    html += &match caption.flatten() {
        Some((row, caption)) if is_right(row) => {
            format!("<p>{caption}. It has no wrong pixel to show.</p>")
        }
        Some((row, caption)) => wrong(row, (run, judged), &caption)?,
        None => String::new(),
    };
    Some(html)
}

fn reference(run: &Run, frame: Option<usize>) -> String {
    let (view, number) = (xml(&run.view), frame_in_words(frame));
    let alt = format!("the reference of {}: lit white, shadow black", run.view);
    let name = format!("<b>reference</b>, {view}{number}");
    let caption = format!("{name}: lit white, shadow black, green faces away");
    figure(run, frame, None, ["visibility", &alt, &caption])
}

/// The wrong pixels of a row on one of its views.
fn wrong(row: &Row, (run, judged): (&Run, &Measured), caption: &str) -> Option<String> {
    let hard = "blue lights a shadow, red shadows light";
    let hard = run.is_hard().then_some(hard);
    let colours = hard.unwrap_or("blue is too light, red too dark");
    let alt = format!("wrong pixels of {} on {}: {colours}", row.label, run.view);
    let (label, caption) = (run.method_label(), format!("{caption}; {colours}"));
    Some(figure(
        run,
        frame(judged)?,
        Some(label),
        ["error", &alt, &caption],
    ))
}

/// The frame of a camera path that the pictures show; the outer `None` without pictures.
fn frame(measured: &Measured) -> Option<Option<usize>> {
    Some(measured.images.as_ref()?.frame)
}

/// The frame's own error and time: those of the row are of the whole path.
fn figures_of_frame(table: &Shown, measured: &Measured, frame: usize) -> Option<String> {
    let frame = measured.sequence.as_ref()?.frames.get(frame)?;
    let error = error_of_frame(frame, !table.summary.is_soft());
    let cost = frame.cost;
    let wall = table.summary.by_wall().then_some(cost.wall_ms);
    let time = wall.or_else(|| cost.gpu_ms.map(|_| cost.ms()));
    Some(format!("{error}, {} ms", or_dash(time, ms)))
}

/// Returns the error of one frame of a camera path: of hard shadows (`is_hard`) the share of the
/// pixels facing the light that are wrong outside the band, else the root mean square error of the
/// shares of light.
pub fn error_of_frame(frame: &SequenceFrame, is_hard: bool) -> String {
    match frame.wrong_outside_band {
        _ if !is_hard => format!("RMSE {:.4}", frame.graded.rmse),
        0 => "no wrong pixel".into(),
        wrong => format!("{} wrong", percent(wrong, frame.facing_light)),
    }
}

/// A comma and the frame of a camera path; nothing for a view.
fn frame_in_words(frame: Option<usize>) -> String {
    frame.map_or(String::new(), |frame| format!(", frame {frame}"))
}

/// The run on the view where a method is wrong the most; of equal ones the first.
fn worst_view<'a>(row: &Row<'a>) -> Option<(&'a Run, &'a Measured)> {
    let share = |(run, measured): &(&Run, &Measured)| {
        let wrong = measured.wrong_outside_band() as f64 / run.pixels.facing_light.max(1) as f64;
        (wrong, measured.graded.rmse)
    };
    row.runs().reduce(|worst, next| {
        let is_worse = share(&next) > share(&worst);
        if is_worse { next } else { worst }
    })
}

fn is_right(row: &Row) -> bool {
    row.is_exact() && row.wrong().outside_band == 0
}

/// The error of a row as the verdict ranks it.
fn error(table: &Shown, row: &Row) -> String {
    let wrong = row.wrong();
    if table.summary.is_soft() {
        return format!("RMSE {:.4}", row.rmse().unwrap_or(0.0));
    }
    let judged = wrong.facing_light.saturating_sub(wrong.band);
    let part = Condition::new(wrong)
        .is_some()
        .then_some((judged, " of what can be judged"));
    let (whole, which) = part.unwrap_or((wrong.facing_light, ""));
    match percent(wrong.outside_band, whole) {
        _ if is_right(row) => format!("no wrong pixel{which}"),
        share => format!("{share} wrong{which}"),
    }
}

/// A picture of a run's view in `frame` of a camera path, with its caption as HTML: of the method
/// with the label, or of the reference. `kind` is the picture's key in the page's data.
fn figure(
    run: &Run,
    frame: Option<usize>,
    label: Option<String>,
    [kind, alt, caption]: [&str; 3],
) -> String {
    let [wide, high] = run.viewport;
    let label = or_nothing(label, |label| format!(" data-label=\"{}\"", xml(&label)));
    let frame = or_nothing(frame, |frame| format!(" data-frame=\"{frame}\""));
    let (view, alt) = (xml(&run.view), xml(alt));
    format!(
        "<figure><button type=\"button\" data-view=\"{view}\" data-kind=\"{kind}\"{label}{frame}>\
         <img width=\"{wide}\" height=\"{high}\" alt=\"{alt}\"></button>\
         <figcaption>{caption}</figcaption></figure>\n"
    )
}
