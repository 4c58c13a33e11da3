//! `skiagraph run`: one frame of one graph, and any of its materials as a file.

use crate::{
    args::{GpuArgs, RunArgs},
    error::{CliError, print},
    files::{check_writable, write_whole},
    items,
    parse::{Encoding, Save},
    picture::{self, Picture, Planes},
    preset::{self, Faults, Preset},
    render,
    stage::Stage,
    table::{bytes, percent, thousands},
};
use skiagraph_graph::{Capture, Content, Executor, Item, Plan, PlanRequest, gpu::Gpu};
use skiagraph_passes::{
    SceneProvider,
    provider::{CAMERA, LIGHT},
};
use skiagraph_scene::View;
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

/// Plans, renders one frame, says what ran, and saves what was asked for.
///
/// # Errors
/// A faulty graph, a scene that cannot be loaded, no GPU, a file that cannot be written.
pub fn run(args: &RunArgs, asked: &GpuArgs) -> Result<(), CliError> {
    let RunArgs {
        method,
        scene,
        save,
        poison,
    } = args;
    let (preset, params) = &preset::load_one(method, &preset::sources())?;
    if scene.view.as_deref() == Some("all") && !save.is_empty() {
        return Err(CliError::Usage(
            "--save takes the picture of one view; give its name instead of `all`".into(),
        ));
    }
    let writer = |save: &Save| format!("--save {}", capture(save).name());
    let files: Vec<_> = save
        .iter()
        .map(|save| (writer(save), save.file.as_path()))
        .collect();
    check_writable(&files)?;
    let gpu = render::open(asked, preset.graph.features())?;
    let stage = Stage::load(scene)?;
    let scene = Arc::new(stage.scene);
    let mut provider = SceneProvider::new(scene.clone());
    for view in &stage.views {
        provider.set_view(view, method.size.0);
        let mut request = PlanRequest::new(method.size.0, &provider);
        request.params = params.clone();
        request.captures = captures(preset, save);
        render::abilities(&gpu).ask(&mut request);
        let plan = preset
            .graph
            .plan(&request)
            .map_err(|diagnostics| Faults::of(&preset.name, &diagnostics))?;
        preset::warn(&preset.graph, plan.warnings());
        check_encodings(&plan, save)?;
        let readings: Vec<Reading> = save
            .iter()
            .map(|save| Reading::of(&plan, save, view))
            .collect();
        print(&format!(
            "{} on {}, view {}, {}\n{}",
            preset.name,
            scene.name,
            view.name,
            method.size,
            story(&plan)
        ))?;
        let poisoned = poison.then(|| poisoned(&gpu, &plan, &mut provider, preset));
        let contents = render(&gpu, plan, &mut provider, save, preset)?;
        for (save, reading) in save.iter().zip(readings) {
            let name = capture(save).name();
            let Some(content) = contents.get(&name) else {
                return Err(CliError::Input(format!(
                    "`{}` has no `{name}` to save",
                    preset.name
                )));
            };
            print(&write(save, content, &reading)?)?;
        }
        if let Some(verdict) = poisoned {
            print(&verdict?)?;
        }
    }
    Ok(())
}

/// Renders with two patterns in all memory that a frame has not written yet: outputs that differ depend on what nobody wrote.
///
/// # Errors
/// Names these outputs.
fn poisoned(
    gpu: &Gpu,
    plan: &Plan,
    provider: &mut SceneProvider,
    preset: &Preset,
) -> Result<String, CliError> {
    let outputs = preset.graph.outputs();
    let mut render = |pattern: u8| {
        let plan = plan
            .with(|request| request.poison = Some(pattern))
            .map_err(|diagnostics| Faults::of(&preset.name, &diagnostics))?;
        let read = || {
            let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, provider)?;
            render::read(gpu, &mut executor, &outputs)
        };
        read().map_err(|error| render::failed(&preset.name, error))
    };
    let (low, high) = (render(0x11)?, render(0xee)?);
    let mut differing = Vec::new();
    for (name, content) in &low {
        let other = high.get(name).map_or(&[][..], Content::bytes);
        let bytes = content.bytes().iter().zip(other);
        let count = bytes.filter(|(a, b)| a != b).count();
        if count > 0 {
            let all = content.bytes().len() as u64;
            differing.push(format!(
                "`{name}` ({} of its bytes)",
                percent(count as u64, all)
            ));
        }
    }
    if differing.is_empty() {
        return Ok(
            "  poisoned memory: no output depends on what the frame has not written\n".into(),
        );
    }
    Err(CliError::Input(format!(
        "`{}` reads memory that no pass has written in the frame: with two patterns in it, {} differ\n  clear what is written only in part, and promise by `overwrites` only what holds",
        preset.name,
        differing.join(", ")
    )))
}

fn capture(save: &Save) -> Capture {
    Capture {
        material: save.material.clone(),
        after: save.after.clone(),
    }
}

/// Refuses the picture of a buffer and the items of a texture before anything is rendered.
fn check_encodings(plan: &Plan, saves: &[Save]) -> Result<(), CliError> {
    let outputs = plan.outputs();
    for save in saves {
        let name = capture(save).name();
        let Some(output) = outputs.iter().find(|output| output.name == name) else {
            continue;
        };
        let refused = match (save.encoding, output.format) {
            (Encoding::Png, None) => "is a buffer and has no picture; save it as .csv or .bin",
            (Encoding::Csv, Some(_)) => "is a texture and has no items; save it as .png or .bin",
            _ => continue,
        };
        return Err(CliError::Input(format!("`{name}` {refused}")));
    }
    Ok(())
}

/// How the contents of one save are to be read.
struct Reading {
    /// The camera whose depths they are, if they are depths.
    planes: Option<Planes>,
    /// The items of a buffer.
    item: Option<Item>,
}

impl Reading {
    fn of(plan: &Plan, save: &Save, view: &View) -> Self {
        let name = capture(save).name();
        let behind = plan.provided_behind(&name);
        // A pass that also knows the light may well draw from there.
        let is_camera = behind.contains(CAMERA) && !behind.contains(LIGHT);
        let planes = || Planes {
            near: view.near,
            far: view.far,
        };
        Self {
            planes: is_camera.then(planes),
            item: plan.item(&name),
        }
    }
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
    read().map_err(|error| render::failed(&preset.name, error))
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

fn write(save: &Save, content: &Content, reading: &Reading) -> Result<String, CliError> {
    let file = save.file.display();
    match save.encoding {
        Encoding::Png => {
            let picture =
                Picture::of(&save.material, content, reading.planes).map_err(|reason| {
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
        Encoding::Csv => {
            let raw = content.bytes();
            let table = items::to_csv(raw, reading.item.as_ref())
                .map_err(|error| CliError::write(&save.file, error))?;
            write_whole(&save.file, &table)?;
            let (stride, what) = match &reading.item {
                Some(item) => (item.stride, "items as the shader declares them"),
                None => (4, "words, each read as u32, i32 and f32"),
            };
            let lines = thousands((raw.len() / stride.max(1)) as u64);
            Ok(format!("  saved {file}: {lines} {what}\n"))
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
