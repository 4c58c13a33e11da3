//! Charts published figures beside measured ones: published left, measured right, on the same axes.
//! There is a chart for each quantity that both have, by map size and by viewport.

use crate::charts::conditions;
use crate::looks::looks;
use crate::published_left_out::{views_left_out, without_counterpart};
use crate::published_panels::{Bar, Groups, PanelRow, cells, published, rows, whole as whole_run};
use skiagraph_chart::{Figure, Panel};
use skiagraph_compare::lists::unique;
use skiagraph_compare::records::columns::{figure, head_of, quantities};
use skiagraph_compare::records::figure::Case;
use skiagraph_compare::records::published_row::Row;
use skiagraph_compare::records::results::Run;
use skiagraph_compare::records::sources::Kept;

/// Charts of published and measured figures, and the list of figures that are only published or
/// only measured.
pub struct Charts {
    /// The charts, each behind the name of its file without extension.
    pub charts: Vec<(String, Figure)>,
    /// Lines of text, each about figures that are not drawn, with the reason.
    pub left_out: Vec<String>,
}

/// Times of two machines have no axis in common, so those of a method are drawn as shares of this
/// quantity of the method that draws no map.
const SUM: &str = "ms.steps";

/// The chart of methods without a map, whose times have nothing to be a share of.
const GROWTH: &str = "time-by-viewport";

/// Draws charts for each share, time and rate that is both published and measured, by map size and
/// by viewport; counts are not drawn. The published figures must be in [`Run::published`] of the
/// runs of `kept`. `published_rows` are all figures of the publication; `label` is its name in the
/// charts. `viewport` (pixels) limits the charts to one viewport; `None` draws all.
pub fn draw(
    kept: &[Kept],
    published_rows: &[Row],
    label: &str,
    viewport: Option<[u32; 2]>,
) -> Charts {
    let is_in = |size: [u32; 2]| viewport.is_none_or(|wanted| wanted == size);
    let cells: Vec<Case> = kept
        .iter()
        .flat_map(|kept| cells(&kept.results))
        .filter(|cell| is_in(cell.run.viewport))
        .collect();
    let theirs = published_rows.iter().filter(|row| is_in(row.key().2));
    let mut left_out = without_counterpart(&cells, theirs, label);
    let methods = unique(cells.iter().map(|cell| cell.run.preset.clone()));
    let mut charts = Vec::new();
    let mut add = |name: String, [title, note]: [String; 2], drawn: &[PanelRow], panels| {
        let whose = format!("Left: {label}, as published. Right: ours, measured as follows.");
        let mut notes: Vec<String> = [note, whose].into();
        notes.retain(|note| !note.is_empty());
        notes.extend(conditions(kept));
        notes.extend(remarks(drawn));
        let figure = Figure {
            title,
            notes,
            looks: looks(methods.clone()),
            panels,
            columns: 2,
            shared_axes: true,
            ..Figure::default()
        };
        if !figure.panels.is_empty() {
            charts.push((name, figure));
        }
    };
    for quantity in of_runs(&cells) {
        let head = head_of(&quantity);
        let (y, note) = match axis(&cells, &quantity) {
            Ok(words) => words,
            Err(why) => {
                left_out.push(format!("not drawn: {quantity}: {why}"));
                continue;
            }
        };
        let mut lacking = Vec::new();
        for groups in [Groups::Maps, Groups::Viewports] {
            let name = format!("{}-by-{}", file_name(&quantity), groups.axis());
            let drawn = rows(&cells, groups, |cell| bar(cell, &quantity));
            let panels = drawn.iter().flat_map(|row| row.bars(label, groups, &y));
            let panels: Vec<Panel> = panels.collect();
            if panels.is_empty() {
                lacking.push(groups.plural());
            } else {
                left_out.extend(views_left_out(&cells, &name, &drawn, groups));
            }
            let title = format!("{head} by {}", groups.axis());
            add(name, [title, note.clone()], &drawn, panels);
        }
        if lacking.len() == 2 {
            left_out.push(format!(
                "not drawn: {quantity}: no two {} of which there are figures on both sides",
                lacking.join(" or ")
            ));
        }
    }
    let drawn = rows(&cells, Groups::Viewports, |cell| {
        let bar = Bar::new(cell, SUM, (1.0, 1.0)).filter(|_| cell.run.map_size.is_none());
        bar.filter(|bar| bar.theirs > 0.0 && bar.ours > 0.0)
    });
    let panels = drawn
        .iter()
        .flat_map(|row| row.growth(label, "times the smallest viewport's"));
    let words = [
        "Time by viewport of methods without a map",
        "Sums of steps.",
    ];
    add(
        GROWTH.into(),
        words.map(Into::into),
        &drawn,
        panels.collect(),
    );
    Charts { charts, left_out }
}

