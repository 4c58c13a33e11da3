//! Tests the answers of engines on rays whose right answer is known, as a driver's conformance test
//! would: is a closed surface watertight, and how many of 10⁹ rays are answered wrongly.
//!
//! ```no_run
//! use skiagraph_compare::{rays::conformance::conformance, records::rays::per_billion};
//! use skiagraph_compare::sink::Session;
//!
//! # fn test(session: Session) -> Result<(), Box<dyn std::error::Error>> {
//! let record = conformance(session, 1_000_000)?;
//! let (leaks, rays) = record.sum("RayQuery", Some(true));
//! println!("{} of 10^9 rays leak", per_billion(leaks, rays).0);
//! # Ok(())
//! # }
//! ```

use crate::error::CompareError;
use crate::measuring::{date, device};
use crate::rays::solids::{Aim, Solid, solids};
use crate::rays::tracer::{Hit, Ray, RaySet, Tracer};
use crate::records::rays::{Conformance, EXAMPLES, EngineAnswers, RayTest, WrongRay};
use crate::records::results::PROGRAM;
use crate::sink::{Session, Step};
use skiagraph_gpu::timing::Trust;
use skiagraph_passes::{Engine, SceneProvider};
use skiagraph_reference::Oracle;
use skiagraph_scene::{Mesh, Scene};
use std::sync::Arc;

/// Features to open a device with ([`open_with`](crate::measuring::device::open_with)), so that its
/// ray queries can be used.
pub const RAY_QUERIES: wgpu::Features = wgpu::Features::EXPERIMENTAL_RAY_QUERY;

/// Rays that are traced at once.
const BATCH: usize = 1 << 20;

/// Engines that answer any rays.
const ENGINES: [Engine; 2] = [Engine::Hierarchy, Engine::RayQuery];

/// Traces `count` rays of each [`Aim`] through each of [`solids`] by the engine `Hierarchy`, and by
/// `RayQuery` where the device has [`RAY_QUERIES`]; then `count` rays through a random crowd of
/// triangles, whose right answers the f64 [reference](crate#terms) finds.
///
/// # Errors
/// The errors of [`Tracer::new`] and [`Tracer::trace`], among them an early end. Wrong answers are
/// no error, but the result.
pub fn conformance(session: Session, count: u64) -> Result<Conformance, CompareError> {
    let has_queries = session.gpu.device.features().contains(RAY_QUERIES);
    let why = "the adapter has no EXPERIMENTAL_RAY_QUERY";
    let mut record = Conformance {
        schema: 1,
        program: PROGRAM.into(),
        // Nothing is timed.
        adapter: device::describe(session.gpu, Trust::Trusted),
        machine: device::machine(),
        began: date::now(),
        unavailable: Vec::new(),
        tests: Vec::new(),
    };
    if !has_queries {
        record.unavailable.push(("RayQuery".into(), why.into()));
    }
    let engines: Vec<Engine> = ENGINES[..1 + usize::from(has_queries)].to_vec();
    let solids = solids();
    let tests = solids.len() * Aim::ALL.len() + 1;
    let step = Step::begin(session.sink, "rays of known answers", tests as u64, "tests");
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    for solid in &solids {
        let mut testing = Testing::new(session, solid.scene(), &engines);
        for aim in Aim::ALL {
            record
                .tests
                .push(solid_test(&mut testing, solid, aim, count)?);
            step.set_done(record.tests.len() as u64);
        }
    }
    record.tests.push(crowd_test(session, &engines, count)?);
    step.end();
    Ok(record)
}

