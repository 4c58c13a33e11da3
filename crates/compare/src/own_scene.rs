//! Loads a mesh file as a scene: with the views and lights of the file, and chosen ones where it
//! has none.
//!
//! ```
//! use skiagraph_compare::own_camera::OwnCamera;
//! use skiagraph_compare::own_scene::{MeshSceneOptions, OwnScene};
//!
//! let folder = tempfile::tempdir()?;
//! let file = folder.path().join("tile.obj");
//! std::fs::write(&file, "v 0 0 0\nv 0 0 1\nv 1 0 0\nf 1 2 3\n")?;
//! let own = OwnScene::of_mesh(&file, &MeshSceneOptions::default())?;
//! assert!(own.chosen.view && own.chosen.light && own.chosen.has_floor);
//! let views = own.views(None, &OwnCamera::default(), None)?;
//! assert_eq!(views[0].name, "main");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::default_view::{Place, ViewRequest, default_views};
use crate::error::{CompareError, Result};
use crate::own_camera::OwnCamera;
use crate::wording::unknown;
use glam::DVec3;
use itertools::Itertools;
use skiagraph_scene::gltf::Clip;
use skiagraph_scene::{
    CameraPath, DirectionalLight, Ground, ImportReport, Light, Mesh, MeshFile, MeshFileOptions,
    Scene, SceneError, SceneFile, View, add_ground, has_ground,
};
use std::path::Path;

/// The direction in which light travels where no view is chosen: a high sun, from the side.
const FALLBACK_LIGHT: DVec3 = DVec3::new(-0.4, -1.0, -0.55);

/// Vertical field of view of a view that is chosen, degrees.
const DEFAULT_FOV: f64 = 60.0;

/// Settings that turn a mesh file into a scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshSceneOptions {
    /// Settings for reading the file: its polygons and materials.
    pub file: MeshFileOptions,
    /// Camera of the views that are chosen for a file without cameras. Without an `eye`, they are
    /// [chosen](default_views) for `up` (y unless given), `fov_y_degrees` (60 unless given) and
    /// `direction`. With an `eye`, the only view has this camera, and looks from there at the
    /// middle of the mesh unless `direction` is given. [`OwnScene::views`] applies all parts of the
    /// camera: give the same one there. `up` is also up for the floor and the ground.
    pub camera: OwnCamera,
    /// Direction in which the light of a sun travels, world space, of any length above 0, for a
    /// file without lights; `None` chooses a sun or a lamp.
    pub sun: Option<DVec3>,
    /// True to add a ground, a square slab, below a mesh that has no floor, and to choose views
    /// from outside alone.
    pub ground: bool,
}

impl MeshSceneOptions {
    fn up(&self) -> DVec3 {
        self.camera.up.unwrap_or(DVec3::Y)
    }
}

/// Parts of a scene that its mesh file lacked, and facts about the mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chosen {
    /// True if the file has no camera, so that the scene's views were [chosen](default_views).
    pub view: bool,
    /// Kinds of places that the chosen views look from, one for each view of the scene; empty if
    /// the file has cameras, or the options an eye.
    pub places: Vec<Place>,
    /// True if the file has no light: the scene's only light was chosen, or is
    /// [`MeshSceneOptions::sun`]. A chosen view may have a light of its own.
    pub light: bool,
    /// Size of the mesh's box along x, y and z in scene units, without an added ground; `None` for
    /// a mesh without triangles.
    pub size: Option<DVec3>,
    /// True if the mesh has a floor of its own.
    pub has_floor: bool,
    /// The ground that was added; `None` if none was.
    pub ground: Option<Ground>,
}

/// A loaded scene, with the parts that were chosen because its mesh file lacks them. For a built-in
/// scene or a scene file nothing is chosen, and there are no clips.
#[derive(Debug)]
pub struct OwnScene {
    /// The loaded scene.
    pub scene: Scene,
    /// Changes that the import made, and parts that it left out.
    pub report: ImportReport,
    /// The parts that were chosen because the mesh file lacks them.
    pub chosen: Chosen,
    /// Animations of the mesh file; empty for a built-in scene or a scene file.
    pub clips: Vec<Clip>,
}

impl From<(Scene, ImportReport)> for OwnScene {
    /// Wraps a scene whose file holds all parts.
    fn from((scene, report): (Scene, ImportReport)) -> Self {
        Self {
            scene,
            report,
            chosen: Chosen::default(),
            clips: Vec::new(),
        }
    }
}

