//! The figures of a run, all of them: each with its name, unit and value, the tables that show it,
//! how several views become one, and whether it can be limited (`--fail-if`) or drawn as an error.
//! Tables, results.csv, limits and charts are made from this list.
//!
//! ```
//! use skiagraph_compare::records::figures;
//!
//! let words: Vec<_> = figures::limited().filter_map(|figure| figure.gate.as_deref()).collect();
//! assert_eq!(words[..5], ["wrong", "missing", "false", "rmse", "flip"]);
//! assert!(figures::named("rmse").is_some_and(|figure| figure.is_in_csv));
//! ```

use crate::records::figure::Over::{Rms, Sum, Worst};
use crate::records::figure::Table::{Document, Summary, Terminal};
use crate::records::figure::Unit::{self, Bytes, Count, Ms, Percent, Plain, Rate, Text};
use crate::records::figure::{Case, Figure, Taken};
use crate::records::regimes::{Regime, When, quartiles_name, time_name, word};
use crate::records::results::{AreaReference, Measured, Part, Run};
use crate::records::sequence::SequenceFrame;
use crate::records::statistics::{FrameTimes, Spread};
use crate::records::steady::EarlyPicture;
use skiagraph_reference::{
    BlockerCounts, Distances, LayerJump, SoftErrors, TexelsPerPixel, WrongCounts,
};
use std::sync::LazyLock;

/// All figures. Those of results.csv stand in its order, on which scripts rely: new ones stand at
/// the end. Limits are listed in this order, too; tables have places of their own.
pub static FIGURES: LazyLock<Vec<Figure>> = LazyLock::new(list);

/// Head of the column with the number of wrong pixels outside the band, the pixels whose answer
/// rounding decides.
pub const WRONG: &str = "wrong outside band";

/// Returns the figure of this name.
pub fn named(name: &str) -> Option<&'static Figure> {
    FIGURES.iter().find(|figure| figure.name == name)
}

/// Returns the figures that `--fail-if` can limit, in order.
pub fn limited() -> impl Iterator<Item = &'static Figure> {
    FIGURES.iter().filter(|figure| figure.gate.is_some())
}

/// Returns the figures that charts can draw as an error, in order.
pub fn drawn() -> impl Iterator<Item = &'static Figure> {
    FIGURES.iter().filter(|figure| !figure.axis.is_empty())
}

