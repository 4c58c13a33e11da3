//! `skiagraph compare --plan` and `--cells`: a comparison on many machines.

use crate::args::cli::{Cli, Command};
use crate::args::{commands::CompareArgs, shared::GpuArgs};
use crate::commands::compare::{check_all, write_graphs};
use crate::commands::loaded::{COMMIT, Loaded};
use crate::error::CliError;
use crate::terminal::{Terminal, console::note};
use clap::Parser;
use skiagraph_compare::files::write::write_whole;
use skiagraph_compare::measuring::many_machines::{self, SceneCells, Share};
use skiagraph_compare::records::cell_plan::{CellPlan, FILE};
use skiagraph_compare::records::shard::Shard;
use skiagraph_compare::sink::Session;
use skiagraph_compare::wording::plural;
use std::{ffi::OsString, path::Path};

/// Checks all arguments, and writes the cells of the comparison into the file `--plan`.
///
/// # Errors
/// If a graph has errors, a scene cannot be loaded, no GPU can be opened, or the file cannot be
/// written.
pub async fn plan(args: &CompareArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let file = args.plan.as_deref().unwrap_or(Path::new(FILE));
    let loaded = Loaded::new(args, gpu, std::env::args_os())?;
    let session = Session::new(&loaded.gpu, &Terminal);
    check_all(&loaded.comparisons, session)?;
    let words = std::env::args_os().skip(1).map(OsString::into_string);
    let words = words.collect::<Result<Vec<String>, OsString>>();
    let words = words.map_err(|word| {
        let text = format!("--plan: {word:?} is not UTF-8; rename it, for plans are text");
        CliError::Input(text)
    })?;
    let plan = many_machines::plan(&scenes(&loaded), session, words).await?;
    write_whole(file, plan.text().as_bytes())?;
    let (cells, file) = (plural(plan.cells.len(), "cell"), file.display());
    note(&format!(
        "{cells} are in {file}; `skiagraph compare --cells {file} --shard 1/2 --out DIR` measures \
         the first half"
    ));
    Ok(())
}

/// Measures a part of a plan into the folder `--out`.
///
/// # Errors
/// If the plan cannot be read, or is not of this program and these files; those of `compare`.
pub async fn measure(args: &CompareArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let file = args.cells.as_deref().unwrap_or(Path::new(FILE));
    let plan = CellPlan::read(file)?;
    plan.check_version(COMMIT)?;
    let arguments = plan.head.arguments.iter().map(OsString::from);
    let words = ["skiagraph".into()].into_iter().chain(arguments);
    let refused = |why: String| {
        let what = "\"arguments\" are not those of a comparison";
        CliError::Input(format!("{}: {what}: {why}", file.display()))
    };
    let planned = Cli::try_parse_from(words.clone()).map_err(|why| refused(why.to_string()))?;
    let Command::Compare(mut planned) = planned.command else {
        return Err(refused("plan it anew (--plan)".into()));
    };
    planned.out.clone_from(&args.out);
    let loaded = Loaded::new(&planned, gpu, words)?;
    let session = Session::new(&loaded.gpu, &Terminal);
    let share = Share {
        plan: &plan,
        shard: args.shard.unwrap_or(Shard::ALL),
        out: &args.out,
    };
    check_all(&loaded.comparisons, session)?;
    let done = many_machines::measure(&share, &scenes(&loaded), session).await?;
    for (comparison, target) in loaded.comparisons.iter().zip(&loaded.targets) {
        write_graphs(comparison, &target.folder, session)?;
    }
    for label in &done.unavailable {
        note(&format!("{label} cannot run here"));
    }
    let (cells, out) = (plural(done.cells, "cell"), args.out.display());
    note(&format!(
        "shard {}: {cells} are in {out}, {} of them from before; `skiagraph merge {out} --out \
         DIR` joins all shards",
        share.shard, done.kept
    ));
    Ok(())
}

fn scenes(loaded: &Loaded) -> Vec<SceneCells<'_>> {
    let scenes = loaded.comparisons.iter().zip(&loaded.targets);
    let scenes = scenes.map(|(comparison, target)| SceneCells {
        comparison,
        folder: target.name.as_deref(),
    });
    scenes.collect()
}
