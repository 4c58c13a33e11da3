//! Writes the notes below tables of results.

use crate::graded::{area_reference, graded};
use itertools::Itertools;
use skiagraph_compare::records::results::{AreaReference, Machine, Results, Run};
use skiagraph_compare::records::sequence::Sequence;
use skiagraph_compare::records::steady::EarlyPicture;
use skiagraph_compare::wording::{frames, ms, percent, plural, thousands};
use skiagraph_reference::{BlockerCounts, PixelCounts, Quantiles};

/// The band is too large if more than one in this many of the pixels that face the light lie in it.
const MAX_BAND: u128 = 1000;

/// Returns a warning if the band (the pixels whose answer rounding decides) of a run's view and
/// viewport exceeds 0.1 % of the pixels that face the light; `None` otherwise.
pub fn band_warning(run: &Run) -> Option<String> {
    let is_large = u128::from(run.band) * MAX_BAND > u128::from(run.pixels.facing_light);
    let text = "warning: the band is larger than 0.1 % of PFL; what lies in it is not proven";
    is_large.then(|| text.to_owned())
}

/// Returns a warning if the machine's load was half of its logical processors or more when the
/// comparison began, so that other programs slowed down the times; `None` otherwise.
pub fn load_warning(machine: &Machine) -> Option<String> {
    let load = machine.load.filter(|_| machine.is_loaded())?;
    let cores = plural(machine.cores as usize, "core");
    Some(format!(
        "warning: the machine was busy when this began (load {load:.1} on {cores}): times have a \
         wide spread; ratios of methods that took turns suffer the least"
    ))
}

/// Returns the [notes on the scene](Results::notes) as lines that say so; warnings stay as they
/// are.
pub fn scene_notes(results: &Results) -> impl Iterator<Item = String> {
    results.notes.iter().map(|note| match note.as_str() {
        note if note.starts_with("warning: ") => note.to_owned(),
        note => format!("scene: {note}"),
    })
}

/// Returns a warning if the GPU rasterised `wrong_surface` of these pixels with a surface that
/// another one hides; `None` if there are no such pixels. Methods are judged on the rasterised
/// surface.
pub fn surface_warning(wrong_surface_count: u64, pixels: &PixelCounts) -> Option<String> {
    let total = pixels.background + pixels.facing_away + pixels.facing_light;
    let text = || format!("warning: {}", wrong_surface(wrong_surface_count, total));
    (wrong_surface_count > 0).then(text)
}

/// Returns two lines: the counts of pixels by the [reference](skiagraph_compare#terms), and the
/// doubt about its answers. `band` is the number of pixels in the band, whose answer rounding
/// decides.
pub fn pixels(counts: &PixelCounts, area: Option<&AreaReference>, band: u64) -> String {
    let doubt = match area {
        Some(area) => area_reference(area, band),
        None => {
            let (band, share) = (thousands(band), percent(band, counts.facing_light));
            format!("in the band, where the answer hangs on rounding: {band} ({share} of PFL)")
        }
    };
    let facing = thousands(counts.facing_light);
    let [lit, shadow] = [counts.lit, counts.shadow].map(thousands);
    let [away, background] = [counts.facing_away, counts.background].map(thousands);
    format!(
        "facing the light (PFL) {facing} = lit {lit} + shadow {shadow} · facing away {away} · \
         background {background}\n{doubt}"
    )
}

/// Returns the sentence that the GPU rasterised `count` of `total` pixels with a surface that
/// another one hides.
pub fn wrong_surface(count: u64, total: u64) -> String {
    let [count, total] = [count, total].map(thousands);
    format!(
        "{count} of {total} pixels show a surface that another one hides, or none where there is \
         one; every method is judged on the surface that is shown"
    )
}