impl OwnScene {
    /// Loads a mesh file, and chooses the parts of a scene that it lacks.
    ///
    /// # Errors
    /// The file cannot be read, or the options' sun is not a valid light.
    pub fn of_mesh(path: &Path, options: &MeshSceneOptions) -> Result<Self, SceneError> {
        let MeshFile {
            name,
            mut mesh,
            mut views,
            mut lights,
            clips,
            report,
        } = MeshFile::load(path, &options.file)?;
        let mut chosen = Chosen {
            view: views.is_empty(),
            light: lights.is_empty(),
            size: mesh
                .bounds()
                .map(|(min, max)| max.as_dvec3() - min.as_dvec3()),
            has_floor: has_ground(&mesh, options.up()),
            ..Chosen::default()
        };
        if chosen.light {
            let sun = Light::from(DirectionalLight::new(options.sun.unwrap_or(FALLBACK_LIGHT)));
            sun.check().map_err(|reason| SceneError::BadView {
                path: path.to_owned(),
                reason,
            })?;
            lights.push(sun);
        }
        let subject = mesh.triangles.len();
        if options.ground && !chosen.has_floor {
            chosen.ground = add_ground(&mut mesh, options.up());
        }
        if chosen.view {
            let camera = &options.camera;
            let is_given = !chosen.light || options.sun.is_some();
            let light = lights.first().filter(|_| is_given);
            let request = ViewRequest {
                up: options.up(),
                fov_y_degrees: camera.fov_y_degrees.unwrap_or(DEFAULT_FOV),
                direction: camera.direction,
                light: light.map(|light| light.kind),
                outside: options.ground,
                subject: Some(subject),
            };
            let defaults = camera.eye.is_none().then(|| default_views(&mesh, &request));
            if let Some(defaults) = defaults.flatten() {
                if chosen.light {
                    lights = vec![Light::only(defaults.light)];
                }
                chosen.places = defaults.views.iter().map(|view| view.place).collect();
                views = defaults.views.into_iter().map(|view| view.view).collect();
            } else {
                let view = towards(&mesh, camera.eye.unwrap_or_default());
                views.push(camera.of_view(&view, &mesh, true));
            }
        }
        let scene = Scene {
            name,
            mesh,
            views,
            lights,
        };
        Ok(Self {
            scene,
            report,
            chosen,
            clips,
        })
    }

    /// Returns the views of the scene that `name` selects: the first view for `None`, every view
    /// for `all`. `camera` replaces parts of their cameras, and `sun`, the direction in which the
    /// light of a sun travels, their lights. Clip planes that `camera` leaves open are fitted to
    /// the mesh if `camera` has an eye or the view was chosen. Views with a replaced part are named
    /// `own`, or `VIEW-own` if there are several, but a chosen view keeps its name. `sun` is
    /// ignored if the file had no light: give it as [`MeshSceneOptions::sun`] then.
    ///
    /// # Errors
    /// The scene has no such view, or `camera` or `sun` does not make a valid view or light.
    pub fn views(
        &self,
        name: Option<&str>,
        camera: &OwnCamera,
        sun: Option<DVec3>,
    ) -> Result<Vec<View>> {
        let views = self.named_views(name)?;
        let sun = sun.filter(|_| !self.chosen.light);
        if camera.is_empty() && sun.is_none() && !self.chosen.view {
            return Ok(views);
        }
        let several = views.len() > 1;
        let own = |view: View| {
            let fits = camera.eye.is_some() || self.chosen.view;
            let mut own = camera.of_view(&view, &self.scene.mesh, fits);
            own.name = match (self.chosen.view, several) {
                (true, _) => view.name,
                (_, true) => format!("{}-own", view.name),
                (_, false) => "own".into(),
            };
            if let Some(direction) = sun {
                own.light = Some(Light {
                    name: "own".into(),
                    kind: DirectionalLight::new(direction).into(),
                });
            }
            let light = own.light.as_ref().map_or(Ok(()), Light::check);
            own.check().and(light).map_err(CompareError::Request)?;
            Ok(own)
        };
        views.into_iter().map(own).collect()
    }

    fn named_views(&self, name: Option<&str>) -> Result<Vec<View>> {
        let Scene {
            name: scene, views, ..
        } = &self.scene;
        match name {
            Some("all") => Ok(views.clone()),
            None => Ok(views.iter().take(1).cloned().collect()),
            Some(name) => match self.scene.view(name) {
                Some(view) => Ok(vec![view.clone()]),
                None => {
                    let names = views.iter().map(|view| &view.name);
                    let what = format!("the scene `{scene}` has no view `{name}`");
                    let text = unknown(&what, name, "views", names) + ", or all of them: all";
                    Err(CompareError::Input(text))
                }
            },
        }
    }

    /// Returns the camera paths of the scene's animations, and the reasons why other animations
    /// have none. An animation that moves no camera is seen from the view `standing`.
    pub fn paths(&self, standing: &View) -> (Vec<CameraPath>, Vec<String>) {
        let Scene { views, lights, .. } = &self.scene;
        let clips = self.clips.iter();
        let paths = clips.flat_map(|clip| clip.paths(views, lights, standing));
        paths.partition_result()
    }

    /// Returns the scene file of this scene, which [`of_mesh`](Self::of_mesh) loaded with `options`
    /// from the mesh file `mesh`, with `paths` as its camera paths. It holds the path `mesh` as it
    /// is, and the views of [`scene`](Self::scene).
    /// [`write_scene`](crate::files::scene::write_scene) writes the path relative to the file, and
    /// is also given the result of [`views`](Self::views).
    pub fn file(
        &self,
        mesh: &str,
        options: &MeshSceneOptions,
        paths: Vec<CameraPath>,
    ) -> SceneFile {
        SceneFile {
            ground: self.chosen.ground.map(|_| options.up()),
            lights: self.scene.lights.clone(),
            views: self.scene.views.clone(),
            paths,
            ..SceneFile::new(&self.scene.name, options.file.source(mesh))
        }
    }
}

/// A view from an eye to the middle of a mesh, before its clip planes are fitted.
fn towards(mesh: &Mesh, eye: DVec3) -> View {
    let bounds = mesh.bounds();
    let middle = bounds.map(|(min, max)| (min.as_dvec3() + max.as_dvec3()) * 0.5);
    let direction = Some(middle.unwrap_or_default() - eye).filter(|way| *way != DVec3::ZERO);
    View {
        name: "main".into(),
        eye,
        direction: direction.unwrap_or(DVec3::NEG_Z),
        fov_y_degrees: DEFAULT_FOV,
        near: 1.0,
        far: 2.0,
        ..View::default()
    }
}
