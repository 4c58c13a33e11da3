//! `skiagraph judge` and `truth`: judge pictures that another renderer made of a view, and write
//! what is right for other judges.

use crate::args::commands::{JudgeArgs, RecordFormat, TruthArgs};
use crate::args::shared::{GpuArgs, SceneArgs};
use crate::error::CliError;
use crate::scene_selection::SceneSelection;
use crate::terminal::{Terminal, console::print, interrupt, stop};
use skiagraph_compare::files::json::to_text;
use skiagraph_compare::foreign::judging::{Judging, Surfaces, judge as judge_pictures};
use skiagraph_compare::foreign::truth::{TruthRequest, write_truth};
use skiagraph_report::{gate::Gate, judged_text};
use skiagraph_scene::{Scene, View};
use std::io::{IsTerminal, stdout};

/// Judges the pictures, prints the figures, and writes them with pictures of the errors.
///
/// # Errors
/// If a file cannot be read or is not a picture of the view, the scene cannot be loaded, no GPU can
/// be opened, Ctrl-C stops the command, a file cannot be written, or a limit of `--fail-if` is
/// exceeded.
pub async fn judge(args: &JudgeArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let surfaces = match (&args.ids, &args.depth) {
        (Some(ids), _) => Surfaces::Ids(ids.clone()),
        (None, Some(depth)) => Surfaces::Depth(depth.clone()),
        (None, None) => Surfaces::Rasterised,
    };
    let judging = Judging {
        pictures: args.pictures.clone(),
        unshadowed: args.unshadowed.clone(),
        reading: args.read_as.unwrap_or_default(),
        surfaces,
        oracle: args.reference.oracle,
        reference_samples: args.reference.reference_samples,
        draws: args.out.is_some(),
    };
    let files = args.pictures.iter().map(|it| it.display().to_string());
    let files: Vec<String> = files.collect();
    for gate in &args.fail_if {
        gate.check_pictures(&files).map_err(CliError::Input)?;
    }
    let (scene, view) = single_view(&args.scene)?;
    interrupt::install()?;
    let judged = judge_pictures(&judging, scene, &view, &gpu.request(), &Terminal).await?;
    stop::take_end();
    if let Some(folder) = &args.out {
        judged.write(folder)?;
    }
    match args.format {
        RecordFormat::Table => print(&judged_text::text(&judged.record, stdout().is_terminal()))?,
        RecordFormat::Json => print(&to_text(&judged.record))?,
    }
    let failures = |gate: &Gate| gate.picture_failures(&judged.record);
    match &args.fail_if.iter().flat_map(failures).collect::<Vec<_>>()[..] {
        [] => Ok(()),
        failures => Err(CliError::Gate(failures.join("\n"))),
    }
}

/// Writes the truth of a view into a folder, and says what each file is.
///
/// # Errors
/// If the scene cannot be loaded, no GPU can be opened, Ctrl-C stops the command, or a file cannot
/// be written.
pub async fn truth(args: &TruthArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let request = TruthRequest {
        viewport: args.size.0,
        oracle: args.reference.oracle,
        reference_samples: args.reference.reference_samples,
        format: args.data,
    };
    let (scene, view) = single_view(&args.scene)?;
    interrupt::install()?;
    let lines = write_truth(&request, scene, &view, &args.out, &gpu.request(), &Terminal).await?;
    let (folder, lines) = (args.out.display(), lines.join("\n  "));
    print(&format!("{folder}:\n  {lines}\n"))
}

/// Loads a scene with the one view that the arguments select.
///
/// # Errors
/// Those of [`SceneSelection::load`]; several views or lights.
fn single_view(args: &SceneArgs) -> Result<(Scene, View), CliError> {
    let SceneSelection { scene, views, .. } = SceneSelection::load(args)?;
    match <[View; 1]>::try_from(views) {
        Ok([view]) => Ok((scene, view)),
        Err(views) => Err(CliError::Usage(format!(
            "a picture is of one view under one light, and {} are asked for: give the name of one \
             instead of `all`",
            views.len()
        ))),
    }
}
