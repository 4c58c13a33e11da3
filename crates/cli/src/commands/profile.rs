//! `skiagraph profile`: graphs over many frames.

use crate::args::commands::ProfileArgs;
use crate::args::shared::GpuArgs;
use crate::args::values::{Size, unique};
use crate::error::CliError;
use crate::files::json;
use crate::files::write::{check_writable, write_whole};
use crate::graphs::openings;
use crate::graphs::variants;
use crate::graphs::{method, preset};
use crate::measuring::scene_selection::SceneSelection;
use crate::measuring::{device, profiling};
use crate::records::profile::Profile;
use crate::records::read_back;
use crate::records::samples::TimedFrame;
use crate::reporting::profile_csv::to_csv;
use crate::reporting::profile_text::{matrices, report};
use crate::reporting::trace::trace;
use crate::terminal::console::{note, print};
use crate::terminal::interrupt;
use std::{path::Path, sync::Arc};

/// Times graphs, prints what it measured, and writes what was asked for.
///
/// # Errors
/// A faulty graph or baseline, a scene that cannot be loaded, no GPU, Ctrl-C, a file that cannot be
/// written.
pub fn profile(args: &ProfileArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    check_writable(&files(args))?;
    let old = match &args.baseline {
        Some(path) => Some((path.as_path(), read_back::profile(path)?)),
        None => None,
    };
    let sources = preset::sources();
    let (arguments, params) = openings::arguments(&args.presets, &args.params, &sources)?;
    let presets = preset::load_all(&variants::presets(&arguments), &sources)?;
    let methods = method::methods(&presets, &arguments, &params, &args.map_size)?;
    method::note_without_map(&methods, &args.map_size);
    let gpu = device::open(gpu, preset::graphs(&presets))?;
    let SceneSelection { scene, views } = SceneSelection::load(&args.scene)?;
    let viewports = unique(&args.size);
    let planned = methods.len() * views.len() * viewports.len();
    check_single(args, planned)?;
    interrupt::install()?;
    let scene = Arc::new(scene);
    let mut profiles: Vec<Profile> = Vec::new();
    let mut timed = Vec::new();
    for method in methods {
        let method = method.settled(gpu.device.features());
        for view in &views {
            for &Size(viewport) in &viewports {
                let method = method.at(viewport);
                let mut profile;
                (profile, timed) = match profiling::profile(args, &gpu, &method, &scene, view) {
                    Err(CliError::Interrupted { .. }) if !profiles.is_empty() => {
                        return interrupted(args, &profiles, planned);
                    }
                    measured => measured?,
                };
                let old = old.as_ref();
                profile.baseline = old.map(|(path, old)| profile.against(path, old));
                let is_whole = timed.len() >= args.frames as usize;
                profiles.push(profile);
                if !is_whole && planned > 1 {
                    return interrupted(args, &profiles, planned);
                }
            }
        }
    }
    show(&profiles)?;
    let written = write(args, &profiles, &timed)?;
    if timed.len() < args.frames as usize {
        return Err(CliError::Interrupted {
            kept: format!(
                "the figures are of the {} of {} frames that were timed{written}",
                timed.len(),
                args.frames
            ),
        });
    }
    Ok(())
}

/// One in full, several as tables beside each other.
fn show(profiles: &[Profile]) -> Result<(), CliError> {
    match profiles {
        [profile] => print(&report(profile)),
        all => print(&matrices(all)),
    }
}

/// Shows and writes what there is.
fn interrupted(args: &ProfileArgs, profiles: &[Profile], planned: usize) -> Result<(), CliError> {
    show(profiles)?;
    let written = write(args, profiles, &[])?;
    Err(CliError::Interrupted {
        kept: format!(
            "{} of {planned} profiles are shown{written}",
            profiles.len()
        ),
    })
}

/// Refuses files that hold one profile where there are several.
fn check_single(args: &ProfileArgs, planned: usize) -> Result<(), CliError> {
    let single = [
        ("--json", args.json.is_some()),
        ("--trace", args.trace.is_some()),
        ("--baseline", args.baseline.is_some()),
    ];
    match single.iter().find(|(_, is_given)| *is_given) {
        Some((name, _)) if planned > 1 => Err(CliError::Usage(format!(
            "{name} is of one profile, and {planned} are asked for; name one method, view and \
             size, or take --csv, which holds them all"
        ))),
        _ => Ok(()),
    }
}

/// The files to write, each with the argument that names it.
fn files(args: &ProfileArgs) -> Vec<(String, &Path)> {
    let files = [
        ("--csv", &args.csv),
        ("--json", &args.json),
        ("--trace", &args.trace),
    ];
    let given = files
        .into_iter()
        .filter_map(|(name, path)| Some((name.to_owned(), path.as_deref()?)));
    given.collect()
}

/// Writes the files; returns what to say about them.
fn write(
    args: &ProfileArgs,
    profiles: &[Profile],
    timed: &[TimedFrame],
) -> Result<String, CliError> {
    if let Some(path) = &args.csv {
        let csv = to_csv(profiles).map_err(|error| CliError::write(path, error))?;
        write_whole(path, csv.as_bytes())?;
    }
    let single = profiles.first().filter(|_| profiles.len() == 1);
    if let Some((path, profile)) = args.json.as_ref().zip(single) {
        write_whole(path, json::to_text(profile).as_bytes())?;
    }
    if let Some((path, profile)) = args.trace.as_ref().zip(single) {
        write_whole(path, trace(&profile.conditions, timed).as_bytes())?;
    }
    let names: Vec<String> = files(args)
        .iter()
        .map(|(_, path)| path.display().to_string())
        .collect();
    if names.is_empty() {
        return Ok(String::new());
    }
    note(&format!("wrote {}", names.join(", ")));
    Ok(format!("; so are {}", names.join(", ")))
}
