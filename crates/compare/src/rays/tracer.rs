//! Traces given rays by one engine of `Trace`, without a method around it.
//!
//! ```no_run
//! use glam::Vec3;
//! use skiagraph_compare::{rays::tracer::{Ray, RaySet, Tracer}, sink::Session};
//! use skiagraph_passes::{Engine, SceneProvider};
//! use skiagraph_scene::Scene;
//! use std::sync::Arc;
//!
//! # fn count(session: Session, scene: Arc<Scene>) -> Result<(), Box<dyn std::error::Error>> {
//! let ray = Ray { origin: Vec3::ZERO, t_min: 0.0, direction: Vec3::Y, t_max: 100.0 };
//! let set = RaySet::new("up", vec![ray]);
//! let mut provider = SceneProvider::new(scene);
//! let mut tracer = Tracer::new(session, &mut provider, &set, Engine::Hierarchy)?;
//! let (time, hits) = tracer.trace()?;
//! println!("{time:?}: blocked by {:?}", hits[0].primitive());
//! # Ok(())
//! # }
//! ```

use crate::error::CompareError;
use crate::graphs::faults::reasons;
use crate::graphs::planning::Capabilities;
use crate::measuring::frame;
use crate::sink::Session;
use glam::Vec3;
use skiagraph_gpu::{Executor, Frame, Provider, ProviderError};
use skiagraph_graph::{Capture, Describe, Graph, Plan, Provided, ProvidedBinding, Sources};
use skiagraph_passes::{EmbeddedSources, Engine, SceneProvider, registry};
use skiagraph_scene::Scene;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};
use wgpu::util::DeviceExt;

/// A ray as the shaders have it: it is blocked by a triangle at t if `t_min` < t ≤ `t_max`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Ray {
    /// Begin of the ray, in scene units.
    pub origin: Vec3,
    /// Least t, in lengths of [`direction`](Self::direction); 0 or more.
    pub t_min: f32,
    /// Direction of the ray, of any length but zero.
    pub direction: Vec3,
    /// Greatest t, in lengths of [`direction`](Self::direction); finite.
    pub t_max: f32,
}

/// Rays that are traced together.
#[derive(Clone, Debug, Default)]
pub struct RaySet {
    /// Name of the set, for tables and messages.
    pub name: String,
    /// The rays; at least one, and at most [`MOST_RAYS`].
    pub rays: Vec<Ray>,
    /// For each ray the id of the triangle that it passes through unblocked (its index in the
    /// mesh), in the order of [`rays`](Self::rays); empty if every triangle blocks every ray.
    pub skip: Vec<u32>,
    /// True if every ray's direction is, bit for bit, the unit vector towards the scene's first
    /// light that shaders have (`light.to_light`); that light is directional. The engine
    /// [`LightSpace`](Engine::LightSpace) answers a ray with any other direction as a miss.
    pub to_light: bool,
}

/// Greatest number of rays of a set: at 32 bytes a ray they are the 128 MiB that every GPU binds as
/// one buffer.
pub const MOST_RAYS: usize = 1 << 22;

impl RaySet {
    /// Creates a set of rays with an empty [`skip`](Self::skip) and a false
    /// [`to_light`](Self::to_light).
    pub fn new(name: impl Into<String>, rays: Vec<Ray>) -> Self {
        Self {
            name: name.into(),
            rays,
            ..Self::default()
        }
    }
}

/// Answer of an engine for a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hit(u32);

impl Hit {
    /// Returns the id of a triangle that blocks the ray, its index in the mesh; `None` if the ray
    /// is not blocked, or has no answer.
    pub fn primitive(self) -> Option<u32> {
        (self.0 < UNANSWERED).then_some(self.0)
    }

    /// True if a triangle blocks the ray.
    pub fn is_blocked(self) -> bool {
        self.0 < UNANSWERED
    }

    /// True if the driver ended the shader's loops before the ray had an answer.
    pub fn is_unanswered(self) -> bool {
        self.0 == UNANSWERED
    }
}

/// Least primitive id that is none: the ray has no answer.
const UNANSWERED: u32 = 0xffff_fffd;

/// One [`Engine`] of `Trace` with the rays that it traces.
pub struct Tracer<'a> {
    session: Session<'a>,
    executor: Executor,
    /// Time in which the engine's hierarchy or acceleration structure was built and uploaded.
    pub built: Duration,
}