/// The label of a quantity's axis, and a note on it.
///
/// # Errors
/// Why it cannot be drawn: there is nothing that it is a share of.
fn axis(cells: &[Case], quantity: &str) -> Result<(String, String), String> {
    let head = head_of(quantity);
    let Some(whole) = whole_of(quantity) else {
        return Ok((head, String::new()));
    };
    let whole_head = head_of(whole);
    let mut wholes = cells.iter().filter_map(|cell| whole_run(cell, whole));
    let method = &wholes
        .next()
        .ok_or_else(|| format!("no method without a map has {whole_head} there"))?
        .preset;
    let base = format!("{method}'s {whole_head}");
    let note = format!("Shares of {base} in the same view and viewport.");
    Ok((format!("{head}, % of {base}"), note))
}

/// The quantities that are published of these runs, but counts, which are shares, too.
fn of_runs(cells: &[Case]) -> Vec<String> {
    let figures = cells.iter().flat_map(|cell| &cell.run.published);
    let quantities_of = figures.map(|figure| figure.quantity.clone());
    let is_drawn = |name: &String| name.ends_with("_percent") || whole_of(name).is_some();
    let mut names = unique(quantities_of.filter(is_drawn));
    let order = quantities();
    let place = |quantity: &String| order.iter().position(|name| name == quantity);
    names.sort_by_key(|quantity| place(quantity).unwrap_or(order.len()));
    names
}

/// The quantity that figures of another machine are shares of: of times the sum of steps, of rates
/// the rate.
fn whole_of(quantity: &str) -> Option<&'static str> {
    match quantity {
        "fps" => Some("fps"),
        _ => quantity.starts_with("ms.").then_some(SUM),
    }
}

/// `certain-wrong` of `certain_wrong_percent`, `ms-trace-rays` of `ms.trace_rays`.
fn file_name(quantity: &str) -> String {
    let name = quantity.strip_suffix("_percent").unwrap_or(quantity);
    name.replace(['.', '_', '+'], "-")
}

/// Lists what is wrong with the figures that are drawn.
fn remarks(drawn: &[PanelRow]) -> Vec<String> {
    let figures = drawn.iter().flat_map(PanelRow::figures);
    unique(figures.filter_map(|figure| {
        let note = figure.note.as_ref()?;
        Some(format!("{}, {}: {note}", figure.by, figure.source))
    }))
}

