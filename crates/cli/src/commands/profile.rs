//! `skiagraph profile`: times the passes of graphs over many frames.

use crate::args::commands::ProfileArgs;
use crate::args::shared::{GpuArgs, SweepArgs};
use crate::commands::loaded::note_without_map;
use crate::error::CliError;
use crate::scene_selection::SceneSelection;
use crate::terminal::console::{note, print};
use crate::terminal::{Terminal, interrupt, stop};
use itertools::Itertools;
use skiagraph_compare::error::CompareError;
use skiagraph_compare::files::json;
use skiagraph_compare::files::write::{check_writable, write_whole};
use skiagraph_compare::graphs::{faults::refusal, method, preset};
use skiagraph_compare::lists::unique;
use skiagraph_compare::measuring::{device, profiling};
use skiagraph_compare::pictures::run_pictures::conditions;
use skiagraph_compare::records::profile::Profile;
use skiagraph_compare::records::read_back;
use skiagraph_compare::records::samples::TimedFrame;
use skiagraph_compare::sink::Session;
use skiagraph_compare::size::Size;
use skiagraph_report::profile_csv::to_csv;
use skiagraph_report::profile_text::{matrices, report};
use skiagraph_report::trace::trace;
use std::{path::Path, sync::Arc};

/// Times graphs, prints the profiles, and writes the files that the arguments name.
///
/// # Errors
/// If a graph or a baseline is faulty, a scene cannot be loaded, no GPU can be opened, Ctrl-C stops
/// the command, or a file cannot be written.
pub async fn profile(args: &ProfileArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    check_writable(&files(args))?;
    let read = |path| Ok::<_, CliError>((path, read_back::profile(path)?));
    let old = args.baseline.as_deref().map(read).transpose()?;
    let (timing, SweepArgs { map_size, params }) = (&args.timing, &args.timing.sweep);
    let sources = preset::sources(&Terminal);
    let methods = method::load(&args.presets, params, map_size, &sources, preset::load_each)?;
    note_without_map(&methods, map_size);
    let graphs = methods.iter().map(|method| &method.preset.graph);
    let gpu = device::open(&gpu.request(), graphs)?;
    let session = Session::new(&gpu, &Terminal);
    let SceneSelection { scene, views, .. } = SceneSelection::load(&args.scene)?;
    let viewports = unique(timing.size.iter().map(|Size(size)| *size));
    let planned = methods.len() * views.len() * viewports.len();
    check_single(args, planned)?;
    interrupt::install()?;
    let scene = Arc::new(scene);
    let mut profiles: Vec<Profile> = Vec::new();
    let mut timed = Vec::new();
    let (mut unavailable, mut mistakes) = (Vec::new(), Vec::new());
    let features = gpu.device.features();
    let settled = methods.into_iter().map(|method| method.settled(features));
    let places = views.iter().cartesian_product(viewports);
    for (method, (view, viewport)) in settled.collect_vec().iter().cartesian_product(places) {
        let (method, count) = (method.at(viewport), [timing.warmup, timing.frames]);
        let mut profile;
        (profile, timed) = match profiling::profile(session, count, &method, &scene, view).await {
            Err(CompareError::Interrupted { .. }) if !profiles.is_empty() && stop::raised() => {
                return interrupted(args, &profiles, planned);
            }
            Err(error) if planned > 1 && !error.ends_all() => {
                let (reason, is_mistake) = refusal(&error);
                let place = conditions(&method, &view.name, viewport);
                unavailable.push(format!("n/a: {}, {place}: {reason}\n", method.name));
                let text = format!("`{}` cannot run: {reason}", method.name);
                mistakes.extend(is_mistake.then_some(text));
                continue;
            }
            measured => measured?,
        };
        let old = old.as_ref();
        profile.baseline = old.map(|(path, old)| profile.against(path, old));
        let is_whole = timed.len() >= timing.frames as usize;
        profiles.push(profile);
        if is_whole {
            let (args, profiles) = (args.clone(), profiles.clone());
            interrupt::on_end_in_the_middle(move || interrupted(&args, &profiles, planned));
        } else if stop::raised() && planned > 1 {
            return interrupted(args, &profiles, planned);
        }
    }
    if profiles.is_empty() {
        let text = format!("nothing can run\n{}", unavailable.concat());
        return Err(CliError::Input(text.trim_end().into()));
    }
    stop::take_end();
    show(&profiles)?;
    print(&unavailable.concat())?;
    let written = write(args, &profiles, &timed)?;
    if timed.len() < timing.frames as usize {
        let done = format!("{} of {} frames", timed.len(), timing.frames);
        let kept = format!("the figures are of the {done} that were timed{written}");
        return Err(CliError::Interrupted { kept });
    }
    match &unique(mistakes)[..] {
        [] => Ok(()),
        mistakes => Err(CliError::Judged(mistakes.join("\nerror: "))),
    }
}

/// One in full, several as tables beside each other.
fn show(profiles: &[Profile]) -> Result<(), CliError> {
    match profiles {
        [profile] => print(&report(profile)),
        profiles => print(&matrices(profiles)),
    }
}

/// Shows and writes what there is.
fn interrupted(args: &ProfileArgs, profiles: &[Profile], planned: usize) -> Result<(), CliError> {
    show(profiles)?;
    let (written, count) = (write(args, profiles, &[])?, profiles.len());
    let kept = format!("{count} of {planned} profiles are shown{written}");
    Err(CliError::Interrupted { kept })
}

/// Refuses files that hold one profile where there are several.
fn check_single(args: &ProfileArgs, planned: usize) -> Result<(), CliError> {
    let given = [&args.json, &args.trace, &args.baseline].map(Option::is_some);
    let mut single = ["--json", "--trace", "--baseline"].iter().zip(given);
    match single.find(|(_, is_given)| *is_given) {
        Some((name, _)) if planned > 1 => Err(CliError::Usage(format!(
            "{name} is of one profile, and {planned} are asked for; name one method, view and \
             size, or take --csv, which holds them all"
        ))),
        _ => Ok(()),
    }
}

/// The files to write, each with the argument that names it.
fn files(args: &ProfileArgs) -> Vec<(String, &Path)> {
    let names = ["--csv", "--json", "--trace"].into_iter();
    let files = names.zip([&args.csv, &args.json, &args.trace]);
    let given = files.filter_map(|(name, path)| Some((name.to_owned(), path.as_deref()?)));
    given.collect()
}

/// Writes the files; returns what to say about them.
fn write(
    args: &ProfileArgs,
    profiles: &[Profile],
    timed: &[TimedFrame],
) -> Result<String, CliError> {
    if let Some(path) = &args.csv {
        let csv = to_csv(profiles).map_err(|error| CompareError::write(path, error))?;
        write_whole(path, csv.as_bytes())?;
    }
    let single = profiles.first().filter(|_| profiles.len() == 1);
    if let Some((path, profile)) = args.json.as_ref().zip(single) {
        write_whole(path, json::to_text(profile).as_bytes())?;
    }
    if let Some((path, profile)) = args.trace.as_ref().zip(single) {
        write_whole(path, trace(&profile.conditions, timed).as_bytes())?;
    }
    let files = files(args);
    let names = files.iter().map(|(_, path)| path.display()).join(", ");
    if files.is_empty() {
        return Ok(names);
    }
    note(&format!("wrote {names}"));
    Ok(format!("; so are {names}"))
}
