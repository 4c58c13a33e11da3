//! Builds charts from results in folders: chooses the runs and quantities to draw.
//! `skiagraph-chart` draws them.

use crate::looks::looks;
use crate::summary::rows;
use itertools::Itertools;
use skiagraph_chart::{Figure, Kind, Mark, Panel, Series};
use skiagraph_compare::error::{CompareError, Result};
use skiagraph_compare::lists::{entry, find_or_push, place};
use skiagraph_compare::records::figure::{self, Case, Clocks};
use skiagraph_compare::records::figures;
use skiagraph_compare::records::results::Run;
use skiagraph_compare::records::sources::Kept;
use skiagraph_compare::wording::{frames, or_nothing, size};
use std::collections::BTreeSet;

const TIME: &str = "GPU ms of a frame less its G-buffer";

/// Builds the chart of time against error: a panel for each folder, viewport and light, and a mark
/// for each method and map size. The time is the GPU time of a frame without its G-buffer, in
/// milliseconds. `error` is the figure that is drawn as the error, for several views what it is
/// over them; without it the wrong pixels outside the band (the pixels whose answer rounding
/// decides), in percent of all pixels. Runs that do not have the figure are not drawn: with these
/// those whose answers are [shares of light](skiagraph_compare#terms), or whose light has an
/// extent. `viewport` (pixels) limits the chart to one viewport; `None` draws all.
///
/// # Errors
/// If a drawn run has no GPU times.
pub fn front(
    kept: &[Kept],
    viewport: Option<[u32; 2]>,
    error: Option<&figure::Figure>,
) -> Result<Figure> {
    let Some(error) = error.or_else(|| figures::named("wrong_of_all")) else {
        return Ok(Figure::default());
    };
    let maps = maps(kept, viewport);
    let mut panels = Vec::new();
    for kept in kept {
        let mut places: Vec<(_, Vec<Case>)> = Vec::new();
        for case in cases(kept, viewport).filter(|case| error.value(case).is_some()) {
            entry(&mut places, (case.run.viewport, &case.run.light)).push(case);
        }
        for (_, cases) in places {
            panels.push(front_panel(kept, &cases, error, &maps)?);
        }
    }
    let scenes = kept.iter().map(|kept| kept.results.scene.to_string());
    let mut figure = figure("Time against error", kept, panels);
    figure.sizes = named(&maps, 1);
    figure.notes.push(scenes.sorted().dedup().join("; "));
    figure.notes.push(
        "Left is faster, down is more right; where there are several views, the means of all."
            .into(),
    );
    Ok(figure)
}

/// The runs of a folder that are drawn.
fn cases(kept: &Kept, viewport: Option<[u32; 2]>) -> impl Iterator<Item = Case<'_>> {
    let clocks = Clocks::new(&kept.results);
    let runs = kept.results.runs.iter();
    let runs = runs.filter(move |run| is_drawn(run, viewport));
    runs.map(move |run| clocks.case(run))
}

/// A figure of these panels. Methods look the same in all of the same results.
fn figure(title: &str, kept: &[Kept], panels: Vec<Panel>) -> Figure {
    let runs = kept.iter().flat_map(|kept| &kept.results.runs);
    Figure {
        title: title.into(),
        notes: conditions(kept),
        looks: looks(runs.map(|run| run.preset.clone())),
        columns: panels.len().clamp(1, 2),
        panels,
        ..Figure::default()
    }
}

/// Edges of the maps that are drawn, in texels, the smallest first.
fn maps(kept: &[Kept], viewport: Option<[u32; 2]>) -> Vec<u32> {
    let runs = kept.iter().flat_map(|kept| &kept.results.runs);
    let maps = runs.filter(|run| is_drawn(run, viewport));
    let maps = maps.filter_map(|run| run.map_size).sorted().dedup();
    maps.collect()
}

/// Names of the sizes of marks.
fn named(maps: &[u32], least: usize) -> Vec<String> {
    let named = maps.iter().filter(|_| maps.len() >= least);
    named.map(|map| format!("map {map}²")).collect()
}

