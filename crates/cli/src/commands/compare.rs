//! `skiagraph compare`: every method on every view, viewport and map size, speed beside error.

use crate::args::commands::{CompareArgs, Format, Images};
use crate::args::shared::{GpuArgs, SceneArgs};
use crate::args::values::{LightArgument, Size, unique};
use crate::commands::report;
use crate::error::CliError;
use crate::files::fingerprint::Fingerprint;
use crate::files::json;
use crate::files::write::{check_folder, write_whole};
use crate::graphs::idle_params::IdleParams;
use crate::graphs::method::{self, Method};
use crate::graphs::openings;
use crate::graphs::planning::Capabilities;
use crate::graphs::variants;
use crate::graphs::{preset, shadow_method};
use crate::measuring::comparison::{Comparison, ComparisonSetup};
use crate::measuring::ground_truth::PrimaryVisibility;
use crate::measuring::scene_selection::{SceneSelection, check_path, under_lights};
use crate::measuring::view_or_path::ViewOrPath;
use crate::measuring::{date, device};
use crate::pictures::run_pictures::{check_stems, graph_name, reference_stem, stem};
use crate::records::results::{PROGRAM, Results};
use crate::reporting::summary_table::{self, Summary};
use crate::reporting::{markdown, published, results_table};
use crate::terminal::console::{note, print};
use crate::terminal::interrupt;
use crate::wording::{command_line, size};
use skiagraph_draw::Drawing;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{Scene, SceneLibrary, View};
use std::sync::Arc;

/// Checks everything, then runs the comparison.
///
/// # Errors
/// Faulty graphs, a scene that cannot be loaded, no GPU, earlier results that cannot be resumed,
/// Ctrl-C, no method that runs on this adapter.
pub fn compare(args: &CompareArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let published = published::read(&args.published)?;
    let sources = preset::sources();
    let names = preset::named_or_all(&args.presets, &sources);
    let (arguments, params) = openings::arguments(&names, &args.params, &sources)?;
    let presets = shadow_method::load_all(&variants::presets(&arguments), &sources)?;
    let methods = method::methods(&presets, &arguments, &params, &args.map_size)?;
    method::note_without_map(&methods, &args.map_size);
    let primary = PrimaryVisibility::load(&sources)?;
    let gpu = device::open(gpu, preset::graphs(&presets))?;
    let features = gpu.device.features();
    let methods: Vec<Method> = methods
        .into_iter()
        .map(|method| method.settled(features))
        .collect();
    let SceneSelection { scene, views } = SceneSelection::load(&args.scene)?;
    let viewports: Vec<[u32; 2]> = unique(&args.size).iter().map(|Size(size)| *size).collect();
    let scene = Arc::new(scene);
    let mut provider = SceneProvider::new(scene.clone());
    let device = Capabilities::new(&gpu);
    let is_layered = |method: &Method| shadow_method::is_layered(method, &device, &provider);
    let lights = if methods.iter().any(is_layered) {
        every_light(&args.scene)
    } else {
        args.scene.clone()
    };
    let views_or_paths = views_or_paths(args, &scene, views, &lights)?;
    if args.images == Images::All {
        check_pictures(&methods, &views_or_paths, &viewports)?;
    }
    // Everything is planned before anything runs, so that a mistake in the last file is told at
    // once and not after an hour. A provider describes the same for every view under a light of one
    // kind.
    for &viewport in &viewports {
        primary.plan(&gpu, viewport, &provider)?;
    }
    let (mut kinds, mut idle) = (Vec::new(), IdleParams::default());
    for view_or_path in &views_or_paths {
        let light = view_or_path.light(&scene);
        let kind = light.word();
        if !kinds.contains(&kind) {
            kinds.push(kind);
            provider.set_light(light);
            shadow_method::check_plans(&methods, &viewports, &provider, Some(&device))?;
            idle.note(&methods, &device, &provider);
        }
    }
    check_folder(&args.out)?;
    let results = Results {
        schema: 1,
        program: PROGRAM.into(),
        adapter: device::describe(&gpu, device::timestamp_trust(&gpu)),
        scene: (&*scene).into(),
        oracle: args.oracle.to_string(),
        frames: args.frames,
        warmup: args.warmup,
        cached_frames: args.cached_frames.unwrap_or(args.frames),
        commands: vec![command_line(std::env::args_os())],
        runs: Vec::new(),
    };
    let setup = ComparisonSetup {
        gpu: &gpu,
        scene: &scene,
        views: &views_or_paths,
        viewports: &viewports,
        methods: &methods,
        primary: &primary,
        fingerprint: fingerprint(args, &scene, &views_or_paths, &primary),
    };
    let graphs = match args.images {
        Images::All => graphs(&setup, &provider),
        Images::None => Vec::new(),
    };
    // Earlier results may be refused: nothing of theirs is overwritten then.
    let mut comparison = Comparison::new(args, setup, provider, published, results)?;
    for (name, svg) in &graphs {
        write_whole(&args.out.join(name), svg.as_bytes())?;
    }
    interrupt::install()?;
    let outcome = run(args, &mut comparison, &views_or_paths, viewports.len());
    finish(args, comparison, outcome)
}

