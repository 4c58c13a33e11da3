//! Finds scenes by name or path, and the meshes that they name.

use crate::error::SceneError;
use crate::gltf::load_gltf;
use crate::ground::add_ground;
use crate::limit::Limit;
use crate::mesh_file::{MeshFile, MeshFileOptions};
use crate::obj::options::ObjOptions;
use crate::obj::read::load_obj;
use crate::path::CameraPath;
use crate::report::ImportReport;
use crate::scene::Scene;
use crate::scene_file::{MeshSource, SceneFile};
use crate::text::has_extension;
use skiagraph_located_ron::diagnostics::Diagnostic;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Name of the environment variable that lists folders of meshes, separated as in `PATH`.
pub const ASSETS_VARIABLE: &str = "SKIAGRAPH_ASSETS";

/// Room for thousands of views.
const SCENE_FILE: Limit = Limit {
    of: "a scene file",
    mib: 1,
    way_out: "a mesh belongs into an .obj file of its own",
};

/// Scene files that are part of the program: name and text.
const BUILT_IN: [(&str, &str); 9] = [
    ("avenue", include_str!("../scenes/avenue.ron")),
    ("bench", include_str!("../scenes/bench.ron")),
    ("city", include_str!("../scenes/city.ron")),
    ("forest", include_str!("../scenes/forest.ron")),
    ("level", include_str!("../scenes/level.ron")),
    ("park", include_str!("../scenes/park.ron")),
    ("park_soft", include_str!("../scenes/park_soft.ron")),
    ("sponza", include_str!("../scenes/sponza.ron")),
    ("sponza_masked", include_str!("../scenes/sponza_masked.ron")),
];

/// One row of the list that `skiagraph scenes` prints.
#[derive(Clone, Debug, Default)]
pub struct SceneListing {
    /// Name of the scene on the command line.
    pub name: String,
    /// Description in one line, or the reason why the scene file cannot be read, which may have
    /// several lines.
    pub description: String,
    /// Names of the scene's views; empty if the scene file cannot be read.
    pub views: Vec<String>,
    /// Names of the scene's camera paths; empty if the scene file cannot be read.
    pub paths: Vec<String>,
    /// True if the scene's mesh is generated, or its file was found on disk.
    pub mesh_found: bool,
    /// Path of the scene file; `None` for a built-in scene, or if the text of the file cannot be
    /// read.
    pub file: Option<PathBuf>,
}

/// Folders in which scenes and meshes are searched.
#[derive(Clone, Debug, Default)]
pub struct SceneLibrary {
    /// Folder of scene files. A file in it replaces a built-in scene of the same name.
    pub scenes: PathBuf,
    /// Folders of meshes, searched in order after the folder of the scene file.
    pub assets: Vec<PathBuf>,
}

/// Returns Skiagraph's folder of the user's cache, on Linux `~/.cache/skiagraph`, which need not
/// exist. `None` if the user has no home.
pub fn cache_folder() -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", "skiagraph")?;
    Some(folders.cache_dir().to_owned())
}

impl SceneLibrary {
    /// Returns the default folders. Scenes are in `scenes/` below the working directory. Meshes are
    /// in the folders of `SKIAGRAPH_ASSETS` ([`ASSETS_VARIABLE`]), then in Skiagraph's folder of
    /// the user's cache, on Linux `~/.cache/skiagraph`.
    pub fn from_environment() -> Self {
        let variable = std::env::var_os(ASSETS_VARIABLE).unwrap_or_default();
        let mut assets = Vec::new();
        // Splitting panics where there are no environment variables.
        if !variable.is_empty() {
            let folders = std::env::split_paths(&variable);
            assets.extend(folders.filter(|path| !path.as_os_str().is_empty()));
        }
        assets.extend(cache_folder());
        Self {
            scenes: PathBuf::from("scenes"),
            assets,
        }
    }

    /// Loads a scene with its mesh. The report lists changes that the import made to the mesh, and
    /// parts of the file that it left out. `argument` is the name of a built-in scene, the name of
    /// a file in [`scenes`](Self::scenes) without `.ron`, or the path of a `.ron`, `.gltf` or
    /// `.glb` file; a mesh file needs cameras and lights of its own. If the scene's mesh is
    /// generated in any size, a number of triangles may follow: `city:1000000`.
    ///
    /// # Errors
    /// [`SceneError`]: an unknown scene, a number of triangles that the mesh cannot have, a broken
    /// scene file or mesh, a mesh that was not found (with every place searched), a mesh file
    /// without cameras or lights.
    pub fn load(&self, argument: &str) -> Result<(Scene, ImportReport), SceneError> {
        let path = Path::new(argument);
        if MeshFile::is_one(path) {
            return load_bare(path);
        }
        let (file, scene) = self.parse_sized(argument)?;
        self.assemble(scene, file.as_deref())
    }

