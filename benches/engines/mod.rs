//! The rays, and what traces them.

#[cfg(feature = "embree")]
mod embree;

use skiagraph_compare::{
    rays::{
        speed::random_rays,
        tracer::{RaySet, Tracer, shadow_rays},
    },
    sink::Session,
};
use skiagraph_passes::{Engine as Word, SceneProvider};
use skiagraph_scene::{Scene, SceneLibrary, SceneRequest};
use std::{sync::Arc, time::Duration};

/// Features that `RayQuery` asks for.
pub const RAY_QUERY: wgpu::Features = wgpu::Features::EXPERIMENTAL_RAY_QUERY;

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
pub fn rays(session: Session, edge: u32) -> Vec<Rays> {
    let load = |name: &str| {
        let request = SceneRequest {
            argument: name.to_owned(),
            obj: None,
        };
        let loaded = SceneLibrary::from_environment().load(&request);
        loaded.map(|(scene, _)| Arc::new(scene))
    };
    let shadow = |name: &str, scene: &Arc<Scene>| {
        let set = shadow_rays(session, name, scene, edge);
        Rays {
            scene: Arc::clone(scene),
            set: set.unwrap_or_else(|why| panic!("{why}")),
        }
    };
    let mut sets = Vec::new();
    match load("sponza") {
        Ok(scene) => {
            sets.push(shadow("Sponza `main`", &scene));
            let random = random_rays(&scene, (edge * edge) as usize);
            let set = RaySet::new("Sponza, random", random);
            sets.push(Rays { scene, set });
        }
        Err(why) => println!("without Sponza: {why}"),
    }
    let park = load("park").unwrap_or_else(|why| panic!("{why}"));
    sets.push(shadow("`park` `bench_side`", &park));
    sets
}

/// The engines that there are for these rays, the compute hierarchy first.
pub fn engines<'a>(session: Session<'a>, rays: &'a Rays) -> Vec<Engine<'a>> {
    let mut provider = SceneProvider::new(Arc::clone(&rays.scene));
    let mut engine = |word: Word| {
        let tracer = Tracer::new(session, &mut provider, &rays.set, word);
        let mut tracer = tracer.unwrap_or_else(|why| panic!("{why}"));
        Engine {
            name: format!("{word:?}"),
            built: tracer.built,
            trace: Box::new(move || {
                let (time, hits) = tracer.trace().unwrap_or_else(|why| panic!("{why}"));
                (time, hits.iter().map(|hit| hit.is_blocked()).collect())
            }),
            blocked: Vec::new(),
        }
    };
    let mut all = vec![engine(Word::Hierarchy)];
    if rays.set.to_light {
        all.push(engine(Word::LightSpace));
    }
    if session.gpu.device.features().contains(RAY_QUERY) {
        all.push(engine(Word::RayQuery));
    }
    #[cfg(feature = "embree")]
    all.push(embree::engine(rays));
    all
}
