//! `skiagraph check`: prints every diagnostic of graphs, without a GPU.

use crate::args::commands::{CheckArgs, CheckFormat};
use crate::args::shared::{GpuArgs, SceneArgs};
use crate::args::values::LightArgument;
use crate::error::CliError;
use crate::scene_selection::SceneSelection;
use crate::terminal::console::{print, report};
use crate::terminal::{Terminal, interrupt, stop};
use skiagraph_compare::files::json::to_text;
use skiagraph_compare::files::watch::{self, Watch};
use skiagraph_compare::graphs::faults::{GraphFaults, warn};
use skiagraph_compare::graphs::planning::{self, Capabilities, Checked, Trial};
use skiagraph_compare::graphs::{idle_params, light_kinds, preset};
use skiagraph_compare::measuring::device;
use skiagraph_compare::records::check::{CheckReport, FileReport};
use skiagraph_graph::{Diagnostics, Graph, Plan, Sources};
use skiagraph_passes::{names::LIGHT, registry};
use skiagraph_scene::{DirectionalLight, LightKind};
use std::sync::{Arc, mpsc};
use std::time::Duration;

/// Time until Ctrl-C is noticed at the latest.
const LISTENING: Duration = Duration::from_millis(100);

/// Loads and plans each graph and prints its diagnostics. Graphs must run on the adapter that `gpu`
/// names; without one, needs beyond wgpu's default limits are only warnings. With `--watch` it
/// checks again after every change, until Ctrl-C.
///
/// # Errors
/// If a graph has errors (all are reported together; warnings are only printed) or the named
/// adapter is missing. With `--watch`, only if files cannot be watched.
pub fn check(args: &CheckArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    if !args.watch {
        return check_once(args, gpu);
    }
    interrupt::install()?;
    let (sender, changes) = mpsc::channel();
    let folders = watch::folders(args.graphs.iter().map(String::as_str));
    let listen = move || {
        // The receiver goes away only when this command ends.
        let _ = sender.send(());
    };
    let _watch = Watch::start(&folders, listen).map_err(|error| {
        let way_out = "without --watch they are checked once";
        CliError::Input(format!("cannot watch files here: {error}; {way_out}"))
    })?;
    loop {
        if let Err(error) = check_once(args, gpu) {
            report(&error);
        }
        while changes.recv_timeout(LISTENING).is_err() {
            if stop::raised() {
                return Ok(());
            }
        }
        while changes.try_recv().is_ok() {}
    }
}

fn check_once(args: &CheckArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let sources = preset::sources(&Terminal);
    let registry = registry();
    let names = args.graphs.iter();
    let paths: Vec<_> = names.map(|name| preset::locate(name, &sources)).collect();
    let is_named = gpu.adapter.is_some() || gpu.backend.is_some();
    let adapter = is_named.then(|| open(gpu, paths.iter().flatten(), &sources));
    let adapter = adapter.transpose()?;
    let trial = trial(args, adapter.as_ref())?;
    let outcomes = args.graphs.iter().zip(paths).map(|(argument, path)| {
        let path = path.map_err(|why| Fault::Missing(why.to_string()));
        let check = |path: String| planning::check(&path, &registry, &sources, &trial);
        let checked = path.and_then(|path| check(path).map_err(Fault::Graph));
        (argument.as_str(), checked)
    });
    let outcomes: Vec<Found> = outcomes.collect();
    match args.format {
        CheckFormat::Text => text(&outcomes),
        CheckFormat::Json => json(&outcomes),
    }
}

