//! Published figures and ours in charts beside each other: theirs left, ours right, on the same
//! axes. docs/data/README.md says which figures of the dissertation each chart is.

use crate::charts::{Kept, conditions};
use crate::published_left_out::{views_left_out, without_counterpart};
use crate::published_panels::{Bar, Cell, Groups, PanelRow, TRACER, cells, published, rows};
use skiagraph_chart::{Figure, Panel, Series};
use skiagraph_compare::records::published_row::Row;
use skiagraph_compare::records::results::{Measured, Part, Run};

/// The charts that could be drawn, and why others could not.
pub struct Charts {
    /// Names of files without their ending, and what is in them.
    pub charts: Vec<(&'static str, Figure)>,
    /// A line for each thing that has no counterpart.
    pub left_out: Vec<String>,
}

/// Description of one chart.
struct Family {
    /// Name of its file.
    name: &'static str,
    title: &'static str,
    /// Quantity that grows upwards.
    y: &'static str,
    /// Remark for the reader.
    note: &'static str,
    groups: Groups,
    bars: for<'a> fn(&'a Cell<'a>) -> Vec<Bar<'a>>,
}

const FAMILIES: [Family; 9] = [
    Family {
        name: "wrong-by-viewport",
        title: "nsm: wrong pixels by viewport",
        y: "wrong, % of its class",
        note: WRONG,
        groups: Groups::Viewports,
        bars: wrong,
    },
    Family {
        name: "wrong-by-map",
        title: "nsm: wrong pixels by map size",
        y: "wrong, % of its class",
        note: WRONG,
        groups: Groups::Maps,
        bars: wrong,
    },
    Family {
        name: "certain-wrong",
        title: "Hybrids: certain pixels that are wrong",
        y: "certain wrong, % of PFL",
        note: "PFL: the pixels that face the light. All others of them are certain and right, or \
               left to rays.",
        groups: Groups::Maps,
        bars: |cell| {
            let wrong = cell.measured.split.certain_wrong();
            of_facing(cell, "certain_wrong_percent", wrong)
        },
    },
    Family {
        name: "uncertain",
        title: "Hybrids: uncertain pixels",
        y: "uncertain, % of PFL",
        note: "PFL: the pixels that face the light.",
        groups: Groups::Maps,
        bars: |cell| of_facing(cell, "uncertain_percent", cell.measured.uncertain),
    },
    Family {
        name: "create-shadow-map",
        title: "Time of the step create_shadow_map",
        y: SHARE_Y,
        note: SHARE,
        groups: Groups::Maps,
        bars: |cell| step(cell, "create_shadow_map"),
    },
    Family {
        name: "fill-rays",
        title: "Time of the step fill_rays",
        y: SHARE_Y,
        note: SHARE,
        groups: Groups::Maps,
        bars: |cell| step(cell, "fill_rays"),
    },
    Family {
        name: "trace-rays",
        title: "Time of the step trace_rays",
        y: SHARE_Y,
        note: SHARE,
        groups: Groups::Maps,
        bars: |cell| step(cell, "trace_rays"),
    },
    Family {
        name: "sum-of-steps",
        title: "Sum of steps",
        y: SHARE_Y,
        note: "Below 100: faster than tracing every pixel, by sums of steps.",
        groups: Groups::Maps,
        bars: |cell| {
            let sum = |of: &Measured| of.steps_ms();
            of_tracer(cell, [SUM, SUM], sum, sum)
        },
    },
    Family {
        name: "frames-per-second",
        title: "Frames per second",
        y: "% of rt's",
        note: "Above 100: faster than tracing every pixel, by whole frames. Without nsm.",
        groups: Groups::Maps,
        bars: |cell| {
            if is_nsm(cell) {
                Vec::new()
            } else {
                of_tracer(cell, ["fps"; 2], Measured::fps, Measured::fps)
            }
        },
    },
];

const WRONG: &str =
    "Shares of the pixels that the method lights, and of those that it has in shadow.";
const SHARE: &str = "Shares of rt's sum of steps in the same viewport, drawing the view included.";
const SHARE_Y: &str = "% of rt's sum of steps";
/// The quantity of a sum of steps.
const SUM: &str = "ms.steps";

/// The chart of the tracer's time against pixels.
const TRACER_CHART: &str = "rt-by-viewport";

/// Draws everything that both have of these results, to whose runs the figures were attached.
/// `rows` are all of them.
pub fn draw(
    kept: &[Kept],
    published_rows: &[Row],
    label: &str,
    viewport: Option<[u32; 2]>,
) -> Charts {
    let is_in = |size: [u32; 2]| viewport.is_none_or(|wanted| wanted == size);
    let cells: Vec<Cell> = kept
        .iter()
        .flat_map(|kept| cells(&kept.results))
        .filter(|cell| is_in(cell.run.viewport))
        .collect();
    let theirs = published_rows.iter().filter(|row| is_in(row.key().2));
    let mut left_out = without_counterpart(&cells, theirs, label);
    let mut methods: Vec<String> = Vec::new();
    for Cell { run, .. } in &cells {
        if !methods.contains(&run.preset) {
            methods.push(run.preset.clone());
        }
    }
    let is_method = |series: &Series| methods.contains(&series.name);
    let mut charts = Vec::new();
    let mut add = |name, [title, note]: [&str; 2], drawn: &[PanelRow], panels: Vec<Panel>| {
        let mut notes = vec![note.to_owned()];
        notes.push(format!(
            "Left: {label}, as published. Right: ours, measured as follows."
        ));
        notes.extend(conditions(kept));
        notes.extend(remarks(drawn));
        let figure = Figure {
            title: title.into(),
            notes,
            looks: if panels.iter().flat_map(|panel| &panel.series).any(is_method) {
                methods.clone()
            } else {
                Vec::new()
            },
            panels,
            columns: 2,
            shared_axes: true,
            ..Figure::default()
        };
        if !figure.panels.is_empty() {
            charts.push((name, figure));
        }
    };
    for family in &FAMILIES {
        let drawn = rows(&cells, family.groups, family.bars);
        left_out.extend(views_left_out(&cells, family.name, &drawn, family.groups));
        let panels = drawn
            .iter()
            .flat_map(|row| row.bars(label, family.groups, family.y));
        let words = [family.title, family.note];
        add(family.name, words, &drawn, panels.collect());
    }
    let drawn = rows(&cells, Groups::Viewports, tracer);
    left_out.extend(views_left_out(
        &cells,
        TRACER_CHART,
        &drawn,
        Groups::Viewports,
    ));
    let panels = drawn
        .iter()
        .flat_map(|row| row.growth(label, "times the smallest viewport's"));
    let words = ["rt: time by viewport", "Sums of steps."];
    add(TRACER_CHART, words, &drawn, panels.collect());
    Charts { charts, left_out }
}

/// Lists what is wrong with the figures that are drawn.
fn remarks(drawn: &[PanelRow]) -> Vec<String> {
    let mut remarks = Vec::new();
    for figure in drawn.iter().flat_map(PanelRow::figures) {
        if let Some(note) = &figure.note {
            let remark = format!("{}, {}: {note}", figure.by, figure.source);
            if !remarks.contains(&remark) {
                remarks.push(remark);
            }
        }
    }
    remarks
}

/// The bar that a figure of theirs and one of ours make, if there are both; theirs is divided by
/// `whole`.
fn bar<'a>(
    series: &str,
    (run, quantity): (&'a Run, &str),
    whole: f64,
    ours: Option<f64>,
) -> Option<Bar<'a>> {
    let figure = published(run, quantity)?;
    let bar = Bar {
        series: series.to_owned(),
        figure,
        theirs: figure.value / whole,
        ours: ours?,
    };
    // Shares of nothing are none.
    (bar.theirs.is_finite() && bar.ours.is_finite()).then_some(bar)
}