    /// Reads the scene file of the scene `argument` (a name or path as in
    /// [`load`](Self::load)), for a caller that changes it and writes it again
    /// ([`scene_text`](crate::scene_text)). The path of a mesh file in it is replaced by the path
    /// at which the file was found.
    ///
    /// # Errors
    /// The errors of [`load`](Self::load), except for errors in the content of the mesh, and
    /// [`SceneError::NoSceneFile`] for the path of a mesh file.
    pub fn scene_file(&self, argument: &str) -> Result<SceneFile, SceneError> {
        if MeshFile::is_one(Path::new(argument)) {
            return Err(SceneError::NoSceneFile {
                argument: argument.to_owned(),
            });
        }
        let (file, mut scene) = self.parse_sized(argument)?;
        let path = self.mesh_file(&scene, file.as_deref())?;
        if let (Some(path), MeshSource::Obj { file, .. } | MeshSource::Gltf { file, .. }) =
            (path, &mut scene.mesh)
        {
            *file = path.to_string_lossy().into_owned();
        }
        Ok(scene)
    }

    /// The scene of an argument that may name a size.
    fn parse_sized(&self, argument: &str) -> Result<(Option<PathBuf>, SceneFile), SceneError> {
        let (name, size) = sized(argument);
        let (file, mut scene) = self.parse(name)?;
        if let Some(size) = size {
            resize(&mut scene, size).map_err(|reason| SceneError::Size {
                argument: argument.to_owned(),
                reason,
            })?;
        }
        Ok((file, scene))
    }

    /// Reads the camera paths of the scene `argument` (a name or path as in
    /// [`load`](Self::load)) without loading its mesh. Returns an empty list for a mesh file,
    /// whose animations come with its mesh ([`MeshFile::clips`]).
    ///
    /// # Errors
    /// [`SceneError`]: an unknown scene, a scene file that is not valid.
    pub fn paths(&self, argument: &str) -> Result<Vec<CameraPath>, SceneError> {
        if MeshFile::is_one(Path::new(argument)) {
            return Ok(Vec::new());
        }
        let (_, scene) = self.parse(sized(argument).0)?;
        Ok(scene.paths)
    }

    fn parse(&self, argument: &str) -> Result<(Option<PathBuf>, SceneFile), SceneError> {
        let (file, text) = self.locate(argument)?;
        let name = file.as_ref().map_or_else(
            || format!("<built-in {argument}>"),
            |file| file.display().to_string(),
        );
        Ok((file, SceneFile::parse(&text, &name)?))
    }

    /// Lists all scenes that can be named, sorted by name: files of the scenes folder and built-in
    /// scenes.
    pub fn list(&self) -> Vec<SceneListing> {
        // A folder that is not there, or cannot be listed, holds no scenes.
        let entries = std::fs::read_dir(&self.scenes).into_iter().flatten();
        let paths = entries.flatten().map(|entry| entry.path());
        let files = paths.filter(|path| has_extension(path, "ron"));
        let stem = |path: PathBuf| Some(path.file_stem()?.to_string_lossy().into_owned());
        let built_in = BUILT_IN.iter().map(|(name, _)| (*name).to_owned());
        let names: BTreeSet<String> = built_in.chain(files.filter_map(stem)).collect();
        names.into_iter().map(|name| self.describe(name)).collect()
    }

    fn describe(&self, name: String) -> SceneListing {
        let (file, scene) = match self.locate(&name) {
            Ok((file, text)) => (file, SceneFile::parse(&text, &name)),
            Err(error) => (None, Err(error)),
        };
        let mut listing = SceneListing {
            name,
            file,
            ..SceneListing::default()
        };
        match scene {
            Ok(scene) => {
                let views = scene.views.iter().map(|view| view.name.clone());
                let paths = scene.paths.iter().map(|path| path.view.name.clone());
                (listing.views, listing.paths) = (views.collect(), paths.collect());
                listing.mesh_found = scene.mesh.file().is_none_or(|(mesh, _)| {
                    let places = self.mesh_places(mesh, listing.file.as_deref());
                    places.iter().any(|place| place.is_file())
                });
                listing.description = scene.description;
            }
            Err(SceneError::SceneFile(diagnostics)) => {
                let briefs: Vec<String> = diagnostics.iter().map(Diagnostic::brief).collect();
                listing.description = briefs.join("\n");
            }
            Err(error) => listing.description = error.to_string(),
        }
        listing
    }

    /// Finds a scene file by its name, without a number of triangles, or by its path, which ends in
    /// `.ron`. Returns its path (`None` for a built-in scene) and its text.
    ///
    /// # Errors
    /// [`SceneError`]: an unknown scene, a file that cannot be read.
    pub fn locate(&self, argument: &str) -> Result<(Option<PathBuf>, String), SceneError> {
        let path = Path::new(argument);
        let by_name = self.scenes.join(format!("{argument}.ron"));
        let file = if has_extension(path, "ron") {
            Some(path)
        } else if by_name.is_file() {
            Some(by_name.as_path())
        } else {
            None
        };
        if let Some(file) = file {
            let text = SCENE_FILE.read_text(file);
            let text = text.map_err(SceneError::unread(file))?;
            return Ok((Some(file.to_owned()), text));
        }
        match BUILT_IN.iter().find(|(name, _)| *name == argument) {
            Some((_, text)) => Ok((None, (*text).to_owned())),
            None => Err(SceneError::UnknownScene {
                argument: argument.to_owned(),
                folder: self.scenes.clone(),
                builtin: BUILT_IN.iter().map(|(name, _)| *name).collect(),
            }),
        }
    }

