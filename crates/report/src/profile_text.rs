//! Writes a profile as text: conditions, passes, memory, and a comparison with an older profile.

use crate::notes::untimed;
use crate::table::{or_dash, terminal};
use skiagraph_compare::graphs::variants::MAP_SIZE;
use skiagraph_compare::lists::unique;
use skiagraph_compare::records::baseline::{Comparison, Difference, Ratio, Verdict};
use skiagraph_compare::records::profile::{Conditions, Line, Material, PassProfile, Profile};
use skiagraph_compare::records::statistics::Series;
use skiagraph_compare::records::table::Table;
use skiagraph_compare::records::turns::LEAST_TURNS;
use skiagraph_compare::wording::{bytes, frames, ms, or_nothing, size};

/// Returns a profile as text for a terminal, with the comparison with an older profile if it has
/// one.
pub fn report(profile: &Profile) -> String {
    let mut text = conditions(profile);
    text += &format!("\nTimes, ms\n{}\n", times(profile));
    let wall = &profile.frame.wall_ms;
    let [min, median, p95, max] = [wall.min, wall.median, wall.p95, wall.max].map(ms);
    text += &format!(
        "Wall time from the start of encoding until the GPU was done: least {min}, median \
         {median}, p95 {p95}, greatest {max}\n"
    );
    text.extend(notes(profile).map(|note| format!("{note}\n")));
    text += &format!("\nMemory\n{}\n", memory(&profile.memory.materials));
    let [size, saved] = [profile.memory.bytes, profile.memory.saved_bytes].map(bytes);
    text += &format!("Materials take {size}; sharing saves {saved}\n");
    if let Some(baseline) = &profile.baseline {
        text.push_str(&comparison(baseline, profile));
    }
    text
}

/// Name of the line of whole frames.
const WHOLE: &str = "whole frame";

fn name_of(pass: Option<&PassProfile>) -> &str {
    pass.map_or(WHOLE, |pass| &pass.name)
}

/// Returns several profiles as text: a table for each method, with a row for each pass and a column
/// for each view, viewport and map size. Cells are median GPU times in milliseconds.
pub fn matrices(profiles: &[Profile]) -> String {
    let mut text = String::new();
    if let Some(Profile { conditions, .. }) = profiles.first() {
        let (scene, adapter, warmup) = (&conditions.scene, &conditions.adapter, conditions.warmup);
        let frames = frames(conditions.frames);
        text += &format!("{scene}\n{adapter}\n");
        text += &format!("GPU ms, medians of {frames} after {warmup} to warm up\n");
    }
    for method in unique(profiles.iter().map(|profile| &profile.conditions.preset)) {
        let columns = profiles.iter();
        let columns = columns.filter(|profile| profile.conditions.preset == *method);
        text += &format!("\n{}\n", matrix(method, &columns.collect::<Vec<_>>()));
    }
    text
}

fn matrix(method: &str, profiles: &[&Profile]) -> String {
    let head = |profile: &&Profile| {
        let Conditions { view, viewport, .. } = &profile.conditions;
        let map = profile.conditions.params.get(MAP_SIZE);
        let map = or_nothing(map, |map| format!("\nmap {map}"));
        format!("{view}\n{}{map}", size(*viewport))
    };
    let heads = [method.to_owned()].into_iter();
    let heads = heads.chain(profiles.iter().map(head));
    let passes = profiles.iter().flat_map(|profile| &profile.passes);
    let names = unique(passes.map(|pass| pass.name.as_str())).into_iter();
    let row = |name: &str| -> Vec<String> {
        let cells = profiles.iter().map(|profile| {
            let line = profile.lines().find(|(pass, ..)| name_of(*pass) == name);
            or_dash(line.and_then(|(_, gpu, _)| gpu), |gpu| ms(gpu.median))
        });
        [name.to_owned()].into_iter().chain(cells).collect()
    };
    terminal(&Table::new(heads, 1, names.chain([WHOLE]).map(row)))
}

