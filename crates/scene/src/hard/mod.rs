//! Scenes on which shadow methods go wrong: the catalogue of `skiagraph stress`.
//!
//! Every case is a function that builds a small scene, the same bits on every machine, with one view named `main`, and says in a line
//! what it provokes. Where geometry alone tells which points are lit, it tells so, so that the oracle is tested, too.

mod answer;
mod build;
mod fences;
mod light;
mod map;
mod plain;
mod rounding;
mod solids;
mod thin;
mod topology;

use crate::Scene;
use glam::DVec3;

/// One case of the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct HardCase {
    /// Name on the command line: lower case, words joined by `_`.
    pub name: &'static str,
    /// What it provokes, in one line.
    pub reason: &'static str,
    /// What its casters are, which decides what may be asked of methods that cull front faces.
    pub casters: Casters,
    /// Most pixels in the band, as a share of the pixels that face the light.
    pub band_cap: f64,
    /// What its picture shows.
    pub shows: Shows,
    build: fn() -> Scene,
    lit: Option<fn(DVec3) -> Option<bool>>,
}

/// What the casters of a scene are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Casters {
    /// Closed surfaces wound outward that do not pass through each other: no lit surface is its own caster when front faces are culled.
    Closed,
    /// Sheets, surfaces wound both ways, or solids that pass through each other: front faces culled, some cast no shadow.
    Open,
}

/// What the pixels of a case's picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// Some lit, some in shadow.
    Both,
    /// All that face the light are lit.
    LitOnly,
    /// None faces the light.
    Nothing,
}

/// The band of a case that says nothing else, as a share of the pixels that face the light.
const BAND_CAP: f64 = 0.01;

impl HardCase {
    /// A case whose picture shows both light and shadow, without an analytic answer, and still without a scene.
    const fn new(name: &'static str, reason: &'static str, casters: Casters) -> Self {
        Self {
            name,
            reason,
            casters,
            band_cap: BAND_CAP,
            shows: Shows::Both,
            build: || build::Shape::default().scene([0.0; 3], [1.0; 3], DVec3::NEG_Y),
            lit: None,
        }
    }

    /// Builds it.
    pub fn scene(&self) -> Scene {
        Scene {
            name: self.name.into(),
            ..(self.build)()
        }
    }

    /// Whether light reaches a point of a surface that faces the light, told from the geometry; `None` where it is too close to call
    /// or the case has no such answer.
    pub fn lit(&self, point: DVec3) -> Option<bool> {
        self.lit.and_then(|lit| lit(point))
    }

    /// Whether [`HardCase::lit`] has answers at all.
    pub fn is_analytic(&self) -> bool {
        self.lit.is_some()
    }
}

/// The catalogue, in the order in which it is shown.
pub fn cases() -> Vec<HardCase> {
    [
        plain::CASES,
        rounding::CASES,
        light::CASES,
        map::CASES,
        fences::CASES,
        thin::CASES,
        solids::CASES,
        topology::CASES,
    ]
    .concat()
}

/// The case of that name.
pub fn case(name: &str) -> Option<HardCase> {
    cases().into_iter().find(|case| case.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::{BTreeSet, HashMap};

    #[test]
    fn every_case_is_a_sound_scene_with_a_name_and_a_reason_of_its_own() {
        let mut names = BTreeSet::new();
        for case in cases() {
            assert!(names.insert(case.name), "{} twice", case.name);
            assert!(
                case.name
                    .chars()
                    .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_'),
                "{}",
                case.name
            );
            assert!(
                !case.reason.is_empty() && !case.reason.contains('\n'),
                "{}",
                case.name
            );
            let Scene {
                name,
                mesh,
                views,
                light,
            } = case.scene();
            assert_eq!(name, case.name);
            assert!(views.len() == 1 && views[0].name == "main", "{name}");
            assert!(
                light.direction.is_finite() && light.direction != DVec3::ZERO,
                "{name}"
            );
            assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name}");
            let known = |index: &u32| (*index as usize) < mesh.positions.len();
            assert!(mesh.triangles.iter().flatten().all(known), "{name}");
            assert_eq!(mesh.triangles.len(), mesh.normal_indices.len(), "{name}");
            assert!(
                mesh.triangles.len() < 20_000,
                "{name}: too large for a matrix that CI runs"
            );
        }
    }
    /// Every edge as often one way as the other, and every connected part wound outward.
    #[test]
    fn closed_casters_are_closed() {
        for case in cases().iter().filter(|c| c.casters == Casters::Closed) {
            let mesh = case.scene().mesh;
            let mut ways = HashMap::new();
            for &[a, b, c] in &mesh.triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    let way = if from < to { 1 } else { -1 };
                    *ways.entry((from.min(to), from.max(to))).or_insert(0) += way;
                }
            }
            let open = ways.values().filter(|&&sum| sum != 0).count();
            assert_eq!(open, 0, "{}: open edges", case.name);
            for (part, volume) in volumes(&mesh) {
                assert!(
                    volume > 0.0,
                    "{}: the part of position {part} encloses {volume}",
                    case.name
                );
            }
        }
    }

    /// The volume within each set of triangles that hang together, by its lowest position.
    fn volumes(mesh: &crate::Mesh) -> HashMap<u32, f64> {
        let mut parts: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        loop {
            let before = parts.clone();
            for triangle in &mesh.triangles {
                let lowest = triangle.map(|i| parts[i as usize]).into_iter().min();
                triangle
                    .iter()
                    .for_each(|&i| parts[i as usize] = lowest.unwrap_or(i));
            }
            if parts == before {
                break;
            }
        }
        let mut volumes = HashMap::new();
        for (i, triangle) in mesh.triangles.iter().enumerate() {
            let part = parts[triangle[0] as usize];
            let origin = mesh.positions[part as usize].as_dvec3();
            let [a, b, c] = mesh.corners(i as u32).map(|corner| corner - origin);
            *volumes.entry(part).or_insert(0.0) += a.dot(b.cross(c));
        }
        volumes
    }
}
