//! `skiagraph compare`: every method on every view, viewport and map size, speed beside error.

mod comparison;

use crate::{
    args::{CompareArgs, GpuArgs, Images},
    contract,
    error::{CliError, note},
    files::check_folder,
    interrupt,
    measure::{Method, reference_stem, stem},
    parse::Size,
    preset::{self, Faults, Preset},
    published,
    reference::Primary,
    render,
    results::{Results, Scene as SceneResult},
    stage::Stage,
};
use comparison::{Comparison, Subject};
use skiagraph_graph::{LayeredSources, gpu::Gpu};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::View;
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

/// Checks everything, then runs the comparison.
///
/// # Errors
/// Faulty graphs, a scene that cannot be loaded, no GPU, earlier results that cannot be resumed, Ctrl-C, no method that runs on this
/// adapter.
pub fn compare(args: &CompareArgs, asked: &GpuArgs) -> Result<(), CliError> {
    let published = published::read(&args.beside)?;
    let sources = preset::sources();
    let names = if args.presets.is_empty() {
        skiagraph_passes::presets()
            .into_iter()
            .map(|preset| preset.name)
            .collect()
    } else {
        args.presets.clone()
    };
    let presets = load(&names, &sources)?;
    let methods = methods(&presets, args)?;
    let primary = Primary::load(&sources)?;
    let wanted = presets.iter().map(|preset| preset.graph.features());
    let gpu = render::open(
        asked,
        wanted.fold(wgpu::Features::empty(), |all, own| all | own),
    )?;
    let Stage { scene, views } = Stage::load(&args.scene)?;
    if args.images == Images::All {
        check_pictures(&methods, &views, args)?;
    }
    let scene = Arc::new(scene);
    let provider = SceneProvider::new(scene.clone());
    check_plans(&gpu, &primary, &methods, args, &provider)?;
    let trust = render::trust(&gpu);
    let results = Results {
        schema: 1,
        program: concat!("skiagraph ", env!("CARGO_PKG_VERSION")).into(),
        adapter: render::describe(&gpu, &trust),
        scene: SceneResult {
            name: scene.name.clone(),
            triangles: scene.mesh.triangles.len() as u64,
        },
        oracle: args.oracle.to_string(),
        frames: args.frames,
        warmup: args.warmup,
        cached_frames: args.cached_frames.unwrap_or(args.frames),
        runs: Vec::new(),
    };
    let viewports: Vec<[u32; 2]> = unique(&args.size).iter().map(|size| size.0).collect();
    let subject = Subject {
        gpu: &gpu,
        scene: &scene,
        views: &views,
        viewports: &viewports,
        methods: &methods,
        primary: &primary,
        fingerprint: primary.fingerprint.with_scene(&scene.mesh, &scene.light),
    };
    let mut comparison = Comparison::new(args, subject, provider, published, results)?;
    check_folder(&args.out)?;
    interrupt::install()?;
    let outcome = comparison.run();
    comparison.finish(outcome)
}

/// Loads the graphs and refuses those that are no shadow methods.
fn load(names: &[String], sources: &LayeredSources) -> Result<Vec<Preset>, CliError> {
    let presets = preset::load_all(names, sources)?;
    let incomplete: Vec<String> = presets
        .iter()
        .filter_map(contract::missing_outputs)
        .collect();
    if incomplete.is_empty() {
        Ok(presets)
    } else {
        Err(CliError::Input(incomplete.join("\nerror: ")))
    }
}

/// Each preset with each map size; a preset without that param once.
fn methods<'a>(presets: &'a [Preset], args: &CompareArgs) -> Result<Vec<Method<'a>>, CliError> {
    preset::check_names(presets, &args.params)?;
    let mapless = presets
        .iter()
        .all(|preset| !preset::has_param(preset, preset::MAP_SIZE));
    if mapless && !args.map_size.is_empty() {
        note("--map-size has no effect: none of these graphs has the param `map_size`");
    }
    let mut methods = Vec::new();
    for preset in presets {
        let mut sizes: Vec<Option<u32>> = unique(&args.map_size).into_iter().map(Some).collect();
        if sizes.is_empty() || !preset::has_param(preset, preset::MAP_SIZE) {
            sizes = vec![None];
        }
        for size in sizes {
            methods.push(Method::new(
                preset,
                preset::params(preset, &args.params, size)?,
            ));
        }
    }
    Ok(methods)
}

/// Plans everything before anything runs: nobody should wait for an hour to read that the last file has a mistake. A graph
/// that only this adapter cannot run is no mistake. What a provider describes is the same for every view.
fn check_plans(
    gpu: &Gpu,
    primary: &Primary,
    methods: &[Method],
    args: &CompareArgs,
    provider: &SceneProvider,
) -> Result<(), CliError> {
    let mut faults = Faults::default();
    let mut misfits = BTreeSet::new();
    // Of methods that this adapter cannot run; and whether it can run one.
    let (mut unable, mut is_able) = (Faults::default(), false);
    for Size(viewport) in unique(&args.size) {
        primary.plan(gpu, viewport, provider)?;
        for method in methods {
            match method.plan(viewport, render::greatest_abilities(), provider) {
                Ok(plan) => {
                    misfits.extend(contract::misfit(method.preset, &plan, viewport));
                    match method.plan(viewport, render::abilities(gpu), provider) {
                        Ok(_) => is_able = true,
                        Err(diagnostics) => unable.add(&method.preset.name, &diagnostics),
                    }
                }
                Err(diagnostics) => faults.add(&method.preset.name, &diagnostics),
            }
        }
    }
    faults.none_or_error()?;
    if !is_able {
        unable.none_or_error()?;
    }
    if misfits.is_empty() {
        return Ok(());
    }
    Err(CliError::Input(
        misfits.into_iter().collect::<Vec<_>>().join("\nerror: "),
    ))
}

/// Refuses runs that would overwrite each other's pictures, before anything runs.
fn check_pictures(methods: &[Method], views: &[View], args: &CompareArgs) -> Result<(), CliError> {
    let mut owners: BTreeMap<String, String> = BTreeMap::new();
    for view in views {
        for Size(viewport) in unique(&args.size) {
            let reference = (
                reference_stem(&view.name, viewport),
                format!("the reference on view `{}`", view.name),
            );
            let runs = methods.iter().map(|method| {
                (
                    stem(method, &view.name, viewport),
                    format!("`{}` on view `{}`", method.preset.name, view.name),
                )
            });
            for (stem, owner) in runs.chain([reference]) {
                if let Some(other) = owners.get(&stem) {
                    return Err(CliError::Input(format!(
                        "the pictures of {other} and of {owner} would overwrite each other: both are called {stem}-….png\n  rename one, or compare them one after the other with another --out"
                    )));
                }
                owners.insert(stem, owner);
            }
        }
    }
    Ok(())
}

/// The list without repeats, in its own order.
fn unique<T: Copy + PartialEq>(list: &[T]) -> Vec<T> {
    let mut kept = Vec::new();
    for &item in list {
        if !kept.contains(&item) {
            kept.push(item);
        }
    }
    kept
}
