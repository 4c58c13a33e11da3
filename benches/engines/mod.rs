//! The rays, and what traces them.

#[cfg(feature = "embree")]
mod embree;
pub mod tracer;

use skiagraph_gpu::device::Gpu;
use skiagraph_passes::Engine as Word;
use skiagraph_scene::{Scene, SceneLibrary};
use std::{sync::Arc, time::Duration};
use tracer::{RAY_QUERY, RaySet, Tracer, random_rays, shadow_rays, with_rays};

/// Rays through a scene.
pub struct Rays {
    pub scene: Arc<Scene>,
    pub set: RaySet,
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
        let loaded = SceneLibrary::from_environment().load(name);
        loaded.map(|(scene, _)| Arc::new(scene))
    };
    let shadow = |name: &str, scene: &Arc<Scene>| Rays {
        scene: Arc::clone(scene),
        set: shadow_rays(gpu, name, scene, edge),
    };
    let mut sets = Vec::new();
    match load("sponza") {
        Ok(scene) => {
            sets.push(shadow("Sponza `main`", &scene));
            let set = random_rays("Sponza, random", &scene, (edge * edge) as usize);
            sets.push(Rays { scene, set });
        }
        Err(why) => println!("without Sponza: {why}"),
    }
    let park = load("park").unwrap_or_else(|why| panic!("{why}"));
    sets.push(shadow("`park` `bench_side`", &park));
    sets
}

/// The engines that there are for these rays, the compute hierarchy first.
pub fn engines<'a>(gpu: &Gpu, rays: &'a Rays) -> Vec<Engine<'a>> {
    let mut provider = with_rays(&rays.scene, &rays.set);
    let mut engine = |word: Word| {
        let mut tracer = Tracer::new(gpu, &mut provider, &rays.set, word);
        Engine {
            name: format!("{word:?}"),
            built: tracer.built,
            trace: Box::new(move || tracer.trace()),
            blocked: Vec::new(),
        }
    };
    let mut engines = vec![engine(Word::Hierarchy)];
    if rays.set.to_light {
        engines.push(engine(Word::LightSpace));
    }
    if gpu.device.features().contains(RAY_QUERY) {
        engines.push(engine(Word::RayQuery));
    }
    #[cfg(feature = "embree")]
    engines.push(embree::engine(rays));
    engines
}
