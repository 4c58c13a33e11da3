//! Loads the scene and the views that the arguments name.

use crate::args::shared::SceneArgs;
use crate::error::CliError;
use crate::own_mesh::{self, Chosen, OwnMesh};
use crate::terminal::console::note;
use crate::write_scene;
use glam::DVec3;
use skiagraph_compare::error::CompareError;
use skiagraph_compare::measuring::view_or_path::{ViewOrPath, under_lights};
use skiagraph_compare::wording::{did_you_mean, unknown};
use skiagraph_scene::{
    CameraPath, DirectionalLight, Light, MeshFile, Scene, SceneError, SceneLibrary, SceneRequest,
    View,
};
use std::path::Path;

/// A loaded scene with the views that the arguments select, at least one.
#[derive(Debug)]
pub struct SceneSelection {
    /// The loaded scene.
    pub scene: Scene,
    /// The selected views.
    pub views: Vec<View>,
    /// Camera paths from the animations of a mesh file; empty for other scenes, whose files list
    /// them.
    pub paths: Vec<CameraPath>,
}

impl SceneSelection {
    /// Loads the scene and selects its views. Prints a warning if the import had to repair or leave
    /// out something.
    ///
    /// # Errors
    /// If the scene cannot be loaded, lacks a named view, or the camera of the arguments is
    /// invalid.
    pub fn load(args: &SceneArgs) -> Result<Self, CliError> {
        let is_mesh = MeshFile::is_one(Path::new(&args.scene));
        if !is_mesh && (args.materials.is_some() || args.concave.is_some() || args.ground) {
            return Err(CliError::Usage(format!(
                "--materials, --concave and --ground are of a mesh file (.obj, .gltf, .glb); a \
                 scene file says `materials`, `concave` and `ground` itself, so leave them out \
                 with --scene {}",
                args.scene
            )));
        }
        let library = SceneLibrary::from_environment();
        if let Some(file) = library.stand_in(&args.scene) {
            note(&format!(
                "{} stands in for the built-in scene `{}`, which differs",
                file.display(),
                args.scene
            ));
        }
        let loaded = if is_mesh {
            own_mesh::load(args)
        } else {
            library.load(&request(args)).map(OwnMesh::from)
        };
        let own = loaded.map_err(|error| explain(error, args, &library))?;
        let OwnMesh { scene, report, .. } = &own;
        if report.has_warnings() {
            let text = report.to_string();
            let text = text.trim_end();
            // Several stand below each other.
            let begin = if text.contains('\n') { "\n  " } else { " " };
            note(&format!(
                "{}:{begin}{}",
                args.scene,
                text.replace('\n', "\n  ")
            ));
        }
        let views = choose(scene, args.view.as_deref())?;
        let views = override_views(scene, views, args, own.chosen)?;
        let paths = views
            .first()
            .map_or_else(Vec::new, |view| own.paths(args, view));
        if let Some(path) = &args.write_scene {
            let file = if is_mesh {
                write_scene::of_mesh(args, scene, own.chosen, &paths)
            } else {
                let file = library.scene_file(&args.scene);
                file.map_err(|error| explain(error, args, &library))?
            };
            write_scene::write(path, file, &views)?;
        }
        let views = under_lights(scene, views, args.light_name())?;
        if let Some(text) = from_below(&views, args) {
            note(&text);
        }
        Ok(Self {
            scene: own.scene,
            views,
            paths,
        })
    }
}

fn request(args: &SceneArgs) -> SceneRequest {
    SceneRequest {
        argument: args.scene.clone(),
        obj: None,
    }
}

/// That a sun of one's own shines upwards, which most often is its direction turned round.
fn from_below(views: &[View], args: &SceneArgs) -> Option<String> {
    let direction = args.own_light()?;
    let up = views.first()?.up;
    let three = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
    (direction.dot(up) > 0.0).then(|| {
        format!(
            "warning: --light {} shines from below: it is the direction in which the light \
             travels; --light {} shines from above",
            three(direction),
            three(-direction + DVec3::ZERO)
        )
    })
}

