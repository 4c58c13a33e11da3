//! The schemas of `any_hits.json` and `rays.json`, version 1: speed and answers of the engines of
//! `Trace` on given rays.
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

/// Content of `any_hits.json`: any hits per second of every engine.
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
    /// Start of the measurement, in UTC.
    pub began: String,
    /// Number of timed turns; each engine traces all rays once in each.
    pub turns: u32,
    /// The sets of rays.
    pub sets: Vec<RaySetSpeed>,
}

/// Speed of the engines on one set of rays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RaySetSpeed {
    /// Name of the set.
    pub name: String,
    /// Scene through which the rays go.
    pub scene: Scene,
    /// Number of rays.
    pub rays: u64,
    /// The engines, `Hierarchy` first.
    pub engines: Vec<EngineSpeed>,
}

/// Speed of one engine on one set of rays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EngineSpeed {
    /// Name of the engine, as documents write it: `Hierarchy`.
    pub engine: String,
    /// Time in which its hierarchy was built and uploaded, in milliseconds.
    pub built_ms: f64,
    /// Median time from submission to the end, in milliseconds.
    pub ms: f64,
    /// Millions of rays per second, by the median.
    pub mrays_per_s: f64,
    /// Number of rays that it found blocked.
    pub blocked: u64,
    /// Number of rays that it answered unlike `Hierarchy`.
    pub unlike_first: u64,
    /// Number of rays that it did not answer.
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
    /// Start of the test, in UTC.
    pub began: String,
    /// Engines that cannot run here, each with the reason.
    pub unavailable: Vec<(String, String)>,
    /// The tests, each with the same rays for every engine.
    pub tests: Vec<RayTest>,
}

/// Rays through one solid that have one right answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RayTest {
    /// Name of the solid or scene.
    pub solid: String,
    /// Its surface, and the errors that it provokes.
    pub reason: String,
    /// Number of its triangles.
    pub triangles: u64,
    /// Places at which the rays are aimed: `at edges`.
    pub aim: String,
    /// Right answer: true if the rays are blocked; null where each has its own, by the reference.
    pub is_blocked: Option<bool>,
    /// Number of rays with a right answer.
    pub rays: u64,
    /// Number of rays besides, whose answer rounding decides: not judged.
    pub indeterminate: u64,
    /// Answers of the engines.
    pub engines: Vec<EngineAnswers>,
}

/// Answers of one engine in one test.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EngineAnswers {
    /// Name of the engine, as documents write it: `RayQuery`.
    pub engine: String,
    /// Number of blocked rays that it let through: leaks, where the surface is closed.
    pub through: u64,
    /// Number of unblocked rays that it found blocked.
    pub blocked: u64,
    /// Number of rays that it did not answer, because the driver ended the shader's loops.
    pub unanswered: u64,
    /// The first wrong rays, at most [`EXAMPLES`].
    pub examples: Vec<WrongRay>,
}

/// Most wrong rays that a record holds of one engine in one test.
pub const EXAMPLES: usize = 8;

/// A ray that was answered wrongly; its numbers are exact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WrongRay {
    /// Begin of the ray.
    pub origin: [f32; 3],
    /// Direction of the ray.
    pub direction: [f32; 3],
    /// Greatest t, in lengths of the direction; the least is 0.
    pub t_max: f32,
    /// Primitive that the engine found; null if none.
    pub primitive: Option<u32>,
    /// Primitive that `Hierarchy` finds; null if none.
    pub expected: Option<u32>,
    /// Corners of `primitive`, or else of `expected`; null if there is neither.
    pub corners: Option<[[f32; 3]; 3]>,
}

impl EngineAnswers {
    /// Returns the number of rays with a wrong answer, or none.
    pub fn wrong(&self) -> u64 {
        self.through + self.blocked + self.unanswered
    }
}

impl Conformance {
    /// Returns the number of rays that were answered wrongly, over all engines and tests.
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

    /// Sums up an engine's answers: wrong rays, and all. With `blocked`, only rays that are all
    /// blocked, or all not: those of closed solids.
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

/// Returns the share of wrong rays in wrong rays per 10⁹, and its upper bound with a certainty of
/// 95 % (Poisson): where none of n is wrong, 3/n. Rounded to a tenth.
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
