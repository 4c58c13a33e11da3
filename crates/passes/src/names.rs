//! Names of resources that a [`SceneProvider`](crate::SceneProvider) offers to graphs; its table
//! lists all of them.
//!
//! A plan lists the names that its passes ask for:
//!
//! ```
//! use skiagraph_graph::{Graph, PlanRequest};
//! use skiagraph_passes::{EmbeddedSources, SceneProvider, names::LIGHT, registry};
//! # use skiagraph_scene::{DirectionalLight, Indexed};
//! # let positions = &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
//! # let indices = &[0, 1, 2];
//! # let mesh = Indexed { positions, normals: &[], indices }.mesh()?;
//! # let sun = DirectionalLight::new(glam::DVec3::NEG_Y);
//!
//! let provider = SceneProvider::from_mesh(mesh, sun);
//! let graph = Graph::load("pipelines/nsm.ron", &registry(), &EmbeddedSources)?;
//! let plan = graph.plan(&PlanRequest::new([64, 64], &provider))?;
//! assert!(plan.provided().contains(&LIGHT));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::eye::Eye;
use skiagraph_scene::LightKind;
use std::sync::atomic::{AtomicU64, Ordering};

pub(crate) const POSITIONS: &str = "scene.positions";
pub(crate) const INDICES: &str = "scene.indices";
/// Positions of parts before their maps move them; no graph sees it.
pub(crate) const AT_REST: &str = "positions at rest";
pub(crate) const NORMALS: &str = "scene.normals";
pub(crate) const BVH_NODES: &str = "scene.bvh_nodes";
pub(crate) const BVH_PRIMITIVES: &str = "scene.bvh_primitives";
pub(crate) const LIGHT_SPACE_NODES: &str = "scene.light_space_nodes";
pub(crate) const LIGHT_SPACE_PRIMITIVES: &str = "scene.light_space_primitives";
pub(crate) const TLAS: &str = "scene.tlas";
pub(crate) const EMBREE: &str = "scene.embree";
/// Name of the storage buffer of the triangles' alpha masks
/// ([`mask_words`](skiagraph_scene::packed_masks::mask_words)), which `shared/masks.wgsl`
/// reads. It has no items if no triangle of the scene is masked (cut out by the alpha of its
/// texture) or double-sided.
pub const MASKS: &str = "scene.masks";
/// Name of the storage buffer of the triangles that cast shadows, ascending, each with its three
/// indices and its primitive id, which `shared/listed_casters.wgsl` reads. The list of a scene
/// without casters counts no items, and holds one of 0xffffffff.
pub const CASTERS: &str = "scene.casters";
/// Name of the storage buffer of the triangles' roles in shadows
/// ([`shadow_words`](skiagraph_scene::packed_masks::shadow_words)), which `shared/roles.wgsl`
/// reads. It has no items if all triangles cast shadows and receive them.
pub const SHADOWS: &str = "scene.shadows";
/// Name of the storage buffer of the [`Sheets`](skiagraph_scene::Sheets), a bit per triangle,
/// which `shared/sheets.wgsl` reads: the triangles of which shadow maps draw both faces. It has
/// no items if the scene has none.
pub const SHEETS: &str = "scene.sheets";
/// Name of the uniform buffer of the camera
/// ([`CameraUniform`](crate::uniforms::CameraUniform)), which `shared/camera.wgsl` reads.
pub const CAMERA: &str = "camera";
/// Name of the uniform buffer that holds the matrix from a depth buffer to positions
/// ([`UnprojectionUniform`](crate::uniforms::UnprojectionUniform)), which
/// `shared/unprojection.wgsl` reads.
pub const UNPROJECTION: &str = "unprojection";
/// Name of the uniform buffer of the light and its light space
/// ([`LightUniform`](crate::uniforms::LightUniform)), which `shared/light.wgsl` reads.
pub const LIGHT: &str = "light";
/// Name of the uniform buffer of the light's disk
/// ([`LightAreaUniform`](crate::uniforms::LightAreaUniform)), which `shared/light_area.wgsl`
/// reads.
pub const LIGHT_AREA: &str = "light_area";

/// Returns a number that no provider of this process has counted yet: equal versions mean equal
/// content, across all providers.
pub(crate) fn next_version() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

/// Appends an item to a list of at most `most`, of which the first one goes.
pub(crate) fn remember<T>(list: &mut Vec<T>, item: T, most: usize) {
    if list.len() >= most {
        list.remove(0);
    }
    list.push(item);
}

/// Settings made lately, each with a number for its content. A setting made again gets the number
/// that it had: executors that have seen it have nothing to do.
#[derive(Clone, Debug)]
pub(crate) struct Lately<T> {
    /// The value that is set.
    pub now: T,
    number: u64,
    /// Values that were set before.
    known: Vec<(T, u64)>,
}

impl<T: PartialEq> Lately<T> {
    /// How many are remembered: more than executors take turns with one provider.
    const MOST: usize = 31;