/// Describes the texels of a run's shadow map per pixel, and how errors of neighbouring pixels
/// differ between the map's layers. Returns `None` if the run has no measurements of texels.
pub fn map_figures(run: &Run) -> Option<String> {
    let measured = run.measured.as_ref()?;
    let texels = measured.texels.as_ref()?;
    let range = |it: &Quantiles| format!("{} to {}", digits(it.p5), digits(it.p95));
    let [whole, perspective, projection] =
        [&texels.texels, &texels.perspective, &texels.projection].map(range);
    let median = digits(texels.texels.median);
    let under_one = percent(texels.under_one, texels.pixels);
    let mut text = format!(
        "texels per pixel: median {median}, nine tenths of the pixels {whole}; by distance and \
         map {perspective}, by angles × {projection}; under one in {under_one}"
    );
    if texels.outside_map > 0 {
        text += &format!("; outside the map {}", thousands(texels.outside_map));
    }
    if let Some(jump) = &measured.layer_jump {
        let (across, elsewhere) = (jump.across, jump.elsewhere);
        let pairs = plural(jump.pairs as usize, "pair");
        text += &format!(
            ". Neighbours differ in error by {across:.4} across layers ({pairs}), by \
             {elsewhere:.4} elsewhere"
        );
    }
    Some(text)
}

/// A number with three significant digits.
fn digits(number: f64) -> String {
    let behind = 2.0 - number.abs().max(1e-6).log10().floor();
    format!("{number:.*}", behind.max(0.0) as usize)
}

/// Returns a line for each method that was wrong on pixels that it called certain by its output
/// `status`: the number of these pixels outside of the band, and how many of them each kind of
/// caster shades. Runs of a method in the same setting must be consecutive; all its map sizes share
/// one line.
pub fn certain_wrong(runs: &[Run]) -> Vec<String> {
    let wrong = |run| Some((run, certain_wrong_of(run)?));
    let methods = runs.chunk_by(|one, other| one.preset == other.preset);
    let lines = methods.filter_map(|runs| {
        let (runs, counts): (Vec<&Run>, Vec<_>) = runs.iter().filter_map(wrong).unzip();
        Some(format!("{}: {}", maps(&runs)?, blocked_by(&counts)))
    });
    lines.collect()
}

/// Returns the number of pixels that a method called certain and got wrong outside of the band, and
/// what blocks their light; `None` if there are none, or if shares of light are compared.
pub fn certain_wrong_of(run: &Run) -> Option<(u64, BlockerCounts)> {
    let measured = run.measured.as_ref().filter(|_| run.is_hard())?;
    let blockers = measured.certain_wrong_blockers.unwrap_or_default();
    let certain = measured.wrong.certain;
    (certain > 0).then_some((certain, blockers))
}

/// Names a setting of params that makes most of a run's wrong pixels right; `None` if none was
/// found.
pub fn hint(run: &Run) -> Option<String> {
    let hint = run.measured.as_ref()?.hint.as_ref()?;
    let (label, words, set) = (run.method_label(), hint.cause.words(), &hint.set);
    let [part, wrong, then] = [hint.explained, hint.wrong, hint.wrong_then].map(thousands);
    Some(format!(
        "{label}: {part} of {wrong} wrong pixels {words}: try {set}, with which {then} are wrong \
         here (--tune searches further)"
    ))
}

/// A method with those of its maps that the runs are of; `None` without runs.
fn maps(runs: &[&Run]) -> Option<String> {
    let preset = &runs.first()?.preset;
    let maps = runs.iter().filter_map(|run| run.map_size).join(" / ");
    Some(match maps.as_str() {
        "" => preset.clone(),
        maps => format!("{preset} {maps}"),
    })
}