#[allow(clippy::too_many_lines, reason = "a list may be long")]
#[rustfmt::skip] // A line each.
fn list() -> Vec<Figure> {
    let mut list = vec![
        text("adapter", |case| case.results.adapter.name.clone()),
        text("scene", |case| case.results.scene.name.clone()),
        Figure::new("triangles", Count, |case| case.results.scene.triangles),
        text("oracle", |case| case.results.oracle.clone()),
        text("preset", |case| case.run.preset.clone())
            .shown(Terminal, 0, "method").shown(Document, 0, "method"),
        text("view", |case| case.run.view.clone()),
        Figure::new("width", Count, |case| case.run.viewport[0]),
        Figure::new("height", Count, |case| case.run.viewport[1]),
        text("map_size", |case| case.run.map_size.map(|size| size.to_string()))
            .shown(Terminal, 1, "map").shown(Document, 1, "map"),
        Figure::new("background", Count, |case| case.run.pixels.background),
        Figure::new("facing_away", Count, |case| case.run.pixels.facing_away),
        Figure::new("facing_light", Count, |case| case.run.pixels.facing_light),
        Figure::new("lit", Count, |case| case.run.pixels.lit),
        Figure::new("shadow", Count, |case| case.run.pixels.shadow),
        Figure::new("band", Count, |case| case.run.band),
        count("certain_lit", |measured| measured.certain.lit)
            .shown(Document, 11, "certain lit").beside("certain_lit"),
        count("certain_shadow", |measured| measured.certain.shadow)
            .shown(Document, 12, "certain shadow").beside("certain_shadow"),
        share("certain_right", |measured| measured.split.certain_right()).not_in_csv()
            .shown(Document, 3, "certain right %").published("certain_right_percent"),
        share("uncertain", |measured| measured.uncertain).shown(Terminal, 17, "uncertain")
            .shown(Document, 4, "uncertain %").published("uncertain_percent"),
        share("certain_wrong", |measured| measured.split.certain_wrong()).not_in_csv()
            .shown(Terminal, 18, "certain wrong")
            .shown(Document, 5, "certain wrong %").published("certain_wrong_percent"),
        count("rays", |measured| measured.rays)
            .shown(Terminal, 19, "rays").shown(Document, 26, "rays").published("rays"),
        count("rays_per_frame", |measured| {
            measured.rays.map(|rays| rays as f64 / frames(measured) as f64)
        }).not_in_csv().shown(Summary, 24, "rays"),
        count("wrong_lit", |measured| measured.wrong.lit).shown(Terminal, 6, "wrong lit")
            .shown(Document, 7, "wrong lit").published("wrong_lit"),
        count("wrong_shadow", |measured| measured.wrong.shadow).shown(Terminal, 7, "wrong shadow")
            .shown(Document, 8, "wrong shadow").published("wrong_shadow"),
        part_of("wrong_lit_percent", |run, measured| {
            let WrongCounts { lit, shadow, .. } = measured.wrong;
            part(lit, (run.pixels.lit + lit).saturating_sub(shadow))
        }).not_in_csv()
            .shown(Document, 9, "wrong lit %").beside("wrong_lit_percent"),
        part_of("wrong_shadow_percent", |run, measured| {
            let WrongCounts { lit, shadow, .. } = measured.wrong;
            part(shadow, (run.pixels.shadow + shadow).saturating_sub(lit))
        }).not_in_csv()
            .shown(Document, 10, "wrong shadow %").beside("wrong_shadow_percent"),
        share("wrong_total", |measured| measured.wrong.total).shown(Terminal, 5, "wrong")
            .shown(Document, 6, "wrong %").published("wrong_percent"),
        count("wrong_certain", |measured| measured.wrong.certain),
        count("wrong_in_band", |measured| measured.wrong.in_band)
            .repeated(|cycle| (cycle.wrong_mean - cycle.wrong_outside_band_mean).ceil())
            .shown(Terminal, 8, "in band").shown(Summary, 25, "in band").over_views(Sum),
        count("wrong_outside_band", Measured::wrong_outside_band).not_in_csv()
            .repeated(|cycle| cycle.wrong_outside_band_mean.ceil())
            .shown(Summary, 0, WRONG).over_views(Sum),
        share("wrong", Measured::wrong_outside_band).not_in_csv()
            .repeated(|cycle| cycle.wrong_outside_band_mean.ceil())
            .in_frames(|_, measured| each(measured, |frame| {
                percent(frame.wrong_outside_band, frame.facing_light)
            })).of_picture(|picture, pixels| {
                percent(picture.wrong_attributable(), pixels.facing_light)
            }).shown(Summary, 1, "%").limited("wrong")
            .drawn("wrong pixels, % of those facing the light"),
        part_of("wrong_of_all", |run, measured| {
            let pixels = run.viewport.map(u64::from).iter().product::<u64>();
            let part = part(measured.wrong_outside_band(), pixels * frames(measured));
            run.is_hard().then_some(part)
        }).not_in_csv().drawn("wrong pixels outside the band, % of all"),
        part_of("missing", |run, measured| part(measured.wrong.lit, run.pixels.shadow)).not_in_csv()
            .of_picture(|picture, pixels| percent(picture.wrong.lit, pixels.shadow))
            .shown(Summary, 18, "missing").limited("missing").drawn("missing shadow, %"),
        part_of("false", |run, measured| part(measured.wrong.shadow, run.pixels.lit)).not_in_csv()
            .of_picture(|picture, pixels| percent(picture.wrong.shadow, pixels.lit))
            .shown(Summary, 19, "false").limited("false").drawn("false shadow, % of the light"),
        count("facing_mismatch", |measured| measured.facing_mismatch),
        time("steps_ms", Measured::steps_ms).not_in_csv()
            .shown(Document, 100, "sum of steps ms").beside("ms.steps"),
        measured("fps", Rate, |measured| gpu(measured, |times| 1000.0 / times.median)).not_in_csv()
            .shown(Document, 101, "fps").beside("fps"),
        time("gpu_ms", |measured| gpu(measured, |times| times.median)).shown(Terminal, 3, "GPU ms")
            .shown(Document, 102, "frame ms").published("ms.frame"),
        time("wall_ms", |measured| measured.frame.wall_ms.median).shown(Terminal, 4, "wall ms"),
        count("memory_bytes", |measured| measured.memory_bytes),
        count("saved_bytes", |measured| measured.saved_bytes),
        text("unavailable", |case| case.run.unavailable.clone()),
        count("lit_certain_right", |measured| measured.split.lit.certain_right),
        count("lit_certain_wrong", |measured| measured.split.lit.certain_wrong),
        count("lit_certain_wrong_outside_band",
            |measured| measured.split.lit.certain_wrong_outside_band),
        count("lit_uncertain", |measured| measured.split.lit.uncertain)
            .shown(Document, 13, "uncertain lit").beside("lit_uncertain"),
        count("lit_uncertain_wrong", |measured| measured.split.lit.uncertain_wrong),
        count("shadow_certain_right", |measured| measured.split.shadow.certain_right),
        count("shadow_certain_wrong", |measured| measured.split.shadow.certain_wrong),
        count("shadow_certain_wrong_outside_band",
            |measured| measured.split.shadow.certain_wrong_outside_band),
        count("shadow_uncertain", |measured| measured.split.shadow.uncertain)
            .shown(Document, 14, "uncertain shadow").beside("shadow_uncertain"),
        count("shadow_uncertain_wrong", |measured| measured.split.shadow.uncertain_wrong),
        time("gbuffer_gpu_ms", Measured::gbuffer_ms),
        time("own_ms", Measured::ms_without_gbuffer).not_in_csv()
            .shown(Summary, 23, "less G-buffer"),
        Figure::new("own_quartiles", Ms, |case| {
            let measured = case.run.measured.as_ref()?;
            let (own, gpu) = (measured.ms_without_gbuffer()?, measured.frame.gpu_ms?);
            Some([gpu.q1, gpu.q3].map(|end| own + end - gpu.median))
        }).not_in_csv(),
        count("scene_bytes", |measured| measured.scene_bytes),
        count("wrong_certain_open_part", |measured| blocked(measured, |by| by.open_part)),
        count("wrong_certain_closed_part", |measured| blocked(measured, |by| by.closed_part)),
        count("wrong_certain_no_blocker", |measured| blocked(measured, |by| by.none)),
        part_of("shimmer", |_, measured| shimmer(measured)).only(are_paths)
            .shown(Terminal, 21, "shimmer").shown(Document, 25, "shimmer %")
            .shown(Summary, 3, "shimmer"),
        count("shimmer_compared", |measured| shimmer(measured).map(|part| part.of)),
        count("worst_frame", |measured| worst(measured).map(|(index, _)| index as u64)),
        part_of("worst_frame_wrong", |_, measured| worst_wrong(measured)).only(are_paths)
            .shown(Terminal, 20, "worst frame").shown(Document, 23, "worst frame wrong %"),
        part_of("worst_wrong", |_, measured| worst_wrong(measured)).not_in_csv()
            .only(are_paths).only(|runs| !are_soft(runs))
            .shown(Summary, 2, "worst frame").over_views(Worst),
        text("answer", |case| Some(case.run.measured.as_ref()?.answer.word().to_owned()))
            .only(are_graded).shown(Terminal, 2, "answer").shown(Document, 2, "answer"),
        text("reference", |case| case.run.area.map_or("hard", |_| "area").to_owned()),
        area("reference_samples", Count, |area| area.samples.into()),
        area("reference_error_rms", Plain, |area| area.standard_error_rms),
        area("reference_error_worst", Plain, |area| area.standard_error_worst),
        area("penumbra", Count, |area| area.penumbra as f64),
        real("rmse", |measured| measured.graded.rmse).repeated(|cycle| cycle.rmse_mean)
            .in_frames(|_, measured| each(measured, |frame| frame.graded.rmse))
            .of_picture(|picture, _| picture.graded.rmse_outside_band)
            .shown(Terminal, 9, "RMSE").shown(Document, 15, "RMSE")
            .shown(Summary, 20, "RMSE").over_views(Rms).limited("rmse")
            .drawn("RMSE of the shares of light"),
        real("rmse_outside_band", |measured| measured.graded.rmse_outside_band),
        real("mean_absolute_error", |measured| measured.graded.mean_absolute_error),
        share("off_over_1_255", |measured| measured.graded.off.over_1_255),
        share("off_over_1_16", |measured| measured.graded.off.over_1_16),
        share("off_over_1_4", |measured| measured.graded.off.over_1_4),
        real("flip", |measured| measured.graded.flip).repeated(|cycle| cycle.flip_mean)
            .in_frames(|_, measured| each(measured, |frame| frame.graded.flip))
            .of_picture(|picture, _| picture.graded.flip)
            .shown(Terminal, 10, "FLIP").shown(Document, 16, "FLIP")
            .shown(Summary, 26, "FLIP").limited("flip").drawn("FLIP error of the shaded picture"),
        cost(None),
    ];
    list.extend(Regime::ALL.map(|regime| cost(Some(regime))));
    list.extend(Regime::ALL.map(|regime| quartiles(Some(regime))));
    list.extend([
        quartiles(None).shown(Summary, 21, "quartiles"),
        count("nan", |measured| measured.graded.invalid.nan),
        count("infinite", |measured| measured.graded.invalid.infinite),
        count("outside", |measured| measured.graded.invalid.outside),
        count("no_share", |measured| measured.graded.invalid.total()).not_in_csv().only(are_graded)
            .shown(Terminal, 16, "no share").shown(Document, 22, "no share"),
        count("steady_frames", |measured| measured.steady.as_ref().map(|steady| steady.frames)),
        count("steady_period", |measured| measured.steady.as_ref().map(|steady| steady.period)),
        count("slowest_frame", |measured| {
            Some(measured.sequence.as_ref()?.slowest()?.0 as u64)
        }),
        time("slowest_frame_ms", |measured| Some(measured.sequence.as_ref()?.slowest()?.1.ms())),
        real("worst_frame_rmse", |measured| worst(measured).map(|(_, frame)| frame.graded.rmse))
            .only(are_paths).only(are_graded).shown(Document, 24, "worst frame RMSE"),
        real("worst_rmse", |measured| worst(measured).map(|(_, frame)| frame.graded.rmse))
            .not_in_csv().only(are_paths).only(are_soft)
            .shown(Summary, 2, "worst frame").over_views(Worst),
        Figure::new("wrong_surface", Count, |case| case.run.wrong_surface),
        real("light_in_umbra", |measured| measured.graded.soft.light_in_umbra).only(are_graded)
            .shown(Terminal, 11, "light in umbra").shown(Document, 17, "light in umbra"),
        real("dark_in_light", |measured| measured.graded.soft.dark_in_light).only(are_graded)
            .shown(Terminal, 12, "dark in light").shown(Document, 18, "dark in light"),
        real("penumbra_rmse", |measured| penumbra(measured, |soft| soft.penumbra_rmse))
            .only(are_graded)
            .shown(Terminal, 13, "penumbra RMSE").shown(Document, 19, "penumbra RMSE"),
        real("penumbra_bias", |measured| penumbra(measured, |soft| soft.penumbra_bias))
            .only(are_graded)
            .shown(Terminal, 14, "penumbra bias").shown(Document, 20, "penumbra bias"),
        count("edge_near", |measured| measured.edges.all().near),
        real("edge_mean_pixels", |measured| edge(measured, |by| by.mean_pixels))
            .shown(Terminal, 15, "px from edge").shown(Document, 21, "px from edge"),
        real("edge_max_pixels", |measured| edge(measured, |by| by.max_pixels)),
        real("edge_mean_world", |measured| edge(measured, |by| by.mean_world)),
        real("edge_max_world", |measured| edge(measured, |by| by.max_world)),
        texels("texel_pixels", Count, |by| by.pixels as f64),
        texels("texels_under_one", Count, |by| by.under_one as f64),
        texels("texels_outside_map", Count, |by| by.outside_map as f64),
        texels("texels_p5", Plain, |by| by.texels.p5),
        texels("texels_median", Plain, |by| by.texels.median),
        texels("texels_p95", Plain, |by| by.texels.p95),
        texels("perspective_p5", Plain, |by| by.perspective.p5),
        texels("perspective_median", Plain, |by| by.perspective.median),
        texels("perspective_p95", Plain, |by| by.perspective.p95),
        texels("projection_p5", Plain, |by| by.projection.p5),
        texels("projection_median", Plain, |by| by.projection.median),
        texels("projection_p95", Plain, |by| by.projection.p95),
        layers("layer_pairs", Count, |by| by.pairs as f64),
        layers("layer_differ", Plain, |by| by.across),
        layers("layer_differ_elsewhere", Plain, |by| by.elsewhere),
        layers("layer_jump", Plain, LayerJump::jump),
        text("light", |case| case.run.light.clone()),
        text("params", |case| case.run.assignments()),
        Figure::new("frames", Count, |case| case.results.frames),
        Figure::new("warmup", Count, |case| case.results.warmup),
        Figure::new("regime_frames", Count, |case| case.results.regime_frames),
        time("gpu_min_ms", |measured| gpu(measured, |times| times.min)),
        time("gpu_q1_ms", |measured| gpu(measured, |times| times.q1)),
        time("gpu_q3_ms", |measured| gpu(measured, |times| times.q3)),
        time("gpu_p95_ms", |measured| gpu(measured, |times| times.p95)),
        time("cpu_ms", |measured| measured.frame.cpu_ms.map(|times| times.median)),
        time("wall_min_ms", |measured| measured.frame.wall_ms.min),
        time("wall_q1_ms", |measured| measured.frame.wall_ms.q1),
        time("wall_q3_ms", |measured| measured.frame.wall_ms.q3),
        time("wall_p95_ms", |measured| measured.frame.wall_ms.p95),
    ]);
    for regime in Regime::ALL {
        let name = word(Some(regime));
        let time = |clock: &str, spread: fn(&FrameTimes) -> Option<Spread>| {
            measured(format!("{name}_{clock}_ms"), Ms, move |by| {
                Some(spread(by.times(Some(regime))?)?.median)
            })
        };
        list.extend([
            time("gpu", |times| times.gpu_ms),
            time("cpu", |times| times.cpu_ms),
            time("wall", |times| Some(times.wall_ms)),
            measured(format!("{name}_uploaded_bytes"), Count, move |by| {
                let mut regimes = by.regimes.iter();
                Some(regimes.find(|times| times.regime == regime)?.uploaded_bytes)
            }),
        ]);
    }
    list.extend([
        text("backend", |case| case.results.adapter.backend.clone()),
        text("driver", |case| case.results.adapter.driver.clone()),
        text("device_type", |case| case.results.adapter.device_type.clone()),
        text("host", |case| case.machine().host.clone()),
        text("processor", |case| case.machine().processor.clone()),
        Figure::new("cores", Count, |case| case.machine().cores),
        Figure::new("load", Rate, |case| case.machine().load),
        text("date", |case| case.run.date.clone()),
        text("hour", |case| case.run.session.clone()),
        text("program", |case| case.results.program.clone()),
        text("commit", |case| case.run.commit.clone()),
        text("cell", |case| case.run.cell.clone()),
        text("fingerprint", |case| case.run.fingerprint.clone()),
        percentile(50, "p50"),
        percentile(95, "p95"),
        percentile(99, "p99"),
        percentile(100, "worst"),
        measured("memory", Bytes, |measured| {
            measured.memory_bytes + measured.scene_bytes
        }).not_in_csv().shown(Summary, 22, "memory").over_views(Worst).limited("memory"),
    ]);
    for (place, frames) in (220..).step_by(2).zip([1, 4, 16, 64]) {
        let early = |name: &str, place, error: fn(&EarlyPicture) -> f64| {
            let csv = format!("after_{frames}_{}", name.to_lowercase());
            let figure = measured(csv, Plain, move |by| {
                let mut begin = by.steady.as_ref()?.begin.iter();
                Some(error(begin.find(|picture| picture.frames == frames)?))
            });
            figure.only(remember).shown(Terminal, place, format!("{name} after {frames}"))
        };
        list.push(early("RMSE", place, |picture| picture.rmse));
        list.push(early("FLIP", place + 1, |picture| picture.flip));
    }
    list
}