    /// Returns the text of the scene file that [`locate`](Self::locate) finds for `argument`.
    ///
    /// # Errors
    /// [`SceneError`]: an unknown scene, a file that cannot be read.
    pub fn text(&self, argument: &str) -> Result<String, SceneError> {
        self.locate(argument).map(|(_, text)| text)
    }

    /// Returns the path of the file in the folder [`scenes`](Self::scenes) that replaces the
    /// built-in scene `argument`: a name such as `park`, or with a number of triangles
    /// `city:100000`. Returns `None` if `argument` is not the name of a built-in scene, if there is
    /// no such file or it cannot be read, or if its text equals that of the built-in scene.
    pub fn stand_in(&self, argument: &str) -> Option<PathBuf> {
        let name = sized(argument).0;
        let (_, text) = BUILT_IN.iter().find(|(built_in, _)| *built_in == name)?;
        let (file, read) = self.locate(name).ok()?;
        file.filter(|_| read != *text)
    }

    fn mesh_places(&self, mesh: &str, scene_file: Option<&Path>) -> Vec<PathBuf> {
        let beside = scene_file.map(|file| file.parent().unwrap_or(Path::new("")).to_owned());
        let folders = beside.iter().chain(&self.assets);
        folders.map(|folder| folder.join(mesh)).collect()
    }

    /// Where the mesh of a scene file is.
    fn mesh_file(
        &self,
        scene: &SceneFile,
        file: Option<&Path>,
    ) -> Result<Option<PathBuf>, SceneError> {
        let Some((mesh, source)) = scene.mesh.file() else {
            return Ok(None);
        };
        let places = self.mesh_places(mesh, file);
        // A path that is neither file nor folder is there as well; reading it tells the error.
        let find = |is: fn(&Path) -> bool| places.iter().find(|place| is(place));
        let other = || find(|place| place.exists() && !place.is_dir());
        if let Some(place) = find(Path::is_file).or_else(other) {
            return Ok(Some(place.clone()));
        }
        if let Some(folder) = find(Path::is_dir) {
            return Err(SceneError::MeshIsFolder {
                scene: scene.name.clone(),
                path: folder.clone(),
            });
        }
        Err(SceneError::MeshNotFound {
            scene: scene.name.clone(),
            file: mesh.to_owned(),
            searched: places,
            source_text: source.map(str::to_owned),
        })
    }

    fn assemble(
        &self,
        scene: SceneFile,
        file: Option<&Path>,
    ) -> Result<(Scene, ImportReport), SceneError> {
        let path = self.mesh_file(&scene, file)?.unwrap_or_default();
        let (mut mesh, mut report) = match &scene.mesh {
            MeshSource::Generated(generator) => (generator.build(), ImportReport::default()),
            MeshSource::Obj {
                leave_out,
                quads,
                concave,
                materials,
                ..
            } => {
                let options = ObjOptions {
                    leave_out: leave_out.clone(),
                    quads: *quads,
                    concave: *concave,
                    materials: materials.clone(),
                };
                load_obj(&path, &options)?
            }
            MeshSource::Gltf { materials, .. } => load_gltf(&path, *materials)?,
        };
        if let Some(up) = scene.ground {
            add_ground(&mut mesh, up);
        }
        scene.give_roles(&mut mesh, &mut report)?;
        Ok((
            Scene {
                name: scene.name,
                mesh,
                views: scene.views,
                lights: scene.lights,
            },
            report,
        ))
    }
}

/// A scene's name or path, and the number of triangles behind it.
fn sized(argument: &str) -> (&str, Option<&str>) {
    match argument.rsplit_once(':') {
        // A colon further in front may belong to a path.
        Some((scene, size)) if !scene.is_empty() && !size.contains(['/', '\\', '.']) => {
            (scene, Some(size))
        }
        _ => (argument, None),
    }
}

/// Gives a generated mesh another number of triangles.
fn resize(scene: &mut SceneFile, size: &str) -> Result<(), String> {
    match &mut scene.mesh {
        MeshSource::Generated(generator) => {
            *generator = generator.with_triangles(size)?;
            Ok(())
        }
        MeshSource::Obj { file, .. } | MeshSource::Gltf { file, .. } => {
            Err(format!("the mesh {file:?} is a file of one size"))
        }
    }
}

fn load_bare(path: &Path) -> Result<(Scene, ImportReport), SceneError> {
    let needs_view = || SceneError::ObjNeedsView {
        path: path.to_owned(),
    };
    if has_extension(path, "obj") {
        return Err(needs_view());
    }
    let file = MeshFile::load(path, &MeshFileOptions::default())?;
    if file.views.is_empty() || file.lights.is_empty() {
        return Err(needs_view());
    }
    let scene = Scene {
        name: file.name,
        mesh: file.mesh,
        views: file.views,
        lights: file.lights,
    };
    Ok((scene, file.report))
}
