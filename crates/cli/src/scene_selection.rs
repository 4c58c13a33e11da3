//! Loads the scene and the views that the arguments name.

use crate::args::shared::SceneArgs;
use crate::error::CliError;
use crate::terminal::{Terminal, console::note, progress};
use itertools::Itertools;
use skiagraph_compare::error::CompareError;
use skiagraph_compare::files::scene::write_scene;
use skiagraph_compare::measuring::view_or_path::{ViewOrPath, under_lights};
use skiagraph_compare::own_scene::OwnScene;
use skiagraph_compare::own_scene_notes;
use skiagraph_compare::sink::Sink;
use skiagraph_compare::wording::did_you_mean;
use skiagraph_scene::{
    CameraPath, ImportReport, MeshFile, Scene, SceneError, SceneFile, SceneLibrary, View,
};
use std::path::Path;

/// A loaded scene with the views that the arguments select, at least one.
#[derive(Debug)]
pub struct SceneSelection {
    /// The loaded scene.
    pub scene: Scene,
    /// The selected views.
    pub views: Vec<View>,
    /// Further views that were chosen for a mesh file without cameras, where no view is named: it
    /// is not sure that the first is the one that is meant.
    pub further: Vec<View>,
    /// Camera paths: of the scene file, or from the animations of a mesh file.
    pub paths: Vec<CameraPath>,
    /// Notes on the scene, one line each, that were printed while it was loaded.
    pub notes: Vec<String>,
}

impl SceneSelection {
    /// Loads the scene and selects its views. Prints what the import had to repair or leave out,
    /// and what was chosen for the scene.
    ///
    /// # Errors
    /// If the scene cannot be loaded, lacks a named view, or the camera of the arguments is
    /// invalid.
    pub fn load(args: &SceneArgs) -> Result<Self, CliError> {
        let is_mesh = MeshFile::is_one(Path::new(args.scene()));
        if !is_mesh && (args.materials.is_some() || args.concave.is_some() || args.ground) {
            return Err(CliError::Usage(format!(
                "--materials, --concave and --ground are of a mesh file (.obj, .gltf, .glb); a \
                 scene file says `materials`, `concave` and `ground` itself, so leave them out \
                 with --scene {}",
                args.scene()
            )));
        }
        progress::begin_quietly(&format!("loading {}", args.scene()), 1, "scenes");
        let selection = Self::load_quietly(args, is_mesh);
        Terminal.end_step(false);
        selection
    }

    fn load_quietly(args: &SceneArgs, is_mesh: bool) -> Result<Self, CliError> {
        let library = SceneLibrary::from_environment();
        let mut notes = Notes::default();
        if let Some(file) = library.stand_in(args.scene()) {
            let (file, scene) = (file.display(), args.scene());
            let text = format!("{file} stands in for the built-in scene `{scene}`, which differs");
            notes.print(text);
        }
        let (options, explain) = (args.mesh_scene(), |error| explain(error, args, &library));
        let own = if is_mesh {
            let own = OwnScene::of_mesh(Path::new(args.scene()), &options).map_err(explain)?;
            for text in own_scene_notes::notes(&options, &own) {
                notes.print_on(args, text);
            }
            own
        } else {
            library.load(args.scene()).map_err(explain)?.into()
        };
        notes.print_report(args, &own.report);
        if args.eye.is_some() && args.view.as_deref() == Some("all") && own.scene.views.len() > 1 {
            let text = "--eye is one view of your own: leave out --view all, or --eye";
            return Err(CliError::Usage(text.into()));
        }
        let views = own.views(args.view.as_deref(), &options.camera, options.sun)?;
        let mut further = Vec::new();
        if own.chosen.view && args.view.is_none() {
            further = own.views(Some("all"), &options.camera, options.sun)?;
            further.remove(0);
        }
        let standing = views.first();
        let (paths, failed) = standing.map_or_else(Default::default, |view| own.paths(view));
        for text in failed {
            notes.print_on(args, format!("{text}: left out"));
        }
        if !paths.is_empty() {
            let names = paths.iter().map(|path| &path.view.name).join(", ");
            notes.print_on(args, format!("its animations, for --path: {names}"));
        }
        if let Some(path) = &args.write_scene {
            let file = if is_mesh {
                own.file(args.scene(), &options, paths.clone())
            } else {
                library.scene_file(args.scene()).map_err(explain)?
            };
            write(path, file, &views)?;
        }
        let paths = if is_mesh {
            paths
        } else {
            library.paths(args.scene()).map_err(explain)?
        };
        let under_lights = |views| under_lights(&own.scene, views, args.light_name());
        let (views, further) = (under_lights(views)?, under_lights(further)?);
        if let Some(text) = own_scene_notes::from_below(&views, options.sun) {
            notes.print(text);
        }
        Ok(Self {
            scene: own.scene,
            views,
            further,
            paths,
            notes: notes.0,
        })
    }
}

