//! `skiagraph any_hits` and `stress --rays`: rays by themselves, timed and judged.

use crate::args::commands::{AnyHitsArgs, RecordFormat, StressArgs};
use crate::args::shared::{GpuArgs, SceneArgs};
use crate::error::CliError;
use crate::scene_selection::SceneSelection;
use crate::terminal::{Terminal, console::print, interrupt};
use skiagraph_compare::files::json::to_text;
use skiagraph_compare::files::write::{check_folder, write_whole};
use skiagraph_compare::measuring::device::open_with;
use skiagraph_compare::rays::conformance::{self, RAY_QUERIES};
use skiagraph_compare::rays::speed::{self, SpeedRequest};
use skiagraph_compare::sink::Session;
use skiagraph_report::ray_text;
use std::{path::Path, sync::Arc};

/// Times the engines, prints a table, and writes any_hits.json.
///
/// # Errors
/// If a scene cannot be loaded or has no rays, no GPU can be opened, Ctrl-C stops the command, or a
/// file cannot be written.
pub fn any_hits(args: &AnyHitsArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let scenes = args.scenes.iter().map(|scene| {
        let selection = SceneSelection::load(&SceneArgs::default().of(scene))?;
        Ok(Arc::new(selection.scene))
    });
    let scenes = scenes.collect::<Result<_, CliError>>()?;
    args.out.as_deref().map(check_folder).transpose()?;
    let gpu = open_with(&gpu.request(), RAY_QUERIES)?;
    interrupt::install()?;
    let request = SpeedRequest::new(scenes, args.size, args.turns);
    let record = speed::any_hits(Session::new(&gpu, &Terminal), &request)?;
    write(args.out.as_deref(), "any_hits.json", &to_text(&record))?;
    print(&ray_text::any_hits(&record))
}

/// Judges the engines on rays of known answers, prints a table, and writes rays.json and rays.md.
///
/// # Errors
/// If a ray of the compute hierarchy or of the driver's ray queries is answered wrongly, no GPU can
/// be opened, Ctrl-C stops the command, or a file cannot be written.
pub fn conformance(count: u64, args: &StressArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    args.out.as_deref().map(check_folder).transpose()?;
    let gpu = open_with(&gpu.request(), RAY_QUERIES)?;
    interrupt::install()?;
    let record = conformance::conformance(Session::new(&gpu, &Terminal), count)?;
    let out = args.out.as_deref();
    write(out, "rays.json", &to_text(&record))?;
    write(out, "rays.md", &ray_text::vendor_report(&record))?;
    match args.format {
        RecordFormat::Table => print(&ray_text::conformance(&record))?,
        RecordFormat::Json => print(&to_text(&record))?,
    }
    match record.wrong() {
        0 => Ok(()),
        wrong => Err(CliError::Judged(format!(
            "{wrong} rays are answered wrongly"
        ))),
    }
}

fn write(folder: Option<&Path>, name: &str, text: &str) -> Result<(), CliError> {
    let Some(folder) = folder else { return Ok(()) };
    Ok(write_whole(&folder.join(name), text.as_bytes())?)
}
