//! Planning a graph: for which adapter, and with what scene.

use crate::graphs::light_kinds;
use glam::{DVec3, Vec3};
use skiagraph_gpu::{Provider, device::Gpu};
use skiagraph_graph::{Diagnostics, Graph, Plan, PlanRequest, Registry, Sources};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{DirectionalLight, LightKind, Mesh, PointLight, Scene, SpotLight, View};
use std::sync::Arc;

/// What an adapter can do, as far as a plan depends on it.
#[derive(Clone, Debug)]
pub struct Capabilities {
    /// Limits of a device.
    pub limits: wgpu::Limits,
    /// Its features.
    pub features: wgpu::Features,
    /// Bytes of memory for the graph, where that is known.
    pub memory: Option<u64>,
}

impl Capabilities {
    /// Of the opened device.
    pub fn of(gpu: &Gpu) -> Self {
        Self {
            limits: gpu.device.limits(),
            features: gpu.device.features(),
            memory: gpu.memory,
        }
    }

    /// Of the most able adapters of today: a graph that cannot be planned for them is at fault
    /// itself.
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
            memory: None,
        }
    }

    /// A request for a plan on such an adapter.
    pub fn request(self, viewport: [u32; 2], provider: &dyn Provider) -> PlanRequest<'_> {
        let mut request = PlanRequest::new(viewport, provider);
        request.limits = self.limits;
        request.features = self.features;
        request.memory_limit = self.memory;
        request
    }
}

const VIEWPORT: [u32; 2] = [64, 64];

/// Everything that is wrong with a graph, as far as it can be said without a scene; on an adapter,
/// or on any: then what is beyond the baseline is a warning.
pub fn check(
    path: &str,
    registry: &Registry,
    sources: &dyn Sources,
    adapter: Option<&Capabilities>,
) -> Result<(Graph, Plan), Diagnostics> {
    let mut provider = placeholder(VIEWPORT);
    let checked = check_under(&provider, path, registry, sources, adapter)?;
    for light in positional() {
        if light_kinds::takes(&checked.0, light.word()) {
            provider.set_light(light);
            check_under(&provider, path, registry, sources, adapter)?;
        }
    }
    Ok(checked)
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
        None => PlanRequest {
            any_adapter: true,
            ..PlanRequest::new(VIEWPORT, provider)
        },
    };
    Graph::check(path, registry, sources, &request)
}

/// A light of each kind besides directional ones.
pub fn positional() -> [LightKind; 2] {
    let position = DVec3::Z;
    let spot = SpotLight {
        position,
        direction: DVec3::NEG_Z,
        cone_degrees: 90.0,
        radius: 0.0,
    };
    let point = PointLight {
        position,
        radius: 0.0,
    };
    [spot.into(), point.into()]
}

/// Describes all that a scene can give, of the least scene that has it.
pub fn placeholder(viewport: [u32; 2]) -> SceneProvider {
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
    let light = DirectionalLight::new(DVec3::NEG_Z);
    let scene = Scene {
        name: "check".into(),
        mesh,
        views: vec![view.clone()],
        lights: vec![light.into()],
    };
    let mut provider = SceneProvider::new(Arc::new(scene));
    provider.set_view(&view, viewport);
    provider
}
