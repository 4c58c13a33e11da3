//! `skiagraph run`: renders the frames of a view or path to files, numbered ones of a sequence.

use crate::args::commands::RunArgs;
use crate::error::CliError;
use crate::scene_selection::paths;
use crate::terminal::{Terminal, console::print, interrupt};
use skiagraph_compare::graphs::preset::Preset;
use skiagraph_compare::measuring::frame;
use skiagraph_compare::measuring::frame_sequence::FrameSequence;
use skiagraph_compare::measuring::view_or_path::ViewOrPath;
use skiagraph_compare::pictures::colours::ClipPlanes;
use skiagraph_compare::pictures::run_pictures::numbered;
use skiagraph_compare::pictures::save::{Save, decodings, names, write_all};
use skiagraph_compare::sink::{Session, Step};
use skiagraph_compare::wording::frames;
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::Plan;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{CameraPath, Scene, View};

/// Returns `save` with the file of a frame; a numbered one is `v.0003.png` for `v.png` and index 3.
pub fn of_frame(save: &Save, index: usize, is_numbered: bool) -> Save {
    let mut save = save.clone();
    if is_numbered {
        save.file = numbered(&save.file, index);
    }
    save
}

/// Returns the frames of the path that the arguments name, or of the only view. `None` without
/// `--frames` and `--path`. `own` holds a mesh file's paths; other scenes list theirs in a file.
///
/// # Errors
/// If the path does not exist or has too few frames, or the arguments select several views or
/// paths.
pub fn sequence(
    args: &RunArgs,
    scene: &Scene,
    views: &[View],
    own: &[CameraPath],
) -> Result<Option<FrameSequence>, CliError> {
    let view_or_path = match (&args.path, args.frames, views) {
        (None, None, _) if args.jitter.is_some() => {
            return Err(CliError::Usage("--jitter needs --frames or --path".into()));
        }
        (None, None, _) => return Ok(None),
        (Some(name), ..) => path(args, scene, own, name)?,
        (None, Some(_), [view]) => ViewOrPath::Still(view.clone()),
        (None, Some(_), _) => {
            let text = "--frames is of one view under one light";
            return Err(CliError::Usage(text.into()));
        }
    };
    if let (ViewOrPath::Path(path), Some(count)) = (&view_or_path, args.frames)
        && count > path.frames()
    {
        return Err(CliError::Input(format!(
            "--frames {count}: the path `{}` has {}",
            view_or_path.name(),
            frames(path.frames())
        )));
    }
    let sequence = FrameSequence::new(&view_or_path, scene, args.jitter, args.frames)?;
    Ok(Some(sequence))
}

fn path(
    args: &RunArgs,
    scene: &Scene,
    own: &[CameraPath],
    name: &str,
) -> Result<ViewOrPath, CliError> {
    let light = args.scene.light_name();
    let mut selected = paths(&args.scene, scene, own, name, light)?.into_iter();
    match (selected.next(), selected.next()) {
        (Some(path), None) => Ok(path),
        _ => Err(CliError::Usage(
            "--save takes the pictures of one path under one light; name them".into(),
        )),
    }
}

/// Renders the frames of a view or path one after another, starting without earlier frames, and
/// saves the requested materials of each, in numbered files if `are_numbered`. Files are written
/// whole; of numbered ones Ctrl-C keeps those of finished frames.
///
/// # Errors
/// If Ctrl-C stops the command, the executor fails, or a file cannot be written.
pub async fn record(
    (sequence, are_numbered): (&FrameSequence, bool),
    session: Session<'_>,
    (preset, plan): (&Preset, Plan),
    provider: &mut SceneProvider,
    saves: &[Save],
) -> Result<(), CliError> {
    if are_numbered {
        interrupt::install()?;
    }
    let failed = |error| frame::failed(session, &preset.name, error);
    let viewport = plan.viewport();
    let settled = frame::settled(session, plan, provider).await;
    let (mut executor, growth) = settled.map_err(failed)?;
    print(&growth.text())?;
    if let Some(pass) = executor.waits_in() {
        print(&format!("  waits for the CPU, which works in {pass}\n"))?;
    }
    let names = names(saves);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let total = sequence.poses.len();
    let step = are_numbered.then(|| Step::begin(&Terminal, &preset.name, total as u64, "frames"));
    for (index, pose) in sequence.poses.iter().enumerate() {
        if session.is_stopped() {
            let kept = format!("the pictures of {} are there", frames(index as u32));
            return Err(CliError::Interrupted { kept });
        }
        sequence.show(index, viewport, provider)?;
        let decodings = decodings(executor.plan(), saves, ClipPlanes::new(&pose.view));
        let request = Frame::new().with_read(&names);
        let request = request.with_seconds(sequence.seconds(index));
        let draw = async |executor: &mut Executor| frame::run(session, executor, &request).await;
        let drawn = frame::next(&mut executor, provider, draw).await;
        let contents = frame::contents(drawn.map_err(failed)?.frame.0.readbacks);
        let files = saves.iter().map(|save| of_frame(save, index, are_numbered));
        let files: Vec<Save> = files.collect();
        for line in write_all(&preset.name, &files, &decodings, &contents) {
            let line = line?;
            if !are_numbered {
                print(&line)?;
            }
        }
        step.iter().for_each(|step| step.set_done(index as u64 + 1));
    }
    step.into_iter().for_each(Step::end);
    for save in saves.iter().filter(|_| are_numbered) {
        let file = |index| numbered(&save.file, index);
        print(&format!(
            "  saved {}: {} to {}\n",
            save.capture.name(),
            file(0).display(),
            file(total.saturating_sub(1)).display()
        ))?;
    }
    Ok(())
}