/// Size of the marks of a run: the place of its map among these.
fn mark_size(map: Option<u32>, maps: &[u32]) -> usize {
    let place = map.and_then(|map| maps.iter().position(|size| *size == map));
    place.unwrap_or(0)
}

/// The panel of the runs of one viewport and light.
fn front_panel(kept: &Kept, cases: &[Case], error: &figure::Figure, maps: &[u32]) -> Result<Panel> {
    let mut series: Vec<Series> = Vec::new();
    let viewport = cases.first().map_or([0; 2], |case| case.run.viewport);
    for row in rows(cases.iter().copied(), viewport) {
        let Some(y) = row.over(error).and_then(|value| error.number(value)) else {
            continue;
        };
        let ms = row.number("own_ms").ok_or_else(|| no_times(kept))?;
        let spread = row.range("own_quartiles");
        let mark = Mark {
            size: mark_size(row.map_size(), maps),
            spread: spread.filter(|[low, high]| *low > 0.0 && low < high),
            ..Mark::new(ms, y)
        };
        let is_of = |series: &Series| series.name == row.method;
        let line = find_or_push(&mut series, is_of, || Series::new(&row.method, Vec::new()));
        line.marks.push(mark);
    }
    let views: BTreeSet<&str> = cases.iter().map(|case| case.run.view.as_str()).collect();
    let views = match views.first() {
        Some(view) if views.len() == 1 => format!("view {view}"),
        _ => format!("mean of {} views", views.len()),
    };
    let title = or_nothing(cases.first(), |Case { run, .. }| {
        let place = titled(&views, run.light.as_deref(), run.viewport);
        format!("{}, {place}", kept.results.scene.name)
    });
    Ok(Panel::new(Kind::Front, &title, [TIME, error.axis], series))
}

/// Names views, light and viewport of a panel.
fn titled(views: &str, light: Option<&str>, viewport: [u32; 2]) -> String {
    let light = or_nothing(light, |light| format!(", light {light}"));
    format!("{views}{light}, {}", size(viewport))
}

/// Builds the chart of time and memory against the number of triangles: two panels for each scene,
/// view, light and viewport, and a line for each method and map size. Results whose scenes have the
/// same name, such as a generated city in several sizes, share their panels. The time is the GPU
/// time of a frame without its G-buffer, in milliseconds. The memory is that of the method's own
/// textures and buffers and of the scene's data that it reads, in MB (10⁶ bytes). `viewport`
/// (pixels) limits the chart to one viewport; `None` draws all.
///
/// # Errors
/// If a drawn run has no GPU times.
pub fn growth(kept: &[Kept], viewport: Option<[u32; 2]>) -> Result<Figure> {
    let maps = maps(kept, viewport);
    let mut cells = Vec::new();
    let mut panels: Vec<[Panel; 2]> = Vec::new();
    let each = kept.iter();
    let runs = each.flat_map(|kept| cases(kept, viewport).map(move |case| (kept, case.run)));
    for (kept, run) in runs {
        let Some(measured) = &run.measured else {
            continue;
        };
        let scene = &kept.results.scene;
        let light = run.light.as_deref();
        let cell = (scene.name.as_str(), run.view.as_str(), light, run.viewport);
        let index = place(&mut cells, cell);
        if index == panels.len() {
            let place = titled(&format!("view {}", run.view), light, run.viewport);
            let title = format!("{}, {place}", scene.name);
            let panel = |y| Panel::new(Kind::Growth, &title, ["triangles", y], Vec::new());
            panels.push([panel(TIME), panel("MB of buffers and textures")]);
        }
        let size = mark_size(run.map_size, &maps);
        let bytes = measured.memory_bytes + measured.scene_bytes;
        let ms = measured.ms_without_gbuffer();
        let heights = [ms.ok_or_else(|| no_times(kept))?, bytes as f64 / 1e6];
        for (panel, y) in panels[index].iter_mut().zip(heights) {
            let x = scene.triangles as f64;
            let mark = Mark {
                size,
                ..Mark::new(x, y)
            };
            // A line for each method and map.
            let is_of = |series: &Series| {
                series.name == run.preset && series.marks.iter().all(|mark| mark.size == size)
            };
            let new = || Series::new(&run.preset, Vec::new());
            let series = find_or_push(&mut panel.series, is_of, new);
            series.marks.push(mark);
        }
    }
    let mut panels: Vec<Panel> = panels.into_iter().flatten().collect();
    for series in panels.iter_mut().flat_map(|panel| &mut panel.series) {
        series.marks.sort_by(|a, b| a.x.total_cmp(&b.x));
    }
    let mut figure = figure("Growth with the number of triangles", kept, panels);
    figure.sizes = named(&maps, 2);
    let note = "Memory is the graph's own and the scene's buffers that it reads.";
    figure.notes.push(note.into());
    Ok(figure)
}

