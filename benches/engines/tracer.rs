//! Traces given rays by one engine of `Trace`, without a method around it.

use glam::Vec3;
use skiagraph_benches::planned;
use skiagraph_gpu::{Content, Executor, Frame, Provider, device::Gpu};
use skiagraph_graph::{Capture, Describe, MemorySources, PlanRequest};
use skiagraph_passes::{EmbeddedSources, Engine, SceneProvider, registry};
use skiagraph_scene::{Scene, generate::numbers::Random};
use skiagraph_tests::extended::Extended;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A ray as the shaders have it: it is blocked by a triangle at t if `t_min` < t ≤ `t_max`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Ray {
    origin: Vec3,
    t_min: f32,
    direction: Vec3,
    t_max: f32,
}

/// Rays that are traced together.
pub struct RaySet {
    pub name: String,
    pub rays: Vec<Ray>,
    /// For each ray the triangle that it passes through unblocked; empty if there is none.
    pub skip: Vec<u32>,
    /// True if each ray points to the scene's light, which is directional.
    pub to_light: bool,
}

/// One engine with the rays that it traces.
pub struct Tracer {
    executor: Executor,
    gpu: Gpu,
    /// Time in which the engine's hierarchy or acceleration structure was built and uploaded.
    pub built: Duration,
}

/// Feature that the engine `RayQuery` needs.
pub const RAY_QUERY: wgpu::Features = wgpu::Features::EXPERIMENTAL_RAY_QUERY;

/// Least id that names no triangle.
const NONE: u32 = 0xffff_fffd;

impl Tracer {
    /// Prepares an engine for rays through a scene, whose provider keeps the engine's hierarchy.
    /// `provider` is that of [`with_rays`].
    pub fn new(gpu: &Gpu, provider: &mut Extended, set: &RaySet, engine: Engine) -> Self {
        let (device, queue) = (&gpu.device, &gpu.queue);
        let uploaded = |provider: &mut Extended| {
            provider
                .submit_built(device, queue)
                .expect("nothing is lost");
            drop(device.poll(wgpu::PollType::wait_indefinitely()));
        };
        // All engines share the mesh's uploads, which are no part of the time.
        for shared in ["scene.positions", "scene.indices"] {
            provider.build(shared, device, queue).expect("in memory");
        }
        uploaded(provider);
        let began = Instant::now();
        match engine {
            Engine::Hierarchy => drop(provider.build("scene.bvh_nodes", device, queue)),
            Engine::LightSpace => drop(provider.build("scene.light_space_nodes", device, queue)),
            Engine::RayQuery => {
                drop(provider.build_acceleration_structure("scene.tlas", device, queue));
            }
            Engine::Embree => {}
        }
        uploaded(provider);
        let built = began.elapsed();
        let document = document(set, engine);
        let files = MemorySources::new([("any_hits.ron", document.as_str())]);
        let request = request(gpu, 1, provider);
        let sources = (&registry(), &files.over(EmbeddedSources) as _);
        let plan = planned("any_hits.ron", sources, &request);
        let executor = Executor::on(gpu, plan, provider);
        Self {
            executor: executor.unwrap_or_else(|why| panic!("{why}")),
            gpu: gpu.clone(),
            built,
        }
    }

    /// Traces all rays once, for any hit: the time from the start of encoding until the GPU was
    /// done, by the CPU's clock, and which rays are blocked.
    pub fn trace(&mut self) -> (Duration, Vec<bool>) {
        let began = Instant::now();
        run(&self.gpu, &mut self.executor, &Frame::new().with_all(true));
        let time = began.elapsed();
        // Read back by a frame of its own, which is not timed.
        let hits = read(&self.gpu, &mut self.executor, &["hits"]).remove(0);
        let blocked = hits.chunks_exact(4).map(|hit| hit[1] < NONE);
        (time, blocked.collect())
    }
}

fn run(gpu: &Gpu, executor: &mut Executor, frame: &Frame) -> Vec<Content> {
    executor.submit(frame, &|| false).expect("the passes run");
    drop(gpu.device.poll(wgpu::PollType::wait_indefinitely()));
    let report = executor.finish().expect("the frame is done");
    let readbacks = report.readbacks.into_iter();
    readbacks.map(|readback| readback.content).collect()
}

fn read(gpu: &Gpu, executor: &mut Executor, names: &[&str]) -> Vec<Vec<u32>> {
    let contents = run(gpu, executor, &Frame::new().with_read(names)).into_iter();
    contents.filter_map(|content| content.as_u32()).collect()
}

/// Returns the shadow rays that the preset `rt` traces at `edge` × `edge` pixels of the scene's
/// first view.
pub fn shadow_rays(gpu: &Gpu, name: &str, scene: &Arc<Scene>, edge: u32) -> RaySet {
    let mut provider = SceneProvider::new(Arc::clone(scene));
    provider.set_view(&scene.views[0], [edge; 2]);
    let names = ["rays", "ray_primitives", "ray_count"];
    let mut request = request(gpu, edge, &provider);
    request.captures = names.map(Capture::new).into();
    let sources = (&registry(), &EmbeddedSources as _);
    let plan = planned("pipelines/rt.ron", sources, &request);
    let executor = Executor::on(gpu, plan, &mut provider);
    let mut executor = executor.unwrap_or_else(|why| panic!("{why}"));
    let mut contents = read(gpu, &mut executor, &names);
    let count = contents[2][0] as usize;
    contents[1].truncate(count);
    let mut rays: Vec<Ray> = bytemuck::pod_collect_to_vec(&contents[0]);
    rays.truncate(count);
    RaySet {
        name: name.to_owned(),
        rays,
        skip: contents.swap_remove(1),
        to_light: scene.light_of(&scene.views[0]).directional().is_some(),
    }
}

/// Returns `count` rays from anywhere in the scene's bounding box in any direction, a tenth of the
/// box's diagonal long on average; the same on every machine.
pub fn random_rays(name: &str, scene: &Scene, count: usize) -> RaySet {
    let (low, high) = scene.mesh.bounds().unwrap_or_default();
    let mut random = Random::new(1);
    let mut vector = || {
        let mut unit = || random.range(0.0, 1.0) as f32;
        Vec3::new(unit(), unit(), unit())
    };
    let ray = |_| Ray {
        origin: low + vector() * (high - low),
        t_min: 0.0,
        direction: vector() * 2.0 - 1.0,
        t_max: 0.1 * (high - low).length(),
    };
    RaySet {
        name: name.to_owned(),
        rays: (0..count).map(ray).collect(),
        skip: Vec::new(),
        to_light: false,
    }
}

fn request<'a>(gpu: &Gpu, edge: u32, provider: &'a dyn Describe) -> PlanRequest<'a> {
    let request = PlanRequest::new([edge; 2], provider);
    request.with_device(gpu.device.limits(), gpu.device.features())
}

/// Returns a provider of a scene with the rays of a set.
pub fn with_rays(scene: &Arc<Scene>, set: &RaySet) -> Extended {
    let mut provider = Extended::new(SceneProvider::new(Arc::clone(scene)));
    provider.add("given.rays", &set.rays);
    provider.add("given.skip", &set.skip);
    provider.add("given.number", &[set.rays.len() as u32]);
    provider
}

/// A graph of one pass, which traces.
fn document(set: &RaySet, engine: Engine) -> String {
    let direction = set.to_light.then_some(", direction: Light");
    let skip = (!set.skip.is_empty()).then_some(r#", skip: "given.skip""#);
    let [direction, skip] = [direction, skip].map(Option::unwrap_or_default);
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
        )"#
    )
}