/// The shadow map, ours or with the conventions of who published.
fn is_nsm(cell: &Cell) -> bool {
    ["nsm", "nsm_d"].contains(&cell.run.preset.as_str())
}

fn wrong<'a>(cell: &'a Cell<'a>) -> Vec<Bar<'a>> {
    if !is_nsm(cell) {
        return Vec::new();
    }
    let share =
        |part: Option<Part>| part.map(|Part { count, of }| 100.0 * count as f64 / of as f64);
    let run = cell.run;
    let lit = bar(
        "wrongly lit",
        (run, "wrong_lit_percent"),
        1.0,
        share(run.wrong_lit()),
    );
    let quantity = "wrong_shadow_percent";
    let shadow = bar(
        "wrongly in shadow",
        (run, quantity),
        1.0,
        share(run.wrong_shadow()),
    );
    lit.into_iter().chain(shadow).collect()
}

/// A count of ours as a share of the pixels that face the light.
fn of_facing<'a>(cell: &'a Cell<'a>, quantity: &str, count: u64) -> Vec<Bar<'a>> {
    let ours = 100.0 * count as f64 / cell.run.pixels.facing_light as f64;
    let bar = bar(&cell.run.preset, (cell.run, quantity), 1.0, Some(ours));
    bar.into_iter().collect()
}

