//! `skiagraph run`: one frame of one graph, and any of its materials as a file.

use crate::{
    args::RunArgs,
    error::{CliError, print},
    files::write_whole,
    parse::{Encoding, Save},
    picture::{self, Picture},
    preset::{self, Faults, Preset},
    render,
    stage::Stage,
    table::bytes,
};
use skiagraph_graph::{Capture, Content, Executor, Plan, PlanRequest, gpu::Gpu};
use skiagraph_passes::SceneProvider;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Component, PathBuf},
    slice,
    sync::Arc,
};

/// Plans, renders one frame, says what ran, and saves what was asked for.
///
/// # Errors
/// A faulty graph, a scene that cannot be loaded, no GPU, a file that cannot be written.
pub fn run(args: &RunArgs, adapter: Option<&str>) -> Result<(), CliError> {
    let sources = preset::sources();
    let [preset] = &preset::load_all(slice::from_ref(&args.preset), &sources)?[..] else {
        return Err(CliError::Input("no graph".into()));
    };
    preset::check_names(slice::from_ref(preset), &args.params)?;
    let params = preset::params(preset, &args.params, args.map_size)?;
    if args.scene.view.as_deref() == Some("all") && !args.save.is_empty() {
        return Err(CliError::Usage(
            "--save takes the picture of one view; give its name instead of `all`".into(),
        ));
    }
    check_files(&args.save)?;
    let gpu = render::open(adapter, preset.graph.features())?;
    let stage = Stage::load(&args.scene)?;
    let scene = Arc::new(stage.scene);
    let mut provider = SceneProvider::new(scene.clone());
    for view in &stage.views {
        provider.set_view(view, args.size.0);
        let mut request = PlanRequest::new(args.size.0, &provider);
        request.params = params.clone();
        request.captures = captures(preset, &args.save);
        request.limits = gpu.device.limits();
        request.features = gpu.device.features();
        let plan = preset
            .graph
            .plan(&request)
            .map_err(|diagnostics| Faults::of(&preset.name, &diagnostics))?;
        preset::warn(&preset.graph, plan.warnings());
        check_pictures(&plan, &args.save)?;
        print(&format!(
            "{} on {}, view {}, {}\n{}",
            preset.name,
            scene.name,
            view.name,
            args.size,
            story(&plan)
        ))?;
        let contents = render(&gpu, plan, &mut provider, &args.save, preset)?;
        for save in &args.save {
            let name = capture(save).name();
            let Some(content) = contents.get(&name) else {
                return Err(CliError::Input(format!(
                    "`{}` has no `{name}` to save",
                    preset.name
                )));
            };
            print(&write(save, content)?)?;
        }
    }
    Ok(())
}

fn capture(save: &Save) -> Capture {
    Capture {
        material: save.material.clone(),
        after: save.after.clone(),
    }
}

/// Refuses two saves into one file.
fn check_files(saves: &[Save]) -> Result<(), CliError> {
    let place = |save: &Save| -> PathBuf {
        let parts = save.file.components();
        parts.filter(|part| *part != Component::CurDir).collect()
    };
    for (index, save) in saves.iter().enumerate() {
        if let Some(earlier) = saves[..index]
            .iter()
            .find(|other| place(other) == place(save))
        {
            return Err(CliError::Usage(format!(
                "--save {} and --save {} both write {}; give each a file of its own",
                capture(earlier).name(),
                capture(save).name(),
                save.file.display()
            )));
        }
    }
    Ok(())
}

/// Refuses the picture of a buffer before anything is rendered.
fn check_pictures(plan: &Plan, saves: &[Save]) -> Result<(), CliError> {
    let outputs = plan.outputs();
    for save in saves.iter().filter(|save| save.encoding == Encoding::Png) {
        let name = capture(save).name();
        if outputs
            .iter()
            .any(|output| output.name == name && output.format.is_none())
        {
            return Err(CliError::Input(format!(
                "`{name}` is a buffer and has no picture; save it as .bin"
            )));
        }
    }
    Ok(())
}

/// What of the saves the graph does not hand out anyway.
fn captures(preset: &Preset, saves: &[Save]) -> Vec<Capture> {
    let outputs = preset.graph.outputs();
    let wanted: BTreeMap<String, Capture> = saves
        .iter()
        .map(capture)
        .map(|capture| (capture.name(), capture))
        .collect();
    wanted
        .into_iter()
        .filter(|(name, _)| !outputs.contains(&name.as_str()))
        .map(|(_, capture)| capture)
        .collect()
}

fn render(
    gpu: &Gpu,
    plan: Plan,
    provider: &mut SceneProvider,
    saves: &[Save],
    preset: &Preset,
) -> Result<BTreeMap<String, Content>, CliError> {
    let names: BTreeSet<String> = saves.iter().map(|save| capture(save).name()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let read = || {
        let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, provider)?;
        render::read(gpu, &mut executor, &names)
    };
    read().map_err(|error| CliError::Gpu {
        graph: preset.name.clone(),
        source: Box::new(error),
    })
}

/// Which passes ran, which did not and why, and what was built for them.
fn story(plan: &Plan) -> String {
    let mut text = String::new();
    for pass in plan.passes() {
        text.push_str(&format!("  ran {} ({})\n", pass.name, pass.kind));
    }
    for pass in plan.culled() {
        text.push_str(&format!("  left out {}: {}\n", pass.name, pass.reason));
    }
    let provided = match &plan.provided()[..] {
        [] => "nothing".into(),
        names => names.join(", "),
    };
    text.push_str(&format!("  built for it: {provided}\n"));
    text.push_str(&format!(
        "  materials: {}, {} saved by sharing\n",
        bytes(plan.memory_bytes()),
        bytes(plan.saved_bytes())
    ));
    text
}

fn write(save: &Save, content: &Content) -> Result<String, CliError> {
    let file = save.file.display();
    match save.encoding {
        Encoding::Png => {
            let picture = Picture::of(&save.material, content).map_err(|reason| {
                CliError::Input(format!(
                    "--save {}: `{}` {reason}",
                    save.material, save.material
                ))
            })?;
            picture::save(&save.file, &picture.image)?;
            let [width, height] = picture.image.size;
            Ok(format!(
                "  saved {file}: {width}x{height}, {}\n",
                picture.legend
            ))
        }
        Encoding::Raw => {
            let (raw, what) = match content {
                Content::Texture {
                    format,
                    size: [width, height],
                    bytes,
                } => (bytes, format!("{width}x{height} texels of {format:?}")),
                Content::Buffer(bytes) => (bytes, "a buffer".into()),
            };
            write_whole(&save.file, raw)?;
            Ok(format!(
                "  saved {file}: {}, {what}\n",
                bytes(raw.len() as u64)
            ))
        }
    }
}