/// Returns the viewport, scene and light that the arguments name, or their stand-ins.
fn trial<'a>(args: &CheckArgs, adapter: Option<&'a Capabilities>) -> Result<Trial<'a>, CliError> {
    let mut trial = Trial {
        adapter,
        viewport: args.size.map(|size| size.0),
        ..Trial::default()
    };
    match (&args.scene, &args.light) {
        (Some(scene), light) => {
            let scene = SceneArgs {
                scenes: vec![scene.clone()],
                light: light.clone(),
                ..SceneArgs::default()
            };
            let SceneSelection { scene, views, .. } = SceneSelection::load(&scene)?;
            trial.scene = Some((Arc::new(scene), views));
        }
        (None, Some(LightArgument::Direction(direction))) => {
            trial.light = Some(DirectionalLight::new(*direction).into());
        }
        (None, Some(LightArgument::Name(kind))) => {
            trial.light = LightKind::EACH.into_iter().find(|it| it.word() == kind);
            if trial.light.is_none() {
                return Err(CliError::Usage(format!(
                    "--light {kind} is a light of a scene: name it with --scene, or a kind: {}",
                    LightKind::WORDS.join(", ")
                )));
            }
        }
        (None, None) => {}
    }
    Ok(trial)
}

/// Opens the adapter that the arguments name, and returns its abilities for these graphs.
fn open<'a>(
    gpu: &GpuArgs,
    paths: impl Iterator<Item = &'a String>,
    sources: &dyn Sources,
) -> Result<Capabilities, CliError> {
    let graphs = paths.filter_map(|path| Graph::load(path, &registry(), sources).ok());
    let gpu = device::open(&gpu.request(), &graphs.collect::<Vec<_>>())?;
    Ok(Capabilities::new(&gpu))
}

/// Why an argument cannot be used.
enum Fault {
    /// It names no graph.
    Missing(String),
    /// Mistakes in the graph.
    Graph(Diagnostics),
}

/// The arguments in their order, and what came of them.
type Found<'a> = (&'a str, Result<Checked, Fault>);

fn text(outcomes: &[Found]) -> Result<(), CliError> {
    let mut faults = GraphFaults::default();
    let mut fine = String::new();
    let mut missing = Vec::new();
    for (argument, checked) in outcomes {
        match checked {
            Ok(checked) => {
                let (graph, plan) = (&checked.graph, &checked.plan);
                warn(&Terminal, graph, plan.warnings());
                let passes = plan.passes().len();
                let noun = if passes == 1 { "pass" } else { "passes" };
                let refused = refused_lights(graph, plan);
                let idle = idle_params::under_other_lights(graph);
                let place = &checked.planned_for;
                fine += &format!("{argument}: fine, {passes} {noun} for {place}{refused}{idle}\n");
            }
            Err(Fault::Graph(diagnostics)) => faults.add(argument, diagnostics),
            Err(Fault::Missing(message)) => missing.push(message.as_str()),
        }
    }
    print(&fine)?;
    let faulty = faults.none_or_error().map_err(CliError::from);
    if missing.is_empty() {
        return faulty;
    }
    if let Err(error) = faulty {
        report(&error);
    }
    Err(CliError::Input(missing.join("\nerror: ")))
}

/// The kinds of light that a graph does not take, if it asks for a light.
fn refused_lights(graph: &Graph, plan: &Plan) -> String {
    let [_, refused] = light_kinds::split(graph);
    if plan.provided().contains(&LIGHT) && !refused.is_empty() {
        format!("; takes no {} light", refused.join(" or "))
    } else {
        String::new()
    }
}

fn json(outcomes: &[Found]) -> Result<(), CliError> {
    let file_report = |(argument, checked): &Found| match checked {
        Ok(Checked { graph, plan, .. }) => {
            let warnings = graph.warnings().iter().chain(plan.warnings());
            FileReport::new(argument, Some(plan.passes().len()), warnings)
        }
        Err(Fault::Graph(diagnostics)) => FileReport::new(argument, None, diagnostics.iter()),
        Err(Fault::Missing(message)) => FileReport::missing(argument, message.clone()),
    };
    let report = CheckReport::new(outcomes.iter().map(file_report).collect());
    print(&to_text(&report))?;
    let faulty = outcomes.iter().filter(|(_, checked)| checked.is_err());
    match (faulty.count(), outcomes.len()) {
        (0, _) => Ok(()),
        (faulty, count) => Err(CliError::Input(format!(
            "{faulty} of {count} cannot be used; the diagnostics are on standard output"
        ))),
    }
}
