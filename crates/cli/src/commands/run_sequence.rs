//! `skiagraph run --frames`: a numbered sequence of pictures.

use crate::args::commands::RunArgs;
use crate::error::CliError;
use crate::scene_selection::paths;
use crate::terminal::console::print;
use crate::terminal::{Terminal, interrupt};
use skiagraph_compare::graphs::preset::Preset;
use skiagraph_compare::measuring::camera_pose::CameraPose;
use skiagraph_compare::measuring::frame;
use skiagraph_compare::measuring::mesh_frames::MeshFrames;
use skiagraph_compare::measuring::view_or_path::ViewOrPath;
use skiagraph_compare::pictures::colours::ClipPlanes;
use skiagraph_compare::pictures::run_pictures::numbered;
use skiagraph_compare::pictures::save::{Save, capture, decodings, names, write_all};
use skiagraph_compare::sink::{Session, Step};
use skiagraph_compare::wording::frames;
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::Plan;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{CameraPath, Scene, View};

/// The file in which a frame is saved.
pub fn of_frame(save: &Save, index: usize) -> Save {
    Save {
        file: numbered(&save.file, index),
        ..save.clone()
    }
}

/// The views of the frames that are asked for, with how many there are in a second.
pub struct PoseSequence {
    poses: Vec<CameraPose>,
    /// The mesh in each frame, where parts of it move.
    mesh_frames: Option<MeshFrames>,
    frames_per_second: f64,
}

impl PoseSequence {
    /// Collects the frames of each path that is asked for, or of each view; none without `--frames`
    /// and `--path`.
    ///
    /// # Errors
    /// No such path, or one that has fewer frames.
    pub fn new(
        args: &RunArgs,
        scene: &Scene,
        views: &[View],
        own: &[CameraPath],
    ) -> Result<Option<Self>, CliError> {
        let view_or_path = match (&args.path, args.frames, views) {
            (None, None, _) if args.jitter.is_some() => {
                return Err(CliError::Usage("--jitter needs --frames or --path".into()));
            }
            (None, None, _) => return Ok(None),
            (Some(name), ..) => Self::path(args, scene, own, name)?,
            (None, Some(_), [view]) => ViewOrPath::Still(view.clone()),
            (None, Some(_), _) => {
                return Err(CliError::Usage(
                    "--frames is of one view under one light".into(),
                ));
            }
        };
        let of_path = view_or_path.poses(args.jitter);
        let poses = match (&view_or_path, args.frames) {
            (ViewOrPath::Still(view), Some(count)) => {
                CameraPose::numbered(vec![view.clone(); count as usize], args.jitter)
            }
            (ViewOrPath::Path(_), Some(count)) if count as usize > of_path.len() => {
                return Err(CliError::Input(format!(
                    "--frames {count}: the path `{}` has {}",
                    view_or_path.name(),
                    frames(of_path.len() as u32)
                )));
            }
            (_, count) => {
                let count = count.map_or(of_path.len(), |count| count as usize);
                of_path.into_iter().take(count).collect()
            }
        };
        Ok(Some(Self {
            frames_per_second: view_or_path.frames_per_second(),
            mesh_frames: view_or_path.mesh_frames(scene, poses.len())?,
            poses,
        }))
    }

    fn path(
        args: &RunArgs,
        scene: &Scene,
        own: &[CameraPath],
        name: &str,
    ) -> Result<ViewOrPath, CliError> {
        let light = args.scene.light_name();
        let mut found = paths(&args.scene, scene, own, name, light)?.into_iter();
        match (found.next(), found.next()) {
            (Some(path), None) => Ok(path),
            _ => Err(CliError::Usage(
                "--save takes the pictures of one path under one light; name them".into(),
            )),
        }
    }

    /// Gives the provider the mesh of the first frame.
    pub fn begin(&self, provider: &mut SceneProvider) {
        if let Some(mesh_frames) = &self.mesh_frames {
            mesh_frames.begin(provider);
        }
    }

    /// The first frame's view.
    pub fn first(&self) -> Option<&View> {
        self.poses.first().map(|pose| &pose.view)
    }

    /// Renders the frames one after the other, the first with an empty memory, and saves what is
    /// asked for of each: every file whole, those of the frames before an interrupt stay.
    ///
    /// # Errors
    /// Ctrl-C, those of the executor, a file that cannot be written.
    pub fn record(
        &self,
        session: Session,
        (preset, plan): (&Preset, Plan),
        provider: &mut SceneProvider,
        saves: &[Save],
    ) -> Result<(), CliError> {
        interrupt::install()?;
        let failed = |error| frame::failed(session, &preset.name, error);
        let viewport = plan.viewport();
        let (mut executor, growth) = frame::settled(session, plan, provider).map_err(failed)?;
        print(&growth.text())?;
        let step = Step::begin(&Terminal, &preset.name, self.poses.len() as u64, "frames");
        for (index, pose) in self.poses.iter().enumerate() {
            if session.is_stopped() {
                let kept = format!("the pictures of {} are there", frames(index as u32));
                return Err(CliError::Interrupted { kept });
            }
            pose.show(provider, viewport);
            if let Some(mesh_frames) = &self.mesh_frames {
                mesh_frames.show(index, provider)?;
            }
            let decodings = decodings(executor.plan(), saves, ClipPlanes::new(&pose.view));
            let contents = self
                .frame(session, &mut executor, provider, (index, saves))
                .map_err(failed)?;
            let files = saves.iter().map(|save| of_frame(save, index));
            let files: Vec<Save> = files.collect();
            write_all(&preset.name, &files, &decodings, &contents)
                .try_for_each(|said| said.map(drop))?;
            step.set_done(index as u64 + 1);
        }
        step.end();
        let last = self.poses.len().saturating_sub(1);
        for save in saves {
            let file = |index| numbered(&save.file, index);
            print(&format!(
                "  saved {}: {} to {}\n",
                capture(save).name(),
                file(0).display(),
                file(last).display()
            ))?;
        }
        Ok(())
    }

    fn frame(
        &self,
        session: Session,
        executor: &mut Executor,
        provider: &mut SceneProvider,
        (index, saves): (usize, &[Save]),
    ) -> Result<frame::Contents, skiagraph_gpu::ExecuteError> {
        executor.refresh(provider)?;
        let names = names(saves);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let request = Frame {
            read: &names,
            seconds: (index as f64 / self.frames_per_second) as f32,
            ..Frame::default()
        };
        let (report, _) = frame::run(session, executor, &request)?;
        executor.grow(provider)?;
        Ok(frame::contents(report.readbacks))
    }
}