/// Lines on a scene that were printed.
#[derive(Default)]
struct Notes(Vec<String>);

impl Notes {
    fn print(&mut self, text: String) {
        note(&text);
        self.0.push(text);
    }

    /// Prints a line behind the name of the scene.
    fn print_on(&mut self, args: &SceneArgs, text: String) {
        note(&format!("{}: {text}", args.scene()));
        self.0.push(text);
    }

    /// Prints the repairs of an import, several below each other.
    fn print_report(&mut self, args: &SceneArgs, report: &ImportReport) {
        if report.has_warnings() {
            let text = report.to_string();
            let text = text.trim_end();
            let begin = if text.contains('\n') { "\n  " } else { " " };
            self.0.extend(text.lines().map(str::to_owned));
            let text = text.replace('\n', "\n  ");
            note(&format!("{}:{begin}{text}", args.scene()));
        }
    }
}

/// Writes the file of `--write-scene`.
fn write(path: &Path, file: SceneFile, views: &[View]) -> Result<(), CliError> {
    let is_new = write_scene(path, file, views).map_err(|error| match error {
        CompareError::Request(text) => CliError::Usage(format!("--write-scene {text}")),
        error => error.into(),
    })?;
    if is_new {
        let path = path.display();
        note(&format!(
            "wrote {path}, to be edited (docs/scenes.md); use it with --scene {path}"
        ));
    }
    Ok(())
}

fn explain(error: SceneError, args: &SceneArgs, library: &SceneLibrary) -> CliError {
    match error {
        SceneError::BadView { .. } => CliError::Usage(error.to_string()),
        SceneError::UnknownScene { .. } => {
            let scenes = library.list();
            let hint = did_you_mean(args.scene(), scenes.iter().map(|scene| scene.name.as_str()));
            CliError::Input(format!("{error}{hint}"))
        }
        SceneError::SceneFile(diagnostics) => CliError::Compare(CompareError::Diagnostics {
            faults: vec![diagnostics.iter().cloned().collect()],
            summary: format!("cannot load the scene `{}`", args.scene()),
        }),
        error => CliError::Scene {
            name: args.scene().to_owned(),
            source: Box::new(error),
        },
    }
}

/// Returns the camera paths that `name`, the value of `--path`, selects, under the lights that
/// `light` selects. `own` holds the paths of the scene.
///
/// # Errors
/// If the arguments set a camera or a light as well, or the path or light does not exist.
pub fn paths(
    args: &SceneArgs,
    scene: &Scene,
    own: &[CameraPath],
    name: &str,
    light: Option<&str>,
) -> Result<Vec<ViewOrPath>, CliError> {
    if !args.camera().is_empty() || args.own_light().is_some() {
        return Err(CliError::Usage(format!(
            "--path {name} brings its camera and its light: leave out --eye, --look, --up, --fov, \
             --near, --far and --light x,y,z"
        )));
    }
    Ok(ViewOrPath::paths(scene, own.to_vec(), name, light)?)
}
