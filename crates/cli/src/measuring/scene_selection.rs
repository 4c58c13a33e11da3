//! From the scene arguments to a loaded scene and the views to draw.

use crate::args::shared::SceneArgs;
use crate::args::values::LightArgument;
use crate::error::CliError;
use crate::terminal::console::note;
use crate::wording::did_you_mean;
use glam::DVec3;
use skiagraph_scene::{
    DirectionalLight, ObjSetup, QuadDiagonal, Scene, SceneError, SceneLibrary, SceneRequest, View,
};

/// A scene and the views that were asked for, at least one.
#[derive(Debug)]
pub struct SceneSelection {
    /// The scene.
    pub scene: Scene,
    /// The views to draw.
    pub views: Vec<View>,
}

impl SceneSelection {
    /// Loads what the arguments name; warns of what an import had to mend.
    ///
    /// # Errors
    /// A scene that cannot be loaded, a view that it does not have, view flags that do not go
    /// together.
    pub fn load(args: &SceneArgs) -> Result<Self, CliError> {
        let request = SceneRequest {
            argument: args.scene.clone(),
            obj: obj_setup(args)?,
        };
        let library = SceneLibrary::from_environment();
        let loaded = library.load(&request);
        let (mut scene, report) = loaded.map_err(|error| explain(error, args, &library))?;
        if report.has_warnings() {
            note(&format!(
                "{}: {}",
                args.scene,
                report.to_string().trim_end().replace('\n', "; ")
            ));
        }
        if request.obj.is_some() {
            fit_planes(&mut scene, args)?;
        }
        let views = choose(&scene, args.view.as_deref())?;
        let views = under_lights(&scene, views, args)?;
        Ok(Self { scene, views })
    }
}

/// Views under the lights that the arguments name.
///
/// # Errors
/// The scene has no such light.
pub fn under_lights(
    scene: &Scene,
    views: Vec<View>,
    args: &SceneArgs,
) -> Result<Vec<View>, CliError> {
    match &args.light {
        Some(LightArgument::Name(name)) => lit_by(scene, views, name),
        Some(LightArgument::Direction(_)) | None => Ok(views),
    }
}

fn explain(error: SceneError, args: &SceneArgs, library: &SceneLibrary) -> CliError {
    match error {
        // Which flags to add or to leave out is a matter of usage.
        SceneError::ObjNeedsView { .. }
        | SceneError::ViewNotWanted { .. }
        | SceneError::BadView { .. } => CliError::Usage(error.to_string()),
        SceneError::UnknownScene { .. } => {
            let known = library.list();
            let hint = did_you_mean(&args.scene, known.iter().map(|scene| scene.name.as_str()));
            CliError::Input(format!("{error}{hint}"))
        }
        error => CliError::Scene {
            name: args.scene.clone(),
            source: Box::new(error),
        },
    }
}

/// View and light of a bare `.obj`, once any of the flags is given; the planes that are not given
/// are fitted later.
fn obj_setup(args: &SceneArgs) -> Result<Option<ObjSetup>, CliError> {
    let direction = match &args.light {
        Some(LightArgument::Direction(direction)) => Some(*direction),
        Some(LightArgument::Name(_)) | None => None,
    };
    let given = [args.eye, args.look, direction, args.up]
        .iter()
        .any(Option::is_some)
        || [args.fov, args.near, args.far].iter().any(Option::is_some);
    if !given {
        return Ok(None);
    }
    let (Some(eye), Some(look), Some(light)) = (args.eye, args.look, direction) else {
        return Err(CliError::Usage(
            "a view of your own needs all of --eye x,y,z, --look x,y,z (direction) and --light \
             x,y,z (the direction in which the light travels)"
                .into(),
        ));
    };
    let far = args
        .far
        .or(args.near.map(|near| near * NEAR_TO_FAR))
        .unwrap_or(NEAR_TO_FAR);
    Ok(Some(ObjSetup {
        view: View {
            name: "main".into(),
            eye,
            direction: look,
            up: args.up.unwrap_or(DVec3::Y),
            fov_y_degrees: args.fov.unwrap_or(60.0),
            near: args.near.unwrap_or(far / NEAR_TO_FAR),
            far,
            light: None,
        },
        light: DirectionalLight::new(light).into(),
        quads: QuadDiagonal::default(),
    }))
}

/// A depth buffer of 32-bit floats tells depths apart well over this range.
const NEAR_TO_FAR: f64 = 1e4;

/// Replaces the clip planes that were not given: far just behind the mesh, near a ten-thousandth of
/// it.
fn fit_planes(scene: &mut Scene, args: &SceneArgs) -> Result<(), CliError> {
    let (Some((min, max)), Some(view)) = (scene.mesh.bounds(), scene.views.first_mut()) else {
        return Ok(());
    };
    let (min, max) = (min.as_dvec3(), max.as_dvec3());
    let farthest = (max - view.eye).abs().max((view.eye - min).abs()).length();
    if args.far.is_none() {
        view.far = (farthest * 1.01)
            .max(args.near.unwrap_or(0.0) * 2.0)
            .max(f64::MIN_POSITIVE);
    }
    if args.near.is_none() {
        view.near = view.far / NEAR_TO_FAR;
    }
    view.check().map_err(CliError::Usage)
}

/// The views under the light of that name, or under all of theirs: `VIEW@LIGHT` where that makes
/// several of one view.
fn lit_by(scene: &Scene, views: Vec<View>, name: &str) -> Result<Vec<View>, CliError> {
    let mut lit = Vec::new();
    for view in views {
        let lights = scene.lights_of(&view);
        let several = lights.len() > 1 && name == "all";
        let chosen: Vec<_> = lights
            .iter()
            .filter(|light| name == "all" || light.name == name)
            .collect();
        if chosen.is_empty() {
            let names: Vec<&str> = lights.iter().map(|light| light.name.as_str()).collect();
            let hint = did_you_mean(name, names.iter().copied());
            return Err(CliError::Input(format!(
                "view `{}` of the scene `{}` has no light `{name}`{hint}\n  lights: {}, or all of \
                 them: all",
                view.name,
                scene.name,
                names.join(", ")
            )));
        }
        lit.extend(chosen.into_iter().map(|light| View {
            name: match several {
                true => format!("{}@{}", view.name, light.name),
                false => view.name.clone(),
            },
            light: Some(light.clone()),
            ..view.clone()
        }));
    }
    Ok(lit)
}

fn choose(scene: &Scene, name: Option<&str>) -> Result<Vec<View>, CliError> {
    match name {
        Some("all") => Ok(scene.views.clone()),
        None => Ok(scene.views.iter().take(1).cloned().collect()),
        Some(name) => match scene.view(name) {
            Some(view) => Ok(vec![view.clone()]),
            None => {
                let names: Vec<&str> = scene.views.iter().map(|view| view.name.as_str()).collect();
                let hint = did_you_mean(name, names.iter().copied());
                Err(CliError::Input(format!(
                    "the scene `{}` has no view `{name}`{hint}\n  views: {}, or all of them: all",
                    scene.name,
                    names.join(", ")
                )))
            }
        },
    }
}