/// The kinds of blocker, as notes name them.
type Kind = (&'static str, fn(&BlockerCounts) -> u64);
const KINDS: [Kind; 3] = [
    ("blocker in an open part", |by| by.open_part),
    ("blocker in a closed part", |by| by.closed_part),
    ("no blocker", |by| by.none),
];

/// Describes how many pixels methods called certain but got wrong, and the kinds of casters that
/// block the light there. `counts` has an entry for each run: the number of these pixels, and the
/// split of this number by kind of caster. Kinds that no run has are left out.
pub fn blocked_by(counts: &[(u64, BlockerCounts)]) -> String {
    let phrase = |name: &str, count: &dyn Fn(&(u64, BlockerCounts)) -> u64| {
        let counts: Vec<u64> = counts.iter().map(count).collect();
        let any = counts.iter().any(|&count| count > 0);
        any.then(|| format!("{name} {}", counts.into_iter().map(thousands).join(" / ")))
    };
    let certain = phrase("certain wrong outside the band", &|(wrong, _)| *wrong);
    let kinds = KINDS.map(|(name, pick)| phrase(name, &|(_, by)| pick(by)));
    [certain].into_iter().chain(kinds).flatten().join(", ")
}

/// Returns the notes on runs of `results`, a line each: certain but wrong pixels, [shares of
/// light](skiagraph_compare#terms), steady states, costs of camera paths, and missing GPU times if
/// the adapter measures them.
pub fn of_runs(results: &Results, runs: &[Run]) -> Vec<String> {
    let mut notes = certain_wrong(runs);
    notes.extend(graded(runs));
    notes.extend(runs.iter().filter_map(remembering));
    notes.extend(runs.iter().flat_map(path_costs));
    if results.adapter.gpu_unavailable.is_none() {
        notes.extend(runs.iter().filter_map(times_missing));
    }
    notes
}

/// Describes the steady state in which a method that reuses results of earlier frames was judged:
/// after how many frames its picture repeats, and its errors then. `None` for other methods.
pub fn remembering(run: &Run) -> Option<String> {
    let measured = run.measured.as_ref()?;
    let steady = measured.steady.as_ref()?;
    let name = run.method_label();
    let after = frames(steady.frames);
    let state = match steady.period {
        Some(1) => format!("its picture stays the same after {after}"),
        Some(period) => format!("its picture repeats every {} after {after}", frames(period)),
        None => format!("its picture does not repeat within {after}"),
    };
    let early = |picture: &EarlyPicture| {
        let (rmse, flip, frames) = (picture.rmse, picture.flip, picture.frames);
        let wrong = thousands(picture.wrong_outside_band);
        format!("{wrong} (RMSE {rmse:.4}, FLIP {flip:.4}) after {frames}")
    };
    let early = steady.begin.iter().map(early).format(", ");
    let line = match steady.judged {
        None => format!("{name} remembers, and stood at the path's begin before: {state}"),
        Some(cycle) if cycle.pictures == 1 => {
            format!("{name} remembers: {state}, and is judged then")
        }
        Some(cycle) => {
            let (count, wrong, rmse) = (cycle.pictures, cycle.wrong_mean, cycle.rmse_mean);
            let (worst, worst_rmse) = (thousands(measured.wrong.total), measured.graded.rmse);
            format!(
                "{name} remembers: {state}; it is ranked by the mean of {count} pictures then, \
                 {wrong:.1} wrong pixels and RMSE {rmse:.5}; the worst has {worst} and \
                 {worst_rmse:.5}"
            )
        }
    };
    Some(if steady.begin.is_empty() {
        line
    } else {
        format!("{line}; from empty memory, wrong outside the band: {early} frames")
    })
}

/// Describes the slowest frame of a camera path, and the CPU times of building scene resources
/// again. Each entry is a line. The list is empty for a still view.
pub fn path_costs(run: &Run) -> Vec<String> {
    let measured = run.measured.as_ref();
    let sequence = measured.and_then(|measured| measured.sequence.as_ref());
    let slowest = sequence.and_then(Sequence::slowest).map(|(index, cost)| {
        let clock = cost.gpu_ms.map_or("wall", |_| "GPU and CPU");
        let (label, time) = (run.method_label(), ms(cost.ms()));
        format!("{label}: slowest frame {index}, {time} ms ({clock})")
    });
    let remade = sequence.and_then(|sequence| remade(run, sequence));
    slowest.into_iter().chain(remade).collect()
}

/// Lists the resources of the scene that followed from what moves.
fn remade(run: &Run, sequence: &Sequence) -> Option<String> {
    let frames = sequence.frames.len();
    let remade = sequence.remade().into_iter();
    let mut remade = remade.map(|(name, how, count, time)| {
        format!("{name} {how} in {count} of {frames}, {} ms each", ms(time))
    });
    let (label, remade) = (run.method_label(), remade.join("; "));
    (!remade.is_empty()).then(|| format!("{label} between frames, on the CPU: {remade}"))
}

/// Names the GPU times that a run lacks; `None` if it lacks none, or could not run. Of an adapter
/// whose timestamps cannot be trusted it names all.
pub fn times_missing(run: &Run) -> Option<String> {
    let measured = run.measured.as_ref()?;
    let passes = measured.passes.iter();
    let passes = passes.map(|pass| (pass.name.as_str(), pass.gpu_ms.is_some()));
    let why = untimed(passes, measured.frame.gpu_ms.is_some())?;
    Some(format!("{}: {why}", run.method_label()))
}

/// Names the GPU times that are missing; `None` if none are. `passes` yields the name of each pass,
/// and true if the pass was timed; `frame` is true if the whole frame was timed.
pub fn untimed<'a>(passes: impl Iterator<Item = (&'a str, bool)>, frame: bool) -> Option<String> {
    let mut untimed = passes.filter_map(|(name, is_timed)| (!is_timed).then_some(name));
    let untimed = untimed.join(", ");
    Some(match (frame, untimed.as_str()) {
        (true, "") => return None,
        (true, _) => format!(
            "the whole frame is timed over its other passes, there are no GPU times of {untimed}"
        ),
        (false, "") => "no GPU time of the whole frame: some frames had none".into(),
        (false, _) => format!("no GPU time of the whole frame: there are none of {untimed}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::results as sample;
    use skiagraph_compare::records::steady::{Cycle, Steady};
    use skiagraph_reference::BlockerCounts;

    #[test]
    fn surfaces_that_are_not_seen_are_said() {
        let mut run = sample().runs.remove(0);
        assert_eq!(surface_warning(run.wrong_surface, &run.pixels), None);
        run.wrong_surface = 1_234;
        assert_eq!(
            surface_warning(run.wrong_surface, &run.pixels).unwrap(),
            "warning: 1,234 of 131,072 pixels show a surface that another one hides, or none where \
             there is one; every method is judged on the surface that is shown"
        );
    }

    #[test]
    fn a_busy_machine_is_told() {
        let mut machine = sample().machine;
        assert_eq!(load_warning(&machine), None);
        machine.load = Some(4.0);
        let warning = load_warning(&machine).unwrap();
        assert!(
            warning
                .starts_with("warning: the machine was busy when this began (load 4.0 on 8 cores)")
        );
        machine.load = None;
        assert_eq!(load_warning(&machine), None);
    }

    #[test]
    fn what_was_judged_of_a_method_that_remembers_is_said() {
        let mut run = sample().runs.remove(0);
        assert_eq!(remembering(&run), None);
        let mut wording = |period, pictures: Option<u32>| {
            let cycle = |pictures| Cycle {
                pictures,
                wrong_mean: 12.25,
                rmse_mean: 0.5,
                ..Cycle::default()
            };
            run.measured.as_mut().unwrap().steady = Some(Steady {
                frames: 256,
                period,
                begin: Vec::new(),
                judged: pictures.map(cycle),
            });
            let line = remembering(&run).unwrap();
            line.split_once(": ").unwrap().1.to_owned()
        };
        assert_eq!(
            wording(Some(1), Some(1)),
            "its picture stays the same after 256 frames, and is judged then"
        );
        assert_eq!(
            wording(None, Some(16)),
            "its picture does not repeat within 256 frames; it is ranked by the mean of 16 \
             pictures then, 12.2 wrong pixels and RMSE 0.50000; the worst has 503 and 0.07100"
        );
        assert_eq!(
            wording(Some(3), None),
            "its picture repeats every 3 frames after 256 frames"
        );
    }

    #[test]
    fn blockers_of_all_maps_stand_in_a_line_and_only_those_there_are() {
        let mut runs = vec![sample().runs.remove(0); 3];
        let blockers = |open_part, closed_part, none| BlockerCounts {
            open_part,
            closed_part,
            none,
        };
        let counts = [blockers(1_200, 0, 0), blockers(0, 0, 0), blockers(7, 0, 2)];
        for ((run, counts), map) in runs.iter_mut().zip(counts).zip([512, 1024, 2048]) {
            run.map_size = Some(map);
            let measured = run.measured.as_mut().unwrap();
            measured.wrong.certain = counts.open_part + counts.none;
            measured.certain_wrong_blockers = Some(counts);
        }
        assert_eq!(
            certain_wrong(&runs),
            [
                "nsm 512 / 2048: certain wrong outside the band 1,200 / 9, blocker in an open part \
                 1,200 / 7, no blocker 0 / 2"
            ]
        );
        runs.truncate(1);
        runs[0].measured.as_mut().unwrap().wrong.certain = 0;
        assert_eq!(certain_wrong(&runs), [""; 0]);
    }
}
