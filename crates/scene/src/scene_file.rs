//! Scene files: mesh, light and named views in RON.
//!
//! ```
//! let text = r#"(
//!     format: 1,
//!     name: "garden",
//!     description: "a park bench in the evening",
//!     mesh: Generated("park"),
//!     light: (direction: (0.744, -0.408, 0.527)),
//!     views: [(
//!         name: "bench", eye: (-23, 18, 30), direction: (0.4, -0.6, -0.7),
//!         fov_y_degrees: 60, near: 1, far: 400,
//!         light: (direction: (0, -1, 0)), // without it: the scene's `light`, or its `lights`
//!     )],
//! )"#;
//! let scene = skiagraph_scene::SceneFile::parse(text, "garden.ron")?;
//! let light = scene.views[0].light.as_ref().unwrap();
//! assert_eq!(light.kind.directional().unwrap().direction, glam::DVec3::NEG_Y);
//! # Ok::<(), skiagraph_scene::SceneError>(())
//! ```

use crate::camera::View;
use crate::error::SceneError;
use crate::generate::Generator;
use crate::light::DirectionalLight;
use crate::light_kind::Light;
use crate::material_use::MaterialUse;
use crate::mesh::Mesh;
use crate::obj::options::{Concave, ObjMaterials, QuadDiagonal};
use crate::path::CameraPath;
use crate::report::{ImportReport, nothing_casts};
use crate::shadows::Shadows;
use crate::vector::{SomeVector, Vector, is_default};
use glam::DVec3;
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use skiagraph_located_ron::diagnostics::{Code, Diagnostic, Diagnostics};
use skiagraph_located_ron::fields::from_all_fields;
use skiagraph_located_ron::reader::Node;
use skiagraph_located_ron::span::{SourceFile, Span};
use std::collections::{BTreeMap, HashMap};

/// Content of a scene file. `SceneFile::parse` checks everything in it, but loads no mesh. Serde
/// alone refuses the lists `lights`, `views` and `paths`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "scene")]
pub struct SceneFile {
    /// Version of the format: 1.
    pub format: u32,
    /// Name of the scene, shown in tables and results.
    pub name: String,
    /// Description of the scene in one line, for the list that `skiagraph scenes` prints; may be
    /// empty.
    #[serde(default, skip_serializing_if = "is_default")]
    pub description: String,
    /// Source of the scene's triangles.
    pub mesh: MeshSource,
    /// Direction up, of any length above 0, of a ground that is added just below the mesh; `None`
    /// adds no ground.
    #[serde(default, deserialize_with = "ground")]
    #[serde(
        serialize_with = "SomeVector::serialize",
        skip_serializing_if = "Option::is_none"
    )]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Vector>"))]
    pub ground: Option<DVec3>,
    /// Roles of parts in shadows, by their names: OBJ groups and objects, glTF nodes, parts of
    /// generated meshes, `ground`. Parts that are not named cast and receive shadows, or do what a
    /// glTF file says.
    #[serde(default, skip_serializing_if = "is_default")]
    pub shadows: BTreeMap<String, Shadows>,
    /// Places of the names in `shadows` in the text that was parsed, for messages; may be empty.
    #[serde(skip)]
    pub shadow_places: BTreeMap<String, Span>,
    /// Lights of the scene: at least one, no two of the same name. They light each view that has no
    /// light of its own.
    #[serde(
        default,
        rename(deserialize = "light"),
        deserialize_with = "only_light"
    )]
    #[cfg_attr(feature = "schema", schemars(with = "Option<DirectionalLight>"))]
    #[cfg_attr(
        feature = "schema",
        schemars(description = "One sun, in the place of `lights`.")
    )]
    pub lights: Vec<Light>,
    /// Views of the scene: at least one, no two of the same name. The first is the default.
    #[serde(skip_deserializing)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub views: Vec<View>,
    /// Camera paths of the scene, no two of the same name; may be empty.
    #[serde(skip_deserializing, skip_serializing_if = "is_default")]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub paths: Vec<CameraPath>,
}

/// Fields of a scene file that are lists.
const LISTS: [&str; 3] = ["lights", "views", "paths"];

