//! `skiagraph compare`: every method on every view, viewport and map size, speed beside error.

use crate::{
    args::{CompareArgs, Format},
    contract,
    error::{CliError, note, print},
    interrupt,
    measure::{Method, Setting, reference_stem, stem},
    parse::Size,
    picture,
    preset::{self, Faults, Preset},
    progress::Step,
    reference::{self, Primary},
    render,
    results::{Results, Scene as SceneResult},
    stage::Stage,
    table::{Look, group},
};
use skiagraph_graph::{LayeredSources, gpu::Gpu};
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{Image, Oracle};
use skiagraph_scene::{DirectionalLight, View};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    sync::Arc,
};

/// Runs the comparison; whatever is measured is on disk at once.
///
/// # Errors
/// Faulty graphs, a scene that cannot be loaded, no GPU, Ctrl-C, no method that runs on this adapter.
pub fn compare(args: &CompareArgs, adapter: Option<&str>) -> Result<(), CliError> {
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
        adapter,
        wanted.fold(wgpu::Features::empty(), |all, own| all | own),
    )?;
    let Stage { scene, views } = Stage::load(&args.scene)?;
    check_pictures(&methods, &views, args)?;
    let scene = Arc::new(scene);
    let provider = SceneProvider::new(scene.clone());
    check_plans(&gpu, &primary, &methods, args, &provider)?;
    fs::create_dir_all(&args.out).map_err(|error| CliError::write(&args.out, error))?;
    interrupt::install()?;

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
        runs: Vec::new(),
    };
    let step = Step::begin(format!("hierarchy of {}", scene.name), 1, "steps");
    let oracle = Oracle::new(&scene.mesh);
    step.end();
    let planned = views.len() * unique(&args.size).len() * methods.len();
    let mut comparison = Comparison {
        args,
        primary,
        gpu,
        light: scene.light,
        provider,
        oracle,
        results,
        broken: Vec::new(),
    };
    let outcome = comparison.views(&views, &methods);
    comparison.finish(outcome, planned)
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

struct Comparison<'a> {
    args: &'a CompareArgs,
    primary: Primary,
    gpu: Gpu,
    light: DirectionalLight,
    provider: SceneProvider,
    oracle: Oracle<'a>,
    results: Results,
    /// Why graphs broke the contract of outputs.
    broken: Vec<String>,
}

impl Comparison<'_> {
    fn views(&mut self, views: &[View], methods: &[Method]) -> Result<(), CliError> {
        for view in views {
            for viewport in unique(&self.args.size) {
                let first = self.results.runs.len();
                let outcome = self.view(view, viewport.0, methods);
                let runs = &self.results.runs[first..];
                match self.args.format {
                    Format::Table => {
                        print(&format!("{}\n", group(&self.results, runs, Look::Terminal)))?
                    }
                    Format::Markdown => {
                        print(&format!("{}\n", group(&self.results, runs, Look::Markdown)))?
                    }
                    Format::Json => {}
                }
                outcome?;
            }
        }
        Ok(())
    }

    fn view(
        &mut self,
        view: &View,
        viewport: [u32; 2],
        methods: &[Method],
    ) -> Result<(), CliError> {
        let camera = view.camera(viewport);
        self.provider.set_view(view, viewport);
        let [width, height] = viewport;
        let what = format!("{} {width}x{height}", view.name);
        let step = Step::begin(format!("visible triangles, {what}"), 1, "frames");
        let ids = self.primary.ids(&self.gpu, viewport, &mut self.provider)?;
        step.end();
        let reference = reference::judge(
            &self.oracle,
            &camera,
            &self.light,
            &ids,
            self.args.oracle,
            &what,
        )?;
        let name = format!("{}-visibility.png", reference_stem(&view.name, viewport));
        let image = Image::visibility(viewport, &reference.visibility(), &reference.status())
            .map_err(|error| CliError::Input(format!("no picture {name}: {error}")))?;
        picture::save(&self.args.out.join(name), &image)?;
        let setting = Setting {
            gpu: &self.gpu,
            timestamps: self.results.adapter.gpu_unavailable.is_none(),
            view: &view.name,
            reference: &reference,
            frames: self.args.frames,
            warmup: self.args.warmup,
            out: &self.args.out,
        };
        for method in methods {
            let run = match setting.measure(method, &mut self.provider) {
                // The others are worth measuring all the same.
                Err(CliError::Contract(reason)) => {
                    let run = setting.unavailable(method, reason.clone());
                    self.broken.push(reason);
                    run
                }
                run => run?,
            };
            self.results.runs.push(run);
            self.results.save(&self.args.out)?;
        }
        Ok(())
    }

    fn finish(self, outcome: Result<(), CliError>, planned: usize) -> Result<(), CliError> {
        let Self {
            args,
            results,
            broken,
            ..
        } = self;
        if args.format == Format::Json && !results.runs.is_empty() {
            print(&results.to_json())?;
        }
        let done = results.runs.len();
        if let Err(CliError::Interrupted { .. }) = outcome {
            let kept = match done {
                0 => "no run was finished".into(),
                _ => format!(
                    "{done} of {planned} runs are kept in {}",
                    args.out.join("results.json").display()
                ),
            };
            return Err(CliError::Interrupted { kept });
        }
        outcome?;
        if !broken.is_empty() {
            return Err(CliError::Contract(broken.join("\nerror: ")));
        }
        if results.runs.iter().all(|run| run.measured.is_none()) {
            return Err(CliError::Input(format!(
                "no method can run on {}; the reasons stand above",
                results.adapter.name
            )));
        }
        note(&format!(
            "results.json, results.csv and the pictures are in {}",
            args.out.display()
        ));
        Ok(())
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
    for Size(viewport) in unique(&args.size) {
        primary.plan(gpu, viewport, provider)?;
        for method in methods {
            match method.plan(viewport, render::greatest_abilities(), provider) {
                Ok(plan) => misfits.extend(contract::misfit(method.preset, &plan, viewport)),
                Err(diagnostics) => faults.add(&method.preset.name, &diagnostics),
            }
        }
    }
    faults.none_or_error()?;
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
