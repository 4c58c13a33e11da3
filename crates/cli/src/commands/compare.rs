//! `skiagraph compare`: measures speed and error of methods on every view, viewport and map size.

use crate::args::commands::{CompareArgs, Format, Images};
use crate::args::shared::GpuArgs;
use crate::error::CliError;
use crate::scene_selection::{SceneSelection, paths};
use crate::terminal::{
    Terminal,
    console::{note, print},
    interrupt,
};
use itertools::Itertools;
use skiagraph_compare::comparison::{Comparison, Protocol};
use skiagraph_compare::error::CompareError;
use skiagraph_compare::files::{
    json,
    write::{check_folder, write_whole},
};
use skiagraph_compare::graphs::{method::Method, planning::Capabilities, preset, shadow_method};
use skiagraph_compare::lists::unique;
use skiagraph_compare::measuring::{
    date, device,
    ground_truth::PrimaryVisibility,
    resume::Kept,
    series::Series,
    view_or_path::{ViewOrPath, under_lights},
};
use skiagraph_compare::pictures::run_pictures::graph_name;
use skiagraph_compare::records::{
    budgets::Budgets, published, results::Results, results_baseline::Baseline,
};
use skiagraph_compare::sink::Session;
use skiagraph_compare::size::Size;
use skiagraph_compare::wording::{command_line, size, unknown};
use skiagraph_draw::{from_plan, to_svg};
use skiagraph_passes::SceneProvider;
use skiagraph_report::{
    baseline_text,
    gate::Gate,
    markdown, page, results_table,
    summary_table::{self, Summary},
    table::terminal,
};
use skiagraph_scene::Scene;
use std::sync::Arc;

/// Checks all arguments, then measures the methods and prints and saves the results.
///
/// # Errors
/// If a graph has errors, a scene cannot be loaded, no GPU can be opened, earlier results cannot be
/// continued, Ctrl-C stops the command, no method runs on this adapter, a limit of `--fail-if` is
/// exceeded, or a method is worse than in `--baseline`.
pub fn compare(args: &CompareArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let published = published::read(&args.published)?;
    let baseline = args.baseline.as_deref().map(Baseline::read).transpose()?;
    let sources = preset::sources(&Terminal);
    let names = if args.presets.is_empty() && !args.all {
        preset::shipped_and_own(&sources)
    } else {
        preset::named_or_all(&args.presets, &sources)
    };
    let methods = shadow_method::load_methods(&names, &args.params, &args.map_size, &sources)?;
    note_without_map(&methods, &args.map_size);
    check_gates(&args.fail_if, &methods)?;
    let primary = PrimaryVisibility::load(&sources)?;
    let loaded = methods.iter().map(|method| &method.preset.graph);
    let gpu = device::open(&gpu.request(), loaded)?;
    let session = Session::new(&gpu, &Terminal);
    let SceneSelection {
        scene,
        views,
        paths: own,
    } = SceneSelection::load(&args.scene)?;
    let scene = Arc::new(scene);
    let light = light_name(args, &methods, &scene, session);
    let views = match (&args.path, &args.scene.light) {
        (Some(name), _) => paths(&args.scene, &scene, &own, name, light)?,
        (None, Some(_)) => views.into_iter().map(ViewOrPath::Still).collect(),
        (None, None) => {
            let views = under_lights(&scene, views, light)?.into_iter();
            views.map(ViewOrPath::Still).collect()
        }
    };
    let comparison = Comparison {
        views,
        viewports: unique(args.size.iter().map(|Size(size)| *size)),
        methods,
        protocol: Protocol {
            frames: args.frames,
            warmup: args.warmup,
            cached_frames: args.cached_frames.unwrap_or(args.frames),
            jitter: args.jitter,
            oracle: args.oracle,
            reference_samples: args.reference_samples,
            pictures: args.images == Images::All,
            data: args.data,
        },
        primary,
        budgets: Budgets {
            frame_ms: args.under,
            wrong_percent: args.below,
            memory_bytes: args.memory,
        },
        published,
        command: Some(command_line(std::env::args_os())),
        commit: option_env!("SKIAGRAPH_COMMIT").map(str::to_owned),
        scene,
    };
    comparison.check(session)?;
    check_folder(&args.out)?;
    let graphs = match args.images {
        Images::All => graphs(&comparison, session),
        Images::None => Vec::new(),
    };
    let kept = match (args.replace, args.resume) {
        (true, _) => Kept::Nothing,
        (_, true) => Kept::All,
        _ => Kept::Others,
    };
    // Earlier results may be refused: nothing of theirs is overwritten then.
    let mut series = Series::new(&comparison, session, Some((&args.out, kept)))?;
    if let Some(baseline) = &baseline {
        baseline.check(&series.results, series.planned_runs())?;
    }
    for (name, svg) in &graphs {
        write_whole(&args.out.join(name), svg.as_bytes())?;
    }
    interrupt::install()?;
    let outcome = run(args, &comparison, &mut series);
    let results = finish(args, series, outcome)?;
    judge(args, baseline.as_ref(), &results)
}

