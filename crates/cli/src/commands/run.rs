//! `skiagraph run`: renders a frame of a graph, or several, and saves materials to files.

use crate::args::commands::RunArgs;
use crate::args::shared::GpuArgs;
use crate::commands::run_sequence::{of_frame, record, sequence};
use crate::error::CliError;
use crate::scene_selection::SceneSelection;
use crate::terminal::{Terminal, console::print};
use skiagraph_compare::files::write::check_writable;
use skiagraph_compare::graphs::idle_params::IdleParams;
use skiagraph_compare::graphs::planning::Capabilities;
use skiagraph_compare::graphs::preset;
use skiagraph_compare::measuring::frame_sequence::FrameSequence;
use skiagraph_compare::measuring::view_or_path::ViewOrPath;
use skiagraph_compare::measuring::{device, poison};
use skiagraph_compare::pictures::save::{Save, captures, check_encodings};
use skiagraph_compare::sink::Session;
use skiagraph_compare::wording::bytes;
use skiagraph_graph::Plan;
use skiagraph_passes::SceneProvider;
use std::sync::Arc;

/// Renders one frame of a graph, or a sequence, prints which passes ran, and saves the materials
/// that the arguments name.
///
/// # Errors
/// If the graph has errors, a scene cannot be loaded, no GPU can be opened, or a file cannot be
/// written.
pub async fn run(args: &RunArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let (method, saves) = (&args.method, &args.save);
    let (preset, params) = &method.load(&preset::sources(&Terminal))?;
    if args.scene.view.as_deref() == Some("all") && !saves.is_empty() {
        return Err(CliError::Usage(
            "--save takes the picture of one view; give its name instead of `all`".into(),
        ));
    }

    let is_sequence = args.frames.is_some() || args.path.is_some();
    let files = saves.iter().map(|save| of_frame(save, 0, is_sequence));
    let files: Vec<Save> = files.collect();
    let name = |save: &Save| format!("--save {}", save.capture.name());
    let files = files.iter().map(|save| (name(save), save.file.as_path()));
    check_writable(&files.collect::<Vec<_>>())?;
    let gpu = device::open(&gpu.request(), [&preset.graph])?;
    let session = Session::new(&gpu, &Terminal);
    let selection = SceneSelection::load(&args.scene)?;
    let (mut views, scene) = (selection.views, Arc::new(selection.scene));
    let sequence = sequence(args, &scene, &views, &selection.paths)?;
    let mut provider = SceneProvider::new(scene.clone());
    if let Some(sequence) = &sequence {
        let first = sequence.poses.iter().take(1);
        views = first.map(|pose| pose.view.clone()).collect();
        sequence.begin(&scene, &mut provider, &mut None);
    }
    let mut idle = IdleParams::default();
    for view in &views {
        provider.set_view(view, method.size.0);
        let mut request = Capabilities::new(&gpu).request(method.size.0, &provider);
        request.params = params.clone();
        request.captures = captures(&preset.graph.default_outputs(), saves);
        let plan = preset.plan(&request, &Terminal)?;
        idle.note_of(&Terminal, &preset.name, &plan, provider.light());
        check_encodings(&plan, saves)?;
        let place = format!("{}, view {}, {}", scene.name, view.name, method.size);
        print(&format!("{} on {place}\n{}", preset.name, summary(&plan)))?;
        let mut poisoned = None;
        if args.poison {
            poisoned = Some(poison::check(session, &plan, &mut provider, preset).await);
        }
        let still = ViewOrPath::Still(view.clone());
        let still = FrameSequence::new(&still, &scene, None, None)?;
        let frames = (sequence.as_ref().unwrap_or(&still), is_sequence);
        record(frames, session, (preset, plan), &mut provider, saves).await?;
        if let Some(verdict) = poisoned {
            print(&verdict?)?;
        }
    }
    Ok(())
}

/// Which passes ran, which did not and why, and what was built for them.
fn summary(plan: &Plan) -> String {
    let mut text = String::new();
    for pass in plan.passes() {
        text += &format!("  ran {} ({})\n", pass.name, pass.kind);
    }
    for pass in plan.culled() {
        text += &format!("  left out {}: {}\n", pass.name, pass.reason);
    }
    let provided = match &plan.provided()[..] {
        [] => "nothing".into(),
        names => names.join(", "),
    };
    text += &format!("  built for it: {provided}\n");
    let [size, saved] = [plan.memory_bytes(), plan.saved_bytes()].map(bytes);
    text += &format!("  materials: {size}, {saved} saved by sharing\n");
    text
}