/// Builds the chart of errors over the frames of camera paths: a panel for each folder, path, light
/// and viewport, and a line for each method and map size. The `error` is defined at
/// [`path_panels`]. `viewport` (pixels) limits the chart to one viewport; `None` draws all.
///
/// # Errors
/// If none of the runs is of a camera path, or its frames do not have the figure.
pub fn frames_of_paths(
    kept: &[Kept],
    viewport: Option<[u32; 2]>,
    error: Option<&figure::Figure>,
) -> Result<Figure> {
    let maps = maps(kept, viewport);
    let of_folder = |kept| path_panels(cases(kept, viewport), &maps, error);
    let panels: Vec<Panel> = kept.iter().flat_map(of_folder).collect();
    if panels.is_empty() {
        return Err(CompareError::Input(match error {
            Some(error) if kept.iter().any(has_path) => {
                format!("there is nothing to draw: frames have no {}", error.name)
            }
            _ => "there are no frames to draw: no run is of a camera path (compare --path)".into(),
        }));
    }
    Ok(Figure {
        sizes: named(&maps, 2),
        ..figure("Errors along camera paths", kept, panels)
    })
}

/// True if a run is of a camera path.
fn has_path(kept: &Kept) -> bool {
    figures::are_paths(&kept.results.runs.iter().collect::<Vec<_>>())
}

/// Returns a panel for each camera path, light and viewport among `cases`, with a series for each
/// run and a mark for the `error` of each frame. Without a figure it is the percentage of the
/// pixels facing the light that are wrong outside the band (the pixels whose answer rounding
/// decides), under a light [with an extent](skiagraph_compare#terms) the root mean square error of
/// the [shares of light](skiagraph_compare#terms). Runs of still views are skipped. A series is
/// named after its method. The size of its marks is the index of the run's map size in `maps`
/// (texels), or 0.
pub fn path_panels<'a>(
    cases: impl Iterator<Item = Case<'a>>,
    maps: &[u32],
    error: Option<&figure::Figure>,
) -> Vec<Panel> {
    let mut paths: Vec<(_, Panel)> = Vec::new();
    for case in cases {
        let run = case.run;
        let usual = run.area.map_or("wrong", |_| "rmse");
        let Some(error) = error.or_else(|| figures::named(usual)) else {
            continue;
        };
        let Some(frames) = error.of_frames(&case) else {
            continue;
        };
        let place = (&run.view, run.light.as_deref(), run.viewport);
        let title = titled(&format!("path {}", run.view), place.1, run.viewport);
        let new = || Panel::new(Kind::Frames, &title, ["frame", error.axis], Vec::new());
        let (_, panel) = find_or_push(&mut paths, |(key, _)| *key == place, || (place, new()));
        let mark = |(index, error): (usize, f64)| Mark {
            size: mark_size(run.map_size, maps),
            about: format!("{}\nframe {index}: {error:.4}", run.method_label()),
            ..Mark::new(index as f64, error)
        };
        let marks = frames.into_iter().enumerate().map(mark).collect();
        panel.series.push(Series::new(&run.preset, marks));
    }
    paths.into_iter().map(|(_, panel)| panel).collect()
}

/// Renders a figure as the text of an SVG file.
///
/// # Errors
/// [`CompareError::Input`] with the message of an error of [`Figure::to_svg`].
pub fn svg(figure: &Figure) -> Result<String> {
    let svg = figure.to_svg();
    svg.map_err(|error| CompareError::Input(error.to_string()))
}