fn times(profile: &Profile) -> String {
    let row = |(pass, gpu, cpu): Line| {
        let gpu = |pick: fn(&Series) -> f64| or_dash(gpu, |series| ms(pick(series)));
        let share = |share| format!("{:.1} %", share * 100.0);
        vec![
            name_of(pass).into(),
            pass.map_or(String::new(), |pass| pass.kind.clone()),
            gpu(|series| series.min),
            gpu(|series| series.median),
            gpu(|series| series.p95),
            gpu(|series| series.max),
            pass.map_or(String::new(), |pass| or_dash(pass.share, share)),
            ms(cpu.median),
        ]
    };
    let heads = "pass|kind|GPU min|median|p95|max|of frame|CPU median".split('|');
    terminal(&Table::new(heads, 2, profile.lines().map(row)))
}

fn notes(profile: &Profile) -> impl Iterator<Item = String> {
    let passes = profile.passes.iter();
    let passes = passes.map(|pass| (pass.name.as_str(), pass.gpu_ms.is_some()));
    let missing = match &profile.conditions.adapter.gpu_unavailable {
        Some(_) => None,
        None => untimed(passes, profile.frame.gpu_ms.is_some()).map(|why| format!("note: {why}")),
    };
    let slow = (profile.conditions.build == "debug").then(|| {
        "note: a debug build of the program, so CPU times are those of unoptimised code".to_owned()
    });
    missing.into_iter().chain(slow)
}

fn conditions(profile: &Profile) -> String {
    let conditions = &profile.conditions;
    let (program, build, date) = (&conditions.program, &conditions.build, &conditions.date);
    let (adapter, scene, warmup) = (&conditions.adapter, &conditions.scene, conditions.warmup);
    let (preset, view, asked) = (&conditions.preset, &conditions.view, conditions.frames);
    let params = conditions.params();
    let params = params.map(|(name, value)| format!("{name} = {value}"));
    let params = params.reduce(|list, param| format!("{list}, {param}"));
    let params = params.unwrap_or("none".into());
    let timed = profile.timed() as u32;
    let stopped = (timed < asked).then(|| format!(", stopped before the {asked} asked for"));
    let stopped = stopped.unwrap_or_default();
    let trust = match &adapter.gpu_unavailable {
        None => "trusted: they agree with wall time".to_owned(),
        Some(reason) => format!("not used: {reason}"),
    };
    format!(
        "{preset} on {scene} · view {view} · {}\n\
         params: {params}\n\
         {adapter}\n\
         GPU timestamps {trust}\n\
         {} after {warmup} to warm up{stopped} · {date} · {program}, {build} build\n",
        size(conditions.viewport),
        frames(timed)
    )
}

fn memory(materials: &[Material]) -> String {
    let row = |material: &Material| {
        let mut size = match material.format {
            Some(_) => size(material.size),
            None => format!("{} bytes", material.size[0]),
        };
        for (count, noun) in [(material.layers, "layers"), (material.mips, "mips")] {
            if count > 1 {
                size += &format!(", {count} {noun}");
            }
        }
        vec![
            material.name.clone(),
            material.format.clone().unwrap_or("buffer".into()),
            material.shared_with.join(", "),
            size,
            bytes(material.bytes),
        ]
    };
    let heads = "material|format|shares memory with|size|memory".split('|');
    terminal(&Table::new(heads, 3, materials.iter().map(row)))
}