/// A chart of each method's graph, with its file name; of one that this adapter cannot run there is
/// none.
fn graphs(setup: &ComparisonSetup, provider: &SceneProvider) -> Vec<(String, String)> {
    let Some(&viewport) = setup.viewports.first() else {
        return Vec::new();
    };
    let chart = |method: &Method| {
        let capabilities = Capabilities::new(setup.gpu);
        let plan = method.at(viewport).plan(viewport, capabilities, provider);
        let title = format!("{}, viewport {}", method.name, size(viewport));
        let svg = Drawing::from_plan(&plan.ok()?).titled(title).to_svg();
        Some((graph_name(&method.name), svg))
    };
    setup.methods.iter().filter_map(chart).collect()
}

/// Hashes everything that all runs depend on.
fn fingerprint(
    args: &CompareArgs,
    scene: &Scene,
    views_or_paths: &[ViewOrPath],
    primary: &PrimaryVisibility,
) -> Fingerprint {
    let mut of = primary.fingerprint.with_scene(&scene.mesh, &scene.lights);
    let has_extent = |view_or_path: &ViewOrPath| view_or_path.light(scene).has_extent();
    if views_or_paths.iter().any(has_extent) {
        of = of.with_text(&args.reference_samples.to_string());
    }
    match args.jitter {
        Some(count) => of.with_text(&format!("jitter {count}")),
        None => of,
    }
}

/// A method that answers for every light is judged under every light, unless one is named.
fn every_light(args: &SceneArgs) -> SceneArgs {
    let all = || LightArgument::Name("all".into());
    SceneArgs {
        light: args.light.clone().or_else(|| Some(all())),
        ..args.clone()
    }
}

/// The views, or the camera paths that are asked for, under the lights that are.
fn views_or_paths(
    args: &CompareArgs,
    scene: &Scene,
    views: Vec<View>,
    lights: &SceneArgs,
) -> Result<Vec<ViewOrPath>, CliError> {
    let Some(name) = &args.path else {
        let views = if args.scene.light == lights.light {
            views
        } else {
            under_lights(scene, views, lights)?
        };
        return Ok(views.into_iter().map(ViewOrPath::Still).collect());
    };
    check_path(&args.scene, name)?;
    let paths = SceneLibrary::from_environment().paths(&args.scene.scene);
    let paths = paths.map_err(|error| CliError::Input(error.to_string()))?;
    ViewOrPath::paths(scene, paths, name, lights)
}

/// Refuses runs that would overwrite each other's pictures, before anything runs.
fn check_pictures(
    methods: &[Method],
    views_or_paths: &[ViewOrPath],
    viewports: &[[u32; 2]],
) -> Result<(), CliError> {
    let mut stems = Vec::new();
    for view_or_path in views_or_paths {
        let view = view_or_path.name();
        for &viewport in viewports {
            stems.extend(methods.iter().map(|method| {
                let owner = format!("`{}` on view `{view}`", method.name);
                (stem(method, view, viewport), owner)
            }));
            let owner = format!("the reference on view `{view}`");
            stems.push((reference_stem(view, viewport), owner));
        }
    }
    check_stems(stems, "--out")
}

/// Measures what is missing, and prints every view and viewport when it is whole.
fn run(
    args: &CompareArgs,
    comparison: &mut Comparison,
    views_or_paths: &[ViewOrPath],
    viewports: usize,
) -> Result<(), CliError> {
    if args.format == Format::Markdown {
        let is_done = comparison.results.runs.len() == comparison.planned();
        let today = (!is_done).then(date::today);
        let header = markdown::header(
            &comparison.results,
            today.as_deref(),
            &args.published,
            args.path.is_some(),
        );
        print(&header)?;
    }
    for (index, view_or_path) in views_or_paths.iter().enumerate() {
        if args.format == Format::Markdown {
            print(&markdown::view(view_or_path.name()))?;
        }
        for viewport in 0..viewports {
            let outcome = comparison.measure(index, viewport);
            let (results, runs) = (&comparison.results, comparison.runs(index, viewport));
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
            let texts: Vec<String> = summaries.iter().map(Summary::text).collect();
            print(&texts.join("\n"))?;
            if args.passes {
                print(&format!("\n{}\n", summary_table::passes(results)))
            } else {
                Ok(())
            }
        }
        Format::Markdown => {
            let texts: Vec<String> = summaries.iter().map(Summary::markdown).collect();
            print(&texts.concat())
        }
        Format::Json => print(&json::to_text(results)),
    }
}

/// Says what came of it.
fn finish(
    args: &CompareArgs,
    mut comparison: Comparison,
    outcome: Result<(), CliError>,
) -> Result<(), CliError> {
    let planned = comparison.planned();
    if !comparison.results.runs.is_empty() {
        print_summary(args, &comparison.whole())?;
        comparison.save(&[])?;
        report::write_beside(&args.out)?;
    }
    let Comparison {
        results, broken, ..
    } = comparison;
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
        return Err(CliError::InvalidOutputs(broken.join("\nerror: ")));
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
    Ok(())
}
