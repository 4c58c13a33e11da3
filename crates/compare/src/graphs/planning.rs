//! Plans graphs for an adapter, with a scene or with a placeholder for one.
//!
//! ```
//! use skiagraph_compare::graphs::planning;
//! use skiagraph_passes::{EmbeddedSources, registry};
//!
//! let (graph, plan) = planning::check("pipelines/nsm.ron", &registry(), &EmbeddedSources, None)?;
//! println!("{}: {} passes", graph.path(), plan.passes().len());
//! assert!(planning::check("pipelines/none.ron", &registry(), &EmbeddedSources, None).is_err());
//! # Ok::<(), skiagraph_graph::Diagnostics>(())
//! ```

use crate::graphs::light_kinds;
use glam::{DVec3, Vec3};
use skiagraph_gpu::{
    Provider,
    device::{Gpu, partial},
};
use skiagraph_graph::{
    Code, Diagnostics, Graph, PartialBackend, Plan, PlanRequest, Registry, Sources,
};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{
    DirectionalLight, Light, LightKind, Mesh, PointLight, Scene, SpotLight, View,
};
use std::sync::Arc;

/// Capabilities of an adapter that a plan depends on.
#[derive(Clone, Debug)]
pub struct Capabilities {
    /// Limits of the device.
    pub limits: wgpu::Limits,
    /// Features of the device.
    pub features: wgpu::Features,
    /// The graphics backend, if it lacks part of WebGPU, as OpenGL does; `None` otherwise.
    pub partial_backend: Option<PartialBackend>,
    /// Bytes that the textures and buffers of a graph may take; `None` for no limit.
    pub memory: Option<u64>,
}

impl Capabilities {
    /// Returns the capabilities of an opened device, and its limit on a graph's memory.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            limits: gpu.device.limits(),
            features: gpu.device.features(),
            partial_backend: partial(gpu.adapter.get_info().backend),
            memory: gpu.memory,
        }
    }

    /// Returns capabilities no smaller than those of the largest adapters of today. A graph that
    /// cannot be planned with them is itself at fault.
    pub fn greatest() -> Self {
        let limits = wgpu::Limits {
            max_texture_dimension_2d: 32768,
            max_texture_array_layers: 2048,
            max_compute_invocations_per_workgroup: 2048,
            ..wgpu::Limits::unlimited()
        };
        Self {
            limits,
            features: wgpu::Features::all(),
            partial_backend: None,
            memory: None,
        }
    }

    /// Creates the request for a plan on this adapter, for a viewport in pixels and a provider of
    /// the scene.
    pub fn request(self, viewport: [u32; 2], provider: &dyn Provider) -> PlanRequest<'_> {
        let mut request = PlanRequest::new(viewport, provider);
        request.limits = self.limits;
        request.features = self.features;
        request.partial_backend = self.partial_backend;
        request.memory_limit = self.memory;
        request
    }
}

const VIEWPORT: [u32; 2] = [64, 64];

/// Checks the graph at `path` without a scene, under each kind of light that it takes. Returns the
/// graph, and its plan under the first of them. With an `adapter` the graph must run on it. With
/// `None`, needs beyond wgpu's default limits and features are only warnings.
///
/// # Errors
/// All faults that were found.
pub fn check(
    path: &str,
    registry: &Registry,
    sources: &dyn Sources,
    adapter: Option<&Capabilities>,
) -> Result<(Graph, Plan), Diagnostics> {
    // A faulty document does not tell which lights it takes: then a light that is refused is passed
    // over, unless nothing else is wrong with it.
    let lights = match Graph::load(path, registry, sources) {
        Ok(graph) => stand_ins(&graph),
        Err(_) => of_each_kind().to_vec(),
    };
    let mut provider = described(VIEWPORT);
    let (mut checked, mut refused) = (None, None);
    for light in lights {
        provider.set_light(light);
        match check_under(&provider, path, registry, sources, adapter) {
            Ok(found) => {
                checked.get_or_insert(found);
            }
            Err(found) if found.iter().any(|it| it.code == Code::Light) => {
                refused.get_or_insert(found);
            }
            Err(found) => return Err(found),
        }
    }
    match (checked, refused) {
        (_, Some(refused)) => Err(refused),
        (Some(checked), None) => Ok(checked),
        // Every document takes some light.
        (None, None) => check_under(&provider, path, registry, sources, adapter),
    }
}

/// The same under one light.
fn check_under(
    provider: &SceneProvider,
    path: &str,
    registry: &Registry,
    sources: &dyn Sources,
    adapter: Option<&Capabilities>,
) -> Result<(Graph, Plan), Diagnostics> {
    let request = match adapter {
        Some(adapter) => adapter.clone().request(VIEWPORT, provider),
        None => PlanRequest::new(VIEWPORT, provider).with_any_adapter(true),
    };
    Graph::check(path, registry, sources, &request)
}

/// A light of each kind, in the order of [`LIGHT_KINDS`](skiagraph_passes::uniforms::LIGHT_KINDS).
fn of_each_kind() -> [LightKind; 3] {
    let (position, radius) = (DVec3::Z, 0.0);
    [
        DirectionalLight::new(DVec3::NEG_Z).into(),
        LightKind::Spot(SpotLight {
            position,
            direction: DVec3::NEG_Z,
            cone_degrees: 90.0,
            radius,
        }),
        LightKind::Point(PointLight { position, radius }),
    ]
}

/// Returns one example light of each kind that a graph takes, in the order directional, spot,
/// point; one of every kind if it takes none of these.
pub fn stand_ins(graph: &Graph) -> Vec<LightKind> {
    let all = of_each_kind();
    let taken = all.iter().filter(|it| light_kinds::takes(graph, it.word()));
    let taken: Vec<LightKind> = taken.copied().collect();
    if taken.is_empty() {
        all.to_vec()
    } else {
        taken
    }
}

/// Returns a provider of scene resources for planning without a scene, for a viewport in pixels. It
/// describes every resource that a scene can have, under the first kind of light (directional,
/// spot, point) that the graph takes.
pub fn placeholder(viewport: [u32; 2], graph: &Graph) -> SceneProvider {
    let mut provider = described(viewport);
    if let Some(light) = stand_ins(graph).first() {
        provider.set_light(*light);
    }
    provider
}

/// Describes all that a scene can give, of the least scene that has it.
fn described(viewport: [u32; 2]) -> SceneProvider {
    let view = View {
        name: "main".into(),
        eye: DVec3::ZERO,
        direction: DVec3::NEG_Z,
        up: DVec3::Y,
        fov_y_degrees: 60.0,
        near: 0.1,
        far: 10.0,
        light: None,
    };
    let mesh = Mesh {
        positions: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
            .map(|[x, y]| Vec3::new(x, y, -1.0))
            .into(),
        triangles: vec![[0, 1, 2]],
        normals: vec![Vec3::Z],
        normal_indices: vec![[0, 0, 0]],
        ..Mesh::default()
    };
    let scene = Scene {
        name: "check".into(),
        mesh,
        views: vec![view.clone()],
        lights: vec![Light {
            name: "light".into(),
            kind: of_each_kind()[0],
        }],
    };
    let mut provider = SceneProvider::new(Arc::new(scene));
    provider.set_view(&view, viewport);
    provider
}