fn text<T: Taken>(name: &str, value: fn(&Case) -> T) -> Figure {
    Figure::new(name, Text, value)
}

/// A figure of a method that could run.
fn measured<T: Taken>(
    name: impl Into<String>,
    unit: Unit,
    value: impl Fn(&Measured) -> T + Send + Sync + 'static,
) -> Figure {
    Figure::new(name, unit, move |case| {
        case.run.measured.as_ref().map(&value)
    })
}

fn count<T: Taken>(name: &str, value: fn(&Measured) -> T) -> Figure {
    measured(name, Count, value)
}

fn time<T: Taken>(name: &str, value: fn(&Measured) -> T) -> Figure {
    measured(name, Ms, value)
}

fn real<T: Taken>(name: &str, value: fn(&Measured) -> T) -> Figure {
    measured(name, Plain, value)
}

/// A count of pixels that is shown as a share of others.
fn part_of<T: Taken>(name: &str, value: fn(&Run, &Measured) -> T) -> Figure {
    Figure::new(name, Percent, move |case| {
        Some(value(case.run, case.run.measured.as_ref()?))
    })
}

/// A count of pixels, as a share of those that face the light.
fn share(name: &str, value: fn(&Measured) -> u64) -> Figure {
    Figure::new(name, Percent, move |case| {
        let count = value(case.run.measured.as_ref()?);
        Some(part(count, case.run.pixels.facing_light))
    })
}