/// Returns a line of text for each method that could not run, with its map size and the reason;
/// equal lines once.
pub fn unavailable(kept: &[Kept]) -> BTreeSet<String> {
    let runs = kept.iter().flat_map(|kept| &kept.results.runs);
    let reasons = runs.filter_map(|run| {
        let reason = run.unavailable.as_ref()?;
        Some(format!("not drawn: {}: {reason}", run.method_label()))
    });
    reasons.collect()
}

fn is_drawn(run: &Run, viewport: Option<[u32; 2]>) -> bool {
    run.measured.is_some() && viewport.is_none_or(|wanted| wanted == run.viewport)
}

fn no_times(kept: &Kept) -> CompareError {
    let why = kept.results.adapter.gpu_unavailable.as_deref();
    let why = why.unwrap_or("the adapter gave none for a pass");
    let folder = kept.folder.display();
    CompareError::Input(format!("{folder}: there are no GPU times to draw: {why}"))
}

/// Returns lines about the measurements: one for each adapter, then one with the numbers of timed
/// frames of still views ([`Results::frames`]).
fn conditions(kept: &[Kept]) -> Vec<String> {
    let results = || kept.iter().map(|kept| &kept.results);
    let adapters = results().map(|results| results.adapter.to_string());
    let is_still = |run: &Run| run.measured.iter().any(|it| it.sequence.is_none());
    let still = results().filter(|results| results.runs.iter().any(is_still));
    let medians = still.map(|results| results.frames).sorted().dedup();
    let medians = medians.map(frames).join(" or ");
    let medians = (!medians.is_empty()).then(|| format!("Medians of {medians}"));
    adapters.sorted().dedup().chain(medians).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::results as sample;
    use skiagraph_compare::records::sequence::{FrameCost, Sequence, SequenceFrame};

    fn kept() -> Kept {
        let mut results = sample();
        // Without the run that has no GPU times.
        results.runs.remove(1);
        Kept {
            folder: "out".into(),
            results,
        }
    }

    #[test]
    fn a_mark_is_the_frame_less_its_gbuffer_and_the_share_of_all_pixels() {
        let mut kept = kept();
        let mut second = kept.results.runs[0].clone();
        second.view = "side".into();
        let measured = second.measured.as_mut().unwrap();
        (measured.wrong.total, measured.wrong.in_band) = (6, 6);
        kept.results.runs.insert(1, second);
        let figure = front(&[kept], None, None).unwrap();
        let [panel] = &figure.panels[..] else {
            panic!("{figure:?}")
        };
        assert_eq!(panel.title, "park, mean of 2 views, 512x256");
        let [nsm] = &panel.series[..] else {
            panic!("{panel:?}")
        };
        // 1.5 ms a frame, 0.375 ms of it the G-buffer; 503 wrong, 6 of them in the band, and none.
        let share = 100.0 * 497.0 / (2.0 * 512.0 * 256.0);
        let mark = Mark {
            spread: nsm.marks[0].spread,
            ..Mark::new(1.125, share)
        };
        assert!(
            mark.spread
                .is_some_and(|[low, high]| low < 1.125 && 1.125 < high)
        );
        assert_eq!((nsm.name.as_str(), &nsm.marks[..]), ("nsm", &[mark][..]));
        assert_eq!(figure.sizes, ["map 1024²"]);
    }

    #[test]
    fn an_error_of_the_list_is_drawn_with_its_axis() {
        let flip = figures::named("flip");
        let figure = front(&[kept()], None, flip).unwrap();
        let [panel] = &figure.panels[..] else {
            panic!("{figure:?}")
        };
        assert_eq!(panel.y, "FLIP error of the shaded picture");
        assert_eq!(panel.series[0].marks[0].y, 0.012);
        // Missing shadow is known of whole paths alone.
        let mut path = kept();
        let measured = path.results.runs[0].measured.as_mut().unwrap();
        measured.sequence = Some(Sequence {
            frames: Vec::new(),
            shimmer: Default::default(),
        });
        assert!(frames_of_paths(&[path.clone()], None, flip).is_ok());
        let error = frames_of_paths(&[path], None, figures::named("missing")).unwrap_err();
        let expected = "there is nothing to draw: frames have no missing";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn lights_have_panels_of_their_own() {
        let mut kept = kept();
        let mut second = kept.results.runs[0].clone();
        (kept.results.runs[0].light, second.light) = (Some("sun".into()), Some("lamp".into()));
        second.measured.as_mut().unwrap().wrong.total = 6;
        kept.results.runs.insert(1, second);
        let figure = front(std::slice::from_ref(&kept), None, None).unwrap();
        let [sun, lamp] = &figure.panels[..] else {
            panic!("{figure:?}")
        };
        assert_eq!(sun.title, "park, view main, light sun, 512x256");
        assert_eq!(lamp.title, "park, view main, light lamp, 512x256");
        let wrong = |panel: &Panel| panel.series[0].marks[0].y;
        assert!(wrong(sun) > 0.0 && wrong(lamp) == 0.0);
        // A light under which all answers are graded has none.
        kept.results.runs[1].measured.as_mut().unwrap().answer =
            skiagraph_compare::records::results::Answer::Graded;
        let figure = front(&[kept], None, None).unwrap();
        let titles: Vec<&str> = figure.panels.iter().map(|panel| &*panel.title).collect();
        assert_eq!(titles, [&*sun.title]);
    }

    #[test]
    fn growth_is_drawn_from_the_smallest_scene_on_with_the_scenes_memory() {
        let mut large = kept();
        large.results.scene.triangles = 1_000_000;
        let figure = growth(&[large, kept()], None).unwrap();
        let [time, memory] = &figure.panels[..] else {
            panic!("{figure:?}")
        };
        let at = |panel: &Panel| {
            let marks = panel.series[0].marks.iter();
            marks.map(|mark| (mark.x, mark.y)).collect::<Vec<_>>()
        };
        assert_eq!(at(time), [(55_000.0, 1.125), (1e6, 1.125)]);
        assert_eq!(at(memory)[0].1, 14.582_912);
    }

    #[test]
    fn a_path_has_a_panel_and_a_method_a_line_of_its_frames() {
        let mut kept = kept();
        assert!(frames_of_paths(&[], None, None).is_err());
        let frame = |wrong_outside_band: u64| SequenceFrame {
            facing_light: 1_000,
            wrong: wrong_outside_band + 5,
            wrong_outside_band,
            graded: Default::default(),
            rays: None,
            cost: FrameCost {
                cpu_ms: 0.0,
                gpu_ms: None,
                wall_ms: 1.0,
            },
            shimmer: None,
            skipped: Vec::new(),
            remade: Vec::new(),
        };
        let run = &mut kept.results.runs[0];
        run.measured.as_mut().unwrap().sequence = Some(Sequence {
            frames: [0, 30, 7].map(frame).to_vec(),
            shimmer: Default::default(),
        });
        let mut other = run.clone();
        other.preset = "pcf".into();
        kept.results.runs.insert(1, other);
        let figure = frames_of_paths(&[kept], None, None).unwrap();
        let [panel] = &figure.panels[..] else {
            panic!("{figure:?}")
        };
        assert_eq!(panel.title, "path main, 512x256");
        let names: Vec<&str> = panel.series.iter().map(|line| line.name.as_str()).collect();
        assert_eq!(names, ["nsm", "pcf"]);
        let marks = panel.series[0].marks.iter().map(|mark| [mark.x, mark.y]);
        assert_eq!(
            marks.collect::<Vec<_>>(),
            [[0.0, 0.0], [1.0, 3.0], [2.0, 0.7]]
        );
        assert!(svg(&figure).is_ok());
    }

    #[test]
    fn what_is_not_drawn_is_told() {
        assert!(
            front(&[kept()], Some([1, 1]), None)
                .unwrap()
                .panels
                .is_empty()
        );
        let lines: Vec<String> = unavailable(&[kept()]).into_iter().collect();
        assert_eq!(lines, ["not drawn: rt_hw: needs ray queries, \"not\" here"]);
        let without = Kept {
            folder: "out".into(),
            results: sample(),
        };
        let error = front(&[without], None, None).unwrap_err().to_string();
        assert!(error.starts_with("out: there are no GPU times"), "{error}");
    }
}
