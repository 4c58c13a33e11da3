//! `skiagraph profile`: one graph over many frames.

use crate::{
    args::{GpuArgs, ProfileArgs},
    date,
    error::{CliError, note, print},
    files::{check_writable, write_whole},
    interrupt,
    measure::Method,
    preset::{self, Faults},
    profile::{
        baseline::Comparison,
        read::read,
        record::{Conditions, Memory, Profile},
        trace::trace,
    },
    progress::Step,
    render::{self, Samples, TimedFrame, Work},
    results::Scene,
    stage::Stage,
};
use skiagraph_graph::{Executor, Plan};
use skiagraph_passes::SceneProvider;
use std::{path::Path, sync::Arc, time::SystemTime};

/// Times a graph, prints what it measured, and writes what was asked for.
///
/// # Errors
/// A faulty graph or baseline, a scene that cannot be loaded, no GPU, Ctrl-C, a file that cannot be written.
pub fn profile(args: &ProfileArgs, asked: &GpuArgs) -> Result<(), CliError> {
    if args.scene.view.as_deref() == Some("all") {
        return Err(CliError::Usage(
            "a profile is one of one view; give its name instead of `all`".into(),
        ));
    }
    check_writable(&files(args))?;
    let old = match &args.baseline {
        Some(path) => Some((path.as_path(), read(path)?)),
        None => None,
    };
    let (preset, params) = preset::load_one(&args.method, &preset::sources())?;
    let method = Method::new(&preset, params);
    let gpu = render::open(asked, preset.graph.features())?;
    let Stage { scene, views } = Stage::load(&args.scene)?;
    let scene = Arc::new(scene);
    let Some(view) = views.first() else {
        return Err(CliError::Input(format!(
            "the scene `{}` has no view",
            scene.name
        )));
    };
    let mut provider = SceneProvider::new(scene.clone());
    provider.set_view(view, args.method.size.0);
    let plan = method
        .plan(args.method.size.0, render::abilities(&gpu), &provider)
        .map_err(|diagnostics| Faults::of(&preset.name, &diagnostics))?;
    preset::warn(&preset.graph, plan.warnings());
    interrupt::install()?;

    let trust = render::trust(&gpu);
    let conditions = Conditions {
        program: concat!("skiagraph ", env!("CARGO_PKG_VERSION")).into(),
        build: if cfg!(debug_assertions) {
            "debug"
        } else {
            "release"
        }
        .into(),
        date: date::utc(SystemTime::now()),
        adapter: render::describe(&gpu, &trust),
        scene: Scene {
            name: scene.name.clone(),
            triangles: scene.mesh.triangles.len() as u64,
        },
        preset: preset.name.clone(),
        view: view.name.clone(),
        viewport: args.method.size.0,
        params: method.all_params(),
        frames: args.frames,
        warmup: args.warmup,
    };
    let (passes, memory) = (plan.passes(), memory(&plan));
    let refused = |error| render::failed(&preset.name, error);
    let mut executor =
        Executor::new(&gpu.device, &gpu.queue, plan, &mut provider).map_err(refused)?;
    let step = Step::begin(
        format!("{}, {} {}", preset.name, view.name, args.method.size),
        u64::from(args.warmup) + u64::from(args.frames),
        "frames",
    );
    let reach = |frames| step.reach(frames);
    let timed = render::sample(
        &gpu,
        &mut executor,
        Work::All,
        args.warmup,
        args.frames,
        reach,
    );
    let timed = timed.map_err(refused)?;
    step.end();

    let samples = Samples::of(&timed);
    let Some(mut profile) = Profile::new(conditions, &passes, &samples, memory) else {
        return Err(CliError::Interrupted {
            kept: "no frame was timed".into(),
        });
    };
    profile.baseline = old.map(|(path, old)| Comparison::of(path, &old, &profile));
    print(&profile.report())?;
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

fn memory(plan: &Plan) -> Memory {
    Memory {
        bytes: plan.memory_bytes(),
        saved_bytes: plan.saved_bytes(),
        materials: plan.memory().into_iter().map(Into::into).collect(),
    }
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
        let csv = profile
            .to_csv()
            .map_err(|error| CliError::write(path, error))?;
        write_whole(path, csv.as_bytes())?;
    }
    if let Some(path) = &args.json {
        write_whole(path, profile.to_json().as_bytes())?;
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