/// A figure of the reference of a light with extent.
fn area(name: &str, unit: Unit, value: fn(&AreaReference) -> f64) -> Figure {
    Figure::new(name, unit, move |case| case.run.area.as_ref().map(value))
}

/// Median milliseconds of frames before which that has moved; of a path without a regime, each
/// frame has its own.
fn cost(when: When) -> Figure {
    let (place, head) = when.map_or((4, "frame ms"), |regime| (5 + regime as u16, regime.word()));
    let figure = Figure::new(time_name(when), Ms, move |case| {
        case.spread(when).map(|times| times.median)
    });
    let figure = figure.not_in_csv().limited(word(when));
    let figure = figure.shown(Summary, place, head);
    match when {
        None => figure.in_frames(|case, measured| measured.frame.costs(case.by_wall)),
        Some(_) => figure,
    }
}

/// The first and third quartile of these times.
fn quartiles(when: When) -> Figure {
    let ends = move |case: &Case| case.spread(when).map(|times| [times.q1, times.q3]);
    Figure::new(quartiles_name(when), Ms, ends).not_in_csv()
}

/// True if a method remembers.
fn remember(runs: &[&Run]) -> bool {
    any(runs, |_, measured| measured.steady.is_some())
}

/// Milliseconds that so many percent of the frames keep to.
fn percentile(percent: u8, word: &str) -> Figure {
    let figure = Figure::new(format!("frame_{word}_ms"), Ms, move |case| {
        let times = &case.run.measured.as_ref()?.frame;
        times.percentile(percent, case.by_wall)
    });
    let figure = figure.shown(Terminal, 90 + u16::from(percent), format!("{word} ms"));
    figure.over_views(Worst).limited(word)
}