fn explain(error: SceneError, args: &SceneArgs, library: &SceneLibrary) -> CliError {
    match error {
        SceneError::BadView { .. } => CliError::Usage(error.to_string()),
        SceneError::UnknownScene { .. } => {
            let known = library.list();
            let hint = did_you_mean(&args.scene, known.iter().map(|scene| scene.name.as_str()));
            CliError::Input(format!("{error}{hint}"))
        }
        SceneError::SceneFile(found) => CliError::Compare(CompareError::Diagnostics {
            faults: vec![found.iter().cloned().collect()],
            summary: format!("cannot load the scene `{}`", args.scene),
        }),
        error => CliError::Scene {
            name: args.scene.clone(),
            source: Box::new(error),
        },
    }
}

/// A depth buffer of 32-bit floats tells depths apart well over this range.
const NEAR_TO_FAR: f64 = 1e4;

/// Returns the camera paths that `name`, the value of `--path`, selects, under the lights that
/// `light` selects. `own` holds the paths of a mesh file; other scenes list theirs in their file.
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
    if args.has_own_camera() || args.own_light().is_some() {
        return Err(CliError::Usage(format!(
            "--path {name} brings its camera and its light: leave out --eye, --look, --up, --fov, \
             --near, --far and --light x,y,z"
        )));
    }
    let paths = if MeshFile::is_one(Path::new(&args.scene)) {
        own.to_vec()
    } else {
        let paths = SceneLibrary::from_environment().paths(&args.scene);
        paths.map_err(|error| CliError::Input(error.to_string()))?
    };
    Ok(ViewOrPath::paths(scene, paths, name, light)?)
}

/// Puts what the arguments say of the camera and the light into views, which are then called
/// `own`, but for one that was chosen.
fn override_views(
    scene: &Scene,
    views: Vec<View>,
    args: &SceneArgs,
    chosen: Chosen,
) -> Result<Vec<View>, CliError> {
    let light = args.own_light().filter(|_| !chosen.light);
    if !args.has_own_camera() && light.is_none() && !chosen.view {
        return Ok(views);
    }
    if args.eye.is_some() && views.len() > 1 {
        return Err(CliError::Usage(
            "--eye is one view of your own: leave out --view all, or --eye".into(),
        ));
    }
    let several = views.len() > 1;
    let own = |view: View| {
        let mut own = View {
            name: match (chosen.view, several) {
                (true, _) => view.name.clone(),
                (_, true) => format!("{}-own", view.name),
                (_, false) => "own".into(),
            },
            eye: args.eye.unwrap_or(view.eye),
            direction: args.look.unwrap_or(view.direction),
            up: args.up.unwrap_or(view.up),
            fov_y_degrees: args.fov.unwrap_or(view.fov_y_degrees),
            ..view
        };
        if let Some(direction) = light {
            own.light = Some(Light {
                name: "own".into(),
                kind: DirectionalLight::new(direction).into(),
            });
        }
        if args.eye.is_some() || chosen.view {
            fit_planes(&mut own, scene, args);
        } else {
            own.far = args.far.unwrap_or(own.far);
            own.near = args.near.unwrap_or(own.near);
        }
        let light = own.light.as_ref().map_or(Ok(()), Light::check);
        own.check().and(light).map_err(CliError::Usage)?;
        Ok(own)
    };
    views.into_iter().map(own).collect()
}

/// Clip planes where none are given: far just behind the mesh, near a ten-thousandth of it.
fn fit_planes(view: &mut View, scene: &Scene, args: &SceneArgs) {
    let farthest = scene.mesh.bounds().map_or(1.0, |(min, max)| {
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        (max - view.eye).abs().max((view.eye - min).abs()).length()
    });
    view.far = args.far.unwrap_or_else(|| {
        (farthest * 1.01)
            .max(args.near.unwrap_or(0.0) * 2.0)
            .max(f64::MIN_POSITIVE)
    });
    view.near = args.near.unwrap_or(view.far / NEAR_TO_FAR);
}

fn choose(scene: &Scene, name: Option<&str>) -> Result<Vec<View>, CliError> {
    match name {
        Some("all") => Ok(scene.views.clone()),
        None => Ok(scene.views.iter().take(1).cloned().collect()),
        Some(name) => match scene.view(name) {
            Some(view) => Ok(vec![view.clone()]),
            None => {
                let names: Vec<&str> = scene.views.iter().map(|view| view.name.as_str()).collect();
                let what = format!("the scene `{}` has no view `{name}`", scene.name);
                let text = unknown(&what, name, "views", &names) + ", or all of them: all";
                Err(CliError::Input(text))
            }
        },
    }
}