    pub fn new(value: T) -> Self {
        Self {
            now: value,
            number: next_version(),
            known: Vec::new(),
        }
    }

    pub fn set(&mut self, value: T) {
        if value == self.now {
            return;
        }
        let place = self.known.iter().position(|(former, _)| *former == value);
        let number = place.map_or_else(next_version, |at| self.known.remove(at).1);
        let before = std::mem::replace(&mut self.now, value);
        remember(&mut self.known, (before, self.number), Self::MOST);
        self.number = number;
    }
}

/// A light, and the version of what is made from it and the mesh's shape together.
#[derive(Clone, Debug)]
pub(crate) struct Laid {
    pub light: Lately<LightKind>,
    over: Lately<[u64; 2]>,
}

impl Laid {
    fn new(light: LightKind, shape: u64) -> Self {
        let light = Lately::new(light);
        Self {
            over: Lately::new([light.number, shape]),
            light,
        }
    }

    fn set(&mut self, light: LightKind, shape: u64) {
        self.light.set(light);
        self.lay(shape);
    }

    fn lay(&mut self, shape: u64) {
        self.over.set([self.light.number, shape]);
    }
}

/// Things that resources are made from, each with a [version](Versions).
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum MadeFrom {
    Eye,
    Light,
    LightOverShape,
    /// All lights, or one of them, which the mesh has no part in.
    Lights,
    LightsOverShape,
    Shape,
    Winding,
    Mesh,
}

/// Eye and lights that the provider is set to, and a version of everything that its resources are
/// made from: resources of equal versions have equal contents.
#[derive(Clone, Debug)]
pub(crate) struct Versions {
    pub eye: Lately<Eye>,
    pub light: Laid,
    /// All lights of the scene, or the view's own.
    pub lights: Lately<Vec<LightKind>>,
    /// Each of them, so that one that moves changes no other.
    each: Vec<Laid>,
    /// Versions of all lights and the shape together.
    lights_over: Lately<[u64; 2]>,
    /// Places and normals of the mesh's corners.
    pub shape: u64,
    /// In which order the corners of triangles come.
    winding: u64,
    /// All else of the mesh.
    mesh: u64,
}

impl Versions {
    pub fn new(eye: Eye, light: LightKind, lights: Vec<LightKind>) -> Self {
        let shape = next_version();
        let each = lights.iter().map(|light| Laid::new(*light, shape));
        let (each, lights) = (each.collect(), Lately::new(lights));
        Self {
            eye: Lately::new(eye),
            light: Laid::new(light, shape),
            lights_over: Lately::new([lights.number, shape]),
            lights,
            each,
            shape,
            winding: next_version(),
            mesh: next_version(),
        }
    }

    pub fn set_light(&mut self, light: LightKind) {
        self.light.set(light, self.shape);
    }

    pub fn set_lights(&mut self, lights: Vec<LightKind>) {
        self.each.truncate(lights.len());
        for (laid, light) in self.each.iter_mut().zip(&lights) {
            laid.set(*light, self.shape);
        }
        let count = self.each.len();
        let added = lights[count..].iter();
        self.each
            .extend(added.map(|light| Laid::new(*light, self.shape)));
        self.lights.set(lights);
        self.lights_over.set([self.lights.number, self.shape]);
    }

    /// Notes that the mesh was replaced by another mesh.
    pub fn change_mesh(&mut self) {
        self.mesh = next_version();
        self.change_winding();
        self.change_shape();
    }

    /// Notes that the surfaces of triangles have changed.
    pub fn change_surfaces(&mut self) {
        self.mesh = next_version();
    }

    /// Notes that triangles are wound the other way, or have other corners.
    pub fn change_winding(&mut self) {
        self.winding = next_version();
    }

    /// Notes that corners of the mesh have moved.
    pub fn change_shape(&mut self) {
        self.shape = next_version();
        self.light.lay(self.shape);
        for laid in &mut self.each {
            laid.lay(self.shape);
        }
        self.lights_over.set([self.lights.number, self.shape]);
    }

    /// Returns the version of a resource that is made from these, in a list of lights that of the
    /// light of that number, or else of the list.
    pub fn get(&self, made_from: MadeFrom, number: Option<usize>) -> u64 {
        let laid = number.and_then(|number| self.each.get(number));
        match made_from {
            MadeFrom::Eye => self.eye.number,
            MadeFrom::Light => self.light.light.number,
            MadeFrom::LightOverShape => self.light.over.number,
            MadeFrom::Lights => laid.map_or(self.lights.number, |laid| laid.light.number),
            MadeFrom::LightsOverShape => {
                laid.map_or(self.lights_over.number, |laid| laid.over.number)
            }
            MadeFrom::Shape => self.shape,
            MadeFrom::Winding => self.winding,
            MadeFrom::Mesh => self.mesh,
        }
    }
}