impl<'a> Tracer<'a> {
    /// Prepares an engine for rays through a scene. The provider keeps the engine's hierarchy:
    /// where the provider has the hierarchy already, [`built`](Self::built) is next to nothing.
    ///
    /// # Errors
    /// [`CompareError::Input`] if there are no rays, or more than [`MOST_RAYS`], or if the engine
    /// cannot run on this adapter; the errors of the executor.
    pub fn new(
        session: Session<'a>,
        scene: &mut SceneProvider,
        set: &RaySet,
        engine: Engine,
    ) -> Result<Self, CompareError> {
        let count = set.rays.len();
        if count == 0 || count > MOST_RAYS {
            return Err(CompareError::Input(format!(
                "{count} rays of the set `{}` cannot be traced at once: give 1 to {MOST_RAYS}",
                set.name
            )));
        }
        let mut given = Given {
            scene,
            set,
            count: [count as u32],
        };
        let (device, queue) = (&session.gpu.device, &session.gpu.queue);
        let refused = |why: ProviderError| CompareError::Input(format!("`{engine:?}`: {why}"));
        // All engines share the mesh's uploads, which are no part of the time.
        for shared in ["scene.positions", "scene.indices"] {
            given.build(shared, device, queue).map_err(refused)?;
        }
        given.submit_built(device, queue).map_err(refused)?;
        let wait = || drop(device.poll(wgpu::PollType::wait_indefinitely()));
        wait();
        let began = Instant::now();
        let structure = match engine {
            Engine::Hierarchy => Some("scene.bvh_nodes"),
            Engine::LightSpace => Some("scene.light_space_nodes"),
            Engine::RayQuery | Engine::Embree => None,
        };
        if let Some(name) = structure {
            given.build(name, device, queue).map_err(refused)?;
        } else if engine == Engine::RayQuery && device.features().contains(RAY_QUERY) {
            let built = given.build_acceleration_structure("scene.tlas", device, queue);
            built.map_err(refused)?;
        }
        given.submit_built(device, queue).map_err(refused)?;
        wait();
        let built = began.elapsed();
        let document = Document(document(set, engine));
        let plan = plan(session, "any_hits.ron", &document, [1, 1], &given)?;
        let executor = frame::executor(session, plan, &mut given);
        Ok(Self {
            session,
            executor: executor.map_err(|error| frame::failed(session, "any_hits", error))?,
            built,
        })
    }

    /// Traces all rays once, for any hit. Returns the time from the start of encoding until the GPU
    /// was done, by the CPU's clock, and an answer for each ray, in the order of [`RaySet::rays`].
    ///
    /// # Errors
    /// The errors of the executor; an early end ([`CompareError::Interrupted`]).
    pub fn trace(&mut self) -> Result<(Duration, Vec<Hit>), CompareError> {
        let failed = |error| frame::failed(self.session, "any_hits", error);
        let all = Frame::new().with_all(true);
        let (_, time) = frame::run(self.session, &mut self.executor, &all).map_err(failed)?;
        // Read back by a frame of its own, which is not timed.
        let contents = frame::read(self.session, &mut self.executor, &["hits"]).map_err(failed)?;
        let words = contents["hits"].as_u32().unwrap_or_default();
        let hits = words.chunks_exact(4).map(|hit| Hit(hit[1]));
        Ok((time, hits.collect()))
    }
}

/// Feature that the engine `RayQuery` needs.
const RAY_QUERY: wgpu::Features = wgpu::Features::EXPERIMENTAL_RAY_QUERY;