/// A figure of the map's texels, where the graph tells it.
fn texels(name: &str, unit: Unit, value: fn(&TexelsPerPixel) -> f64) -> Figure {
    measured(name, unit, move |by| by.texels.as_ref().map(value))
}

/// A figure of the borders between layers, where there are any.
fn layers(name: &str, unit: Unit, value: fn(&LayerJump) -> f64) -> Figure {
    measured(name, unit, move |by| by.layer_jump.as_ref().map(value))
}

fn gpu(measured: &Measured, figure: fn(&Spread) -> f64) -> Option<f64> {
    measured.frame.gpu_ms.as_ref().map(figure)
}

fn part(count: u64, whole: u64) -> Part {
    Part { count, of: whole }
}

fn percent(count: u64, whole: u64) -> f64 {
    100.0 * count as f64 / whole.max(1) as f64
}

/// A figure of each frame of a camera path.
fn each(measured: &Measured, figure: fn(&SequenceFrame) -> f64) -> Option<Vec<f64>> {
    let frames = measured.sequence.as_ref()?.frames.iter();
    Some(frames.map(figure).collect())
}

/// Certain wrong pixels of one kind of blocker; unknown of graded answers.
fn blocked(measured: &Measured, count: fn(BlockerCounts) -> u64) -> Option<u64> {
    match measured.certain_wrong_blockers {
        Some(blockers) => Some(count(blockers)),
        None => (measured.wrong.certain == 0).then_some(0),
    }
}