/// Rays of one answer through a solid.
fn solid_test(
    testing: &mut Testing,
    solid: &Solid,
    aim: Aim,
    count: usize,
) -> Result<RayTest, CompareError> {
    let mut test = RayTest {
        solid: solid.name.into(),
        reason: solid.reason.into(),
        triangles: solid.mesh.triangles.len() as u64,
        aim: aim.words().into(),
        is_blocked: Some(aim.is_blocked()),
        rays: 0,
        indeterminate: 0,
        engines: testing.answers(),
    };
    let (mut left, mut seed) = (count, 1);
    while left > 0 {
        let batch = left.min(BATCH);
        let rays = solid.rays(aim, batch, seed);
        let expected = vec![Some(aim.is_blocked()); batch];
        testing.judge(rays, &expected, &mut test)?;
        (left, seed) = (left - batch, seed + 1);
    }
    Ok(test)
}

/// Rays through many triangles that overlap, judged by the reference wherever rounding cannot flip
/// its answer.
fn crowd_test(session: Session, engines: &[Engine], count: usize) -> Result<RayTest, CompareError> {
    let scene = crowd();
    let mut testing = Testing::new(session, scene, engines);
    let scene = Arc::clone(&testing.scene);
    let mesh = &scene.mesh;
    let mut test = RayTest {
        solid: "crowd".into(),
        reason: "triangles of all sizes through each other, judged by the f64 reference".into(),
        triangles: mesh.triangles.len() as u64,
        aim: "anywhere".into(),
        is_blocked: None,
        rays: 0,
        indeterminate: 0,
        engines: testing.answers(),
    };
    let oracle = Oracle::new(mesh);
    let (mut left, mut seed) = (count, 1);
    while left > 0 {
        let batch = left.min(BATCH);
        let rays = endless_rays(batch, seed);
        let given: Vec<_> = rays.iter().map(|ray| (ray.origin, ray.direction)).collect();
        let answers = oracle.occlusion(&given).into_iter();
        let expected: Vec<_> = answers
            .map(|answer| (!answer.indeterminate).then_some(answer.blocked))
            .collect();
        testing.judge(rays, &expected, &mut test)?;
        (left, seed) = (left - batch, seed + 1);
    }
    Ok(test)
}

/// Rays that leave the cube in which the crowd is: as good as without an end.
fn endless_rays(count: usize, seed: u64) -> Vec<Ray> {
    let mut random = skiagraph_scene::generate::numbers::Random::new(seed);
    let ray = |_| Ray {
        origin: (random.in_ball() * 1.5).as_vec3(),
        t_min: 0.0,
        direction: random.direction().as_vec3(),
        t_max: 1000.0,
    };
    (0..count).map(ray).collect()
}

/// Triangles of a thousandth to a fifth of the unit ball that they are in, few enough for half of
/// all rays to pass.
fn crowd() -> Scene {
    let mut random = skiagraph_scene::generate::numbers::Random::new(3);
    let mut corners: Vec<[f32; 3]> = Vec::new();
    for index in 0..20_000 {
        let size = if index % 50 == 0 { 0.1 } else { 0.005 };
        let middle = random.in_ball();
        for _ in 0..3 {
            let corner = middle + random.direction() * size;
            corners.push(corner.as_vec3().to_array());
        }
    }
    let indices: Vec<u32> = (0..corners.len() as u32).collect();
    let indexed = skiagraph_scene::Indexed {
        positions: &corners,
        normals: &[],
        indices: &indices,
    };
    Scene {
        name: "crowd".into(),
        mesh: indexed.mesh().expect("finite corners, three a triangle"),
        views: Vec::new(),
        lights: Vec::new(),
    }
}

/// A scene, and the engines that trace through it.
struct Testing<'a> {
    session: Session<'a>,
    scene: Arc<Scene>,
    provider: SceneProvider,
    engines: &'a [Engine],
}

impl<'a> Testing<'a> {
    fn new(session: Session<'a>, scene: Scene, engines: &'a [Engine]) -> Self {
        let scene = Arc::new(scene);
        Self {
            session,
            provider: SceneProvider::new(Arc::clone(&scene)),
            scene,
            engines,
        }
    }

