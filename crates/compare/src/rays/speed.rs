//! Times [engines](skiagraph_passes::Engine) of `Trace` on the same rays: any hits per second.
//!
//! ```no_run
//! use skiagraph_compare::{rays::speed::{SpeedRequest, any_hits}, sink::Session};
//! use skiagraph_scene::Scene;
//! use std::sync::Arc;
//!
//! # fn time(session: Session, park: Arc<Scene>) -> Result<(), Box<dyn std::error::Error>> {
//! for set in any_hits(session, &SpeedRequest::new(vec![park], 512, 5))?.sets {
//!     for engine in set.engines {
//!         println!("{}, {}: {} Mrays/s", set.name, engine.engine, engine.mrays_per_s);
//!     }
//! }
//! # Ok(())
//! # }
//! ```

use crate::error::CompareError;
use crate::measuring::{date, device};
use crate::rays::tracer::{Hit, MOST_RAYS, Ray, RaySet, Tracer, shadow_rays};
use crate::records::rays::{AnyHits, EngineSpeed, RaySetSpeed};
use crate::records::results::PROGRAM;
use crate::records::statistics::Spread;
use crate::sink::{Session, Step};
use glam::Vec3;
use skiagraph_gpu::timing::Trust;
use skiagraph_passes::{Engine, SceneProvider};
use skiagraph_scene::{Scene, generate::numbers::Random};
use std::{sync::Arc, time::Duration};

/// Request for a measurement by [`any_hits`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SpeedRequest {
    /// Scenes through which rays go; each has a view.
    pub scenes: Vec<Arc<Scene>>,
    /// Width and height in pixels of the picture whose shadow rays are traced; with 2048 or less
    /// they are at most [`MOST_RAYS`]. As many random rays as the picture has pixels are traced
    /// besides.
    pub edge: u32,
    /// Number of timed turns, 1 or more.
    pub turns: u32,
}

impl SpeedRequest {
    /// Creates a request from its [`scenes`](Self::scenes), [`edge`](Self::edge) and
    /// [`turns`](Self::turns).
    pub fn new(scenes: Vec<Arc<Scene>>, edge: u32, turns: u32) -> Self {
        Self {
            scenes,
            edge,
            turns,
        }
    }
}

/// Times every engine that the adapter has, on two sets of rays for each scene: those of
/// [`shadow_rays`], then those of [`random_rays`]. The engine `LightSpace` takes part only in
/// shadow rays of a directional light. Engines take turns, so that other work of the machine meets
/// all of them. A turn before the timed ones is not timed; its answers are compared.
///
/// # Errors
/// The errors of [`shadow_rays`], [`Tracer::new`] and [`Tracer::trace`], among them an early end.
pub fn any_hits(session: Session, request: &SpeedRequest) -> Result<AnyHits, CompareError> {
    let mut record = AnyHits {
        schema: 1,
        program: PROGRAM.into(),
        // Rays are timed by the CPU's clock.
        adapter: device::describe(session.gpu, Trust::Trusted),
        machine: device::machine(),
        began: date::now(),
        turns: request.turns,
        sets: Vec::new(),
    };
    for scene in &request.scenes {
        let shadow = format!("{}, shadow rays", scene.name);
        let random = format!("{}, random rays", scene.name);
        let count = (request.edge as usize).pow(2).min(MOST_RAYS);
        for set in [
            shadow_rays(session, &shadow, scene, request.edge)?,
            RaySet::new(random, random_rays(scene, count)),
        ] {
            record
                .sets
                .push(set_speed(session, scene, &set, request.turns)?);
        }
    }
    Ok(record)
}

/// The engines that this adapter has for these rays.
fn engines(session: Session, set: &RaySet) -> Vec<Engine> {
    let features = session.gpu.device.features();
    let light_space = set.to_light.then_some(Engine::LightSpace);
    let has_queries = features.contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY);
    let ray_query = has_queries.then_some(Engine::RayQuery);
    let all = [Some(Engine::Hierarchy), light_space, ray_query];
    all.into_iter().flatten().collect()
}

fn set_speed(
    session: Session,
    scene: &Arc<Scene>,
    set: &RaySet,
    turns: u32,
) -> Result<RaySetSpeed, CompareError> {
    let mut provider = SceneProvider::new(Arc::clone(scene));
    let engines = engines(session, set);
    let tracers = engines.iter();
    let tracers = tracers.map(|engine| Tracer::new(session, &mut provider, set, *engine));
    let mut tracers = tracers.collect::<Result<Vec<_>, _>>()?;
    let mut answers: Vec<Vec<Hit>> = Vec::new();
    let mut times: Vec<Vec<Duration>> = vec![Vec::new(); tracers.len()];
    let step = Step::begin(session.sink, &set.name, u64::from(turns) + 1, "turns");
    for turn in 0..=turns {
        for (tracer, times) in tracers.iter_mut().zip(&mut times) {
            let (time, hits) = tracer.trace()?;
            // The first turn warms up, and is what answers are compared by.
            match turn {
                0 => answers.push(hits),
                _ => times.push(time),
            }
        }
        step.set_done(u64::from(turn) + 1);
    }
    step.end();
    let rays = set.rays.len() as u64;
    let speeds = engines.iter().zip(&tracers).zip(times.iter().zip(&answers));
    let speeds = speeds.map(|((engine, tracer), (times, hits))| {
        let ms = Spread::new(times).map_or(0.0, |spread| spread.median);
        let count = |counts: fn(&Hit) -> bool| hits.iter().filter(|hit| counts(hit)).count() as u64;
        let pairs = hits.iter().zip(&answers[0]);
        let unlike = pairs.filter(|(hit, first)| hit.is_blocked() != first.is_blocked());
        EngineSpeed {
            engine: format!("{engine:?}"),
            built_ms: tracer.built.as_secs_f64() * 1e3,
            ms,
            mrays_per_s: rays as f64 / ms / 1e3,
            blocked: count(|hit| hit.is_blocked()),
            unlike_first: unlike.count() as u64,
            unanswered: count(|hit| hit.is_unanswered()),
        }
    });
    Ok(RaySetSpeed {
        name: set.name.clone(),
        scene: (&**scene).into(),
        rays,
        engines: speeds.collect(),
    })
}

/// Returns `count` rays from anywhere in the scene's bounding box in any direction, a tenth of the
/// box's diagonal times the length of [`direction`](Ray::direction) long; the same on every
/// machine.
pub fn random_rays(scene: &Scene, count: usize) -> Vec<Ray> {
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
    (0..count).map(ray).collect()
}