/// Counts, of a camera path, answers that changed though the right ones did not, of those compared.
fn shimmer(measured: &Measured) -> Option<Part> {
    let shimmer = measured.sequence.as_ref()?.shimmer;
    Some(part(shimmer.changed, shimmer.compared))
}

/// Worst frame of a camera path.
fn worst(measured: &Measured) -> Option<(usize, &SequenceFrame)> {
    measured.sequence.as_ref()?.worst()
}

fn worst_wrong(measured: &Measured) -> Option<Part> {
    worst(measured).map(|(_, frame)| part(frame.wrong, frame.facing_light))
}

/// Frames that counts are sums of: those of a path are sums over all its frames.
fn frames(measured: &Measured) -> u64 {
    let path = measured.sequence.as_ref();
    path.map_or(1, |path| path.frames.len().max(1) as u64)
}

/// An error of the penumbra, where there is one.
fn penumbra(measured: &Measured, figure: fn(&SoftErrors) -> f64) -> Option<f64> {
    let soft = &measured.graded.soft;
    (soft.penumbra > 0).then(|| figure(soft))
}

/// A distance of wrong pixels from the edges of shadows, where there are any.
fn edge(measured: &Measured, figure: fn(&Distances) -> f64) -> Option<f64> {
    let distances = measured.edges.all();
    (distances.count > 0).then(|| figure(&distances))
}

/// True if any run has measurements along a camera path.
pub fn are_paths(runs: &[&Run]) -> bool {
    any(runs, |_, measured| measured.sequence.is_some())
}

/// True if any run has a graded answer, or a light with extent.
fn are_graded(runs: &[&Run]) -> bool {
    runs.iter().any(|run| !run.is_hard())
}

/// True if the light of any measured run has an extent.
fn are_soft(runs: &[&Run]) -> bool {
    any(runs, |run, _| run.area.is_some())
}

fn any(runs: &[&Run], is: fn(&Run, &Measured) -> bool) -> bool {
    let mut runs = runs.iter();
    runs.any(|run| run.measured.as_ref().is_some_and(|it| is(run, it)))
}
