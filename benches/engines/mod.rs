//! The rays, and what traces them.

#[cfg(feature = "embree")]
mod embree;
mod gpu;

use glam::Vec3;
use skiagraph_gpu::device::Gpu;
use skiagraph_scene::{Scene, SceneLibrary, SceneRequest};
use std::{sync::Arc, time::Duration};

/// Features that `RayQuery` asks for.
pub const RAY_QUERY: wgpu::Features = wgpu::Features::EXPERIMENTAL_RAY_QUERY;

/// As the shaders have it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Ray {
    pub origin: Vec3,
    pub t_min: f32,
    pub direction: Vec3,
    pub t_max: f32,
}

/// Rays through a scene.
pub struct Rays {
    pub name: &'static str,
    pub scene: Arc<Scene>,
    pub rays: Vec<Ray>,
    /// The primitive that each ray does not see; empty if all see all.
    pub skip: Vec<u32>,
    /// True if all rays go towards the scene's light.
    pub to_light: bool,
}

/// One way to trace some rays.
pub struct Engine<'a> {
    pub name: String,
    /// How long its hierarchy took.
    pub built: Duration,
    /// Traces all of them: how long that took, and which are blocked.
    #[allow(clippy::type_complexity, reason = "one use")]
    pub trace: Box<dyn FnMut() -> (Duration, Vec<bool>) + 'a>,
    /// Answers of the first turn.
    pub blocked: Vec<bool>,
}

/// The sets of rays; shadow rays are those of `edge` × `edge` pixels.
pub fn rays(gpu: &Gpu, edge: u32) -> Vec<Rays> {
    let load = |name: &str| {
        let request = SceneRequest {
            argument: name.to_owned(),
            obj: None,
        };
        let loaded = SceneLibrary::from_environment().load(&request);
        loaded.map(|(scene, _)| Arc::new(scene))
    };
    let mut sets = Vec::new();
    match load("sponza") {
        Ok(scene) => {
            sets.push(gpu::shadow_rays(gpu, "Sponza `main`", &scene, edge));
            sets.push(random_rays("Sponza, random", &scene, edge * edge));
        }
        Err(why) => println!("without Sponza: {why}"),
    }
    let park = load("park").unwrap_or_else(|why| panic!("{why}"));
    sets.push(gpu::shadow_rays(gpu, "`park` `bench_side`", &park, edge));
    sets
}

/// From anywhere in the scene's box in any direction, a tenth of its size long.
fn random_rays(name: &'static str, scene: &Arc<Scene>, count: u32) -> Rays {
    let (low, high) = scene.mesh.bounds().unwrap_or_default();
    let mut random = skiagraph_benches::Random(1);
    let mut unit = || random.below(1 << 24) as f32 / (1u32 << 24) as f32;
    let mut vector = || Vec3::new(unit(), unit(), unit());
    let rays = (0..count).map(|_| Ray {
        origin: low + vector() * (high - low),
        t_min: 0.0,
        direction: vector() * 2.0 - 1.0,
        t_max: 0.1 * (high - low).length(),
    });
    Rays {
        name,
        scene: Arc::clone(scene),
        rays: rays.collect(),
        skip: Vec::new(),
        to_light: false,
    }
}

/// The engines that there are for these rays, the compute hierarchy first.
pub fn engines<'a>(gpu: &'a Gpu, rays: &'a Rays) -> Vec<Engine<'a>> {
    let mut all = vec![gpu::engine(gpu, rays, "Hierarchy", &["scene.bvh_nodes"])];
    if rays.to_light {
        let built = ["scene.light_space_nodes"];
        all.push(gpu::engine(gpu, rays, "LightSpace", &built));
    }
    if gpu.device.features().contains(RAY_QUERY) {
        all.push(gpu::engine(gpu, rays, "RayQuery", &[]));
    }
    #[cfg(feature = "embree")]
    all.push(embree::engine(rays));
    all
}
