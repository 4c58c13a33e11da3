//! `skiagraph profile`: one graph over many frames.

use crate::args::commands::ProfileArgs;
use crate::args::shared::GpuArgs;
use crate::error::CliError;
use crate::files::json;
use crate::files::write::{check_writable, write_whole};
use crate::graphs::method::{self, Method};
use crate::graphs::preset;
use crate::measuring::scene_selection::SceneSelection;
use crate::measuring::{device, profiling};
use crate::records::profile::Profile;
use crate::records::read_back;
use crate::records::samples::TimedFrame;
use crate::reporting::profile_csv::to_csv;
use crate::reporting::profile_text::report;
use crate::reporting::trace::trace;
use crate::terminal::console::{note, print};
use std::{path::Path, sync::Arc};

/// Times a graph, prints what it measured, and writes what was asked for.
///
/// # Errors
/// A faulty graph or baseline, a scene that cannot be loaded, no GPU, Ctrl-C, a file that cannot be
/// written.
pub fn profile(args: &ProfileArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    if args.scene.view.as_deref() == Some("all") {
        return Err(CliError::Usage(
            "a profile is one of one view; give its name instead of `all`".into(),
        ));
    }
    check_writable(&files(args))?;
    let old = match &args.baseline {
        Some(path) => Some((path.as_path(), read_back::profile(path)?)),
        None => None,
    };
    let (preset, params) = method::load_one(&args.method, &preset::sources())?;
    let gpu = device::open(gpu, [&preset.graph])?;
    let method = Method::on(&preset, params, args.method.size.0, gpu.device.features());
    let SceneSelection { scene, views } = SceneSelection::load(&args.scene)?;
    let Some(view) = views.first() else {
        return Err(CliError::Input(format!(
            "the scene `{}` has no view",
            scene.name
        )));
    };
    let scene = Arc::new(scene);
    let (mut profile, timed) = profiling::profile(args, &gpu, &method, &scene, view)?;
    profile.baseline = old.map(|(path, old)| profile.against(path, &old));
    print(&report(&profile))?;
    let written = write(args, &profile, &timed)?;
    if timed.len() < args.frames as usize {
        return Err(CliError::Interrupted {
            kept: format!(
                "what is shown is of the {} of {} frames that were timed{written}",
                timed.len(),
                args.frames
            ),
        });
    }
    Ok(())
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
fn write(args: &ProfileArgs, profile: &Profile, timed: &[TimedFrame]) -> Result<String, CliError> {
    if let Some(path) = &args.csv {
        let csv = to_csv(profile).map_err(|error| CliError::write(path, error))?;
        write_whole(path, csv.as_bytes())?;
    }
    if let Some(path) = &args.json {
        write_whole(path, json::to_text(profile).as_bytes())?;
    }
    if let Some(path) = &args.trace {
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
