//! The schemas of `any_hits.json` and `rays.json`, version 1: speed and answers of the
//! [engines](skiagraph_passes::Engine) of `Trace` on given rays.
//!
//! ```
//! use skiagraph_compare::records::rays::per_billion;
//!
//! assert_eq!(per_billion(2, 1_000_000), (2000.0, 7221.0));
//! // None of a million was wrong: with 95 % certainty no more than 3 of a million are.
//! assert_eq!(per_billion(0, 1_000_000), (0.0, 3000.0));
//! ```

use crate::records::results::{Adapter, Machine, Scene};
use serde::{Deserialize, Serialize};

/// Content of `any_hits.json`: speed of every engine at finding any hit of a ray, not the closest
/// one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AnyHits {
    /// Version of this schema: 1.
    pub schema: u32,
    /// The program that measured, `skiagraph 0.1.0`.
    pub program: String,
    /// GPU on which the rays were traced.
    pub adapter: Adapter,
    /// Machine on which the rays were traced.
    pub machine: Machine,
    /// Start of the measurement, in UTC: `2026-11-21T04:30:12Z`.
    pub began: String,
    /// Number of timed turns; each engine traces all rays once in each.
    pub turns: u32,
    /// The sets of rays: for each scene its shadow rays, then random ones.
    pub sets: Vec<RaySetSpeed>,
}

/// Speed of the engines on one set of rays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RaySetSpeed {
    /// Name of the set: `park, shadow rays`.
    pub name: String,
    /// Scene through which the rays go.
    pub scene: Scene,
    /// Number of rays in the set.
    pub rays: u64,
    /// The engines that the adapter has for these rays, `Hierarchy` first.
    pub engines: Vec<EngineSpeed>,
}

/// Speed of one engine on one set of rays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EngineSpeed {
    /// Name of the [`Engine`](skiagraph_passes::Engine), as documents write it: `Hierarchy`.
    pub engine: String,
    /// Time in which the engine's hierarchy or acceleration structure was built and uploaded, in
    /// milliseconds.
    pub built_ms: f64,
    /// Time in which all rays of the set were traced once, from the start of encoding until the GPU
    /// was done, by the CPU's clock: the median over the turns, in milliseconds.
    pub ms: f64,
    /// Millions of rays per second, by the median time [`ms`](Self::ms).
    pub mrays_per_s: f64,
    /// Number of rays that the engine found blocked.
    pub blocked: u64,
    /// Number of rays that only one of the engine and `Hierarchy` found blocked.
    pub unlike_first: u64,
    /// Number of rays that the engine did not answer, because the driver ended the shader's loops.
    pub unanswered: u64,
}

/// Content of `rays.json`: rays whose right answer is known, and how engines answer them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conformance {
    /// Version of this schema: 1.
    pub schema: u32,
    /// The program that judged, `skiagraph 0.1.0`.
    pub program: String,
    /// GPU on which the rays were traced.
    pub adapter: Adapter,
    /// Machine on which the rays were traced.
    pub machine: Machine,
    /// Start of the tests, in UTC: `2026-11-21T04:30:12Z`.
    pub began: String,
    /// Names of the engines that cannot run on this adapter, each with the reason.
    pub unavailable: Vec<(String, String)>,
    /// The tests, each with the same rays for every engine.
    pub tests: Vec<RayTest>,
}

/// Rays through one [solid](crate::rays::solids::Solid), or through a crowd of triangles, and the
/// engines' answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RayTest {
    /// Name of the solid, or `crowd`.
    pub solid: String,
    /// Description of the surface and of the errors that it provokes, as one line.
    pub reason: String,
    /// Number of triangles of the surface.
    pub triangles: u64,
    /// Places at which the rays are aimed, the [words](crate::rays::solids::Aim::words) of an aim
    /// such as `at edges`; `anywhere` in the crowd.
    pub aim: String,
    /// Right answer of all rays: true if they are blocked. Null in the crowd, where each ray has
    /// its own answer, by the [reference](crate#terms).
    pub is_blocked: Option<bool>,
    /// Number of rays that are judged, as their right answer is known.
    pub rays: u64,
    /// Number of further rays that are not judged, as rounding decides their answer.
    pub indeterminate: u64,
    /// Answers of the engines that ran, `Hierarchy` first.
    pub engines: Vec<EngineAnswers>,
}