    /// No answers yet, of each engine.
    fn answers(&self) -> Vec<EngineAnswers> {
        let none = |engine: &Engine| EngineAnswers {
            engine: format!("{engine:?}"),
            ..EngineAnswers::default()
        };
        self.engines.iter().map(none).collect()
    }

    /// Traces rays by each engine, and counts the answers that are not as `expected`; `None` is not
    /// judged.
    fn judge(
        &mut self,
        rays: Vec<Ray>,
        expected: &[Option<bool>],
        test: &mut RayTest,
    ) -> Result<(), CompareError> {
        let judged = expected.iter().flatten().count();
        test.rays += judged as u64;
        test.indeterminate += (expected.len() - judged) as u64;
        let set = RaySet::new(test.solid.clone(), rays);
        let mut first: Vec<Hit> = Vec::new();
        for (index, engine) in self.engines.iter().enumerate() {
            self.session.check_stopped()?;
            let mut tracer = Tracer::new(self.session, &mut self.provider, &set, *engine)?;
            let (_, hits) = tracer.trace()?;
            if index == 0 {
                first.clone_from(&hits);
            }
            let answers = &mut test.engines[index];
            let rays = hits.iter().zip(&first).zip(expected.iter().zip(&set.rays));
            for ((hit, first), (expected, ray)) in rays {
                let Some(expected) = *expected else { continue };
                if hit.is_unanswered() {
                    answers.unanswered += 1;
                } else if hit.is_blocked() == expected {
                    continue;
                } else if expected {
                    answers.through += 1;
                } else {
                    answers.blocked += 1;
                }
                if answers.examples.len() < EXAMPLES {
                    let example = wrong_ray(&self.scene.mesh, ray, *hit, *first);
                    answers.examples.push(example);
                }
            }
        }
        Ok(())
    }
}

fn wrong_ray(mesh: &Mesh, ray: &Ray, hit: Hit, first: Hit) -> WrongRay {
    let corners = |primitive: u32| {
        mesh.triangles[primitive as usize].map(|index| mesh.positions[index as usize].to_array())
    };
    WrongRay {
        origin: ray.origin.to_array(),
        direction: ray.direction.to_array(),
        t_max: ray.t_max,
        primitive: hit.primitive(),
        expected: first.primitive(),
        corners: hit.primitive().or(first.primitive()).map(corners),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measuring::device::{GpuRequest, open_with};
    use crate::sink::Silent;

    #[test]
    fn the_compute_hierarchy_answers_all_rays_and_a_wrong_answer_is_counted() {
        let gpu = open_with(&GpuRequest::default(), RAY_QUERIES);
        let gpu = gpu.unwrap_or_else(|error| panic!("{error}"));
        let session = Session::new(&gpu, &Silent);
        let record = conformance(session, 300).unwrap();
        assert_eq!(record.tests.len(), 21);
        let (wrong, rays) = record.sum("Hierarchy", None);
        assert_eq!(wrong, 0, "{record:?}");
        assert!(rays > 20 * 300, "few of the crowd are judged: {rays}");

        // The same rays with the other answer expected.
        let solid = solids().remove(0);
        let mut testing = Testing::new(session, solid.scene(), &[Engine::Hierarchy]);
        for aim in [Aim::Edges, Aim::Short] {
            let mut test = solid_test(&mut testing, &solid, aim, 10).unwrap();
            let rays = solid.rays(aim, 100, 9);
            let mut expected = vec![Some(!aim.is_blocked()); 100];
            expected[7] = None;
            testing.judge(rays, &expected, &mut test).unwrap();
            let found = &test.engines[0];
            let counts = [found.through, found.blocked, found.unanswered];
            let through = if aim.is_blocked() { 0 } else { 99 };
            assert_eq!(counts, [through, 99 - through, 0]);
            assert_eq!((test.rays, test.indeterminate), (109, 1));
            assert_eq!(found.examples.len(), EXAMPLES);
            assert_eq!(found.examples[0].corners.is_some(), aim.is_blocked());
        }
    }
}
