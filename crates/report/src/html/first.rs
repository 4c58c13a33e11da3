//! The first screen: reference, the method to take, and where the alternative is wrong, as pictures
//! beside each other. The page's script puts in the files.

use crate::html::charts::sign;
use crate::html::shown::{Shown, part};
use crate::summary::Row;
use skiagraph_chart::xml;
use skiagraph_compare::records::results::{Measured, Run};
use skiagraph_compare::wording::{ms, percent};

/// Returns the pictures of each table's verdict as HTML. A table without a verdict or without
/// pictures has none.
pub fn pictures(tables: &[Shown]) -> String {
    let of_table = |(index, table): (usize, &Shown)| {
        let figures = figures(tables, table)?;
        Some(part("first", &[index], None, &figures))
    };
    tables.iter().enumerate().filter_map(of_table).collect()
}

/// A picture with its caption; `kind` is the key of the picture among those of the page's data.
struct Figure<'a> {
    run: &'a Run,
    /// Frame of a camera path.
    frame: Option<usize>,
    /// True for the reference of the run's view, false for the method.
    is_reference: bool,
    kind: &'a str,
    alt: String,
    /// Caption as HTML.
    caption: String,
}

fn figures(tables: &[Shown], table: &Shown) -> Option<String> {
    let verdict = table.summary.verdict();
    let row = |index: Option<usize>| table.summary.rows.get(index?);
    let taken = row(verdict.taken)?;
    let runner_up = row(verdict.runner_up);
    let (run, _) = worst_view(runner_up.unwrap_or(taken))?;
    let frame = |of: &Measured| Some(of.images.as_ref()?.frame);
    let name = |row: &Row| {
        let sign = sign(tables, &row.method);
        format!("<b>{sign}{}</b>", xml(&row.label))
    };
    let view = xml(&run.view);
    let time = |row: &Row| row.frame_ms(table.by_wall).map_or("–".into(), ms);
    let mut shown = Vec::new();
    let (taken_run, taken_of) = on_view(taken, &run.view)?;
    let judged = match runner_up.and_then(|row| on_view(row, &run.view)) {
        Some((_, of)) => frame(of)?,
        None => frame(taken_of)?,
    };
    shown.push(Figure {
        run,
        frame: judged,
        is_reference: true,
        kind: "visibility",
        alt: format!(
            "the reference of view {}: lit white, shadow black",
            run.view
        ),
        caption: format!("<b>reference</b>, view {view}: lit white, shadow black"),
    });
    shown.push(Figure {
        run: taken_run,
        frame: frame(taken_of)?,
        is_reference: false,
        kind: "shaded",
        alt: format!("{} on view {}, shaded", taken.label, run.view),
        caption: format!(
            "{}: {}, {} ms",
            name(taken),
            error(table, taken),
            time(taken)
        ),
    });
    if let Some(row) = runner_up {
        let (its_run, of) = on_view(row, &run.view)?;
        let (name, error, time) = (name(row), error(table, row), time(row));
        if is_right(row) {
            let text = format!("{name}: {error}, {time} ms. It has no wrong pixel to show.");
            return Some(html(&shown) + &format!("<p>{text}</p>"));
        }
        let colours = match its_run.is_hard() {
            true => "blue lights a shadow, red shadows light",
            false => "blue is too light, red too dark",
        };
        let here = percent(of.wrong_outside_band(), its_run.pixels.facing_light);
        let here = match row.views() > 1 && its_run.is_hard() {
            true => format!(" ({here} on view {view})"),
            false => String::new(),
        };
        shown.push(Figure {
            run: its_run,
            frame: frame(of)?,
            is_reference: false,
            kind: "error",
            alt: format!(
                "wrong pixels of {} on view {}: {colours}",
                row.label, run.view
            ),
            caption: format!("{name}: {error}{here}, {time} ms; {colours}"),
        });
    }
    Some(html(&shown))
}

/// The run on the view where a method is wrong the most; of equal ones the first.
fn worst_view<'a>(row: &Row<'a>) -> Option<(&'a Run, &'a Measured)> {
    let share = |(run, of): &(&Run, &Measured)| {
        let wrong = of.wrong_outside_band() as f64 / run.pixels.facing_light.max(1) as f64;
        (wrong, of.graded.rmse)
    };
    row.runs()
        .reduce(|worst, next| match share(&next) > share(&worst) {
            true => next,
            false => worst,
        })
}

fn on_view<'a>(row: &Row<'a>, view: &str) -> Option<(&'a Run, &'a Measured)> {
    row.runs().find(|(run, _)| run.view == view)
}

fn is_right(row: &Row) -> bool {
    row.is_exact() && row.wrong().outside_band == 0
}

/// The error of a row as the verdict ranks it.
fn error(table: &Shown, row: &Row) -> String {
    let wrong = row.wrong();
    if table.summary.is_soft() {
        format!("RMSE {:.4}", row.rmse().unwrap_or(0.0))
    } else if is_right(row) {
        "no wrong pixel".into()
    } else {
        let share = percent(wrong.outside_band, wrong.facing_light);
        format!("{share} wrong")
    }
}

fn html(figures: &[Figure]) -> String {
    let figure = |of: &Figure| {
        let [wide, high] = of.run.viewport;
        let label = (!of.is_reference).then(|| of.run.method_label());
        let label = label.map_or(String::new(), |label| {
            format!(" data-label=\"{}\"", xml(&label))
        });
        let frame = of
            .frame
            .map_or(String::new(), |frame| format!(" data-frame=\"{frame}\""));
        format!(
            "<figure><button type=\"button\" data-view=\"{}\" data-kind=\"{}\"{label}{frame}>\
             <img width=\"{wide}\" height=\"{high}\" alt=\"{}\"></button>\
             <figcaption>{}</figcaption></figure>\n",
            xml(&of.run.view),
            of.kind,
            xml(&of.alt),
            of.caption
        )
    };
    figures.iter().map(figure).collect()
}