/// Refuses conditions on methods that are not compared.
fn check_gates(gates: &[Gate], methods: &[Method]) -> Result<(), CliError> {
    let names = || methods.iter().map(|method| method.name.as_str());
    let is_unknown = |gate: &&Gate| !names().contains(&*gate.method);
    let Some(gate) = gates.iter().find(is_unknown) else {
        return Ok(());
    };
    let what = format!("--fail-if: `{}` is not compared", gate.method);
    let known: Vec<&str> = names().unique().collect();
    Err(CliError::Input(unknown(
        &what,
        &gate.method,
        "methods",
        &known,
    )))
}

/// Prints the methods on which `--map-size` has no effect.
pub fn note_without_map(methods: &[Method], map_sizes: &[u32]) {
    let without = methods.iter().filter(|method| method.map_size.is_none());
    let without: Vec<&str> = without.map(|method| method.name.as_str()).collect();
    if !map_sizes.is_empty() && !without.is_empty() {
        note(&format!(
            "--map-size has no effect on {}: no param `map_size`",
            without.join(", ")
        ));
    }
}

/// A chart of each method's graph, with its file name; of one that this adapter cannot run there is
/// none.
fn graphs(comparison: &Comparison, session: Session) -> Vec<(String, String)> {
    let Some(&viewport) = comparison.viewports.first() else {
        return Vec::new();
    };
    let mut provider = SceneProvider::new(comparison.scene.clone());
    if let Some(&light) = comparison.kinds_of_light().last() {
        provider.set_light(light);
    }
    let chart = |method: &Method| {
        let capabilities = Capabilities::new(session.gpu);
        let plan = method.at(viewport).plan(viewport, capabilities, &provider);
        let title = format!("{}, viewport {}", method.name, size(viewport));
        let svg = to_svg(&from_plan(&plan.ok()?).titled(title));
        Some((graph_name(&method.name), svg))
    };
    comparison.methods.iter().filter_map(chart).collect()
}

/// The light by its name: where a method answers for every light it is judged under every light,
/// unless one is named.
fn light_name<'a>(
    args: &'a CompareArgs,
    methods: &[Method],
    scene: &Arc<Scene>,
    session: Session,
) -> Option<&'a str> {
    let provider = SceneProvider::new(scene.clone());
    let device = Capabilities::new(session.gpu);
    let is_layered = |method: &Method| shadow_method::is_layered(method, &device, &provider);
    match args.scene.light {
        None if methods.iter().any(is_layered) => Some("all"),
        _ => args.scene.light_name(),
    }
}

/// Measures what is missing, and prints every view and viewport when it is whole.
fn run(args: &CompareArgs, comparison: &Comparison, series: &mut Series) -> Result<(), CliError> {
    if args.format == Format::Markdown {
        let is_done = series.results.runs.len() == series.planned();
        let today = (!is_done).then(date::today);
        let header = markdown::header(
            &series.results,
            today.as_deref(),
            &args.published,
            args.path.is_some(),
        );
        print(&header)?;
    }
    for (index, view_or_path) in comparison.views.iter().enumerate() {
        if args.format == Format::Markdown {
            print(&markdown::view(view_or_path.name()))?;
        }
        for viewport in 0..comparison.viewports.len() {
            let outcome = series.measure(index, viewport);
            let (results, runs) = (&series.results, series.runs(index, viewport));
            match args.format {
                Format::Table if args.details => {
                    print(&format!("{}\n", results_table::group(results, runs)))?;
                }
                Format::Table => {}
                Format::Markdown => print(&markdown::viewport(results, runs))?,
                Format::Json => {}
            }
            outcome?;
        }
    }
    Ok(())
}

