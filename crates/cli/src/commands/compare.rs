//! `skiagraph compare`: every method on every view, viewport and map size, speed beside error.

mod comparison;

use crate::{
    args::{CompareArgs, GpuArgs, Images},
    contract,
    error::{CliError, note},
    files::check_folder,
    interrupt,
    measure::{self, Method, check_stems, reference_stem, stem},
    parse::{Size, unique},
    preset, published,
    reference::Primary,
    render,
    results::{Results, Scene as SceneResult},
    stage::Stage,
};
use comparison::{Comparison, Subject};
use skiagraph_graph::gpu::Gpu;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::View;
use std::sync::Arc;

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
    let presets = contract::load_all(&names, &sources)?;
    let methods = measure::methods(&presets, &args.params, &args.map_size)?;
    if !args.map_size.is_empty() && methods.iter().all(|method| method.map_size.is_none()) {
        note("--map-size has no effect: none of these graphs has the param `map_size`");
    }
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
    check_folder(&args.out)?;
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
    interrupt::install()?;
    let outcome = comparison.run();
    comparison.finish(outcome)
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
    let viewports: Vec<[u32; 2]> = unique(&args.size).iter().map(|size| size.0).collect();
    for &viewport in &viewports {
        primary.plan(gpu, viewport, provider)?;
    }
    contract::check_plans(methods, &viewports, provider, Some(gpu))
}

/// Refuses runs that would overwrite each other's pictures, before anything runs.
fn check_pictures(methods: &[Method], views: &[View], args: &CompareArgs) -> Result<(), CliError> {
    let mut stems = Vec::new();
    for view in views {
        for Size(viewport) in unique(&args.size) {
            stems.extend(methods.iter().map(|method| {
                (
                    stem(method, &view.name, viewport),
                    format!("`{}` on view `{}`", method.preset.name, view.name),
                )
            }));
            stems.push((
                reference_stem(&view.name, viewport),
                format!("the reference on view `{}`", view.name),
            ));
        }
    }
    check_stems(stems, "--out")
}