/// Returns the shadow rays that the preset `rt` traces at `edge` × `edge` pixels of the scene's
/// first view: one for each pixel that asks one, with the pixel's own triangle in
/// [`skip`](RaySet::skip). `name` is the set's name.
///
/// # Errors
/// [`CompareError::Input`] if the scene has no view, or no pixel asks a ray; the errors of the
/// executor.
pub fn shadow_rays(
    session: Session,
    name: &str,
    scene: &Arc<Scene>,
    edge: u32,
) -> Result<RaySet, CompareError> {
    let none = || CompareError::Input(format!("{name} has no pixel that asks a ray"));
    let viewport = [edge; 2];
    let view = scene.views.first().ok_or_else(none)?;
    let mut provider = SceneProvider::new(Arc::clone(scene));
    provider.set_view(view, viewport);
    let names = ["rays", "ray_primitives", "ray_count"];
    let graph = loaded("pipelines/rt.ron", &EmbeddedSources)?;
    let mut request = Capabilities::new(session.gpu).request(viewport, &provider);
    request.captures = names.map(Capture::new).into();
    request.outputs = Some(vec![]);
    let plan = graph.plan(&request);
    let plan = plan.map_err(|faults| CompareError::Input(reasons(faults.iter())))?;
    let (contents, _) = frame::render(session, "rt", plan, &mut provider, &names)?;
    let words = |name: &str| contents[name].as_u32().unwrap_or_default();
    let mut rays: Vec<Ray> = bytemuck::pod_collect_to_vec(&words("rays"));
    let mut skip = words("ray_primitives");
    let count = words("ray_count").first().copied().unwrap_or_default() as usize;
    rays.truncate(count);
    skip.truncate(count);
    if rays.is_empty() {
        return Err(none());
    }
    Ok(RaySet {
        name: name.to_owned(),
        rays,
        skip,
        to_light: scene.light_of(view).directional().is_some(),
    })
}

fn loaded(path: &str, sources: &dyn Sources) -> Result<Graph, CompareError> {
    Graph::load(path, &registry(), sources)
        .map_err(|faults| CompareError::Input(reasons(faults.iter())))
}

fn plan(
    session: Session,
    path: &str,
    sources: &dyn Sources,
    viewport: [u32; 2],
    provider: &dyn Provider,
) -> Result<Plan, CompareError> {
    let request = Capabilities::new(session.gpu).request(viewport, provider);
    let plan = loaded(path, sources)?.plan(&request);
    plan.map_err(|faults| CompareError::Input(reasons(faults.iter())))
}

/// A graph of one pass, which traces.
fn document(set: &RaySet, engine: Engine) -> String {
    let direction = if set.to_light {
        ", direction: Light"
    } else {
        ""
    };
    let skip = if set.skip.is_empty() {
        ""
    } else {
        ", skip: \"given.skip\""
    };
    format!(
        r#"(
            format: 3,
            materials: [Buffer(name: "hits", count: "given.rays.count")],
            passes: [
                Trace(
                    name: "trace", rays: "given.rays", hits: "hits", count: "given.number",
                    mode: Any, engine: {engine:?}{direction}{skip},
                ),
            ],
            outputs: ["hits"],
            proven_on: [gl],
        )"#
    )
}

/// The document alone; its shaders are the embedded ones.
struct Document(String);

impl Sources for Document {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        match path {
            "any_hits.ron" => Ok(Some(self.0.as_str().into())),
            _ => EmbeddedSources.read(path),
        }
    }

    fn list(&self, folder: &str) -> Vec<String> {
        EmbeddedSources.list(folder)
    }
}

/// A scene with rays.
struct Given<'a> {
    scene: &'a mut SceneProvider,
    set: &'a RaySet,
    count: [u32; 1],
}

impl Given<'_> {
    fn content(&self, name: &str) -> Option<(&[u8], u64)> {
        match name {
            "given.rays" => Some((bytemuck::cast_slice(&self.set.rays), 32)),
            "given.skip" => Some((bytemuck::cast_slice(&self.set.skip), 4)),
            "given.number" => Some((bytemuck::cast_slice(&self.count), 4)),
            _ => None,
        }
    }
}

impl Describe for Given<'_> {
    fn names(&self) -> Vec<String> {
        self.scene.names()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let Some((content, stride)) = self.content(name) else {
            return self.scene.describe(name);
        };
        Some(Provided::new(
            ProvidedBinding::Storage,
            Some(content.len() as u64 / stride),
            stride,
        ))
    }
}

impl Provider for Given<'_> {
    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        let Some((contents, _)) = self.content(name) else {
            return self.scene.build(name, device, queue);
        };
        let descriptor = wgpu::util::BufferInitDescriptor {
            label: Some(name),
            contents,
            usage: wgpu::BufferUsages::STORAGE,
        };
        Ok(device.create_buffer_init(&descriptor))
    }

    fn submit_built(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<(), ProviderError> {
        self.scene.submit_built(device, queue)
    }

    fn build_acceleration_structure(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Tlas, ProviderError> {
        self.scene.build_acceleration_structure(name, device, queue)
    }
}