/// Source of a scene's triangles.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "Mesh")
)]
#[serde(deny_unknown_fields)]
pub enum MeshSource {
    /// A Wavefront OBJ file.
    Obj {
        /// Path of the file with forward slashes, relative to a folder. These folders are searched
        /// in order: the folder of the scene file, the folders of `SKIAGRAPH_ASSETS`, Skiagraph's
        /// folder of the user's cache.
        file: String,
        /// Names of the groups or objects that are left out: the whole text after `g` or `o`.
        #[serde(default, skip_serializing_if = "is_default")]
        leave_out: Vec<String>,
        /// Diagonal that splits a quad into triangles.
        #[serde(default, skip_serializing_if = "is_default")]
        quads: QuadDiagonal,
        /// Treatment of concave polygons.
        #[serde(default, skip_serializing_if = "is_default")]
        concave: Concave,
        /// Parts of the file's materials that are read.
        #[serde(default, skip_serializing_if = "is_default")]
        materials: ObjMaterials,
        /// Sentence that tells where the file can be downloaded, for the message that it is
        /// missing; `None` for a file that is not public.
        #[serde(default, skip_serializing_if = "is_default")]
        source: Option<String>,
    },
    /// A glTF 2.0 file, `.gltf` or `.glb`.
    Gltf {
        /// Path of the file with forward slashes, searched in the same folders as the file of
        /// `Obj`.
        file: String,
        /// Parts of the file's materials that are read.
        #[serde(default, skip_serializing_if = "is_default")]
        materials: MaterialUse,
        /// Sentence that tells where the file can be downloaded, for the message that it is
        /// missing; `None` for a file that is not public.
        #[serde(default, skip_serializing_if = "is_default")]
        source: Option<String>,
    },
    /// A mesh that this crate generates. A scene file names it, for example `"park"` or
    /// `"city:100000"`.
    Generated(
        #[serde(deserialize_with = "generator", serialize_with = "generator_text")]
        #[cfg_attr(feature = "schema", schemars(with = "String"))]
        Generator,
    ),
}

impl MeshSource {
    /// The path of the mesh file as the scene file gives it, and where the mesh can be downloaded;
    /// `None` for a mesh that is generated.
    pub(crate) fn file(&self) -> Option<(&str, Option<&str>)> {
        match self {
            Self::Obj { file, source, .. } | Self::Gltf { file, source, .. } => {
                Some((file, source.as_deref()))
            }
            Self::Generated(_) => None,
        }
    }
}

impl SceneFile {
    /// Creates a scene that is a mesh alone, without lights and views.
    pub fn new(name: impl Into<String>, mesh: MeshSource) -> Self {
        Self {
            format: 1,
            name: name.into(),
            description: String::new(),
            mesh,
            ground: None,
            shadows: BTreeMap::new(),
            shadow_places: BTreeMap::new(),
            lights: Vec::new(),
            views: Vec::new(),
            paths: Vec::new(),
        }
    }

    /// Reads a scene from the text of a scene file. `file` is the name of the file in error
    /// messages.
    ///
    /// # Errors
    /// [`SceneError::SceneFile`] with every mistake and its place in the text: invalid RON, unknown
    /// or missing fields, and views, paths and lights that are not valid.
    pub fn parse(text: &str, file: &str) -> Result<Self, SceneError> {
        let mut faults = Vec::new();
        let scene = Self::read(&Node::root(&SourceFile::new(file, text)), &mut faults);
        let scene = scene.filter(|_| faults.is_empty());
        scene.ok_or_else(|| SceneError::SceneFile(Diagnostics::new(faults)))
    }

    /// Gives the parts of the scene's mesh their roles in shadows.
    ///
    /// # Errors
    /// [`SceneError::SceneFile`] with every name that no part of the mesh has.
    pub(crate) fn give_roles(
        &self,
        mesh: &mut Mesh,
        report: &mut ImportReport,
    ) -> Result<(), SceneError> {
        let mut faults = Vec::new();
        for (part, &shadows) in &self.shadows {
            if mesh.set_shadows_of(part, shadows).is_err() {
                let why = format!("no part of the mesh is called {part:?}");
                let names = mesh.groups.iter().map(|group| &group.name);
                let fault = Diagnostic::error(Code::UnknownResource, why).suggest(part, names);
                faults.push(fault.at_any(self.shadow_places.get(part), "no such part"));
            }
        }
        if !faults.is_empty() {
            return Err(SceneError::SceneFile(Diagnostics::new(faults)));
        }
        if let Some(text) = nothing_casts(mesh) {
            let warning = Diagnostic::warning(Code::Unused, text);
            let places = self.shadow_places.values();
            let place = places.min_by_key(|place| place.range.start);
            report.remark(warning.at_any(place, "").brief());
        }
        Ok(())
    }