/// Answers of one engine in one test.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EngineAnswers {
    /// Name of the [`Engine`](skiagraph_passes::Engine), as documents write it: `RayQuery`.
    pub engine: String,
    /// Number of rays that are blocked, but that the engine let through: leaks, where the surface
    /// is closed.
    pub through: u64,
    /// Number of rays that are not blocked, but that the engine found blocked.
    pub blocked: u64,
    /// Number of rays that the engine did not answer, because the driver ended the shader's loops.
    pub unanswered: u64,
    /// The first wrong rays, at most [`EXAMPLES`].
    pub examples: Vec<WrongRay>,
}

/// Greatest number of wrong rays that [`EngineAnswers::examples`] holds.
pub const EXAMPLES: usize = 8;

/// A ray that was answered wrongly; its numbers are exact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WrongRay {
    /// Begin of the ray, in scene units.
    pub origin: [f32; 3],
    /// Direction of the ray, of any length.
    pub direction: [f32; 3],
    /// Greatest t of a hit, in lengths of [`direction`](Self::direction); the least is 0.
    pub t_max: f32,
    /// Id of the triangle that the engine found, its index in the mesh; null if the engine found
    /// none.
    pub primitive: Option<u32>,
    /// Id of the triangle that `Hierarchy` finds, its index in the mesh; null if it finds none.
    pub expected: Option<u32>,
    /// Corners of the triangle `primitive`, or if that is null of `expected`, in scene units; null
    /// if both are null.
    pub corners: Option<[[f32; 3]; 3]>,
}

impl EngineAnswers {
    /// Returns the number of rays with a wrong answer or without an answer.
    pub fn wrong(&self) -> u64 {
        self.through + self.blocked + self.unanswered
    }
}

impl Conformance {
    /// Returns the number of rays that were answered wrongly or not at all, over all engines and
    /// tests.
    pub fn wrong(&self) -> u64 {
        let engines = self.tests.iter().flat_map(|test| &test.engines);
        engines.map(EngineAnswers::wrong).sum()
    }

    /// Returns the names of the engines that ran, in their order.
    pub fn engines(&self) -> Vec<&str> {
        let first = self.tests.first().into_iter();
        let names = first.flat_map(|test| &test.engines);
        names.map(|of| of.engine.as_str()).collect()
    }

    /// Returns the number of rays that the engine with this name answered wrongly or not at all,
    /// and the number of all judged rays, over the tests. With `blocked`, only tests with this
    /// [`is_blocked`](RayTest::is_blocked) count: those of closed solids.
    pub fn sum(&self, engine: &str, blocked: Option<bool>) -> (u64, u64) {
        let tests = self.tests.iter();
        let tests = tests.filter(|test| blocked.is_none() || test.is_blocked == blocked);
        tests.fold((0, 0), |(wrong, rays), test| {
            let own = test.engines.iter().filter(|of| of.engine == engine);
            let found: u64 = own.map(EngineAnswers::wrong).sum();
            (wrong + found, rays + test.rays)
        })
    }
}

/// Returns the share of `wrong` among `rays` in wrong rays per 10⁹, and its upper bound with a
/// certainty of 95 % (Poisson), at most 10⁹; where none of n is wrong, the bound is 3/n. Both are
/// rounded to a tenth. Without rays they are 0 and 10⁹.
pub fn per_billion(wrong: u64, rays: u64) -> (f64, f64) {
    if rays == 0 {
        return (0.0, 1e9);
    }
    let each = 1e9 / rays as f64;
    let most = if wrong == 0 {
        3.0
    } else {
        // Wilson and Hilferty's approximation of χ²(0.975, 2n + 2) / 2.
        let n = wrong as f64 + 1.0;
        n * (1.0 - 1.0 / (9.0 * n) + 1.96 / (3.0 * n.sqrt())).powi(3)
    };
    let tenths = |value: f64| (value * 10.0).round() / 10.0;
    (tenths(wrong as f64 * each), tenths(most * each).min(1e9))
}