/// Prints the summary over all views and viewports, as far as they are done.
fn print_summary(args: &CompareArgs, results: &Results) -> Result<(), CliError> {
    let summaries = summary_table::summaries(results);
    match args.format {
        Format::Table => {
            print(&summaries.iter().map(Summary::text).join("\n"))?;
            for (viewport, lights) in summary_table::by_light(results) {
                let head = format!("By light, {}: wrong pixels, frame, memory", size(viewport));
                print(&format!("\n{head}\n{}\n", terminal(&lights)))?;
            }
            if args.passes {
                print(&format!("\n{}\n", summary_table::passes(results)))?;
            }
            Ok(())
        }
        Format::Markdown => {
            print(&summaries.iter().map(Summary::markdown).collect::<String>())?;
            for (viewport, lights) in summary_table::by_light(results) {
                print(&format!(
                    "\n## By light, {}\n\n{}",
                    size(viewport),
                    lights.markdown()
                ))?;
            }
            Ok(())
        }
        Format::Json => print(&json::to_text(results)),
    }
}

/// Says what came of it, and returns the results.
fn finish(
    args: &CompareArgs,
    mut series: Series,
    outcome: Result<(), CliError>,
) -> Result<Results, CliError> {
    let planned = series.planned();
    if !series.results.runs.is_empty() {
        print_summary(args, &series.whole())?;
        series.save(&[])?;
        page::write_beside(&args.out, &Terminal)?;
    }
    let Series {
        results, broken, ..
    } = series;
    let kept = match results.runs.len() {
        0 => "no run was finished".into(),
        done => format!(
            "{done} of {planned} runs are kept in {}; the same command with --resume goes on \
             from there",
            args.out.join("results.json").display()
        ),
    };
    match outcome {
        Ok(()) => {}
        Err(CliError::Interrupted { .. }) => return Err(CliError::Interrupted { kept }),
        Err(error) => {
            note(&kept);
            return Err(error);
        }
    }
    if !broken.is_empty() {
        return Err(CompareError::InvalidOutputs(broken.join("\nerror: ")).into());
    }
    if results.runs.iter().all(|run| run.measured.is_none()) {
        return Err(CliError::Input(format!(
            "no method can run on {}; the reasons stand above",
            results.adapter.name
        )));
    }
    let files = match args.images {
        Images::All => "report.html, results.json, results.csv and the pictures",
        Images::None => "report.html, results.json and results.csv",
    };
    if !args.published.is_empty() && results.runs.iter().all(|run| run.published.is_empty()) {
        note(
            "--beside has no effect: none of its figures is of these scenes, views, viewports, \
             maps and presets",
        );
    }
    note(&format!("{files} are in {}", args.out.display()));
    let runs = results.runs.iter().filter_map(|run| run.measured.as_ref());
    let bare = runs.filter(|run| run.images.is_none()).count();
    if args.images == Images::All && bare > 0 {
        note(&format!(
            "{bare} of the runs that were kept have no pictures: they were measured with --images \
             none"
        ));
    }
    Ok(results)
}

/// Shows what has changed since the baseline, and holds the results against it and the gates.
fn judge(
    args: &CompareArgs,
    baseline: Option<&Baseline>,
    results: &Results,
) -> Result<(), CliError> {
    let failures = args.fail_if.iter().flat_map(|gate| gate.failures(results));
    let failures: Vec<String> = failures.collect();
    let mut worse = Vec::new();
    if let Some(baseline) = baseline {
        let changes = baseline.against(results)?;
        worse = baseline_text::failures(&changes);
        match args.format {
            Format::Table => print(&format!("\n{}", baseline_text::text(&changes)))?,
            Format::Markdown | Format::Json => note(&baseline_text::text(&changes)),
        }
    }
    match (&failures[..], &worse[..]) {
        ([], []) => Ok(()),
        ([], worse) => Err(CliError::Baseline(worse.join("\n"))),
        (failures, worse) => Err(CliError::Gate([failures, worse].concat().join("\n"))),
    }
}