    fn read(root: &Node, faults: &mut Vec<Diagnostic>) -> Option<Self> {
        let fields = kept(root.fields(), faults)?;
        let field = |name| fields.iter().find(|field| field.name.as_str() == name);
        if let Some(format) = field("format") {
            let number: u32 = kept(format.node.parse(), faults)?;
            if number != 1 {
                // Everything else in it would be a mistake, too.
                let what = format!("format {number} is unknown; this program reads format 1");
                faults.push(Diagnostic::error(Code::FormatVersion, what).at(&format.node, ""));
                return None;
            }
        }
        let list = |name| field(name).map(|field| &field.node);
        let lights = match (field("light"), list("lights")) {
            (light, Some(list)) => {
                faults.extend(light.map(|light| {
                    let what = "a scene has one `light`, or `lights`, not both";
                    Diagnostic::error(Code::DuplicateName, what).at(&light.name, "")
                }));
                named(list, faults)
            }
            (Some(_), None) => Some(Vec::new()),
            (None, None) => {
                faults.push(lacks(root, "a scene needs a `light`, or `lights`"));
                None
            }
        };
        let views = list("views").map(|list| named(list, faults));
        if views.is_none() {
            let what = "a scene needs at least one view: the field `views` is missing";
            faults.push(lacks(root, what));
        }
        let paths = list("paths").map_or(Some(Vec::new()), |list| named(list, faults));
        let shadows = list("shadows").and_then(|node| node.map().ok());
        let places = shadows.into_iter().flatten();
        let shadow_places = places.map(|(name, _)| (name.value, name.span)).collect();
        let head = fields.into_iter();
        let head = head.filter(|field| !LISTS.contains(&field.name.as_str()));
        let scene: Option<Self> = from_all_fields(head.collect(), &root.head(), &LISTS, faults);
        let (mut scene, lights) = (scene?, lights?);
        scene.lights.extend(lights);
        (scene.views, scene.paths) = (views??, paths?);
        scene.shadow_places = shadow_places;
        Some(scene)
    }
}

/// Keeps a value, or tells why there is none.
fn kept<T>(read: Result<T, Diagnostic>, faults: &mut Vec<Diagnostic>) -> Option<T> {
    read.map_err(|wrong| faults.push(wrong)).ok()
}

fn lacks(root: &Node, what: &str) -> Diagnostic {
    Diagnostic::error(Code::MissingField, what).at(root.head(), "")
}

/// The items of a list, which have names, no two the same.
fn named<T: Item>(list: &Node, faults: &mut Vec<Diagnostic>) -> Option<Vec<T>> {
    let items = kept(list.list(), faults)?;
    if items.is_empty() && T::NEEDED {
        let what = format!("`{}` is empty; a scene needs one", T::LIST);
        faults.push(Diagnostic::error(Code::MissingField, what).at(list.head(), ""));
    }
    let (mut names, mut read) = (HashMap::new(), Vec::new());
    let mut complete = true;
    for node in items {
        let checked = T::read(&node, faults).and_then(|item| {
            let wrong = |why| Diagnostic::error(Code::Syntax, why).at(node.head(), "here");
            kept(T::CHECK(&item).map_err(wrong), faults).map(|()| item)
        });
        let Some(item) = checked else {
            complete = false;
            continue;
        };
        let name = T::NAME(&item);
        if let Some(first) = names.insert(name.to_owned(), node.head()) {
            let what = format!("two {} are called {name:?}", T::LIST);
            let twice = Diagnostic::error(Code::DuplicateName, what);
            faults.push(
                twice
                    .at(node.head(), "the second one")
                    .at(first, "the first one"),
            );
        }
        read.push(item);
    }
    complete.then_some(read)
}

/// Item in a list of a scene file.
trait Item: DeserializeOwned {
    /// The list's name.
    const LIST: &str;
    /// True if it may not be empty.
    const NEEDED: bool;
    const NAME: fn(&Self) -> &str;
    const CHECK: fn(&Self) -> Result<(), String>;
    fn read(node: &Node, faults: &mut Vec<Diagnostic>) -> Option<Self> {
        let fields = kept(node.fields(), faults)?;
        from_all_fields(fields, &node.head(), &[], faults)
    }
}

impl Item for Light {
    const LIST: &str = "lights";
    const NEEDED: bool = true;
    const NAME: fn(&Self) -> &str = |light| &light.name;
    const CHECK: fn(&Self) -> Result<(), String> = Self::check;
    fn read(node: &Node, faults: &mut Vec<Diagnostic>) -> Option<Self> {
        kept(node.parse(), faults)
    }
}

impl Item for View {
    const LIST: &str = "views";
    const NEEDED: bool = true;
    const NAME: fn(&Self) -> &str = |view| &view.name;
    const CHECK: fn(&Self) -> Result<(), String> = Self::check;
}

impl Item for CameraPath {
    const LIST: &str = "paths";
    const NEEDED: bool = false;
    const NAME: fn(&Self) -> &str = |path| &path.view.name;
    const CHECK: fn(&Self) -> Result<(), String> = Self::check;
}

fn generator<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Generator, D::Error> {
    let name = String::deserialize(deserializer)?;
    name.parse().map_err(D::Error::custom)
}

fn generator_text<S: Serializer>(generator: &Generator, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(generator)
}

fn ground<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<DVec3>, D::Error> {
    let up = Vector::deserialize(deserializer)?;
    if up.try_normalize().is_none() {
        let text = format!("ground is {up}, expected a direction up, such as (0, 1, 0)");
        return Err(D::Error::custom(text));
    }
    Ok(Some(up))
}

fn only_light<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Light>, D::Error> {
    let light = Light::only(DirectionalLight::deserialize(deserializer)?);
    light.check().map_err(D::Error::custom)?;
    Ok(vec![light])
}