fn tracer<'a>(cell: &'a Cell<'a>) -> Vec<Bar<'a>> {
    let is_tracer = cell.run.preset == TRACER;
    let bar = is_tracer.then(|| bar(TRACER, (cell.run, SUM), 1.0, cell.measured.steps_ms()));
    let bar = bar
        .flatten()
        .filter(|bar| bar.theirs > 0.0 && bar.ours > 0.0);
    bar.into_iter().collect()
}

fn step<'a>(cell: &'a Cell<'a>, name: &str) -> Vec<Bar<'a>> {
    let ours = |of: &Measured| of.step_ms(name);
    of_tracer(cell, [&format!("ms.{name}"), SUM], ours, |of: &Measured| {
        of.steps_ms()
    })
}

/// A quantity as a share of one of the tracer, theirs and ours, percent.
fn of_tracer<'a>(
    cell: &'a Cell<'a>,
    [quantity, whole]: [&str; 2],
    ours: impl Fn(&Measured) -> Option<f64>,
    our_whole: impl Fn(&Measured) -> Option<f64>,
) -> Vec<Bar<'a>> {
    let bar = || {
        let (tracer, measured) = cell.tracer?;
        let whole = published(tracer, whole)?.value / 100.0;
        let ours = 100.0 * ours(cell.measured)? / our_whole(measured)?;
        bar(&cell.run.preset, (cell.run, quantity), whole, Some(ours))
    };
    bar().into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::results as sample;
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
            .find(|(known, _)| *known == name)
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
            panel("D", "wrongly lit", [8.41, 6.47]),
            panel("ours", "wrongly lit", [wrong; 2]),
        ];
        assert_eq!(panels(&charts, "wrong-by-map"), expected);
        // One of two passes of the same length.
        let expected = [
            panel("D", "crsm", [55.4, 50.0]),
            panel("ours", "crsm", [50.0; 2]),
        ];
        assert_eq!(panels(&charts, "create-shadow-map"), expected);
        let expected = [
            panel("D", "crsm", [50.0; 2]),
            panel("ours", "crsm", [100.0; 2]),
        ];
        assert_eq!(panels(&charts, "frames-per-second"), expected);
        let names: Vec<&str> = charts.charts.iter().map(|(name, _)| *name).collect();
        assert_eq!(
            names,
            ["wrong-by-map", "create-shadow-map", "frames-per-second"]
        );
        let notes = &charts.charts[1].1.notes;
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
        let [("rt-by-viewport", figure)] = &charts.charts[..] else {
            panic!("{:?}", charts.charts)
        };
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
            let names: Vec<&str> = charts.charts.iter().map(|(name, _)| *name).collect();
            assert_eq!(names, ["wrong-by-map"]);
            let line = "not drawn: fill-rays: no two map sizes of which there are figures on both \
                        sides";
            assert!(
                charts.left_out.iter().any(|told| told == line),
                "{:?}",
                charts.left_out
            );
        }
    }

    #[test]
    fn other_viewports_are_not_asked_for() {
        let charts = draw(&[kept()], &[], "D", Some([1, 1]));
        assert!(charts.charts.is_empty());
        let here = draw(&[kept()], &[], "D", Some([512, 256]));
        assert_eq!(here.charts.len(), 3);
    }
}