fn comparison(baseline: &Comparison, new: &Profile) -> String {
    let mut text = format!("\nAgainst {}, {}\n", baseline.file, baseline.date);
    if !baseline.differences.is_empty() {
        text += "WARNING: measured under other conditions, so the ratios do not compare like with \
                 like\n";
        for Difference { what, old, new } in &baseline.differences {
            text += &format!("  {what}: then {old}, now {new}\n");
        }
    }
    let (passes, frame) = (&baseline.passes, &baseline.frame);
    let passes = passes.iter().map(|pass| (&*pass.name, pass.gpu, pass.cpu));
    let lines = passes.chain([(WHOLE, frame.gpu, frame.cpu)]);
    let gpu_lines = lines.clone();
    let gpu = gpu_lines.map(|(name, gpu, _)| ratio_row("GPU", name, gpu));
    let cpu = lines.map(|(name, _, cpu)| ratio_row("CPU", name, Some(cpu)));
    let wall = ratio_row("wall", WHOLE, Some(frame.wall));
    let rows = gpu.chain(cpu).chain([wall]);
    let heads = "pass|clock|then|now|now / then|its interval|".split('|');
    text += &format!("{}\n", terminal(&Table::new(heads, 2, rows)));
    if baseline.frame.gpu.is_none() {
        let side = new.frame.gpu_ms.as_ref().map_or("new", |_| "older");
        text += &format!("No ratio of GPU times of whole frames: the {side} profile has none\n");
    }
    let only = [("then", &baseline.only_old), ("now", &baseline.only_new)];
    for (side, names) in only.into_iter().filter(|(_, names)| !names.is_empty()) {
        text += &format!("Only {side}: {}\n", names.join(", "));
    }
    text += &format!(
        "Medians, ms; now / then is the median ratio of every frame now to every frame then, its \
         interval one of 99.9 % (Mann and\n\
         Whitney). Faster or slower: the interval lies on one side of 1, and the ratio is off 1 by \
         3 % or more. With fewer than\n\
         {LEAST_TURNS} frames there is no ratio.\n",
    );
    text
}

fn ratio_row(clock: &str, name: &str, ratio: Option<Ratio>) -> Vec<String> {
    let Some(ratio) = ratio else {
        let cells = [name, clock, "–", "–", "–", "–", ""];
        return cells.map(str::to_owned).into();
    };
    let verdict = match ratio.verdict {
        Verdict::Faster => "faster",
        Verdict::Slower => "slower",
        Verdict::Same => "same",
        Verdict::TooFewFrames => "too few frames",
    };
    vec![
        name.to_owned(),
        clock.to_owned(),
        ms(ratio.old_ms),
        ms(ratio.new_ms),
        or_dash(ratio.ratio, |ratio| format!("{ratio:.3}")),
        or_dash(ratio.low.zip(ratio.high), |(low, high)| {
            format!("{low:.3} … {high:.3}")
        }),
        verdict.to_owned(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::profile as sample;
    use skiagraph_compare::records::statistics::Series;
    use std::path::Path;

    #[test]
    fn the_report_shows_conditions_times_and_memory() {
        insta::assert_snapshot!(report(&sample()));
    }

    #[test]
    fn a_baseline_under_other_conditions_is_shown_and_warned_of() {
        let (mut old, mut new) = (sample(), sample());
        for (profile, ms) in [(&mut old, 1.0), (&mut new, 3.0)] {
            profile.passes[0].gpu_ms =
                Series::new((0..8).map(|frame| ms + 0.125 * f64::from(frame)).collect());
        }
        old.conditions.params.insert("map_size".into(), 512.into());
        old.conditions.adapter.name = "Another GPU".into();
        old.passes[1].name = "fill".into();
        new.baseline = Some(new.against(Path::new("old.json"), &old));
        let report = report(&new);
        let (_, text) = report.split_once("\nAgainst").unwrap();
        insta::assert_snapshot!(text);
    }

    #[test]
    fn untrusted_timestamps_and_an_early_stop_are_said() {
        let mut profile = sample();
        profile.conditions.adapter.gpu_unavailable =
            Some("the adapter has no timestamp queries".into());
        profile.conditions.frames = 30;
        profile.conditions.build = "debug".into();
        let report = report(&profile);
        for part in [
            "GPU timestamps not used: the adapter has no timestamp queries\n",
            "3 frames after 1 to warm up, stopped before the 30 asked for",
            "note: a debug build",
        ] {
            assert!(report.contains(part), "{report}");
        }
    }
}