/// The bar of a quantity: a share as it is, a time or a rate in percent of the whole.
fn bar<'a>(cell: &'a Case<'a>, quantity: &str) -> Option<Bar<'a>> {
    let Some(whole) = whole_of(quantity) else {
        return Bar::new(cell, quantity, (1.0, 1.0));
    };
    let run: &Run = whole_run(cell, whole)?;
    let theirs = published(run, whole)?.value / 100.0;
    let ours = figure(whole, cell.results, run)? / 100.0;
    // The whole is 100 % of itself.
    (run.preset != cell.run.preset).then(|| Bar::new(cell, quantity, (theirs, ours)))?
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::results as sample;
    use skiagraph_chart::Kind;
    use skiagraph_compare::records::results::Published;

    /// Results of `rt`, then `nsm`, `crsm` and a method without published figures in two maps, and
    /// the figures published of them.
    fn kept() -> Kept {
        let mut results = sample();
        let mut run = results.runs.remove(0);
        run.published.clear();
        let run = |preset: &str, map_size, figures: &[(&str, f64)]| {
            let mut run = run.clone();
            (run.preset, run.map_size) = (preset.into(), map_size);
            let figures = figures.iter().map(|(quantity, value)| Published {
                by: "D".into(),
                quantity: (*quantity).into(),
                value: *value,
                source: "table 22".into(),
                note: (*value == 8.31).then(|| "another run".into()),
            });
            run.published.extend(figures);
            run
        };
        results.runs = vec![run("rt", None, &[("ms.steps", 15.0), ("fps", 50.0)])];
        for (map, wrong, ms) in [(1024, 6.47, 7.5), (512, 8.41, 8.31)] {
            results.runs.extend([
                run(
                    "nsm",
                    Some(map),
                    &[("wrong_lit_percent", wrong), ("fps", 300.0)],
                ),
                run(
                    "crsm",
                    Some(map),
                    &[("ms.create_shadow_map", ms), ("fps", 25.0)],
                ),
                run("light_buffer", Some(map), &[]),
            ]);
        }
        Kept {
            folder: "out".into(),
            results,
        }
    }

    fn rounded(share: f64) -> f64 {
        (share * 1e6).round() / 1e6
    }

    /// A panel's title, its groups, and the heights of each series.
    type Drawn = (String, Vec<String>, Vec<(String, Vec<f64>)>);

    /// A chart's panels.
    fn panels(charts: &Charts, name: &str) -> Vec<Drawn> {
        let (_, figure) = charts
            .charts
            .iter()
            .find(|(chart, _)| chart == name)
            .unwrap();
        assert!(figure.shared_axes);
        let panel = |panel: &Panel| {
            let Kind::Bars(groups) = &panel.kind else {
                panic!("{panel:?}")
            };
            let heights = panel.series.iter().map(|series| {
                let mut marks = series.marks.clone();
                marks.sort_by(|a, b| a.x.total_cmp(&b.x));
                (
                    series.name.clone(),
                    marks.iter().map(|mark| rounded(mark.y)).collect(),
                )
            });
            (panel.title.clone(), groups.clone(), heights.collect())
        };
        figure.panels.iter().map(panel).collect()
    }

    #[test]
    fn theirs_stands_left_and_ours_right_the_smallest_map_first() {
        let charts = draw(&[kept()], &[], "D", None);
        let groups = vec!["512²".to_owned(), "1024²".to_owned()];
        let panel = |whose: &str, series: &str, heights: [f64; 2]| {
            let title = format!("{whose}: park, main, 512x256");
            (
                title,
                groups.clone(),
                vec![(series.to_owned(), heights.to_vec())],
            )
        };
        // 102 of 60,000 + 102 - 401 pixels that are lit.
        let wrong = rounded(100.0 * 102.0 / 59_701.0);
        let expected = [
            panel("D", "nsm", [8.41, 6.47]),
            panel("ours", "nsm", [wrong; 2]),
        ];
        assert_eq!(panels(&charts, "wrong-lit-by-map"), expected);
        // One of two passes of the same length.
        let expected = [
            panel("D", "crsm", [55.4, 50.0]),
            panel("ours", "crsm", [50.0; 2]),
        ];
        assert_eq!(panels(&charts, "ms-create-shadow-map-by-map"), expected);
        let rates = |nsm, crsm| vec![("nsm".into(), vec![nsm; 2]), ("crsm".into(), vec![crsm; 2])];
        let rates: Vec<_> = panels(&charts, "fps-by-map")
            .into_iter()
            .zip([rates(600.0, 50.0), rates(100.0, 100.0)])
            .collect();
        assert!(
            rates
                .iter()
                .all(|((.., drawn), expected)| drawn == expected),
            "{rates:?}"
        );
        let names: Vec<&str> = charts
            .charts
            .iter()
            .map(|(name, _)| name.as_str())
            .collect();
        let expected = [
            "wrong-lit-by-map",
            "fps-by-map",
            "ms-create-shadow-map-by-map",
        ];
        assert_eq!(names, expected);
        let figure = &charts.charts[2].1;
        assert_eq!(figure.panels[0].y, "map ms, % of rt's sum of steps ms");
        let notes = &figure.notes;
        assert_eq!(notes.last().unwrap(), "D, table 22: another run");
    }

    #[test]
    fn the_tracers_time_is_drawn_against_pixels() {
        let mut kept = kept();
        kept.results.runs.truncate(1);
        let mut larger = kept.results.runs[0].clone();
        larger.viewport = [1024, 512];
        larger.published[0].value = 45.0;
        kept.results.runs.insert(0, larger);
        let charts = draw(&[kept], &[], "D", None);
        let [(name, figure)] = &charts.charts[..] else {
            panic!("{:?}", charts.charts)
        };
        assert_eq!(name, GROWTH);
        let marks = |panel: &Panel| {
            let marks = panel.series[0].marks.iter();
            marks.map(|mark| (mark.x, mark.y)).collect::<Vec<_>>()
        };
        let [theirs, ours] = &figure.panels[..] else {
            panic!("{figure:?}")
        };
        let pixels = 512.0 * 256.0;
        assert_eq!(marks(theirs), [(pixels, 1.0), (4.0 * pixels, 3.0)]);
        assert_eq!(marks(ours), [(pixels, 1.0), (4.0 * pixels, 1.0)]);
    }

    #[test]
    fn without_the_tracer_or_its_times_no_shares_are_drawn() {
        let mut without = kept();
        without.results.runs.remove(0);
        let mut timeless = kept();
        let measured = timeless.results.runs[0].measured.as_mut().unwrap();
        measured.frame.gpu_ms = None;
        measured.passes[0].gpu_ms = None;
        for kept in [without, timeless] {
            let charts = draw(&[kept], &[], "D", None);
            let names: Vec<&str> = charts
                .charts
                .iter()
                .map(|(name, _)| name.as_str())
                .collect();
            assert_eq!(names, ["wrong-lit-by-map"]);
            let left_out = charts.left_out.join("\n");
            assert!(
                left_out.contains("not drawn: ms.create_shadow_map: "),
                "{left_out}"
            );
        }
    }

    #[test]
    fn other_viewports_are_not_asked_for() {
        let charts = draw(&[kept()], &[], "D", Some([1, 1]));
        assert!(charts.charts.is_empty());
        let drawn = draw(&[kept()], &[], "D", Some([512, 256]));
        assert_eq!(drawn.charts.len(), 3);
    }
}
